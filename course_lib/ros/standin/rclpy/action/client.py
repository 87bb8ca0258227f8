"""Action clients."""

import uuid
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal
from builtin_interfaces.msg import Time
from unique_identifier_msgs.msg import UUID

from course_lib.ros.mistakes import Mistake, marked
from rclpy.callback_groups import CallbackGroup
from rclpy.client import Client, wait_for_partner
from rclpy.impl.endpoint import require_type
from rclpy.impl.graph_queries import NamesAndTypes, actions
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.task import Future, await_or_execute

if TYPE_CHECKING:
    from rclpy.node import Node

OnFeedback = Callable[[Any], object]


class ClientGoalHandle:
    """A goal as its client sees it: the result of the future of `send_goal_async`.

    `accepted` and `stamp` say whether and when the server took it; `status`, a constant of
    action_msgs/msg/GoalStatus, is what the server published of it last.
    """

    def __init__(self, action_client: "ActionClient", goal_id: UUID, goal_response: Any) -> None:
        self._action_client = action_client
        self.goal_id = goal_id
        self.accepted = bool(goal_response.accepted)
        self.stamp: Time = goal_response.stamp
        self.status: int = GoalStatus.STATUS_UNKNOWN

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClientGoalHandle) and self.goal_id == other.goal_id

    __hash__ = None  # type: ignore[assignment]  # as in rclpy

    def __repr__(self) -> str:
        state = f"accepted={self.accepted}, status={self.status}"
        return f"ClientGoalHandle <id={self.goal_id.uuid}, {state}>"

    def cancel_goal(self) -> CancelGoal.Response:
        """Request the cancellation and wait for the answer, which another thread has to take."""
        response: CancelGoal.Response = self._action_client._cancels.call(self._cancel_request())
        return response

    def cancel_goal_async(self) -> Future[CancelGoal.Response]:
        """Request the cancellation."""
        return self._action_client._cancels.call_async(self._cancel_request())

    def get_result(self) -> Any:
        """Wait for its end, which another thread has to take; the answer holds `status` and `result`."""
        return self._action_client._results.call(self._action_client._result_request(self))

    def get_result_async(self) -> Future[Any]:
        """Request its end; the answer holds `status` and `result`."""
        client = self._action_client
        future = client._results.call_async(client._result_request(self))
        future.add_done_callback(lambda _: client._feedback_callbacks.pop(bytes(self.goal_id.uuid), None))
        return future

    def _cancel_request(self) -> CancelGoal.Request:
        return CancelGoal.Request(goal_info=GoalInfo(goal_id=self.goal_id))


