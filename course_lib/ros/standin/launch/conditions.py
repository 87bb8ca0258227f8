"""Conditions of actions."""

from launch.entities import Condition, LaunchContext, SomeSubstitutionsType, text_of

_WORDS = {"true": True, "1": True, "false": False, "0": False}


class InvalidConditionExpressionError(Exception):
    """A condition is neither true nor false."""


class IfCondition(Condition):
    """True where the text is `true` or `1`, in capitals or not; it must be one of true, 1, false, 0."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        super().__init__(predicate=lambda context: is_true(context, predicate_expression))


class UnlessCondition(Condition):
    """True where the text is `false` or `0`."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        super().__init__(predicate=lambda context: not is_true(context, predicate_expression))


def is_true(context: LaunchContext, expression: SomeSubstitutionsType) -> bool:
    """Parse a text as true or false; any other raises an error with launch's text."""
    text = text_of(context, expression).strip().lower()
    if text not in _WORDS:
        raise InvalidConditionExpressionError(
            f"invalid condition expression, given '{text}', expected one of {list(_WORDS)}"
        )
    return _WORDS[text]
