"""Actions: a server and its clients, by robot time."""

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from example_interfaces.action import Fibonacci
from rclpy.action import (
    ActionClient,
    ActionServer,
    CancelResponse,
    GoalResponse,
    get_action_client_names_and_types_by_node,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from rclpy.action.client import ClientGoalHandle
from rclpy.action.server import ServerGoalHandle
from rclpy.exceptions import RCLError
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String
from std_srvs.srv import Trigger
from unique_identifier_msgs.msg import UUID

from course_lib.recording import read_bag, record, write_bag
from course_lib.ros.baton import DeadlockError
from course_lib.ros.graph import Graph

SECOND = 10**9  # [ns]


def count(goal: ServerGoalHandle) -> Fibonacci.Result:
    """Do what the tutorial's server does: one number per second, until it is cancelled."""
    numbers = [0, 1]
    while len(numbers) <= goal.request.order:
        if goal.is_cancel_requested:
            goal.canceled()
            return Fibonacci.Result(sequence=numbers)
        numbers.append(numbers[-1] + numbers[-2])
        goal.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        time.sleep(1)
    goal.succeed()
    return Fibonacci.Result(sequence=numbers)


@pytest.fixture
def server_node(begun: Graph) -> Node:
    return Node("server")


@pytest.fixture
def client(node: Node) -> ActionClient:
    return ActionClient(node, Fibonacci, "fibonacci")


Drive = Callable[[Future[Any]], Any]


@pytest.fixture
def until_done(node: Node, server_node: Node) -> Drive:
    """Spin both nodes until a future is done; returns what it brought."""
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    executor.add_node(server_node)

    def drive(future: Future[Any]) -> Any:
        executor.spin_until_future_complete(future)
        return future.result()

    return drive


def send(client: ActionClient, until_done: Drive, order: int = 3, **more: Any) -> ClientGoalHandle:
    handle = until_done(client.send_goal_async(Fibonacci.Goal(order=order), **more))
    assert isinstance(handle, ClientGoalHandle)
    return handle


def test_a_goal_is_accepted_executed_and_answered(
    begun: Graph, server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    assert client.wait_for_server(timeout_sec=1.0)
    heard: list[Any] = []
    handle = send(client, until_done, feedback_callback=heard.append)
    assert handle.accepted
    start_ns = begun.now_ns
    answer = until_done(handle.get_result_async())
    assert (answer.status, list(answer.result.sequence)) == (GoalStatus.STATUS_SUCCEEDED, [0, 1, 1, 2])
    assert [list(message.feedback.sequence) for message in heard] == [[0, 1, 1], [0, 1, 1, 2]]
    assert heard[0].goal_id == handle.goal_id
    assert round((begun.now_ns - start_ns) / SECOND, 1) == 2.0
    until_done(later(server_node))  # as in rclpy a result is taken before a state that came with it
    assert handle.status == GoalStatus.STATUS_SUCCEEDED


def test_execute_callbacks_may_be_coroutines(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    async def wait_a_turn(goal: ServerGoalHandle) -> Fibonacci.Result:
        await later(server_node)
        goal.succeed()
        return Fibonacci.Result(sequence=[goal.request.order])

    ActionServer(server_node, Fibonacci, "fibonacci", wait_a_turn)
    answer = until_done(send(client, until_done, 7).get_result_async())
    assert list(answer.result.sequence) == [7]


def later(node: Node) -> Future[None]:
    """Give a future that is done in two seconds."""
    done: Future[None] = Future()
    node.create_timer(2.0, lambda: done.set_result(None))
    return done


def test_a_goal_can_be_rejected_and_its_result_is_unknown(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count, goal_callback=lambda goal: GoalResponse.REJECT)
    handle = send(client, until_done)
    assert not handle.accepted
    assert until_done(handle.get_result_async()).status == GoalStatus.STATUS_UNKNOWN


def test_a_goal_callback_that_returns_something_else_rejects_with_a_warning(
    server_node: Node, client: ActionClient, until_done: Drive, capfd: pytest.CaptureFixture[str]
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count, goal_callback=lambda goal: None)
    assert not send(client, until_done).accepted
    warning = "Goal request callback did not return a GoalResponse type. Rejecting goal."
    assert f"[server.action_server]: {warning}" in capfd.readouterr().err


@pytest.mark.parametrize("answer", CancelResponse)
def test_a_goal_is_cancelled_if_the_server_lets_it(
    server_node: Node, client: ActionClient, until_done: Drive, answer: CancelResponse
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count, cancel_callback=lambda goal: answer)
    handle = send(client, until_done)
    response = until_done(handle.cancel_goal_async())
    canceled = answer is CancelResponse.ACCEPT
    assert [one.goal_id for one in response.goals_canceling] == [handle.goal_id] * canceled
    ended = GoalStatus.STATUS_CANCELED if canceled else GoalStatus.STATUS_SUCCEEDED
    assert until_done(handle.get_result_async()).status == ended
    again = until_done(handle.cancel_goal_async())
    assert again.return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED


def test_nothing_is_cancelled_unless_the_server_says_so(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    response = until_done(send(client, until_done).cancel_goal_async())
    assert response.goals_canceling == []


def test_all_goals_are_cancelled_by_a_request_that_names_none(
    server_node: Node, node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(
        server_node, Fibonacci, "fibonacci", count, cancel_callback=lambda goal: CancelResponse.ACCEPT
    )
    handles = [send(client, until_done) for _ in range(2)]
    cancel = node.create_client(CancelGoal, "fibonacci/_action/cancel_goal")
    response = until_done(cancel.call_async(CancelGoal.Request()))
    assert len(response.goals_canceling) == 2
    unknown = CancelGoal.Request()
    unknown.goal_info.goal_id.uuid = [9] * 16
    response = until_done(cancel.call_async(unknown))
    assert response.return_code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID
    ended = [until_done(handle.get_result_async()).status for handle in handles]
    assert ended == [GoalStatus.STATUS_CANCELED] * 2


def test_a_callback_that_ends_no_goal_aborts_it_with_ros_s_warning(
    server_node: Node, client: ActionClient, until_done: Drive, capfd: pytest.CaptureFixture[str]
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", lambda goal: Fibonacci.Result())
    assert until_done(send(client, until_done).get_result_async()).status == GoalStatus.STATUS_ABORTED
    assert (
        "[server.action_server]: Goal state not set, assuming aborted. Goal ID: [" in capfd.readouterr().err
    )


def test_an_exception_aborts_the_goal_and_is_logged(
    server_node: Node, client: ActionClient, until_done: Drive, capfd: pytest.CaptureFixture[str]
) -> None:
    def fail(goal: ServerGoalHandle) -> Fibonacci.Result:
        raise ValueError("no way")

    ActionServer(server_node, Fibonacci, "fibonacci", fail)
    answer = until_done(send(client, until_done).get_result_async())
    assert (answer.status, list(answer.result.sequence)) == (GoalStatus.STATUS_ABORTED, [])
    said = capfd.readouterr().err
    assert "Error raised in execute callback: no way" in said
    assert "ValueError: no way" in said


def test_an_impossible_transition_has_rcl_s_text(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    said: list[str] = []

    def end_wrongly(goal: ServerGoalHandle) -> Fibonacci.Result:
        try:
            goal.canceled()
        except RCLError as error:
            said.append(str(error))
        goal.abort()
        return Fibonacci.Result()

    ActionServer(server_node, Fibonacci, "fibonacci", end_wrongly)
    assert until_done(send(client, until_done).get_result_async()).status == GoalStatus.STATUS_ABORTED
    assert said == [
        "Failed to update goal state: goal_handle attempted invalid transition from state EXECUTING "
        "with event CANCELED"
    ]


def test_wrong_types_are_refused_as_in_ros(node: Node, client: ActionClient) -> None:
    with pytest.raises(TypeError, match=r"^$"):
        client.send_goal_async(Fibonacci.Result())
    with pytest.raises(RuntimeError, match=r"^The action type provided is not valid .*message or service$"):
        ActionServer(node, String, "fibonacci", count)
    with pytest.raises(RuntimeError, match=r"^The service type provided is not valid .*message or action$"):
        node.create_service(Fibonacci, "fibonacci", lambda request, response: response)
    with pytest.raises(RuntimeError, match=r"^The action type provided is not valid"):
        ActionClient(node, Trigger, "fibonacci")
    with pytest.raises(TypeError, match=r"^Failed to register goal execution callback: not callable$"):
        ActionServer(node, Fibonacci, "fibonacci", None)  # type: ignore[arg-type]  # the mistake that is tested


def test_send_goal_waits_while_another_thread_spins(
    node: Node, server_node: Node, client: ActionClient
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    executor.add_node(server_node)
    threading.Thread(target=executor.spin, daemon=True).start()
    answer = client.send_goal(Fibonacci.Goal(order=2))
    assert list(answer.result.sequence) == [0, 1, 1]
    executor.shutdown()


def test_send_goal_in_a_callback_is_a_deadlock_that_is_named(
    node: Node, server_node: Node, client: ActionClient
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    node.create_timer(0.1, lambda: client.send_goal(Fibonacci.Goal()))
    with pytest.raises(DeadlockError, match=r"call\(\) on /fibonacci/_action/send_goal waits for a response"):
        rclpy.spin(node)


def test_without_a_server_waiting_ends_in_time(begun: Graph, client: ActionClient) -> None:
    assert not client.server_is_ready()
    start_ns = begun.now_ns
    assert not client.wait_for_server(timeout_sec=0.5)
    assert begun.now_ns - start_ns == SECOND // 2


def test_a_second_server_of_that_name_is_warned_of(
    node: Node, server_node: Node, client: ActionClient, until_done: Drive, capfd: pytest.CaptureFixture[str]
) -> None:
    for _ in range(2):
        ActionServer(server_node, Fibonacci, "fibonacci", count)
    until_done(send(client, until_done).get_result_async())
    assert (
        "[talker.action_client]: Ignoring unexpected goal response. There may be more than one action server "
        "for the action 'fibonacci'"
    ) in capfd.readouterr().err


def test_a_result_is_kept_for_a_while(server_node: Node, client: ActionClient, until_done: Drive) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count, result_timeout=1)
    handle = send(client, until_done, order=1)
    for _ in range(2):
        assert until_done(handle.get_result_async()).status == GoalStatus.STATUS_SUCCEEDED
    until_done(later(server_node))
    assert until_done(handle.get_result_async()).status == GoalStatus.STATUS_UNKNOWN


def test_the_graph_knows_actions_by_their_hidden_topics(
    node: Node, server_node: Node, client: ActionClient
) -> None:
    server = ActionServer(server_node, Fibonacci, "fibonacci", count)
    known = [("/fibonacci", ["example_interfaces/action/Fibonacci"])]
    assert get_action_names_and_types(node) == known
    assert get_action_server_names_and_types_by_node(node, "server", "/") == known
    assert get_action_server_names_and_types_by_node(node, "talker", "/") == []
    assert get_action_client_names_and_types_by_node(node, "talker", "/") == known
    topics = dict(node.get_topic_names_and_types())
    assert topics["/fibonacci/_action/feedback"] == ["example_interfaces/action/Fibonacci_FeedbackMessage"]
    assert topics["/fibonacci/_action/status"] == ["action_msgs/msg/GoalStatusArray"]
    services = dict(node.get_service_names_and_types())
    assert services["/fibonacci/_action/send_goal"] == ["example_interfaces/action/Fibonacci_SendGoal"]
    assert services["/fibonacci/_action/cancel_goal"] == ["action_msgs/srv/CancelGoal"]
    server.destroy()
    client.destroy()
    assert get_action_names_and_types(node) == []


def test_an_id_that_is_taken_is_rejected(server_node: Node, client: ActionClient, until_done: Drive) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    one = UUID(uuid=range(16))
    first = send(client, until_done, goal_uuid=one)
    assert first.accepted
    assert not send(client, until_done, goal_uuid=one).accepted


def test_what_an_action_publishes_is_recorded_and_read_again(
    begun: Graph, server_node: Node, client: ActionClient, until_done: Drive, tmp_path: Path
) -> None:
    recorder = record(begun)
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    until_done(send(client, until_done).get_result_async())
    write_bag(recorder.recording(), tmp_path / "bag")
    read = read_bag(tmp_path / "bag")
    feedback: list[Any] = [message for _, message in read.messages("/fibonacci/_action/feedback")]
    assert [list(message.feedback.sequence) for message in feedback] == [[0, 1, 1], [0, 1, 1, 2]]