class ActionClient:
    """A client of an action server.

    `action_type` is like `example_interfaces.action.Fibonacci`; `callback_group` is the group of its
    callbacks. The five profiles are those of the services and the topics that it uses.
    """

    def __init__(
        self,
        node: "Node",
        action_type: Any,
        action_name: str,
        *,
        callback_group: CallbackGroup | None = None,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_sub_qos_profile: QoSProfile | int = 10,
        status_sub_qos_profile: QoSProfile = qos_profile_action_status_default,
    ) -> None:
        require_type(action_type, "action")
        self._node, self._action_type, self._action_name = node, action_type, action_name
        self._logger = node.get_logger().get_child("action_client")
        self._goals: WeakValueDictionary[bytes, ClientGoalHandle] = WeakValueDictionary()
        self._feedback_callbacks: dict[bytes, OnFeedback] = {}
        impl, group = action_type.Impl, callback_group
        self._sends = self._client("send_goal", "goal", impl.SendGoalService, goal_service_qos_profile, group)
        self._cancels = self._client("cancel_goal", "cancel", CancelGoal, cancel_service_qos_profile, group)
        self._results = self._client(
            "get_result", "result", impl.GetResultService, result_service_qos_profile, group
        )
        self._ends: list[Any] = [self._sends, self._cancels, self._results]
        topics: tuple[tuple[str, Any, Callable[[Any], object], QoSProfile | int], ...] = (
            ("feedback", impl.FeedbackMessage, self._on_feedback, feedback_sub_qos_profile),
            ("status", GoalStatusArray, self._on_status, status_sub_qos_profile),
        )
        for name, kind, hear, qos in topics:
            topic = f"{action_name}/_action/{name}"
            self._ends.append(node.create_subscription(kind, topic, hear, qos, callback_group=group))

    def _client(
        self, name: str, word: str, kind: Any, qos: QoSProfile, group: CallbackGroup | None
    ) -> Client:
        """Create the client of one of the action's services; `word` is for its warnings."""
        full_name = f"{self._action_name}/_action/{name}"
        client = self._node.create_client(kind, full_name, qos_profile=qos, callback_group=group)
        client.on_unexpected = partial(self._warn, word)
        return client

    def send_goal(self, goal: Any, **kwargs: Any) -> Any:
        """Send a goal and wait for its end, which another thread has to take.

        Returns an answer that holds `status` and `result`. Not for callbacks, which it would block: there it
        is a DeadlockError, where ROS hangs.
        """
        request = self._request(goal, **kwargs)
        return self._accept(request, self._sends.call(request)).get_result()

    def send_goal_async(
        self, goal: Any, feedback_callback: OnFeedback | None = None, goal_uuid: UUID | None = None
    ) -> Future[ClientGoalHandle]:
        """Send a goal; the future brings its handle when the server has accepted or rejected it.

        An object that is not a goal of this action raises a TypeError without a text, as in rclpy.
        """
        request = self._request(goal, feedback_callback, goal_uuid)
        future: Future[ClientGoalHandle] = Future()

        def bring(answer: Future[Any]) -> None:
            future._set_executor(self._node.executor)
            future.set_result(self._accept(request, answer.result()))

        self._sends.call_async(request).add_done_callback(bring)
        return future

    def server_is_ready(self) -> bool:
        """Return whether a server is there."""
        return all(end.partner_count() for end in self._ends)

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Wait until a server is there, [s]; None: without limit; returns whether it is."""
        what = f"the action {self._action_name}"
        return wait_for_partner(self._node.handle, self.server_is_ready, timeout_sec, what)

    def destroy(self) -> None:
        """Leave the graph."""
        for end in self._ends:
            self._node.destroy_publisher(end)

    def _request(
        self, goal: Any, feedback_callback: OnFeedback | None = None, goal_uuid: UUID | None = None
    ) -> Any:
        if not isinstance(goal, self._action_type.Goal):
            raise marked(TypeError(), Mistake.GOAL)
        goal_id = goal_uuid or UUID(uuid=list(uuid.uuid4().bytes))
        if feedback_callback is not None:
            self._feedback_callbacks[bytes(goal_id.uuid)] = feedback_callback
        return self._action_type.Impl.SendGoalService.Request(goal_id=goal_id, goal=goal)

    def _result_request(self, handle: ClientGoalHandle) -> Any:
        return self._action_type.Impl.GetResultService.Request(goal_id=handle.goal_id)

    def _accept(self, request: Any, response: Any) -> ClientGoalHandle:
        handle = ClientGoalHandle(self, request.goal_id, response)
        if handle.accepted:
            key = bytes(request.goal_id.uuid)
            if key in self._goals:
                raise RuntimeError(f"Two goals were accepted with the same ID ({handle})")
            self._goals[key] = handle
        return handle

    async def _on_feedback(self, message: Any) -> None:
        callback = self._feedback_callbacks.get(bytes(message.goal_id.uuid))
        if callback is not None:
            await await_or_execute(callback, message)

    def _on_status(self, message: GoalStatusArray) -> None:
        for one in message.status_list:
            handle = self._goals.get(bytes(one.goal_info.goal_id.uuid))
            if handle is not None:
                handle.status = one.status

    def _warn(self, word: str) -> None:
        self._logger.warning(
            f"Ignoring unexpected {word} response. There may be more than one action server for the action "
            f"'{self._action_name}'"
        )


def get_action_names_and_types(node: "Node") -> NamesAndTypes:
    """List all actions with their types."""
    return actions(node.handle.graph.endpoints())
