"""Events of lifecycle nodes: a requested transition, and a completed one; the matcher of nodes."""

from collections.abc import Callable
from typing import Any, ClassVar

from launch.entities import Event
from lifecycle_msgs.msg import Transition, TransitionEvent

_NAMES = ("CREATE", "CONFIGURE", "CLEANUP", "ACTIVATE", "DEACTIVATE", "UNCONFIGURED_SHUTDOWN")
_TRANSITIONS = [f"TRANSITION_{name}" for name in (*_NAMES, "INACTIVE_SHUTDOWN", "ACTIVE_SHUTDOWN", "DESTROY")]


class ChangeState(Event):
    """A request to the matching lifecycle nodes to execute a transition."""

    valid_transitions: ClassVar[dict[int, str]] = {getattr(Transition, name): name for name in _TRANSITIONS}

    def __init__(
        self,
        *,
        lifecycle_node_matcher: Callable[[Any], bool],
        transition_id: int,
    ) -> None:
        if transition_id not in self.valid_transitions:
            valid = ", ".join(f"{name}: {number}" for number, name in self.valid_transitions.items())
            raise ValueError(f"given transition_id of '{transition_id}', expected one of {{{valid}}}")
        self.lifecycle_node_matcher, self.transition_id = lifecycle_node_matcher, transition_id


class StateTransition(Event):
    """A transition that a lifecycle node has executed. `action` is its LifecycleNode."""

    def __init__(self, *, action: Any, msg: TransitionEvent) -> None:
        self.action, self.msg, self.timestamp = action, msg, msg.timestamp
        self.transition = msg.transition.label
        self.start_state, self.goal_state = msg.start_state.label, msg.goal_state.label


def matches_node_name(node_name: str) -> Callable[[Any], bool]:
    """Return a matcher for the LifecycleNode with this name, including its namespace."""
    full = node_name if node_name.startswith("/") else f"/{node_name}"

    def matches(action: Any) -> bool:
        return bool(action.node_name == full)

    return matches
