"""One row per kind of field: what it holds, and how that is checked, kept, constructed and sent.

Lists are kept by reference, so `to_wire` checks them when they are sent; it joins bools and bytes, which
`from_wire` takes apart.
"""

from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from course_lib.ros.messages import checks
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, Primitive

Convert = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Kind:
    """The conversions of the values of a field; None stands for "as it is"."""

    default: Callable[[], Any]
    check: checks.Check
    construct: Convert | None = None  # what a constructor makes of its argument before the setter sees it
    keep: Convert | None = None  # what the setter stores
    to_wire: Convert | None = None
    from_wire: Convert | None = None
    exact: type | None = None  # every value of exactly this type passes the check, and is kept as it is


def kind_of(field: FieldDefinition, message_class: Callable[[str], type]) -> Kind:
    """Find a field's kind; `message_class` gives the class of a sub message."""
    kind = _kind_of(field, message_class)
    if field.default is None or field.container == "scalar":
        return kind
    return replace(kind, default=lambda: (kind.construct or list)(field.default))


def _kind_of(field: FieldDefinition, message_class: Callable[[str], type]) -> Kind:
    if field.is_message:
        item = message_class(field.base)
        if field.container == "scalar":
            return Kind(item, checks.message_check(field, item), exact=item)
        return _list(field, item, None)
    primitive = PRIMITIVES[field.base]
    if field.container == "scalar":
        return _scalar(field, primitive)
    if primitive.code:
        return (_block if field.container == "array" else _numbers)(field, primitive)
    return _list(field, primitive.python, primitive)


def _scalar(field: FieldDefinition, primitive: Primitive) -> Kind:
    default = _one(primitive) if field.default is None else lambda: field.default
    exact = primitive.python if checks.needs_type_only(field, primitive) else None
    check = checks.scalar_check(field, primitive)
    return Kind(default, check, exact=exact)


def _one(primitive: Primitive) -> Callable[[], Any]:
    return (lambda: b"\x00") if primitive.python is bytes else primitive.python


def _numbers(field: FieldDefinition, primitive: Primitive) -> Kind:
    """An array.array; one that is assigned is kept itself, anything else is copied into a new one."""
    code, dtype = primitive.code, primitive.dtype

    def pack(value: Any) -> "array[Any]":
        if not isinstance(value, np.ndarray) or value.ndim != 1:
            return array(code, value)
        return array(code, np.ascontiguousarray(value, dtype).tobytes())

    return Kind(
        default=lambda: array(code),
        check=checks.numbers_check(field, primitive),
        construct=pack,
        keep=lambda value: value if isinstance(value, array) else pack(value),
    )


def _block(field: FieldDefinition, primitive: Primitive) -> Kind:
    """A numpy array of fixed length; one that is assigned is kept itself."""
    dtype = primitive.dtype
    return Kind(
        default=lambda: np.zeros(field.size, dtype),
        check=checks.block_check(field, primitive),
        construct=lambda value: np.array(value, dtype),
        keep=lambda value: value if isinstance(value, np.ndarray) else np.array(value, dtype),
    )


def _list(field: FieldDefinition, item: type, primitive: Primitive | None) -> Kind:
    """A list kept by reference, so what a program appended is checked only when it is sent."""
    check = checks.collection_check(field, item, primitive)
    send, receive = _LISTS.get(field.base, (None, None))

    is_free = field.container == "sequence" and not field.size and not field.string_bound
    allowed = {item}

    def to_wire(value: Any) -> Any:
        if not (is_free and type(value) is list and (not value or set(map(type, value)) == allowed)):
            check(value)
        return value if send is None else send(value)

    one = item if primitive is None else _one(primitive)
    length = field.size if field.container == "array" else 0
    return Kind(
        default=lambda: [one() for _ in range(length)], check=check, to_wire=to_wire, from_wire=receive
    )


# How lists of single bytes travel.
_LISTS: Mapping[str, tuple[Convert, Convert]] = {
    "bool": (bytes, lambda octets: [octet != 0 for octet in octets]),
    "byte": (b"".join, lambda octets: [bytes([octet]) for octet in octets]),
}
