"""Conditions of actions."""

# PyYAML has no type information.
import yaml

from launch.entities import Condition, LaunchContext, SomeSubstitutionsType, SubstitutionFailure, text_of

_WORDS = {"true": True, "1": True, "false": False, "0": False}


class InvalidConditionExpressionError(ValueError):
    """A condition is neither true nor false."""


class IfCondition(Condition):
    """True if the expression is `true` or `1`. It must be true, 1, false or 0; case is ignored."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        super().__init__(
            predicate=lambda context: evaluate_condition_expression(context, predicate_expression)
        )


class UnlessCondition(Condition):
    """True if the expression is `false` or `0`."""

    def __init__(self, predicate_expression: SomeSubstitutionsType) -> None:
        super().__init__(
            predicate=lambda context: not evaluate_condition_expression(context, predicate_expression)
        )


class LaunchConfigurationEquals(Condition):
    """True if a launch configuration has the expected value, or is unset if that value is None."""

    def __init__(
        self,
        launch_configuration_name: str,
        expected_value: SomeSubstitutionsType | None,
    ) -> None:
        super().__init__(
            predicate=lambda context: _equals(context, launch_configuration_name, expected_value)
        )


class LaunchConfigurationNotEquals(Condition):
    """True if a launch configuration differs from the expected value; for None, if it is set."""

    def __init__(
        self,
        launch_configuration_name: str,
        expected_value: SomeSubstitutionsType | None,
    ) -> None:
        super().__init__(
            predicate=lambda context: not _equals(context, launch_configuration_name, expected_value)
        )


def _equals(context: LaunchContext, name: str, expected: SomeSubstitutionsType | None) -> bool:
    value: object = context.launch_configurations.get(name)
    return value == (None if expected is None else text_of(context, expected))


def evaluate_condition_expression(
    context: LaunchContext,
    expression: SomeSubstitutionsType,
) -> bool:
    """Parse a string as true or false. Any other string raises an error with launch's message."""
    text = text_of(context, expression).strip().lower()
    if text not in _WORDS:
        raise InvalidConditionExpressionError(
            f"invalid condition expression, given '{text}', expected one of {list(_WORDS)}"
        )
    return _WORDS[text]


def as_bool(context: LaunchContext, value: bool | SomeSubstitutionsType) -> bool:
    """Return a bool, or parse a string as YAML does: true, yes, on, 1 and their opposites."""
    if isinstance(value, bool):
        return value
    text = text_of(context, value)
    try:
        parsed = {"1": True, "0": False}.get(text, yaml.safe_load(text))
    except yaml.YAMLError:
        parsed = None
    if not isinstance(parsed, bool):
        raise SubstitutionFailure(f"Cannot convert value '{text}' to '{bool}': expected true or false")
    return parsed
