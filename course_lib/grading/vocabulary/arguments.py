"""The kinds and the lengths of the arguments that authors give to a word."""

from collections.abc import Iterable, Mapping, Sized
from inspect import Parameter
from numbers import Integral, Real
from types import UnionType
from typing import Any, get_args

from course_lib.errors import CourseError
from course_lib.grading.task import My

KINDS: Mapping[Any, tuple[type, str]] = {
    str: (str, "a text"),
    int: (Integral, "a whole number"),
    float: (Real, "a number"),
    bool: (bool, "True or False"),
}
LENGTHS: Mapping[str, tuple[tuple[int, ...], str]] = {
    "position": ((3,), "x, y, z"),
    "translation": ((3,), "x, y, z"),
    "scale": ((3,), "x, y, z"),
    "center": ((2,), "x, y"),
    "color": ((3, 4), "red, green, blue and perhaps alpha"),
}


def refuse_misfits(word: str, parameters: Iterable[Parameter], values: Mapping[str, Any]) -> None:
    """Refuse arguments that no evidence can be compared with.

    Args:
        word: The word's name.
        parameters: Of the word.
        values: The arguments, by the parameters' names.

    Raises:
        CourseError: One is of another kind, or has another length; names it and what was expected.
    """
    for parameter in parameters:
        value, name = values[parameter.name], parameter.name
        if value is None or isinstance(value, My) or parameter.kind is Parameter.VAR_POSITIONAL:
            continue
        expected = _kind_expected(parameter.annotation, value) or _length_expected(name, value)
        if expected:
            raise CourseError(f"{word}: {name}={value!r}, expected {expected}")


def _kind_expected(annotation: Any, value: Any) -> str:
    """Return the words for the kind that a value has not, or ""."""
    either = get_args(annotation) if isinstance(annotation, UnionType) else (annotation,)
    kinds = [one for one in either if one is not type(None)]
    kind, words = KINDS.get(kinds[0], (object, "")) if len(kinds) == 1 else (object, "")
    return "" if isinstance(value, kind) else words


def _length_expected(name: str, value: Any) -> str:
    """Return the words for the length that a value has not, or ""."""
    lengths, words = LENGTHS.get(name, ((), ""))
    if not lengths or (isinstance(value, Sized) and not isinstance(value, str) and len(value) in lengths):
        return ""
    return f"{' or '.join(map(str, lengths))} numbers ({words})"
