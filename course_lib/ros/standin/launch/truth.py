"""Substitutions that are `true` or `false`, or choose by one of these."""

import math
from typing import Any

from launch.conditions import as_bool
from launch.entities import LaunchContext, Substitution, text_of
from launch.entities import SomeSubstitutionsType as Some

_TRUE, _FALSE = ("true", "1"), ("false", "0")


class NotSubstitution(Substitution):
    """The opposite of a truth."""

    def __init__(self, value: Some) -> None:
        super().__init__(lambda context: _word(not as_bool(context, value)))


class AnySubstitution(Substitution):
    """True where at least one is true."""

    def __init__(self, *args: Some) -> None:
        super().__init__(lambda context: _word(any(as_bool(context, value) for value in args)))


class AllSubstitution(Substitution):
    """True where all are true."""

    def __init__(self, *args: Some) -> None:
        super().__init__(lambda context: _word(all(as_bool(context, value) for value in args)))


class AndSubstitution(AllSubstitution):
    """True where both are true."""

    def __init__(self, left: Some, right: Some) -> None:
        super().__init__(left, right)


class OrSubstitution(AnySubstitution):
    """True where one of two is true."""

    def __init__(self, left: Some, right: Some) -> None:
        super().__init__(left, right)


class EqualsSubstitution(Substitution):
    """True where two texts are equal, or mean the same truth, or nearly the same number."""

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(lambda context: _word(_are_equal(context, left, right)))


class NotEqualsSubstitution(Substitution):
    """True where EqualsSubstitution is false."""

    def __init__(self, left: Any, right: Any) -> None:
        super().__init__(lambda context: _word(not _are_equal(context, left, right)))


class IfElseSubstitution(Substitution):
    """One of two texts."""

    def __init__(self, condition: Some, if_value: Some = "", else_value: Some = "") -> None:
        super().__init__(
            lambda context: text_of(context, if_value if as_bool(context, condition) else else_value)
        )


def _word(truth: bool) -> str:
    return "true" if truth else "false"


def _are_equal(context: LaunchContext, left: Any, right: Any) -> bool:
    first, second = _text(context, left), _text(context, right)
    lower = first.lower(), second.lower()
    if all(text in (*_TRUE, *_FALSE) for text in lower):
        return (lower[0] in _TRUE) == (lower[1] in _TRUE)
    try:
        return math.isclose(float(first), float(second))
    except ValueError:
        return first == second


def _text(context: LaunchContext, value: Any) -> str:
    """Return a text; other values than substitutions are written first, as launch does."""
    is_list = isinstance(value, list | tuple) and any(isinstance(part, Substitution) for part in value)
    if is_list or isinstance(value, Substitution):
        return text_of(context, value)
    return "" if value is None else str(value).lower() if isinstance(value, bool) else str(value)
