"""Actions that change the settings of a launch: its arguments, and the variables of the environment."""

import os
from collections.abc import Callable, Mapping, MutableMapping
from functools import partial
from typing import Any

from launch.conditions import as_bool
from launch.entities import Action, LaunchContext, text_of
from launch.entities import SomeSubstitutionsType as Some

_STATES: Mapping[str, Callable[[LaunchContext], MutableMapping[str, Any]]] = {
    "environment": lambda context: context.environment,
    "launch configurations": lambda context: context.launch_configurations,
}


class DeclareLaunchArgument(Action):
    """An argument that `name:=value` behind the launch file sets."""

    def __init__(
        self,
        name: str,
        *,
        default_value: Some | None = None,
        description: str | None = None,
        choices: list[str] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(self._declare, **options)
        self.name, self.default_value, self.choices = name, default_value, choices
        if choices is not None and isinstance(default_value, str) and default_value not in choices:
            raise RuntimeError(
                f'Provided default_value "{default_value}" is not in provided choices "{choices}".'
            )
        self.description = description or (f"One of: {choices}" if choices else "no description given")
        if description and choices:
            self.description = f"{description.removesuffix('.')}. Valid choices are: {choices}"

    def _declare(self, context: LaunchContext) -> None:
        """Set the default where nothing else is set; raises RuntimeError with launch's texts."""
        configurations = context.launch_configurations
        if self.name not in configurations:
            if self.default_value is None:
                raise RuntimeError(f'Required launch argument "{self.name}" was not provided.')
            configurations[self.name] = text_of(context, self.default_value)
        value = configurations[self.name]
        if self.choices is not None and value not in self.choices:
            raise RuntimeError(
                f'Argument "{self.name}" provided value "{value}" is not valid. '
                f"Valid options are: {self.choices}"
            )


class SetLaunchConfiguration(Action):
    """Sets the value of an argument."""

    def __init__(self, name: Some, value: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            context.launch_configurations[text_of(context, name)] = text_of(context, value)

        super().__init__(do, **options)


class UnsetLaunchConfiguration(Action):
    """Removes an argument."""

    def __init__(self, name: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            context.launch_configurations.pop(text_of(context, name), None)

        super().__init__(do, **options)


class ResetLaunchConfigurations(Action):
    """Removes all arguments but those that are given here."""

    def __init__(self, launch_configurations: Mapping[Any, Some] | None = None, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            pairs = (launch_configurations or {}).items()
            kept = {text_of(context, name): text_of(context, value) for name, value in pairs}
            context.launch_configurations.clear()
            context.launch_configurations.update(kept)

        super().__init__(do, **options)


class SetEnvironmentVariable(Action):
    """Sets a variable of the environment."""

    def __init__(self, name: Some, value: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            os.environ[text_of(context, name)] = text_of(context, value)

        super().__init__(do, **options)


class UnsetEnvironmentVariable(Action):
    """Removes a variable of the environment."""

    def __init__(self, name: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            os.environ.pop(text_of(context, name), None)

        super().__init__(do, **options)


class AppendEnvironmentVariable(Action):
    """Sets a variable of the environment, or appends to its value; with `prepend`, puts before it."""

    def __init__(
        self,
        name: Some,
        value: Some,
        prepend: bool | Some = False,
        separator: Some = os.pathsep,
        **options: Any,
    ) -> None:
        def do(context: LaunchContext) -> None:
            key, parts = text_of(context, name), [text_of(context, value)]
            before = as_bool(context, prepend)
            if key in os.environ:
                parts.insert(1 if before else 0, os.environ[key])
            os.environ[key] = text_of(context, separator).join(parts)

        super().__init__(do, **options)


class ResetEnvironment(Action):
    """Sets the environment as it was when the launch began."""

    def __init__(self, **options: Any) -> None:
        super().__init__(lambda context: _replace(os.environ, context.environment_at_start), **options)


class PushLaunchConfigurations(Action):
    """Keeps the values of all arguments."""

    def __init__(self, **options: Any) -> None:
        super().__init__(partial(_push, "launch configurations"), **options)


class PopLaunchConfigurations(Action):
    """Brings back the values of all arguments that were kept last."""

    def __init__(self, **options: Any) -> None:
        super().__init__(partial(_pop, "launch configurations"), **options)


class PushEnvironment(Action):
    """Keeps the environment."""

    def __init__(self, **options: Any) -> None:
        super().__init__(partial(_push, "environment"), **options)


class PopEnvironment(Action):
    """Brings back the environment that was kept last."""

    def __init__(self, **options: Any) -> None:
        super().__init__(partial(_pop, "environment"), **options)


def _push(kind: str, context: LaunchContext) -> None:
    context.kept.setdefault(kind, []).append(dict(_STATES[kind](context)))


def _pop(kind: str, context: LaunchContext) -> None:
    if not context.kept.get(kind):
        raise RuntimeError(f"no {kind} to bring back: push them before they are popped")
    _replace(_STATES[kind](context), context.kept[kind].pop())


def _replace(state: MutableMapping[str, Any], former: Mapping[str, Any]) -> None:
    state.clear()
    state.update(former)
