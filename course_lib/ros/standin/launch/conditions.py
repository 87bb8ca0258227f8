"""What decides whether an action is done."""

from collections.abc import Callable

from launch.launch_context import LaunchContext
from launch.substitution import SomeSubstitutionsType, text_of

_WORDS = {"true": True, "1": True, "false": False, "0": False}


class InvalidConditionExpressionError(Exception):
    """A condition is neither true nor false."""


class Condition:
    """A question that is answered when the action is visited."""

    def __init__(self, *, predicate: Callable[[LaunchContext], bool]) -> None:
        self._predicate = predicate

    def evaluate(self, context: LaunchContext) -> bool:
        """Answer it."""
        return self._predicate(context)


class IfCondition(Condition):
    """True where the text is `true` or `1`, in capitals or not; it must be one of true, 1, false, 0."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        super().__init__(predicate=lambda context: is_true(context, predicate_expression))


class UnlessCondition(Condition):
    """True where the text is `false` or `0`."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        super().__init__(predicate=lambda context: not is_true(context, predicate_expression))


def is_true(context: LaunchContext, expression: SomeSubstitutionsType) -> bool:
    """Read a text as true or false, with launch's complaint about any other."""
    text = text_of(context, expression).strip().lower()
    if text not in _WORDS:
        raise InvalidConditionExpressionError(
            f"invalid condition expression, given '{text}', expected one of {list(_WORDS)}"
        )
    return _WORDS[text]
