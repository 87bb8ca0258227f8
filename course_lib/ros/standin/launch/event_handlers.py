"""Handlers of the events of a launch."""

from collections.abc import Callable
from typing import TypeAlias

from launch.entities import Action, BaseEventHandler, Event, Reaction
from launch.events import ProcessExited, ProcessStarted, Shutdown

Target: TypeAlias = Action | Callable[[Action], bool] | None


EventHandler = BaseEventHandler


class OnProcessStart(BaseEventHandler):
    """A reaction to the start of an action's process, or of any."""

    kind: type[ProcessStarted] = ProcessStarted

    def __init__(
        self, *, target_action: Target = None, on_start: Reaction, handle_once: bool = False
    ) -> None:
        def matches(event: Event) -> bool:
            if type(event) is not self.kind:
                return False
            if callable(target_action):
                return target_action(event.action)
            return target_action is None or event.action is target_action

        super().__init__(matcher=matches, entities=on_start, handle_once=handle_once)


class OnProcessExit(OnProcessStart):
    """A reaction to the end of an action's process, or of any."""

    kind = ProcessExited

    def __init__(self, *, target_action: Target = None, on_exit: Reaction, handle_once: bool = False) -> None:
        super().__init__(target_action=target_action, on_start=on_exit, handle_once=handle_once)


class OnShutdown(BaseEventHandler):
    """A reaction to the end of the launch."""

    def __init__(self, *, on_shutdown: Reaction) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown)
