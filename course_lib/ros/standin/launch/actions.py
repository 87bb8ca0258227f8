"""The actions of a launch; each takes a `condition`."""

import asyncio
from collections.abc import Callable, Coroutine, Iterable, Mapping
from contextlib import suppress
from functools import partial
from typing import Any

from ament_index_python.packages import PackageNotFoundError

from launch.entities import (
    Action,
    BaseEventHandler,
    Entities,
    Event,
    LaunchContext,
    LaunchDescription,
    LaunchDescriptionEntity,
    SubstitutionFailure,
    listed,
    text_of,
)
from launch.entities import SomeSubstitutionsType as Some
from launch.events import ProcessExited
from launch.events import Shutdown as ShutdownEvent
from launch.launch_description_sources import LaunchDescriptionSource
from launch.processes import ExecuteLocal as ExecuteLocal
from launch.processes import ExecuteProcess as ExecuteProcess
from launch.settings import AppendEnvironmentVariable as AppendEnvironmentVariable
from launch.settings import DeclareLaunchArgument as DeclareLaunchArgument
from launch.settings import PopEnvironment as PopEnvironment
from launch.settings import PopLaunchConfigurations as PopLaunchConfigurations
from launch.settings import PushEnvironment as PushEnvironment
from launch.settings import PushLaunchConfigurations as PushLaunchConfigurations
from launch.settings import ResetEnvironment as ResetEnvironment
from launch.settings import ResetLaunchConfigurations as ResetLaunchConfigurations
from launch.settings import SetEnvironmentVariable as SetEnvironmentVariable
from launch.settings import SetLaunchConfiguration as SetLaunchConfiguration
from launch.settings import UnsetEnvironmentVariable as UnsetEnvironmentVariable
from launch.settings import UnsetLaunchConfiguration as UnsetLaunchConfiguration


