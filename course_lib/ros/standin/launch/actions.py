"""The actions of a launch; each takes a `condition`."""

import os
import shlex
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from launch.entities import (
    Action,
    BaseEventHandler,
    Entities,
    Event,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    listed,
    text_of,
)
from launch.entities import SomeSubstitutionsType as Some
from launch.events import Shutdown as ShutdownEvent
from launch.launch_description_sources import LaunchDescriptionSource

_PACKAGES = {"ros2": "ros2cli", "rviz2": "rviz2"}  # of the programs that the kit provides


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


class SetEnvironmentVariable(Action):
    """Sets a variable of the environment."""

    def __init__(self, name: Some, value: Some, **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            os.environ[text_of(context, name)] = text_of(context, value)

        super().__init__(do, **options)


class OpaqueFunction(Action):
    """Calls a function with the context; the entities that it returns are visited next."""

    def __init__(
        self,
        *,
        function: Callable[..., Entities | None],
        args: Iterable[Any] = (),
        kwargs: Mapping[str, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(lambda context: function(context, *args, **(kwargs or {})), **options)


class GroupAction(Action):
    """Actions whose settings, namespaces and variables end with the group, if it is scoped."""

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[str, Some] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(self._open, **options)
        own = [SetLaunchConfiguration(*pair) for pair in (launch_configurations or {}).items()]
        self.actions = [*own, *actions]
        self._scoped, self._forwarding = scoped, forwarding

    def _open(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        if not self._scoped:
            return self.actions
        before = dict(context.launch_configurations), dict(os.environ)
        if not self._forwarding:
            context.launch_configurations.clear()

        def close(context: LaunchContext) -> None:
            context.launch_configurations, environment = before
            os.environ.clear()
            os.environ.update(environment)

        return [*self.actions, Action(close)]


class IncludeLaunchDescription(Action):
    """Another launch file, with arguments; as in ROS they stay set unless a group ends them."""

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | Some,
        *,
        launch_arguments: Iterable[tuple[Some, Some]] = (),
        **options: Any,
    ) -> None:
        source = launch_description_source
        if not isinstance(source, LaunchDescriptionSource):
            source = LaunchDescriptionSource(source)
        self.source = source
        arguments = [SetLaunchConfiguration(*pair) for pair in launch_arguments]

        def do(context: LaunchContext) -> list[LaunchDescriptionEntity]:
            outer, context.file = context.file, str(source.location(context))
            leave = Action(lambda context: setattr(context, "file", outer))
            return [*arguments, source.get_launch_description(context), leave]

        super().__init__(do, **options)


class TimerAction(Action):
    """Actions after so many seconds of robot time."""

    def __init__(
        self, *, period: float | Some, actions: Iterable[LaunchDescriptionEntity], **options: Any
    ) -> None:
        def do(context: LaunchContext) -> None:
            seconds = float(period if isinstance(period, int | float) else text_of(context, period))
            context.runner.later(seconds, actions)

        super().__init__(do, **options)


class LogInfo(Action):
    """A line in the launch's log."""

    def __init__(self, *, msg: Some, **options: Any) -> None:
        super().__init__(
            lambda context: context.runner.log("INFO", "launch.user", text_of(context, msg)), **options
        )


class RegisterEventHandler(Action):
    """Registers a handler of events; as in ROS the newest handler comes first."""

    def __init__(self, event_handler: BaseEventHandler, **options: Any) -> None:
        super().__init__(lambda context: context.handlers.insert(0, event_handler), **options)


class EmitEvent(Action):
    """Emits an event."""

    def __init__(self, *, event: Event, **options: Any) -> None:
        super().__init__(lambda context: context.runner.emit(event), **options)


class Shutdown(EmitEvent):
    """Ends the launch; Node takes one as `on_exit`."""

    def __init__(self, *, reason: str = "reason not given", **options: Any) -> None:
        super().__init__(event=ShutdownEvent(reason=reason), **options)


class ExecuteProcess(Action):
    """Runs `ros2 …` or `rviz2 …`; other programs would not be on robot time."""

    def __init__(self, *, cmd: Iterable[Some], **options: Any) -> None:
        super().__init__(self._start, condition=options.get("condition"))
        self._cmd = list(cmd)

    def _start(self, context: LaunchContext) -> None:
        words = [text_of(context, part) for part in self._cmd]
        program, *rest = shlex.split(words[0]) if len(words) == 1 else words
        if program not in _PACKAGES:
            raise RuntimeError(
                f"ExecuteProcess is not available here: `{shlex.join([program, *rest])}` would run outside "
                "robot time. Start nodes with launch_ros.actions.Node; run other commands beside the launch."
            )
        context.runner.start(self, _PACKAGES[program], program, [*rest, "--ros-args"])


def declared(entities: Entities, context: LaunchContext) -> list[DeclareLaunchArgument]:
    """List the arguments that entities, groups and included files declare."""
    found: list[DeclareLaunchArgument] = []
    for entity in listed(entities):
        if isinstance(entity, DeclareLaunchArgument):
            found.append(entity)
        elif isinstance(entity, LaunchDescription):
            found += declared(entity.entities, context)
        elif isinstance(entity, GroupAction):
            found += declared(entity.actions, context)
        elif isinstance(entity, IncludeLaunchDescription):
            found += declared(entity.source.get_launch_description(context), context)
    return found
