"""A table of field kinds: how the values of each kind are checked, stored, constructed and serialized.

The checks and their error texts are those of rosidl_generator_py (resource/_msg.py.em). Jazzy
disables them, and a publisher then aborts the whole process when a value has the wrong type; here
they are enabled, as in Humble. Lists are stored by reference, so `to_wire` checks them when they
are sent. It joins lists of bools and bytes, which `from_wire` splits again.
"""

import sys
from array import array
from collections import UserString
from collections.abc import Callable, Collection, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from math import isinf
from typing import Any, cast

import numpy as np

from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, Primitive

# Raises AssertionError if the value is invalid.
Check = Callable[[Any], None]
Fits = Callable[[Any], bool]

# The types that Python converts to a number in an array.
_CONVERTED: dict[type, tuple[type, ...]] = {
    float: (float, int, np.floating, np.integer),
    int: (int, np.integer),
}


def make_check(field: FieldDefinition, rule: str, fits: Fits) -> Check:
    """Return a check with the error "The 'x' field must be …"."""

    def check(value: Any) -> None:
        if not fits(value):
            raise AssertionError(f"The '{field.name}' field must be {rule}")

    return check


def scalar_check(field: FieldDefinition, primitive: Primitive) -> Check:
    """Return the check of a number, bool, string or byte, which is a ``bytes`` of length 1."""
    python, max_length = primitive.python, field.string_bound
    if python is bytes:
        rule = "of type 'bytes' or 'ByteString' with length 1"
        return make_check(field, rule, lambda value: isinstance(value, bytes | bytearray) and len(value) == 1)
    if max_length:
        rule = f"string value not longer than {max_length}"
        return make_check(field, rule, lambda value: isinstance(value, str) and len(value) <= max_length)
    if not primitive.range_noun:
        return make_check(field, f"of type '{python.__name__}'", lambda value: isinstance(value, python))
    article = "an" if python is int else "a"
    limits = f"{article} {primitive.range_noun} in [{primitive.low}, {primitive.high}]"

    # The cast prevents mypy from narrowing the value to object.
    low, high, exact = primitive.low, primitive.high, cast("Any", python)

    def check_number(value: Any) -> None:
        # A shortcut for nearly all values.
        if type(value) is exact and low <= value <= high:
            return
        if not isinstance(value, python):
            raise AssertionError(f"The '{field.name}' field must be of type '{python.__name__}'")
        if not _is_in_range(value, primitive):
            raise AssertionError(f"The '{field.name}' field must be {limits}")

    return check_number


def collection_check(field: FieldDefinition, item: type, primitive: Primitive | None) -> Check:
    """Return the check of a sequence or array of `item`. `primitive` has the range of numbers."""
    ranged = primitive if primitive is not None and primitive.range_noun else None

    def fits(value: Any) -> bool:
        return (
            (isinstance(value, Sequence | Set) or (isinstance(value, np.ndarray) and value.ndim == 1))
            and not isinstance(value, str | UserString)
            and _is_valid_length(value, field)
            and all(isinstance(element, item) for element in value)
            and (not field.string_bound or all(len(element) <= field.string_bound for element in value))
            and (ranged is None or all(_is_in_range(element, ranged) for element in value))
        )

    return make_check(field, _describe_collection(field, item, primitive), fits)


def numbers_check(field: FieldDefinition, primitive: Primitive) -> Check:
    """Return the check of a sequence of numbers: by type code for an array.array, else by element.

    All values that `array.array(code, value)` converts are accepted, as on Jazzy: integers for
    floats, numpy numbers, arrays of another type code, one-dimensional numpy arrays.
    """
    element_types = _CONVERTED[primitive.python]
    elements = _describe_collection(field, primitive.python, primitive)
    ranged = primitive if primitive.range_noun else None

    def fits(value: Any) -> bool:
        return (
            isinstance(value, Collection)
            and not isinstance(value, str | UserString | Mapping)
            and _is_valid_length(value, field)
            and all(isinstance(element, element_types) for element in value)
            and (ranged is None or all(_is_in_range(element, ranged) for element in value))
        )

    check_elements = make_check(field, elements, fits)

    def check(value: Any) -> None:
        if isinstance(value, array) and value.typecode == primitive.code:
            if not _is_valid_length(value, field):
                raise AssertionError(f"The '{field.name}' array.array() must have a size <= {field.size}")
        elif (
            isinstance(value, bytes | bytearray) and primitive.code == "B" and _is_valid_length(value, field)
        ):
            # Bytes are always in range, and an image has a hundred thousand of them.
            return
        elif not (isinstance(value, np.ndarray) and _are_valid_numbers(value, field, primitive)):
            check_elements(value)

    return check


def block_check(field: FieldDefinition, primitive: Primitive) -> Check:
    """Return the check of an array of fixed length: by dtype for a numpy array, else by element."""
    check_elements = numbers_check(field, primitive)

    def check(value: Any) -> None:
        if not isinstance(value, np.ndarray):
            check_elements(value)
        elif value.dtype.kind not in ("iuf" if primitive.python is float else "iu"):
            dtype = f"numpy.{primitive.dtype.name}"
            raise AssertionError(f"The '{field.name}' numpy.ndarray() must have the dtype of '{dtype}'")
        elif value.shape != (field.size,):
            # This includes matrices, of which Jazzy sends one column and undefined bytes.
            raise AssertionError(f"The '{field.name}' numpy.ndarray() must have a size of {field.size}")
        elif value.dtype != primitive.dtype:
            check_elements(value)

    return check


