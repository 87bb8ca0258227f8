"""Messages as CDR bytes, and as plain Python values."""

from array import array
from struct import error as StructError  # noqa: N812  # a class under a lower-case name
from typing import Any, TypeVar

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.messages.cdr_layout import LITTLE
from course_lib.ros.messages.cdr_reader import MALFORMED, ORDERS, unpacker
from course_lib.ros.messages.cdr_writer import packer
from course_lib.ros.messages.message import RosMessage

M = TypeVar("M", bound=RosMessage)


def serialize(message: RosMessage) -> bytes:
    """Return a message's CDR bytes (little endian, with the 4 bytes of encapsulation header).

    Raises an AssertionError for a value that got in behind the setters' back, by ``append`` for example.
    """
    try:
        return packer(message._TYPE_NAME)(message)
    except (AttributeError, TypeError, ValueError, StructError):
        try:
            _check(message)
        except AssertionError as complaint:
            raise complaint from None
        raise


def deserialize(cdr: bytes, cls: type[M]) -> M:
    """Create a message from CDR bytes; raises a CourseError if they are of another type."""
    data = bytes(cdr)
    try:
        order = ORDERS.get(data[:2])
        if order is None:
            raise ValueError("its first bytes name no encapsulation that is known")
        message: M = unpacker(cls._TYPE_NAME, order)(data)
    except MALFORMED as error:
        raise CourseError(f"These {len(cdr)} bytes are no {cls._TYPE_NAME}: {error}") from error
    return message


def compile_wire(type_name: str) -> None:
    """Compile what a type's messages need to be sent and heard, so that forks of this process find it."""
    packer(type_name)
    unpacker(type_name, LITTLE)


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
