"""The states of a lifecycle node and the transitions between them (rcl_lifecycle)."""

from collections.abc import Callable
from typing import NamedTuple

from lifecycle_msgs.msg import State, Transition, TransitionDescription, TransitionEvent

from rclpy.exceptions import RCLError
from rclpy.logging import get_logger

STATES = {
    "unknown": State.PRIMARY_STATE_UNKNOWN,
    "unconfigured": State.PRIMARY_STATE_UNCONFIGURED,
    "inactive": State.PRIMARY_STATE_INACTIVE,
    "active": State.PRIMARY_STATE_ACTIVE,
    "finalized": State.PRIMARY_STATE_FINALIZED,
    "configuring": State.TRANSITION_STATE_CONFIGURING,
    "cleaningup": State.TRANSITION_STATE_CLEANINGUP,
    "shuttingdown": State.TRANSITION_STATE_SHUTTINGDOWN,
    "activating": State.TRANSITION_STATE_ACTIVATING,
    "deactivating": State.TRANSITION_STATE_DEACTIVATING,
    "errorprocessing": State.TRANSITION_STATE_ERRORPROCESSING,
}


class Step(NamedTuple):
    """One transition, from the label of a state to that of another."""

    number: int
    label: str
    start: str
    goal: str


SUCCESS, FAILURE, ERROR = "transition_success", "transition_failure", "transition_error"
STEPS = (  # in rcl's order, which the services show
    Step(Transition.TRANSITION_CONFIGURE, "configure", "unconfigured", "configuring"),
    Step(Transition.TRANSITION_ON_CONFIGURE_SUCCESS, SUCCESS, "configuring", "inactive"),
    Step(Transition.TRANSITION_ON_CONFIGURE_FAILURE, FAILURE, "configuring", "unconfigured"),
    Step(Transition.TRANSITION_ON_CONFIGURE_ERROR, ERROR, "configuring", "errorprocessing"),
    Step(Transition.TRANSITION_CLEANUP, "cleanup", "inactive", "cleaningup"),
    Step(Transition.TRANSITION_ON_CLEANUP_SUCCESS, SUCCESS, "cleaningup", "unconfigured"),
    Step(Transition.TRANSITION_ON_CLEANUP_FAILURE, FAILURE, "cleaningup", "inactive"),
    Step(Transition.TRANSITION_ON_CLEANUP_ERROR, ERROR, "cleaningup", "errorprocessing"),
    Step(Transition.TRANSITION_ACTIVATE, "activate", "inactive", "activating"),
    Step(Transition.TRANSITION_ON_ACTIVATE_SUCCESS, SUCCESS, "activating", "active"),
    Step(Transition.TRANSITION_ON_ACTIVATE_FAILURE, FAILURE, "activating", "inactive"),
    Step(Transition.TRANSITION_ON_ACTIVATE_ERROR, ERROR, "activating", "errorprocessing"),
    Step(Transition.TRANSITION_DEACTIVATE, "deactivate", "active", "deactivating"),
    Step(Transition.TRANSITION_ON_DEACTIVATE_SUCCESS, SUCCESS, "deactivating", "inactive"),
    Step(Transition.TRANSITION_ON_DEACTIVATE_FAILURE, FAILURE, "deactivating", "active"),
    Step(Transition.TRANSITION_ON_DEACTIVATE_ERROR, ERROR, "deactivating", "errorprocessing"),
    Step(Transition.TRANSITION_UNCONFIGURED_SHUTDOWN, "shutdown", "unconfigured", "shuttingdown"),
    Step(Transition.TRANSITION_INACTIVE_SHUTDOWN, "shutdown", "inactive", "shuttingdown"),
    Step(Transition.TRANSITION_ACTIVE_SHUTDOWN, "shutdown", "active", "shuttingdown"),
    Step(Transition.TRANSITION_ON_SHUTDOWN_SUCCESS, SUCCESS, "shuttingdown", "finalized"),
    Step(Transition.TRANSITION_ON_SHUTDOWN_FAILURE, FAILURE, "shuttingdown", "finalized"),
    Step(Transition.TRANSITION_ON_SHUTDOWN_ERROR, ERROR, "shuttingdown", "errorprocessing"),
    Step(Transition.TRANSITION_ON_ERROR_SUCCESS, SUCCESS, "errorprocessing", "unconfigured"),
    Step(Transition.TRANSITION_ON_ERROR_FAILURE, FAILURE, "errorprocessing", "finalized"),
    Step(Transition.TRANSITION_ON_ERROR_ERROR, ERROR, "errorprocessing", "finalized"),
)


class StateMachine:
    """The state of one node; `publish` gets an event for each transition."""

    def __init__(self, publish: Callable[[TransitionEvent], object]) -> None:
        self.label = "unconfigured"
        self._publish = publish

    @property
    def number(self) -> int:
        """The number of the state."""
        return STATES[self.label]

    def steps(self) -> list[Step]:
        """List the transitions that begin in the state."""
        return [step for step in STEPS if step.start == self.label]

    def find(self, wanted: int | str) -> Step | None:
        """Return the transition of a number or a label; where there is none, log rcl's line."""
        found = [step for step in self.steps() if wanted in (step.number, step.label)]
        if not found:
            text = f"No transition matching {wanted} found for current state {self.label}"
            get_logger("rcl_lifecycle").warning(text)
        return found[0] if found else None

    def go(self, wanted: int | str) -> None:
        """Trigger a transition; raises an RCLError if the state has none of that number or label."""
        step = self.find(wanted)
        if step is None:
            raise RCLError(
                "Failed to trigger lifecycle state machine transition: Transition is not registered."
            )
        self.label = step.goal
        self._publish(TransitionEvent(start_state=message_of(step.start), goal_state=message_of(step.goal)))


def message_of(label: str) -> State:
    """Return a state as a message."""
    return State(id=STATES[label], label=label)


def description_of(step: Step) -> TransitionDescription:
    """Return a transition as a message."""
    return TransitionDescription(
        transition=Transition(id=step.number, label=step.label),
        start_state=message_of(step.start),
        goal_state=message_of(step.goal),
    )