def _is_in_range(value: Any, primitive: Primitive) -> bool:
    if primitive.python is float:
        return not (value < primitive.low or value > primitive.high) or isinf(value)
    return bool(primitive.low <= value <= primitive.high)


def _is_valid_length(value: Collection[Any], field: FieldDefinition) -> bool:
    if field.container == "array":
        return len(value) == field.size
    return not field.size or len(value) <= field.size


def _are_valid_numbers(
    value: "np.ndarray[Any, Any]",
    field: FieldDefinition,
    primitive: Primitive,
) -> bool:
    if value.ndim != 1 or value.dtype.kind not in ("iuf" if primitive.python is float else "iu"):
        return False
    ends = [value.min(), value.max()] if value.size and primitive.python is int else []
    return all(_is_in_range(end, primitive) for end in ends) and _is_valid_length(value, field)


def _describe_collection(field: FieldDefinition, item: type, primitive: Primitive | None) -> str:
    phrases = ["a set or sequence"]
    if field.size:
        phrases.append(f"with length {'<= ' if field.container == 'sequence' else ''}{field.size}")
    if field.string_bound:
        phrases.append(f"and each string value not longer than {field.string_bound}")
    phrases.append(f"and each value of type '{item.__name__}'")
    if primitive is not None and primitive.range_noun:
        style = ".6f" if primitive.python is float else "d"
        limits = f"[{primitive.low:{style}}, {primitive.high:{style}}]"
        phrases.append(f"and each {primitive.range_noun} in {limits}")
    return " ".join(phrases)


Convert = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Kind:
    """The conversions of a field's values. None means no conversion."""

    default: Callable[[], Any]
    check: Check
    # Converts a constructor's argument before it is passed to the setter.
    construct: Convert | None = None
    # Converts the value that the setter stores.
    keep: Convert | None = None
    to_wire: Convert | None = None
    from_wire: Convert | None = None
    # All values of exactly this type are valid and stored unchanged.
    exact: type | None = None


def kind_of(field: FieldDefinition, message_class: Callable[[str], type]) -> Kind:
    """Return a field's kind. `message_class` returns the class of a nested message."""
    kind = _kind_of(field, message_class)
    if field.default is None or field.container == "scalar":
        return kind
    return replace(kind, default=lambda: (kind.construct or list)(field.default))


def _kind_of(field: FieldDefinition, message_class: Callable[[str], type]) -> Kind:
    if field.is_message:
        item = message_class(field.base)
        if field.container == "scalar":
            rule = f"a sub message of type '{item.__name__}'"
            return Kind(item, make_check(field, rule, lambda value: isinstance(value, item)), exact=item)
        return _list(field, item, None)
    primitive = PRIMITIVES[field.base]
    if field.container == "scalar":
        default = _default_factory(primitive) if field.default is None else lambda: field.default
        is_double = primitive.python is float and primitive.high == sys.float_info.max
        is_free = primitive.python in (bool, str) and not field.string_bound
        exact = primitive.python if is_double or is_free else None
        return Kind(default, scalar_check(field, primitive), exact=exact)
    if primitive.code:
        return (_block if field.container == "array" else _numbers)(field, primitive)
    return _list(field, primitive.python, primitive)


def _default_factory(primitive: Primitive) -> Callable[[], Any]:
    return (lambda: b"\x00") if primitive.python is bytes else primitive.python


def _numbers(field: FieldDefinition, primitive: Primitive) -> Kind:
    """An array.array.

    One that is assigned is stored itself; other values are copied into a new one.
    """
    code, dtype = primitive.code, primitive.dtype

    def pack(value: Any) -> "array[Any]":
        if not isinstance(value, np.ndarray) or value.ndim != 1:
            return array(code, value)
        return array(code, np.ascontiguousarray(value, dtype).tobytes())

    return Kind(
        default=lambda: array(code),
        check=numbers_check(field, primitive),
        construct=pack,
        keep=lambda value: value if isinstance(value, array) and value.typecode == code else pack(value),
    )


def _block(field: FieldDefinition, primitive: Primitive) -> Kind:
    """A numpy array of fixed length. One that is assigned is stored itself."""
    dtype = primitive.dtype
    return Kind(
        default=lambda: np.zeros(field.size, dtype),
        check=block_check(field, primitive),
        construct=lambda value: np.array(value, dtype),
        keep=lambda value: np.asarray(value, dtype),
    )


def _list(field: FieldDefinition, item: type, primitive: Primitive | None) -> Kind:
    """A list stored by reference, so elements that a program appends are checked only when it is sent."""
    check = collection_check(field, item, primitive)
    send, receive = _LISTS.get(field.base, (None, None))

    is_free = field.container == "sequence" and not field.size and not field.string_bound
    element_types = {item}

    def to_wire(value: Any) -> Any:
        if not (is_free and type(value) is list and (not value or set(map(type, value)) == element_types)):
            check(value)
        return value if send is None else send(value)

    one = item if primitive is None else _default_factory(primitive)
    length = field.size if field.container == "array" else 0
    return Kind(
        default=lambda: [one() for _ in range(length)], check=check, to_wire=to_wire, from_wire=receive
    )


# Serialization of lists of bools and bytes.
_LISTS: Mapping[str, tuple[Convert, Convert]] = {
    "bool": (bytes, lambda octets: [octet != 0 for octet in octets]),
    "byte": (b"".join, lambda octets: [bytes([octet]) for octet in octets]),
}
