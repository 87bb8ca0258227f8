"""Action servers and the states of their goals (rcl_action/goal_state_machine.c)."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from unique_identifier_msgs.msg import UUID

from course_lib.ros.mistakes import Mistake, marked
from course_lib.ros.notices import print_notice
from rclpy.callback_groups import CallbackGroup
from rclpy.duration import S_TO_NS
from rclpy.impl.endpoint import require_type
from rclpy.impl.implementation_singleton import RCLError
from rclpy.impl.names import require_action_name
from rclpy.impl.node_handle import require_node
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.service import LateService
from rclpy.task import Future, await_or_execute
from rclpy.time import Time

if TYPE_CHECKING:
    from rclpy.node import Node


class GoalEvent(Enum):
    """Events that change the state of a goal."""

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


class ServerGoalHandle:
    """An accepted goal, which is passed to the callbacks of an action server.

    `request` is the goal as the client sent it, `status` a constant of action_msgs/msg/GoalStatus.
    """

    def __init__(self, action_server: ActionServer, goal_info: GoalInfo, goal_request: Any) -> None:
        self._action_server = action_server
        self._goal_info = goal_info
        self.goal_id: UUID = goal_info.goal_id
        self.request = goal_request
        self.status: int = GoalStatus.STATUS_ACCEPTED
        self._course_accepted_ns = Time.from_msg(goal_info.stamp).nanoseconds

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ServerGoalHandle) and self.goal_id == other.goal_id

    __hash__ = None  # type: ignore[assignment]  # as in rclpy

    @property
    def is_active(self) -> bool:
        """True if the goal is not in a final state."""
        return self.status in _TRANSITIONS

    @property
    def _course_is_cancelable(self) -> bool:
        """True if the goal can be cancelled in its current state."""
        return GoalEvent.CANCEL_GOAL in _TRANSITIONS.get(self.status, {})

    @property
    def is_cancel_requested(self) -> bool:
        """True if the cancellation was accepted.

        The execute callback should call `canceled` and return a result.
        """
        return self.status == GoalStatus.STATUS_CANCELING

    def execute(self, execute_callback: Callable[[ServerGoalHandle], Any] | None = None) -> None:
        """Schedule `execute_callback` for this goal, or the server's callback by default."""
        # A goal that is being cancelled keeps its state: its callback checks `is_cancel_requested`
        # and ends it.
        if not self.is_cancel_requested:
            self._update_state(GoalEvent.EXECUTE)
        self._action_server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        """Publish feedback to the client.

        Another type raises a TypeError without a message, as in rclpy.
        """
        server = self._action_server
        if not isinstance(feedback, server.action_type.Feedback):
            raise marked(TypeError(), Mistake.FEEDBACK)
        # A goal that has been destroyed publishes nothing.
        if self.status != GoalStatus.STATUS_UNKNOWN:
            message = server.action_type.Impl.FeedbackMessage(goal_id=self.goal_id, feedback=feedback)
            server._course_feedback.publish(message)

    def succeed(self) -> None:
        """Set the final state SUCCEEDED: the goal was reached."""
        self._update_state(GoalEvent.SUCCEED)

    def abort(self) -> None:
        """Set the final state ABORTED: the goal cannot be reached."""
        self._update_state(GoalEvent.ABORT)

    def canceled(self) -> None:
        """Set the final state CANCELED, as the client requested."""
        self._update_state(GoalEvent.CANCELED)

    def destroy(self) -> None:
        """Invalidate the goal: its status is UNKNOWN from now on, and later events are ignored."""
        self.status = GoalStatus.STATUS_UNKNOWN

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
        self._action_server._course_notify_state(self)


Respond = Callable[[Any], object]


