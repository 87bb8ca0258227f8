"""ROS's own checks of what may be assigned to a field, in its own words.

The texts are those of rosidl_generator_py (resource/_msg.py.em). Jazzy leaves these checks off, and a
publisher then aborts the whole process on a value of a wrong type; here they are on, as in Humble.
"""

import sys
from array import array
from collections import UserString
from collections.abc import Callable, Collection, Sequence, Set
from math import isinf
from typing import Any, cast

import numpy as np

from course_lib.ros.messages.definitions import FieldDefinition, Primitive

Check = Callable[[Any], None]  # raises AssertionError
Fits = Callable[[Any], bool]


def must(field: FieldDefinition, rule: str, fits: Fits) -> Check:
    """Return a check that complains "The 'x' field must be …"."""

    def check(value: Any) -> None:
        if not fits(value):
            raise AssertionError(f"The '{field.name}' field must be {rule}")

    return check


def scalar_check(field: FieldDefinition, primitive: Primitive) -> Check:
    """Return the check of a number, a bool, a string or a byte, which is a ``bytes`` of length 1."""
    python, bound = primitive.python, field.string_bound
    if python is bytes:
        rule = "of type 'bytes' or 'ByteString' with length 1"
        return must(field, rule, lambda value: isinstance(value, bytes | bytearray) and len(value) == 1)
    if bound:
        rule = f"string value not longer than {bound}"
        return must(field, rule, lambda value: isinstance(value, str) and len(value) <= bound)
    if not primitive.range_word:
        return must(field, f"of type '{python.__name__}'", lambda value: isinstance(value, python))
    article = "an" if python is int else "a"
    limits = f"{article} {primitive.range_word} in [{primitive.low}, {primitive.high}]"

    low, high, exact = primitive.low, primitive.high, cast(Any, python)  # mypy would narrow to object

    def check_number(value: Any) -> None:
        if type(value) is exact and low <= value <= high:  # nearly always
            return
        if not isinstance(value, python):
            raise AssertionError(f"The '{field.name}' field must be of type '{python.__name__}'")
        if not _in_range(value, primitive):
            raise AssertionError(f"The '{field.name}' field must be {limits}")

    return check_number


def needs_type_only(field: FieldDefinition, primitive: Primitive) -> bool:
    """Return whether every value of the field's Python type passes `scalar_check`."""
    if primitive.python is float:
        return primitive.high == sys.float_info.max
    return primitive.python in (bool, str) and not field.string_bound


def message_check(field: FieldDefinition, item: type) -> Check:
    """Return the check of a sub message."""
    rule = f"a sub message of type '{item.__name__}'"
    return must(field, rule, lambda value: isinstance(value, item))


def collection_check(field: FieldDefinition, item: type, primitive: Primitive | None) -> Check:
    """Return the check of a sequence or array of `item`; of numbers, `primitive` has the range."""
    ranged = primitive if primitive is not None and primitive.range_word else None

    def fits(value: Any) -> bool:
        return (
            isinstance(value, Sequence | Set)
            and not isinstance(value, str | UserString)
            and _length_fits(value, field)
            and all(isinstance(element, item) for element in value)
            and (not field.string_bound or all(len(element) <= field.string_bound for element in value))
            and (ranged is None or all(_in_range(element, ranged) for element in value))
        )

    return must(field, _collection_words(field, item, primitive), fits)


def numbers_check(field: FieldDefinition, primitive: Primitive) -> Check:
    """Return the check of a sequence of numbers: an array.array by type code, else element by element.

    A flat numpy array whose values fit passes too, as it does on Jazzy.
    """
    check_elements = collection_check(field, primitive.python, primitive)

    def check(value: Any) -> None:
        if isinstance(value, array):
            if value.typecode != primitive.code:
                raise AssertionError(
                    f"The '{field.name}' array.array() must have the type code of '{primitive.code}'"
                )
            if not _length_fits(value, field):
                raise AssertionError(f"The '{field.name}' array.array() must have a size <= {field.size}")
        elif isinstance(value, bytes | bytearray) and primitive.code == "B" and _length_fits(value, field):
            return  # every byte is in range: an image has a hundred thousand
        elif not (isinstance(value, np.ndarray) and _flat_numbers(value, field, primitive)):
            check_elements(value)

    return check


def block_check(field: FieldDefinition, primitive: Primitive) -> Check:
    """Return the check of an array of a fixed number of numbers: a numpy array, else element by element."""
    check_elements = collection_check(field, primitive.python, primitive)

    def check(value: Any) -> None:
        if not isinstance(value, np.ndarray):
            check_elements(value)
        elif value.dtype != primitive.dtype:
            dtype = f"numpy.{primitive.dtype.name}"
            raise AssertionError(f"The '{field.name}' numpy.ndarray() must have the dtype of '{dtype}'")
        elif value.shape != (field.size,):
            raise AssertionError(f"The '{field.name}' numpy.ndarray() must have a size of {field.size}")

    return check


def _in_range(value: Any, primitive: Primitive) -> bool:
    if primitive.python is float:
        return not (value < primitive.low or value > primitive.high) or isinf(value)
    return bool(primitive.low <= value <= primitive.high)


def _length_fits(value: Collection[Any], field: FieldDefinition) -> bool:
    if field.container == "array":
        return len(value) == field.size
    return not field.size or len(value) <= field.size


def _flat_numbers(value: "np.ndarray[Any, Any]", field: FieldDefinition, primitive: Primitive) -> bool:
    if value.ndim != 1 or value.dtype.kind not in ("iuf" if primitive.python is float else "iu"):
        return False
    ends = [value.min(), value.max()] if value.size and primitive.python is int else []
    return all(_in_range(end, primitive) for end in ends) and _length_fits(value, field)


def _collection_words(field: FieldDefinition, item: type, primitive: Primitive | None) -> str:
    words = ["a set or sequence"]
    if field.size:
        words.append(f"with length {'<= ' if field.container == 'sequence' else ''}{field.size}")
    if field.string_bound:
        words.append(f"and each string value not longer than {field.string_bound}")
    words.append(f"and each value of type '{item.__name__}'")
    if primitive is not None and primitive.range_word:
        style = ".6f" if primitive.python is float else "d"
        limits = f"[{primitive.low:{style}}, {primitive.high:{style}}]"
        words.append(f"and each {primitive.range_word} in {limits}")
    return " ".join(words)
