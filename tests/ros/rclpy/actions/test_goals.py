"""Actions: a server and its clients, by robot time."""

import threading
from pathlib import Path
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from unique_identifier_msgs.msg import UUID

from course_lib.recording import read_bag, record, write_bag
from course_lib.ros.graph.graph import Graph
from tests.ros.rclpy.actions.fibonacci import SECOND, Drive, count, later, send


def test_goal_is_accepted_executed_and_its_result_returned(
    started_graph: Graph, server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    assert client.wait_for_server(timeout_sec=1.0)
    calls: list[Any] = []
    handle = send(client, until_done, feedback_callback=calls.append)
    assert handle.accepted
    start_ns = started_graph.now_ns
    answer = until_done(handle.get_result_async())
    assert (answer.status, list(answer.result.sequence)) == (GoalStatus.STATUS_SUCCEEDED, [0, 1, 1, 2])
    assert [list(message.feedback.sequence) for message in calls] == [[0, 1, 1], [0, 1, 1, 2]]
    assert calls[0].goal_id == handle.goal_id
    assert round((started_graph.now_ns - start_ns) / SECOND, 1) == 2.0
    until_done(later(server_node))  # as in rclpy, a result is handled before a simultaneous state
    assert handle.status == GoalStatus.STATUS_SUCCEEDED


def test_execute_callbacks_can_be_coroutines(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    async def wait_a_turn(goal: ServerGoalHandle) -> Fibonacci.Result:
        await later(server_node)
        goal.succeed()
        return Fibonacci.Result(sequence=[goal.request.order])

    ActionServer(server_node, Fibonacci, "fibonacci", wait_a_turn)
    answer = until_done(send(client, until_done, 7).get_result_async())
    assert list(answer.result.sequence) == [7]


def test_goal_can_be_rejected_and_then_has_an_unknown_result(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count, goal_callback=lambda goal: GoalResponse.REJECT)
    handle = send(client, until_done)
    assert not handle.accepted
    assert until_done(handle.get_result_async()).status == GoalStatus.STATUS_UNKNOWN


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


def test_wait_for_server_without_a_server_returns_at_its_timeout(
    started_graph: Graph, client: ActionClient
) -> None:
    assert not client.server_is_ready()
    start_ns = started_graph.now_ns
    assert not client.wait_for_server(timeout_sec=0.5)
    assert started_graph.now_ns - start_ns == SECOND // 2


def test_result_expires_after_the_result_timeout(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count, result_timeout=1)
    handle = send(client, until_done, order=1)
    for _ in range(2):
        assert until_done(handle.get_result_async()).status == GoalStatus.STATUS_SUCCEEDED
    until_done(later(server_node))
    assert until_done(handle.get_result_async()).status == GoalStatus.STATUS_UNKNOWN


def test_goal_with_a_duplicate_id_is_rejected(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    one = UUID(uuid=range(16))
    first = send(client, until_done, goal_uuid=one)
    assert first.accepted
    assert not send(client, until_done, goal_uuid=one).accepted


def test_action_feedback_is_recorded_and_read_back_from_a_bag(
    started_graph: Graph, server_node: Node, client: ActionClient, until_done: Drive, tmp_path: Path
) -> None:
    recorder = record(started_graph)
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    until_done(send(client, until_done).get_result_async())
    write_bag(recorder.recording(), tmp_path / "bag")
    recording = read_bag(tmp_path / "bag")
    feedback: list[Any] = [message for _, message in recording.messages("/fibonacci/_action/feedback")]
    assert [list(message.feedback.sequence) for message in feedback] == [[0, 1, 1], [0, 1, 1, 2]]


def test_goal_status_is_published_from_acceptance_on(
    node: Node, server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    states: list[int] = []
    node.create_subscription(
        GoalStatusArray,
        "fibonacci/_action/status",
        lambda message: states.append(message.status_list[0].status),
        10,
    )
    until_done(send(client, until_done).get_result_async())
    until_done(later(server_node))
    expected = [GoalStatus.STATUS_ACCEPTED, GoalStatus.STATUS_EXECUTING, GoalStatus.STATUS_SUCCEEDED]
    assert states == expected