class GoalResponse(Enum):
    """The result of a goal callback."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """The result of a cancel callback."""

    REJECT = 1
    ACCEPT = 2


def default_goal_callback(goal_request: Any) -> GoalResponse:
    """Accept all goals."""
    return GoalResponse.ACCEPT


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    """Execute a goal immediately after it was accepted."""
    goal_handle.execute()


def default_cancel_callback(cancel_request: ServerGoalHandle) -> CancelResponse:
    """Reject the cancellation."""
    return CancelResponse.REJECT


class ActionServer:
    """An action server, which executes goals.

    Args:
        node: The node of the server.
        action_type: The action's class, like `example_interfaces.action.Fibonacci`.
        action_name: The action's name; its topics and services are below `<name>/_action`.
        execute_callback: Called with a ServerGoalHandle, may be a coroutine; returns the action's
            Result.
        callback_group: The group of the goal, accepted and cancel callbacks.
        goal_callback: Called with the Goal; returns a GoalResponse.
        handle_accepted_callback: Called with the ServerGoalHandle; executes it immediately by
            default.
        cancel_callback: Called with a ServerGoalHandle; returns a CancelResponse, REJECT by
            default.
        result_timeout: How long the result of a finished goal is kept, [s].

    The five QoS profiles apply to the services and topics that make up the action.
    """

    def __init__(
        self,
        node: Node,
        action_type: Any,
        action_name: str,
        execute_callback: Callable[[ServerGoalHandle], Any],
        *,
        callback_group: CallbackGroup | None = None,
        goal_callback: Callable[[Any], Any] | None = default_goal_callback,
        handle_accepted_callback: Callable[[ServerGoalHandle], Any] | None = default_handle_accepted_callback,
        cancel_callback: Callable[[ServerGoalHandle], Any] | None = default_cancel_callback,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_pub_qos_profile: QoSProfile | int = QoSProfile(depth=10),  # noqa: B008  # as in rclpy
        status_pub_qos_profile: QoSProfile = qos_profile_action_status_default,
        result_timeout: float = 900,
    ) -> None:
        self.register_handle_accepted_callback(handle_accepted_callback)
        self.register_goal_callback(goal_callback)
        self.register_cancel_callback(cancel_callback)
        self.register_execute_callback(execute_callback)
        if not isinstance(result_timeout, int | float) and not hasattr(result_timeout, "__index__"):
            raise TypeError("__init__(): incompatible constructor arguments.")
        if result_timeout < 0:
            raise ValueError("Failed to create action server: timer period must be non-negative")
        group = callback_group or node.default_callback_group
        require_type(action_type, "action")
        require_node(node.handle, "Failed to create action server")
        require_action_name(action_name, "server", node.handle.name, node.handle.namespace)
        self.__is_destroyed = False
        self._node, self._action_type = node, action_type
        self._logger = node.get_logger().get_child("action_server")
        self.__timeout_ns = round(result_timeout * S_TO_NS)
        self._goal_handles: dict[bytes, ServerGoalHandle] = {}
        self.__hints = set[str]()
        self._result_futures: dict[bytes, Future[Any]] = {}
        # Times at which goals reached a final state [ns].
        self.__ends_ns: dict[bytes, int] = {}
        impl, self.__base = action_type.Impl, f"{action_name}/_action"
        feedback, feedback_qos = impl.FeedbackMessage, feedback_pub_qos_profile
        self._course_feedback = node.create_publisher(feedback, f"{self.__base}/feedback", feedback_qos)
        self.__status = node.create_publisher(
            GoalStatusArray, f"{self.__base}/status", status_pub_qos_profile
        )
        self.__ends: list[Any] = [self._course_feedback, self.__status]
        self.__serve("send_goal", impl.SendGoalService, self.__take_goal, goal_service_qos_profile, group)
        self.__serve("cancel_goal", CancelGoal, self.__cancel_goals, cancel_service_qos_profile, group)
        result_qos = result_service_qos_profile
        self.__serve("get_result", impl.GetResultService, self.__promise_result, result_qos, group)
        for end in self.__ends:
            node._course_hide(end)

    def __serve(
        self, name: str, kind: Any, take: Callable[..., Any], qos: QoSProfile, group: CallbackGroup
    ) -> None:
        full_name = self._node._course_resolve(f"{self.__base}/{name}", "service")
        self.__ends.append(LateService(take, self._node.handle, group, kind, name, full_name, qos))
        self._node.add_waitable(self.__ends[-1])

    def destroy(self) -> None:
        """Destroy the goals and the services and publishers that make up the action server."""
        for goal in self._goal_handles.values():
            goal.destroy()
        if self.__is_destroyed:
            # The server is not among the waitables of its node any more.
            raise ValueError("list.remove(x): x not in list")
        for end in self.__ends:
            self._node._course_destroy(end)
        self.__is_destroyed = True

    def register_execute_callback(
        self,
        execute_callback: Callable[[ServerGoalHandle], Any],
    ) -> None:
        """Replace the callback that executes goals."""
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback = execute_callback

    def register_goal_callback(self, goal_callback: Callable[[Any], Any] | None) -> None:
        """Replace the callback that accepts or rejects goals. None accepts all."""
        self._goal_callback = goal_callback or default_goal_callback

    def register_handle_accepted_callback(
        self, handle_accepted_callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        """Replace the callback for accepted goals. None executes them immediately."""
        self._handle_accepted_callback = handle_accepted_callback or default_handle_accepted_callback

    def register_cancel_callback(
        self,
        cancel_callback: Callable[[ServerGoalHandle], Any] | None,
    ) -> None:
        """Replace the callback that accepts or rejects cancellations. None rejects all."""
        self._cancel_callback = cancel_callback or default_cancel_callback

    @property
    def action_type(self) -> Any:
        """The class of the action."""
        return self._action_type

    def _course_notify_state(self, goal: ServerGoalHandle) -> None:
        """Publish the status of all goals.

        A goal in a final state is dropped after the result timeout.
        """
        if not goal.is_active:
            self.__ends_ns[bytes(goal.goal_id.uuid)] = self._node.handle.graph.now_ns
        if not self._node.context.is_valid:
            raise RCLError("Failed get goal status array: feedback publisher is invalid")
        goals = self._goal_handles.values()
        statuses = [GoalStatus(goal_info=goal._goal_info, status=goal.status) for goal in goals]
        self.__status.publish(GoalStatusArray(status_list=statuses))

    def notify_execute(
        self, goal_handle: ServerGoalHandle, execute_callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        """Schedule the execute callback of a goal in the node's executor."""
        executor = self._node.executor
        if executor is not None:
            executor.create_task(self.__execute, execute_callback or self._execute_callback, goal_handle)

    async def __take_goal(self, request: Any, respond: Respond) -> None:
        self.__forget_old_goals()
        info, key = GoalInfo(goal_id=request.goal_id), bytes(request.goal_id.uuid)
        answer = self.action_type.Impl.SendGoalService.Response()
        if key not in self._goal_handles:
            goal_response = await await_or_execute(self._goal_callback, request.goal)
            if not isinstance(goal_response, GoalResponse):
                self._logger.warning(
                    "Goal request callback did not return a GoalResponse type. Rejecting goal."
                )
                self.__hint("end the goal callback with return GoalResponse.ACCEPT, or REJECT.")
            answer.accepted = goal_response is GoalResponse.ACCEPT
        if answer.accepted:
            info.stamp = answer.stamp = self._node.get_clock().now().to_msg()
            self._goal_handles[key] = ServerGoalHandle(self, info, request.goal)
            self._result_futures[key] = Future()
        respond(answer)
        if answer.accepted:
            self._course_notify_state(self._goal_handles[key])
            await await_or_execute(self._handle_accepted_callback, self._goal_handles[key])

    async def __execute(
        self,
        callback: Callable[[ServerGoalHandle], Any],
        goal: ServerGoalHandle,
    ) -> None:
        has_failed = False
        try:
            result = await await_or_execute(callback, goal)
        # As in rclpy, the client receives an empty result.
        except Exception as error:
            result, has_failed = self.action_type.Result(), True
            from course_lib.ros.tracebacks import print_error

            self._logger.error(f"Error raised in execute callback: {error}")
            print_error(error)
        if goal.is_active:
            self._logger.warning(f"Goal state not set, assuming aborted. Goal ID: {goal.goal_id.uuid}")
            # After an exception, the goal has rightly failed.
            if not has_failed:
                self.__hint("call goal_handle.succeed(), with ( ), before the callback returns the result.")
            goal.abort()
        response = self.action_type.Impl.GetResultService.Response(status=goal.status, result=result)
        self._result_futures[bytes(goal.goal_id.uuid)].set_result(response)

    def __hint(self, text: str) -> None:
        """Print a hint once for each server."""
        if text not in self.__hints:
            self.__hints.add(text)
            print_notice(f"hint: {text}")

    async def __cancel_goals(self, request: CancelGoal.Request, respond: Respond) -> None:
        response = CancelGoal.Response()
        for goal in self.__goals_to_cancel(request.goal_info, response):
            if await await_or_execute(self._cancel_callback, goal) is CancelResponse.ACCEPT:
                try:
                    goal._update_state(GoalEvent.CANCEL_GOAL)
                # The goal has ended since it was selected.
                except RCLError as error:
                    self._logger.debug(f"Failed to cancel goal in cancel callback: {error}")
                else:
                    response.goals_canceling.append(goal._goal_info)
        respond(response)

    def __goals_to_cancel(
        self,
        wanted: GoalInfo,
        response: CancelGoal.Response,
    ) -> list[ServerGoalHandle]:
        """Find a request's goals: one, all accepted up to a time, or all (CancelGoal.srv)."""
        key, until = bytes(wanted.goal_id.uuid), Time.from_msg(wanted.stamp).nanoseconds
        if any(key) and not until:
            goal = self._goal_handles.get(key)
            if goal is None:
                response.return_code = CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID
            elif not goal._course_is_cancelable:
                response.return_code = CancelGoal.Response.ERROR_GOAL_TERMINATED
            return [goal] if goal is not None and goal._course_is_cancelable else []
        everything = not any(key) and not until
        return [
            goal
            for name, goal in self._goal_handles.items()
            if goal._course_is_cancelable and (everything or name == key or goal._course_accepted_ns <= until)
        ]

    async def __promise_result(self, request: Any, respond: Respond) -> None:
        self.__forget_old_goals()
        result = self._result_futures.get(bytes(request.goal_id.uuid))
        if result is None:
            respond(self.action_type.Impl.GetResultService.Response(status=GoalStatus.STATUS_UNKNOWN))
        else:
            result.add_done_callback(lambda future: respond(future.result()))

    def __forget_old_goals(self) -> None:
        oldest_ns = self._node.handle.graph.now_ns - self.__timeout_ns
        for key in [key for key, end_ns in self.__ends_ns.items() if end_ns < oldest_ns]:
            self._goal_handles.pop(key).destroy()
            del self._result_futures[key], self.__ends_ns[key]
