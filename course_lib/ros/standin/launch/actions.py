"""What a launch can do."""

import os
import shlex
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from launch.action import Action, Entities, LaunchDescriptionEntity, listed
from launch.conditions import Condition
from launch.event_handlers import BaseEventHandler
from launch.events import Event
from launch.events import Shutdown as ShutdownEvent
from launch.launch_context import LaunchContext
from launch.launch_description import LaunchDescription
from launch.launch_description_sources import LaunchDescriptionSource
from launch.substitution import SomeSubstitutionsType, perform_substitutions

_PACKAGES = {"ros2": "ros2cli", "rviz2": "rviz2"}  # of the programs that the kit provides


class DeclareLaunchArgument(Action):
    """An argument that `name:=value` behind the launch file sets."""

    def __init__(
        self,
        name: str,
        *,
        default_value: SomeSubstitutionsType | None = None,
        description: str | None = None,
        choices: list[str] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.name, self.default_value, self.choices = name, default_value, choices
        if choices is not None and isinstance(default_value, str) and default_value not in choices:
            raise RuntimeError(
                f'Provided default_value "{default_value}" is not in provided choices "{choices}".'
            )
        self.description = description or (
            "no description given" if choices is None else f"One of: {choices}"
        )
        if description and choices:
            self.description = f"{description.removesuffix('.')}. Valid choices are: {choices}"

    def execute(self, context: LaunchContext) -> None:
        """Set the default where nothing else is set; raises RuntimeError with launch's texts."""
        configurations = context.launch_configurations
        if self.name not in configurations:
            if self.default_value is None:
                raise RuntimeError(f'Required launch argument "{self.name}" was not provided.')
            configurations[self.name] = perform_substitutions(context, self.default_value)
        value = configurations[self.name]
        if self.choices is not None and value not in self.choices:
            raise RuntimeError(
                f'Argument "{self.name}" provided value "{value}" is not valid. '
                f"Valid options are: {self.choices}"
            )


class SetLaunchConfiguration(Action):
    """Gives an argument a value."""

    def __init__(
        self, name: SomeSubstitutionsType, value: SomeSubstitutionsType, *, condition: Condition | None = None
    ) -> None:
        super().__init__(condition=condition)
        self._name, self._value = name, value

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        context.launch_configurations[perform_substitutions(context, self._name)] = perform_substitutions(
            context, self._value
        )


class SetEnvironmentVariable(SetLaunchConfiguration):
    """Gives a variable of the environment a value."""

    def execute(self, context: LaunchContext) -> None:
        """Set it."""
        context.environment[perform_substitutions(context, self._name)] = perform_substitutions(
            context, self._value
        )


class OpaqueFunction(Action):
    """Calls a function with the context; what it returns is done next."""

    def __init__(
        self,
        *,
        function: Callable[..., Entities | None],
        args: Iterable[Any] = (),
        kwargs: Mapping[str, Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self._function, self._args, self._kwargs = function, tuple(args), dict(kwargs or {})

    def execute(self, context: LaunchContext) -> Entities | None:
        """Call it."""
        return self._function(context, *self._args, **self._kwargs)


class GroupAction(Action):
    """Actions whose settings, namespaces and variables end with the group, if it is scoped."""

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[str, SomeSubstitutionsType] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self._actions, self._scoped, self._forwarding = list(actions), scoped, forwarding
        self._set = [SetLaunchConfiguration(*pair) for pair in (launch_configurations or {}).items()]

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Give the actions, in a scope of their own."""
        if not self._scoped:
            return [*self._set, *self._actions]
        context.pushed.append((dict(context.launch_configurations), dict(os.environ)))
        if not self._forwarding:
            context.launch_configurations.clear()
        return [*self._set, *self._actions, OpaqueFunction(function=_pop)]


class IncludeLaunchDescription(Action):
    """Another launch file, with arguments."""

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | SomeSubstitutionsType,
        *,
        launch_arguments: Iterable[tuple[SomeSubstitutionsType, SomeSubstitutionsType]] = (),
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        source = launch_description_source
        if not isinstance(source, LaunchDescriptionSource):
            source = LaunchDescriptionSource(source)
        self.source = source
        self._arguments = list(launch_arguments)

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Give what it describes; as in ROS, its arguments stay set afterwards unless a group ends them."""
        outer, context.file = context.file, str(self.source.location(context))
        description = self.source.get_launch_description(context)

        def leave(context: LaunchContext) -> None:
            context.file = outer

        arguments = [SetLaunchConfiguration(*pair) for pair in self._arguments]
        return [*arguments, description, OpaqueFunction(function=leave)]


class TimerAction(Action):
    """Actions after so many seconds of robot time."""

    def __init__(
        self,
        *,
        period: float | SomeSubstitutionsType,
        actions: Iterable[LaunchDescriptionEntity],
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self._period, self._actions = period, list(actions)

    def execute(self, context: LaunchContext) -> None:
        """Have them done later."""
        period = self._period
        if not isinstance(period, int | float):
            period = float(perform_substitutions(context, period))
        context.runner.later(period, self._actions)


class LogInfo(Action):
    """A line in the launch's log."""

    def __init__(self, *, msg: SomeSubstitutionsType, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._msg = msg

    def execute(self, context: LaunchContext) -> None:
        """Write it."""
        print(f"[INFO] [launch.user]: {perform_substitutions(context, self._msg)}")  # noqa: T201  # it is what it does


class RegisterEventHandler(Action):
    """Has a handler take events from now on."""

    def __init__(self, event_handler: BaseEventHandler, *, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._handler = event_handler

    def execute(self, context: LaunchContext) -> None:
        """Register it; as in ROS, the newest handler comes first."""
        context.handlers.insert(0, self._handler)


class EmitEvent(Action):
    """Lets something happen."""

    def __init__(self, *, event: Event, condition: Condition | None = None) -> None:
        super().__init__(condition=condition)
        self._event = event

    def execute(self, context: LaunchContext) -> None:
        """Let it happen."""
        context.runner.emit(self._event)


class Shutdown(EmitEvent):
    """Ends everything; Node takes one as `on_exit`."""

    def __init__(self, *, reason: str = "reason not given", condition: Condition | None = None) -> None:
        super().__init__(event=ShutdownEvent(reason=reason), condition=condition)


class ExecuteProcess(Action):
    """Runs `ros2 …` or `rviz2 …`; other programs would not be on robot time."""

    def __init__(self, *, cmd: Iterable[SomeSubstitutionsType], **options: Any) -> None:
        super().__init__(condition=options.get("condition"))
        self._cmd = list(cmd)

    def execute(self, context: LaunchContext) -> None:
        """Start it, or refuse."""
        words = [perform_substitutions(context, part) for part in self._cmd]
        program, *rest = shlex.split(words[0]) if len(words) == 1 else words
        if program not in _PACKAGES:
            raise RuntimeError(
                f"ExecuteProcess is not available here: `{shlex.join([program, *rest])}` would run outside "
                "robot time. Start nodes with launch_ros.actions.Node; run other commands beside the launch."
            )
        context.runner.start(self, _PACKAGES[program], program, [*rest, "--ros-args"])


def _pop(context: LaunchContext) -> None:
    context.launch_configurations, environment = context.pushed.pop()
    os.environ.clear()
    os.environ.update(environment)


def declared(entities: Entities, context: LaunchContext) -> list[DeclareLaunchArgument]:
    """List the arguments that entities, groups and included files declare."""
    found: list[DeclareLaunchArgument] = []
    for entity in listed(entities):
        if isinstance(entity, DeclareLaunchArgument):
            found.append(entity)
        elif isinstance(entity, LaunchDescription):
            found += declared(entity.entities, context)
        elif isinstance(entity, GroupAction):
            found += declared(entity._actions, context)
        elif isinstance(entity, IncludeLaunchDescription):
            found += declared(entity.source.get_launch_description(context), context)
    return found
