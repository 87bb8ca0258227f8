"""Handlers of events of lifecycle nodes."""

from collections.abc import Callable

from launch.entities import BaseEventHandler, Event, Reaction

from launch_ros.actions import LifecycleNode
from launch_ros.events.lifecycle import StateTransition


class OnStateTransition(BaseEventHandler):
    """Handles transitions of lifecycle nodes. Arguments that are None match any value."""

    def __init__(
        self,
        *,
        entities: Reaction,
        target_lifecycle_node: LifecycleNode | None = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        matcher: Callable[[Event], bool] | None = None,
        handle_once: bool = False,
    ) -> None:
        if not isinstance(target_lifecycle_node, LifecycleNode | None):
            raise RuntimeError("OnStateTransition requires a 'LifecycleNode' action as the target")
        expected = (target_lifecycle_node, transition, start_state, goal_state)

        def matches(event: Event) -> bool:
            if not isinstance(event, StateTransition):
                return False
            there = (event.action, event.transition, event.start_state, event.goal_state)
            return all(wanted in (None, other) for wanted, other in zip(expected, there, strict=True))

        super().__init__(matcher=matcher or matches, entities=entities, handle_once=handle_once)
