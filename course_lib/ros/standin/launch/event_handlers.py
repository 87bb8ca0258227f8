"""What is done when something happens."""

from collections.abc import Callable
from typing import Any, TypeAlias

from launch.action import Action, Entities, LaunchDescriptionEntity, listed
from launch.events import Event, ProcessExited, ProcessStarted, Shutdown
from launch.launch_context import LaunchContext

Reaction: TypeAlias = Entities | Callable[[Any, LaunchContext], Entities | None] | None
Target: TypeAlias = Action | Callable[[Action], bool] | None


class BaseEventHandler:
    """Does `entities` at the events that `matcher` chooses; they may be a function of event and context."""

    def __init__(
        self, *, matcher: Callable[[Event], bool], entities: Reaction = None, handle_once: bool = False
    ) -> None:
        self.matches = matcher
        self.handle_once = handle_once
        self._entities = entities

    def handle(self, event: Event, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Give what is to be done now."""
        return listed(self._entities(event, context) if callable(self._entities) else self._entities)


EventHandler = BaseEventHandler


class OnProcessStart(BaseEventHandler):
    """At the start of an action's process, or of any."""

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
    """At the end of an action's process, or of any."""

    kind = ProcessExited

    def __init__(self, *, target_action: Target = None, on_exit: Reaction, handle_once: bool = False) -> None:
        super().__init__(target_action=target_action, on_start=on_exit, handle_once=handle_once)


class OnShutdown(BaseEventHandler):
    """When everything is about to end."""

    def __init__(self, *, on_shutdown: Reaction) -> None:
        super().__init__(matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown)
