"""Messages as CDR bytes, by rosbags' serialiser, and as plain Python values."""

from array import array
from collections.abc import Iterator
from functools import cache
from struct import error as StructError  # noqa: N812  # a class under a lower-case name
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.messages.compiled import maker
from course_lib.ros.messages.definitions import definition, typestore
from course_lib.ros.messages.kinds import CONVERTED, Convert
from course_lib.ros.messages.message import RosMessage
from course_lib.ros.messages.registry import message_class

if TYPE_CHECKING:
    from rosbags.interfaces.typing import FieldDesc
    from rosbags.typesys.store import MsgType

    from course_lib.ros.messages.store import CdrStore

M = TypeVar("M", bound=RosMessage)


def serialize(message: RosMessage) -> bytes:
    """Return a message's CDR bytes (little endian, with the 4 bytes of encapsulation header).

    Raises an AssertionError for a value that got in behind the setters' back, by ``append`` for example.
    """
    store = _store_with(message._TYPE_NAME)
    try:
        return store.pack(message, message._TYPE_NAME)
    except (AttributeError, TypeError, ValueError, StructError):
        try:
            _check(message)
        except AssertionError as complaint:
            raise complaint from None
        raise


def deserialize(cdr: bytes, cls: type[M]) -> M:
    """Create a message from CDR bytes; raises a CourseError if they are of another type."""
    store = _store_with(cls._TYPE_NAME)
    try:
        message: Any = store.deserialize_cdr(memoryview(cdr), cls._TYPE_NAME)
    except store.malformed as error:
        raise CourseError(f"These {len(cdr)} bytes are no {cls._TYPE_NAME}: {error}") from error
    made: M = message
    return made


def compile_wire(type_name: str) -> None:
    """Compile what a type's messages need to be sent and heard, so that forks of this process find it."""
    _store_with(type_name).get_msgdef(type_name)


@cache
def _store_with(type_name: str) -> "CdrStore":
    """Return the store of our own classes after adding one type and the types in its lists."""
    store = _store()
    if type_name not in store.types:
        store.fielddefs[type_name] = ([], list(_flat(type_name)))
        # rosbags only ever calls it with the values of the fields in order
        store.types[type_name] = cast("type[MsgType]", maker(message_class(type_name)))
    return store


def _flat(type_name: str, path: str = "") -> Iterator[tuple[str, "FieldDesc"]]:
    """Yield what rosbags reads of a message, also of those in its fields: one function then does it all."""
    cls, known = message_class(type_name), typestore().fielddefs[type_name][1]
    for field, (_, desc) in zip(definition(type_name).fields, known, strict=True):
        if field.is_message and field.container == "scalar":
            yield from _flat(field.base, f"{path}_{field.name}.")
            continue
        yield path + _wire_name(cls, field.name), desc
        if field.is_message:
            _store_with(field.base)


@cache
def _store() -> "CdrStore":
    from course_lib.ros.messages.store import CdrStore

    return CdrStore()


def _wire_name(cls: type[RosMessage], name: str) -> str:
    """Name the attribute that rosbags reads: the slot itself, or a property that converts what is in it."""
    kind, wire_name = cls._KINDS.get(name), f"{CONVERTED}{name}"
    if kind is None:
        setattr(cls, wire_name, 0)  # the placeholder of a message without fields
    elif kind.to_wire is None:
        return f"_{name}"
    else:
        setattr(cls, wire_name, _converted(f"_{name}", kind.to_wire))
    return wire_name


def _converted(slot: str, to_wire: Convert) -> property:
    return property(lambda message: to_wire(getattr(message, slot)))


def _check(message: RosMessage) -> None:
    """Run the setters' checks on all that a message holds, the innermost first."""
    for name, kind in message._KINDS.items():
        value = getattr(message, name)
        for inner in value if isinstance(value, list | tuple) else [value]:
            if isinstance(inner, RosMessage):
                _check(inner)
        kind.check(value)


def to_plain(value: Any, truncate: int | None = None) -> Any:
    """Turn a message, or a field's value, into dicts, lists, strings and numbers, in the fields' order.

    Follows rosidl_runtime_py.convert: bytes become a string of as many characters; lists and strings longer
    than `truncate` end in "...".
    """
    if isinstance(value, RosMessage):
        return {name: to_plain(getattr(value, name), truncate) for name in value._KINDS}
    if isinstance(value, bytes | bytearray):
        value = value.decode("latin-1")
    long = truncate is not None and not isinstance(value, bool | int | float) and len(value) > truncate
    if isinstance(value, str):
        return value[:truncate] + "..." if long else value
    if isinstance(value, list | tuple | array | np.ndarray):
        shown = value[:truncate] if long else value
        return [*_elements(shown, truncate), *(["..."] if long else [])]
    return value.item() if isinstance(value, np.generic) else value


def _elements(values: Any, truncate: int | None) -> list[Any]:
    if isinstance(values, array | np.ndarray):
        return list(values.tolist())
    return [to_plain(value, truncate) for value in values]
