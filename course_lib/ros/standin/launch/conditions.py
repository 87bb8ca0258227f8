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


class LaunchConfigurationEquals(Condition):
    """True where an argument's value is the text; with None, where it has no value."""

    def __init__(self, launch_configuration_name: str, expected_value: SomeSubstitutionsType | None) -> None:
        super().__init__(
            predicate=lambda context: _equals(context, launch_configuration_name, expected_value)
        )


class LaunchConfigurationNotEquals(Condition):
    """True where an argument's value is another text, or none; with None, where it has one."""

    def __init__(self, launch_configuration_name: str, expected_value: SomeSubstitutionsType | None) -> None:
        super().__init__(
            predicate=lambda context: not _equals(context, launch_configuration_name, expected_value)
        )


def _equals(context: LaunchContext, name: str, expected: SomeSubstitutionsType | None) -> bool:
    value: object = context.launch_configurations.get(name)
    return value == (None if expected is None else text_of(context, expected))


def is_true(context: LaunchContext, expression: SomeSubstitutionsType) -> bool:
    """Parse a text as true or false; any other raises an error with launch's text."""
    text = text_of(context, expression).strip().lower()
    if text not in _WORDS:
        raise InvalidConditionExpressionError(
            f"invalid condition expression, given '{text}', expected one of {list(_WORDS)}"
        )
    return _WORDS[text]
