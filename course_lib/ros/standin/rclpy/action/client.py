"""Action clients."""

from __future__ import annotations

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
from course_lib.ros.time.time_lock import time_lock
from course_lib.ros.tracebacks import explain_interrupts
from rclpy.callback_groups import CallbackGroup
from rclpy.client import Client, wait_for_partner
from rclpy.impl.endpoint import require_type
from rclpy.impl.graph_queries import NamesAndTypes, actions
from rclpy.impl.implementation_singleton import RCLError
from rclpy.impl.names import require_action_name
from rclpy.impl.node_handle import require_node
from rclpy.qos import QoSProfile, qos_profile_action_status_default, qos_profile_services_default
from rclpy.task import Future, await_or_execute

if TYPE_CHECKING:
    from rclpy.node import Node

OnFeedback = Callable[[Any], object]


class ClientGoalHandle:
    """A goal on the client's side: the result of the future of `send_goal_async`.

    `accepted` and `stamp` are the server's response. `status`, a constant of
    action_msgs/msg/GoalStatus, is the last status published by the server.
    """

    def __init__(self, action_client: ActionClient, goal_id: UUID, goal_response: Any) -> None:
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
        """Request the cancellation and block until another thread has received the response."""
        response: CancelGoal.Response = self._action_client._course_cancels.call(self.__cancel_request())
        return response

    def cancel_goal_async(self) -> Future[CancelGoal.Response]:
        """Request the cancellation and return the future of the response."""
        return self._action_client._course_cancels.call_async(self.__cancel_request())

    def get_result(self) -> Any:
        """Block until another thread has received the result.

        The response holds `status` and `result`.
        """
        return self._action_client._course_results.call(self._action_client._course_result_request(self))

    def get_result_async(self) -> Future[Any]:
        """Request the result and return its future. The response holds `status` and `result`."""
        client = self._action_client
        response = client._course_results.call_async(client._course_result_request(self))
        future: Future[Any] = Future()
        response.add_done_callback(partial(self.__on_result, future))
        future._course_unmet = response._course_unmet
        return future

    def __on_result(self, future: Future[Any], response: Future[Any]) -> None:
        self._action_client._feedback_callbacks.pop(bytes(self.goal_id.uuid), None)
        result = response.result()
        if result is not None and result.status != GoalStatus.STATUS_UNKNOWN:
            # In ROS the last message about the status has arrived by now. The response for a goal
            # that the server has forgotten has no status.
            self.status = result.status
        self._action_client._course_complete(future, result)

    def __cancel_request(self) -> CancelGoal.Request:
        return CancelGoal.Request(goal_info=GoalInfo(goal_id=self.goal_id))


