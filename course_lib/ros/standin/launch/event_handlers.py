"""Handlers for launch events."""

from collections.abc import Callable
from typing import Any, TypeAlias

from launch.entities import (
    Action,
    BaseEventHandler,
    Entities,
    Event,
    ExecutionComplete,
    LaunchContext,
    LaunchDescriptionEntity,
    Reaction,
    as_entity_list,
)
from launch.events import IncludeLaunchDescription as _Included
from launch.events import ProcessExited, ProcessIO, ProcessStarted
from launch.events import Shutdown as _Shutdown

Target: TypeAlias = Action | Callable[[Action], bool] | None
OutputHandler: TypeAlias = Callable[[ProcessIO], Entities | None] | None


EventHandler = BaseEventHandler


class OnActionEventBase(BaseEventHandler):
    """Handles events of a class.

    `action_matcher` selects the action of the event: a particular action, a predicate, or None for
    any action.
    """

    def __init__(
        self,
        *,
        action_matcher: Target,
        on_event: Reaction,
        target_event_cls: type[Event],
        target_action_cls: type[Action] = Action,
        **options: Any,
    ) -> None:
        if not (action_matcher is None or callable(action_matcher) or isinstance(action_matcher, Action)):
            raise ValueError(
                f"{type(self).__name__} requires a '{target_action_cls.__name__}' action or a "
                f"callable as the target, got {action_matcher!r}"
            )

        def matches(event: Event) -> bool:
            if not isinstance(event, target_event_cls):
                return False
            action: Any = getattr(event, "action", None)
            return (
                bool(action_matcher(action)) if callable(action_matcher) else action_matcher in (None, action)
            )

        super().__init__(matcher=matches, entities=on_event, **options)


class OnProcessStart(OnActionEventBase):
    """Handles the start of an action's process, or of any process."""

    def __init__(self, *, target_action: Target = None, on_start: Reaction, **options: Any) -> None:
        super().__init__(
            action_matcher=target_action, on_event=on_start, target_event_cls=ProcessStarted, **options
        )


class OnProcessExit(OnActionEventBase):
    """Handles the exit of an action's process, or of any process."""

    def __init__(self, *, target_action: Target = None, on_exit: Reaction, **options: Any) -> None:
        super().__init__(
            action_matcher=target_action, on_event=on_exit, target_event_cls=ProcessExited, **options
        )


class OnExecutionComplete(OnActionEventBase):
    """Handles the completion of an action: its process has exited, or `execute` has returned."""

    def __init__(
        self,
        *,
        target_action: Target = None,
        on_completion: Reaction,
        **options: Any,
    ) -> None:
        super().__init__(
            action_matcher=target_action,
            on_event=on_completion,
            target_event_cls=ExecutionComplete,
            **options,
        )


class OnProcessIO(OnActionEventBase):
    """Handles the output of an action's process. The processes have no standard input here."""

    def __init__(
        self,
        *,
        target_action: Target = None,
        on_stdin: OutputHandler = None,
        on_stdout: OutputHandler = None,
        on_stderr: OutputHandler = None,
        **options: Any,
    ) -> None:
        reactions = {1: on_stdout, 2: on_stderr}

        def react(event: ProcessIO, context: LaunchContext) -> list[LaunchDescriptionEntity]:
            reaction = reactions[event.fd]
            return [] if reaction is None else as_entity_list(reaction(event))

        super().__init__(action_matcher=target_action, on_event=react, target_event_cls=ProcessIO, **options)


class OnShutdown(BaseEventHandler):
    """Handles the shutdown of the launch."""

    def __init__(self, *, on_shutdown: Reaction, **options: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, _Shutdown), entities=on_shutdown, **options)


class OnIncludeLaunchDescription(BaseEventHandler):
    """Handles the inclusion of a description, whose entities are visited."""

    def __init__(self, **options: Any) -> None:
        super().__init__(
            matcher=lambda event: isinstance(event, _Included),
            entities=lambda event, context: event.launch_description,
            **options,
        )
