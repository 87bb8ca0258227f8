"""Action servers."""

import traceback
from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal

from rclpy.action.server_goal_handle import GoalEvent as GoalEvent
from rclpy.action.server_goal_handle import ServerGoalHandle as ServerGoalHandle
from rclpy.callback_groups import CallbackGroup
from rclpy.constants import S_TO_NS
from rclpy.exceptions import RCLError
from rclpy.impl.endpoint import require_type
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.service import LateService
from rclpy.task import Future, await_or_execute
from rclpy.time import Time

if TYPE_CHECKING:
    from rclpy.node import Node

Respond = Callable[[Any], object]


class GoalResponse(Enum):
    """The answer of a goal callback."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """The answer of a cancel callback."""

    REJECT = 1
    ACCEPT = 2


def default_goal_callback(goal_request: Any) -> GoalResponse:
    """Accept all goals."""
    return GoalResponse.ACCEPT


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    """Execute a goal immediately."""
    goal_handle.execute()


def default_cancel_callback(goal_handle: ServerGoalHandle) -> CancelResponse:
    """Cancel nothing."""
    return CancelResponse.REJECT


def _required(callback: Callable[[ServerGoalHandle], Any]) -> Callable[[ServerGoalHandle], Any]:
    if not callable(callback):
        raise TypeError("Failed to register goal execution callback: not callable")
    return callback


class ActionServer:
    """Executes goals.

    Args:
        node: The node that it is in.
        action_type: The action, like `example_interfaces.action.Fibonacci`.
        action_name: Its name; the topics and services that it uses are below `<name>/_action`.
        execute_callback: Called with a ServerGoalHandle, may be a coroutine; returns the action's Result.
        callback_group: The group of the goal, accepted and cancel callbacks.
        goal_callback: Called with the Goal; returns whether it is accepted.
        handle_accepted_callback: Called with the ServerGoalHandle; by default it is executed at once.
        cancel_callback: Called with a ServerGoalHandle; returns whether it may be cancelled, by default not.
        result_timeout: How long the result of a goal is kept after its end, [s]; negative: for ever.

    The five profiles are those of the services and the topics that it uses.
    """

    def __init__(
        self,
        node: "Node",
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
        feedback_pub_qos_profile: QoSProfile | int = 10,
        status_pub_qos_profile: QoSProfile = qos_profile_action_status_default,
        result_timeout: float = 900,
    ) -> None:
        self._execute_callback = _required(execute_callback)
        self._goal_callback = goal_callback or default_goal_callback
        self._handle_accepted_callback = handle_accepted_callback or default_handle_accepted_callback
        self._cancel_callback = cancel_callback or default_cancel_callback
        require_type(action_type, "action")
        self._node, self.action_type = node, action_type
        self._logger = node.get_logger().get_child("action_server")
        self._timeout_ns = round(result_timeout * S_TO_NS)
        self._goals: dict[bytes, ServerGoalHandle] = {}
        self._results: dict[bytes, Future[Any]] = {}
        self._ends_ns: dict[bytes, int] = {}  # when goals came to their ends
        impl, self._base = action_type.Impl, f"{action_name}/_action"
        feedback, feedback_qos = impl.FeedbackMessage, feedback_pub_qos_profile
        self._feedback = node.create_publisher(feedback, f"{self._base}/feedback", feedback_qos)
        self._status = node.create_publisher(GoalStatusArray, f"{self._base}/status", status_pub_qos_profile)
        self._ends: list[Any] = [self._feedback, self._status]
        group = callback_group or node.default_callback_group
        self._serve("send_goal", impl.SendGoalService, self._take_goal, goal_service_qos_profile, group)
        self._serve("cancel_goal", CancelGoal, self._cancel_goals, cancel_service_qos_profile, group)
        result_qos = result_service_qos_profile
        self._serve("get_result", impl.GetResultService, self._promise_result, result_qos, group)

    def _serve(
        self, name: str, kind: Any, take: Callable[..., Any], qos: QoSProfile, group: CallbackGroup
    ) -> None:
        full_name = self._node.resolve_service_name(f"{self._base}/{name}")
        self._ends.append(LateService(take, self._node.handle, group, kind, name, full_name, qos))
        self._node.add_waitable(self._ends[-1])

    def destroy(self) -> None:
        """Leave the graph."""
        for goal in self._goals.values():
            goal.destroy()
        for end in self._ends:
            self._node.destroy_publisher(end)

    def publish_feedback(self, goal: ServerGoalHandle, feedback: Any) -> None:
        """Publish feedback of a goal that is still known."""
        if not isinstance(feedback, self.action_type.Feedback):
            raise TypeError
        if goal.status != GoalStatus.STATUS_UNKNOWN:
            message = self.action_type.Impl.FeedbackMessage(goal_id=goal.goal_id, feedback=feedback)
            self._feedback.publish(message)

    def notify_state(self, goal: ServerGoalHandle) -> None:
        """Publish the states of all goals; a goal that has ended is forgotten after a while."""
        if not goal.is_active:
            self._ends_ns[bytes(goal.goal_id.uuid)] = self._node.handle.graph.now_ns
        self._status.publish(
            GoalStatusArray(status_list=[goal.to_message() for goal in self._goals.values()])
        )

    def notify_execute(
        self, goal: ServerGoalHandle, execute_callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        """Execute a goal in the executor."""
        executor = self._node.executor
        if executor is not None:
            executor.create_task(self._execute, execute_callback or self._execute_callback, goal)

    async def _take_goal(self, request: Any, respond: Respond) -> None:
        self._forget_old_goals()
        info, key = GoalInfo(goal_id=request.goal_id), bytes(request.goal_id.uuid)
        answer = self.action_type.Impl.SendGoalService.Response()
        if key not in self._goals:
            wanted = await await_or_execute(self._goal_callback, request.goal)
            if not isinstance(wanted, GoalResponse):
                self._logger.warning(
                    "Goal request callback did not return a GoalResponse type. Rejecting goal."
                )
            answer.accepted = wanted is GoalResponse.ACCEPT
        if answer.accepted:
            info.stamp = answer.stamp = self._node.get_clock().now().to_msg()
            self._goals[key] = ServerGoalHandle(self, info, request.goal)
            self._results[key] = Future()
        respond(answer)
        if answer.accepted:
            await await_or_execute(self._handle_accepted_callback, self._goals[key])

    async def _execute(self, callback: Callable[[ServerGoalHandle], Any], goal: ServerGoalHandle) -> None:
        try:
            result = await await_or_execute(callback, goal)
        except Exception as error:  # as in rclpy: the client gets an empty result
            result = self.action_type.Result()
            self._logger.error(f"Error raised in execute callback: {error}")
            traceback.print_exc()
        if goal.is_active:
            self._logger.warning(f"Goal state not set, assuming aborted. Goal ID: {goal.goal_id.uuid}")
            goal.abort()
        response = self.action_type.Impl.GetResultService.Response(status=goal.status, result=result)
        self._results[bytes(goal.goal_id.uuid)].set_result(response)

    async def _cancel_goals(self, request: CancelGoal.Request, respond: Respond) -> None:
        response = CancelGoal.Response()
        for goal in self._to_cancel(request.goal_info, response):
            if await await_or_execute(self._cancel_callback, goal) is CancelResponse.ACCEPT:
                try:
                    goal._update_state(GoalEvent.CANCEL_GOAL)
                except RCLError as error:  # it has ended meanwhile
                    self._logger.debug(f"Failed to cancel goal in cancel callback: {error}")
                else:
                    response.goals_canceling.append(goal.to_message().goal_info)
        respond(response)

    def _to_cancel(self, wanted: GoalInfo, response: CancelGoal.Response) -> list[ServerGoalHandle]:
        """Find the goals that a request means: one, those until a time, or all (CancelGoal.srv)."""
        key, until = bytes(wanted.goal_id.uuid), Time.from_msg(wanted.stamp).nanoseconds
        if any(key) and not until:
            goal = self._goals.get(key)
            if goal is None:
                response.return_code = CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID
            elif not goal.is_cancelable:
                response.return_code = CancelGoal.Response.ERROR_GOAL_TERMINATED
            return [goal] if goal is not None and goal.is_cancelable else []
        everything = not any(key) and not until
        return [
            goal
            for name, goal in self._goals.items()
            if goal.is_cancelable and (everything or name == key or goal.accepted_ns <= until)
        ]

    async def _promise_result(self, request: Any, respond: Respond) -> None:
        self._forget_old_goals()
        result = self._results.get(bytes(request.goal_id.uuid))
        if result is None:
            respond(self.action_type.Impl.GetResultService.Response(status=GoalStatus.STATUS_UNKNOWN))
        else:
            result.add_done_callback(lambda future: respond(future.result()))

    def _forget_old_goals(self) -> None:
        if self._timeout_ns < 0:
            return
        oldest_ns = self._node.handle.graph.now_ns - self._timeout_ns
        for key in [key for key, end_ns in self._ends_ns.items() if end_ns < oldest_ns]:
            self._goals.pop(key).destroy()
            del self._results[key], self._ends_ns[key]
