"""The goals of an action server: their states and transitions (rcl_action/goal_state_machine.c)."""

from collections.abc import Callable
from enum import Enum
from typing import Any, Protocol

from action_msgs.msg import GoalInfo, GoalStatus
from unique_identifier_msgs.msg import UUID

from rclpy.exceptions import RCLError
from rclpy.time import Time


class GoalEvent(Enum):
    """The events in the life of a goal."""

    EXECUTE = 0
    CANCEL_GOAL = 1
    SUCCEED = 2
    ABORT = 3
    CANCELED = 4


STATES = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
_ENDS = {GoalEvent.SUCCEED: GoalStatus.STATUS_SUCCEEDED, GoalEvent.ABORT: GoalStatus.STATUS_ABORTED}
_CANCEL = {GoalEvent.CANCEL_GOAL: GoalStatus.STATUS_CANCELING}
_TRANSITIONS = {
    GoalStatus.STATUS_ACCEPTED: {GoalEvent.EXECUTE: GoalStatus.STATUS_EXECUTING, **_CANCEL},
    GoalStatus.STATUS_EXECUTING: {**_ENDS, **_CANCEL},
    GoalStatus.STATUS_CANCELING: {**_ENDS, GoalEvent.CANCELED: GoalStatus.STATUS_CANCELED},
}


class GoalKeeper(Protocol):
    """An action server, as its goals know it."""

    def publish_feedback(self, goal: "ServerGoalHandle", feedback: Any) -> None:
        """Publish feedback of a goal."""

    def notify_state(self, goal: "ServerGoalHandle") -> None:
        """Publish the states of all goals."""

    def notify_execute(
        self, goal: "ServerGoalHandle", execute_callback: "Callable[[ServerGoalHandle], Any] | None"
    ) -> None:
        """Run the execute callback of a goal in an executor."""


class ServerGoalHandle:
    """An accepted goal, which the callbacks of an action server receive.

    `request` is the goal as the client sent it, `status` a constant of action_msgs/msg/GoalStatus.
    """

    def __init__(self, action_server: GoalKeeper, goal_info: GoalInfo, goal_request: Any) -> None:
        self._action_server = action_server
        self._goal_info = goal_info
        self.goal_id: UUID = goal_info.goal_id
        self.request = goal_request
        self.status: int = GoalStatus.STATUS_ACCEPTED
        self.accepted_ns = Time.from_msg(goal_info.stamp).nanoseconds

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ServerGoalHandle) and self.goal_id == other.goal_id

    __hash__ = None  # type: ignore[assignment]  # as in rclpy

    @property
    def is_active(self) -> bool:
        """True if it has not come to an end."""
        return self.status in _TRANSITIONS

    @property
    def is_cancelable(self) -> bool:
        """True if it can be cancelled."""
        return GoalEvent.CANCEL_GOAL in _TRANSITIONS.get(self.status, {})

    @property
    def is_cancel_requested(self) -> bool:
        """True if its cancellation was requested: then call `canceled` and return a result."""
        return self.status == GoalStatus.STATUS_CANCELING

    def execute(self, execute_callback: Callable[["ServerGoalHandle"], Any] | None = None) -> None:
        """Call the server's execute callback, or another one, with this goal in the executor."""
        if not self.is_cancel_requested:  # else the callback sees that, and ends the goal
            self._update_state(GoalEvent.EXECUTE)
        self._action_server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        """Publish feedback for the client; another type raises a TypeError without a text, as in rclpy."""
        self._action_server.publish_feedback(self, feedback)

    def succeed(self) -> None:
        """End: the goal was reached."""
        self._update_state(GoalEvent.SUCCEED)

    def abort(self) -> None:
        """End: the goal can not be reached."""
        self._update_state(GoalEvent.ABORT)

    def canceled(self) -> None:
        """End: the client had asked for it."""
        self._update_state(GoalEvent.CANCELED)

    def destroy(self) -> None:
        """Invalidate the goal: its state is unknown from now on, and nothing changes it."""
        self.status = GoalStatus.STATUS_UNKNOWN

    def to_message(self) -> GoalStatus:
        """Return its state as it is published."""
        return GoalStatus(goal_info=self._goal_info, status=self.status)

    def _update_state(self, event: GoalEvent) -> None:
        if self.status == GoalStatus.STATUS_UNKNOWN:
            return
        state = _TRANSITIONS.get(self.status, {}).get(event)
        if state is None:
            raise RCLError(
                "Failed to update goal state: goal_handle attempted invalid transition from state "
                f"{STATES[self.status]} with event {event.name}"
            )
        self.status = state
        self._action_server.notify_state(self)