class OpaqueFunction(Action):
    """Calls a function with the context; the entities that it returns are visited next."""

    def __init__(
        self,
        *,
        function: Callable[..., Entities | None],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(lambda context: function(context, *(args or ()), **(kwargs or {})), **options)


class OpaqueCoroutine(Action):
    """Runs a coroutine function beside the processes, with the context unless `ignore_context`."""

    goes_on = True

    def __init__(
        self,
        *,
        coroutine: Callable[..., Coroutine[Any, Any, None]],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        ignore_context: bool = False,
        **options: Any,
    ) -> None:
        def do(context: LaunchContext) -> None:
            first = () if ignore_context else (context,)
            made = partial(coroutine, *first, *(args or ()), **(kwargs or {}))
            context.runner.start_function(self, "coroutine", lambda: asyncio.run(made()), ())

        super().__init__(do, **options)


class GroupAction(Action):
    """Actions whose settings, namespaces and variables end with the group, if it is scoped."""

    def __init__(
        self,
        actions: Iterable[LaunchDescriptionEntity],
        *,
        scoped: bool = True,
        forwarding: bool = True,
        launch_configurations: Mapping[Any, Some] | None = None,
        **options: Any,
    ) -> None:
        super().__init__(self._open, **options)
        self.actions = list(actions)
        self._own = dict(launch_configurations or {})
        self._scoped, self._forwarding = scoped, forwarding

    def _open(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        own = [SetLaunchConfiguration(*pair) for pair in self._own.items()]
        if not self._scoped:
            return [*own, *self.actions]
        only_own = [ResetEnvironment(), ResetLaunchConfigurations(self._own)]
        return [
            *(PushLaunchConfigurations(), PushEnvironment()),
            *(own if self._forwarding else only_own),
            *self.actions,
            *(PopEnvironment(), PopLaunchConfigurations()),
        ]


class IncludeLaunchDescription(Action):
    """Another launch file, with arguments; as in ROS they stay set unless a group ends them."""

    def __init__(
        self,
        launch_description_source: LaunchDescriptionSource | Some,
        *,
        launch_arguments: Iterable[tuple[Some, Some]] | None = None,
        **options: Any,
    ) -> None:
        source = launch_description_source
        if not isinstance(source, LaunchDescriptionSource):
            source = LaunchDescriptionSource(source)
        self.source = source
        arguments = [SetLaunchConfiguration(*pair) for pair in launch_arguments or ()]

        def do(context: LaunchContext) -> list[LaunchDescriptionEntity]:
            outer, context.file = context.file, str(source.location(context))
            leave = Action(lambda context: setattr(context, "file", outer))
            return [*arguments, source.get_launch_description(context), leave]

        super().__init__(do, **options)


class TimerAction(Action):
    """Actions after so many seconds of robot time.

    A shutdown of the launch always cancels it: `cancel_on_shutdown` makes no difference here.
    """

    goes_on = True

    def __init__(
        self,
        *,
        period: float | Some,
        actions: Iterable[LaunchDescriptionEntity],
        cancel_on_shutdown: bool | Some = True,
        **options: Any,
    ) -> None:
        super().__init__(self._begin, **options)
        self.period, self.actions = period, list(actions)
        self._is_canceled = False

    def cancel(self) -> None:
        """Cancel it: its actions are not done."""
        self._is_canceled = True

    def _begin(self, context: LaunchContext) -> None:
        period = self.period
        seconds = float(period if isinstance(period, int | float) else text_of(context, period))
        context.runner.later(seconds, Action(self._end))

    def _end(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        context.complete(self)
        return [] if self._is_canceled else self.actions


class LogInfo(Action):
    """A line in the launch's log."""

    def __init__(self, *, msg: Some, **options: Any) -> None:
        super().__init__(
            lambda context: context.runner.log("INFO", "launch.user", text_of(context, msg)), **options
        )


class RegisterEventHandler(Action):
    """Registers a handler of events; as in ROS the newest handler comes first."""

    def __init__(self, event_handler: BaseEventHandler, **options: Any) -> None:
        super().__init__(lambda context: context.register_event_handler(event_handler), **options)
        self.event_handler = event_handler


class UnregisterEventHandler(Action):
    """Removes a handler of events; raises ValueError if it was not registered."""

    def __init__(self, event_handler: BaseEventHandler, **options: Any) -> None:
        super().__init__(lambda context: context.unregister_event_handler(event_handler), **options)


class EmitEvent(Action):
    """Emits an event."""

    def __init__(self, *, event: Event, **options: Any) -> None:
        super().__init__(lambda context: context.runner.emit(event), **options)


class Shutdown(Action):
    """Ends the launch; Node takes one as `on_exit`."""

    def __init__(self, *, reason: Some = "reason not given", **options: Any) -> None:
        def do(context: LaunchContext) -> None:
            event = getattr(context.locals, "event", None)
            if isinstance(event, ProcessExited):
                text = f"process[{event.process_name}] was required: shutting down launched system"
                context.runner.log("INFO", "launch", text)
            context.runner.emit(ShutdownEvent(reason=text_of(context, reason)))

        super().__init__(do, **options)


def declared(entities: Entities, context: LaunchContext) -> list[DeclareLaunchArgument]:
    """List the arguments that entities declare, also in groups, timers and included files.

    As in ROS those of a file are left out whose path is not known before the launch.
    """
    found: list[DeclareLaunchArgument] = []
    for entity in listed(entities):
        if isinstance(entity, DeclareLaunchArgument):
            found.append(entity)
        elif isinstance(entity, LaunchDescription):
            found += declared(entity.entities, context)
        elif isinstance(entity, GroupAction | TimerAction):
            found += declared(entity.actions, context)
        elif isinstance(entity, IncludeLaunchDescription):
            with suppress(SubstitutionFailure, PackageNotFoundError):
                found += declared(entity.source.get_launch_description(context), context)
    return found