class ActionClient:
    """A client of an action server.

    `action_type` is a class like `example_interfaces.action.Fibonacci`; `callback_group` is the
    group of the client's callbacks. The five QoS profiles apply to the services and topics that
    make up the action.
    """

    def __init__(
        self,
        node: Node,
        action_type: Any,
        action_name: str,
        *,
        callback_group: CallbackGroup | None = None,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_sub_qos_profile: QoSProfile | int = QoSProfile(depth=10),  # noqa: B008  # as in rclpy
        status_sub_qos_profile: QoSProfile = qos_profile_action_status_default,
    ) -> None:
        group = callback_group or node.default_callback_group
        require_type(action_type, "action")
        require_node(node.handle, "Failed to create action client")
        require_action_name(action_name, "client", node.handle.name, node.handle.namespace)
        self.__is_destroyed = False
        self._node, self._action_type, self._action_name = node, action_type, action_name
        self._logger = node.get_logger().get_child("action_client")
        self._goal_handles: WeakValueDictionary[bytes, ClientGoalHandle] = WeakValueDictionary()
        self._feedback_callbacks: dict[bytes, OnFeedback] = {}
        # The last status of each goal that the server has published.
        self.__statuses: dict[bytes, int] = {}
        impl = action_type.Impl
        # Created first, so that the status of a goal is known when its response arrives.
        status = node.create_subscription(
            GoalStatusArray,
            f"{action_name}/_action/status",
            self.__on_status,
            status_sub_qos_profile,
            callback_group=group,
        )
        self.__sends = self.__create_client(
            "send_goal", "goal", impl.SendGoalService, goal_service_qos_profile, group
        )
        self._course_cancels = self.__create_client(
            "cancel_goal", "cancel", CancelGoal, cancel_service_qos_profile, group
        )
        self._course_results = self.__create_client(
            "get_result", "result", impl.GetResultService, result_service_qos_profile, group
        )
        feedback = node.create_subscription(
            impl.FeedbackMessage,
            f"{action_name}/_action/feedback",
            self.__on_feedback,
            feedback_sub_qos_profile,
            callback_group=group,
        )
        clients = (self.__sends, self._course_cancels, self._course_results)
        self.__ends: list[Any] = [*clients, feedback, status]
        for end in self.__ends:
            node._course_hide(end)

    def __create_client(
        self, name: str, word: str, kind: Any, qos: QoSProfile, group: CallbackGroup | None
    ) -> Client:
        """Create the client of one of the action's services.

        `word` names the service in warnings.
        """
        full_name = f"{self._action_name}/_action/{name}"
        client = self._node.create_client(kind, full_name, qos_profile=qos, callback_group=group)
        client._course_on_unexpected = partial(self.__warn, word)
        return client

    def send_goal(self, goal: Any, **kwargs: Any) -> Any:
        """Send a goal and block until another thread has received its result.

        Returns a response with `status` and `result`. Must not be called in a callback, which it
        would block: it raises a DeadlockError there, where ROS hangs.
        """
        request = self.__request(goal, **kwargs)
        return self.__accept(request, self.__sends.call(request)).get_result()

    def send_goal_async(
        self, goal: Any, feedback_callback: OnFeedback | None = None, goal_uuid: UUID | None = None
    ) -> Future[ClientGoalHandle]:
        """Send a goal and return a future of its handle, which the server's response completes.

        An object that is not a goal of this action raises a TypeError without a message, as in
        rclpy.
        """
        request = self.__request(goal, feedback_callback, goal_uuid)
        future: Future[ClientGoalHandle] = Future()

        def bring(answer: Future[Any]) -> None:
            self._course_complete(future, self.__accept(request, answer.result()))

        response = self.__sends.call_async(request)
        response.add_done_callback(bring)
        future._course_unmet = response._course_unmet
        return future

    def _course_complete(self, future: Future[Any], result: Any) -> None:
        """Set the result of a future that the program has not cancelled."""
        if not future.cancelled():
            future._set_executor(self._node.executor)
            future.set_result(result)

    def server_is_ready(self) -> bool:
        """Return whether an action server is available.

        A program that polls it in a loop lets time advance.
        """
        missing = f"the action server {self._action_name} is not there."
        time_lock.poll(lambda: "" if self._course_is_ready() else missing)
        return self._course_is_ready()

    def _course_is_ready(self) -> bool:
        if self.__is_destroyed:
            failed = "Failed to check if action server is available"
            raise RCLError(f"{failed}: rcl node pointer is invalid")
        return all(end._course_partner_count() for end in self.__ends)

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Wait at most `timeout_sec` [s] for a server, without limit if None.

        Return whether there is one.
        """
        awaited = f"the action {self._action_name}"
        why = "" if timeout_sec is not None else f"it waited for {awaited}, whose server is not there."
        with explain_interrupts(lambda: why):
            return wait_for_partner(self._node.handle, self._course_is_ready, timeout_sec, awaited)

    def destroy(self) -> None:
        """Destroy the clients and subscriptions that make up the action client."""
        if self.__is_destroyed:
            # The client is not among the waitables of its node any more.
            raise ValueError("list.remove(x): x not in list")
        for end in self.__ends:
            self._node._course_destroy(end)
        self.__is_destroyed = True

    def __request(
        self, goal: Any, feedback_callback: OnFeedback | None = None, goal_uuid: UUID | None = None
    ) -> Any:
        if not isinstance(goal, self._action_type.Goal):
            raise marked(TypeError(), Mistake.GOAL)
        if self.__is_destroyed:
            raise RCLError("Failed to send goal request: action client pointer is invalid")
        if goal_uuid is not None:
            bytes(goal_uuid.uuid)
        goal_id = goal_uuid or UUID(uuid=list(uuid.uuid4().bytes))
        if feedback_callback is not None:
            self._feedback_callbacks[bytes(goal_id.uuid)] = feedback_callback
        return self._action_type.Impl.SendGoalService.Request(goal_id=goal_id, goal=goal)

    def _course_result_request(self, handle: ClientGoalHandle) -> Any:
        return self._action_type.Impl.GetResultService.Request(goal_id=handle.goal_id)

    def __accept(self, request: Any, response: Any) -> ClientGoalHandle:
        handle = ClientGoalHandle(self, request.goal_id, response)
        if handle.accepted:
            key = bytes(request.goal_id.uuid)
            if key in self._goal_handles:
                raise RuntimeError(f"Two goals were accepted with the same ID ({handle})")
            self._goal_handles[key] = handle
            handle.status = self.__statuses.get(key, handle.status)
        return handle

    async def __on_feedback(self, message: Any) -> None:
        callback = self._feedback_callbacks.get(bytes(message.goal_id.uuid))
        if callback is not None:
            await await_or_execute(callback, message)

    def __on_status(self, message: GoalStatusArray) -> None:
        goals = message.status_list
        self.__statuses = {bytes(goal.goal_info.goal_id.uuid): goal.status for goal in goals}
        for key, status in self.__statuses.items():
            handle = self._goal_handles.get(key)
            if handle is not None:
                handle.status = status

    def __warn(self, word: str) -> None:
        self._logger.warning(
            f"Ignoring unexpected {word} response. There may be more than one action server for "
            f"the action '{self._action_name}'"
        )


def get_action_names_and_types(node: Node) -> NamesAndTypes:
    """List all actions of the graph with their types."""
    return actions(node.handle.graph.endpoints())
