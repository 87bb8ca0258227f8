"""Faults in actions, with ROS's texts."""

from collections.abc import Callable
from typing import Any

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer
from rclpy.action.server import ServerGoalHandle
from rclpy.impl.implementation_singleton import RCLError
from rclpy.node import Node
from std_msgs.msg import String
from std_srvs.srv import Trigger

from course_lib.ros.hints import hint as find_hint
from course_lib.ros.time.time_lock import DeadlockError
from tests.ros.rclpy.actions.fibonacci import Drive, count, send


def test_invalid_return_value_of_a_goal_callback_rejects_the_goal_with_a_warning(
    server_node: Node, client: ActionClient, until_done: Drive, capfd: pytest.CaptureFixture[str]
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count, goal_callback=lambda goal: None)
    assert not send(client, until_done).accepted
    warning = "Goal request callback did not return a GoalResponse type. Rejecting goal."
    printed = capfd.readouterr()
    assert f"[server.action_server]: {warning}" in printed.err
    assert printed.out == "hint: end the goal callback with return GoalResponse.ACCEPT, or REJECT.\n"


def test_execute_callback_without_a_final_state_aborts_the_goal_with_the_warning_of_ros(
    server_node: Node, client: ActionClient, until_done: Drive, capfd: pytest.CaptureFixture[str]
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", lambda goal: Fibonacci.Result())
    assert until_done(send(client, until_done).get_result_async()).status == GoalStatus.STATUS_ABORTED
    printed = capfd.readouterr()
    assert "[server.action_server]: Goal state not set, assuming aborted. Goal ID: [" in printed.err
    assert printed.out == (
        "hint: call goal_handle.succeed(), with ( ), before the callback returns the result.\n"
    )


def test_exception_in_a_callback_aborts_the_goal_and_is_logged(
    server_node: Node, client: ActionClient, until_done: Drive, capfd: pytest.CaptureFixture[str]
) -> None:
    def fail(goal: ServerGoalHandle) -> Fibonacci.Result:
        raise ValueError("no way")

    ActionServer(server_node, Fibonacci, "fibonacci", fail)
    answer = until_done(send(client, until_done).get_result_async())
    assert (answer.status, list(answer.result.sequence)) == (GoalStatus.STATUS_ABORTED, [])
    printed = capfd.readouterr()
    errors = printed.err
    assert "hint:" not in printed.out
    assert "Error raised in execute callback: no way" in errors
    assert "ValueError: no way" in errors
    # The traceback shows the callback, without lines of the kit.
    assert 'in fail\n    raise ValueError("no way")' in errors
    assert "course_lib" not in errors


def test_invalid_goal_transition_raises_the_error_text_of_rcl(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    errors: list[str] = []

    def end_wrongly(goal: ServerGoalHandle) -> Fibonacci.Result:
        try:
            goal.canceled()
        except RCLError as error:
            errors.append(str(error))
        goal.abort()
        return Fibonacci.Result()

    ActionServer(server_node, Fibonacci, "fibonacci", end_wrongly)
    assert until_done(send(client, until_done).get_result_async()).status == GoalStatus.STATUS_ABORTED
    assert errors == [
        "Failed to update goal state: goal_handle attempted invalid transition from state "
        "EXECUTING with event CANCELED"
    ]


def test_wrong_types_are_rejected_as_in_ros(node: Node, client: ActionClient) -> None:
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


def test_send_goal_in_a_callback_raises_deadlock_error(
    node: Node, server_node: Node, client: ActionClient
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    node.create_timer(0.1, lambda: client.send_goal(Fibonacci.Goal()))
    with pytest.raises(DeadlockError, match=r"call\(\) on /fibonacci/_action/send_goal waits for a response"):
        rclpy.spin(node)


def test_second_server_with_the_same_name_causes_a_warning(
    node: Node, server_node: Node, client: ActionClient, until_done: Drive, capfd: pytest.CaptureFixture[str]
) -> None:
    for _ in range(2):
        ActionServer(server_node, Fibonacci, "fibonacci", count)
    until_done(send(client, until_done).get_result_async())
    assert (
        "[talker.action_client]: Ignoring unexpected goal response. There may be more than one "
        "action server for the action 'fibonacci'"
    ) in capfd.readouterr().err


@pytest.mark.parametrize(
    ("callback", "hint"),
    [
        (lambda goal: goal.order, "the goal that the client sent is goal_handle.request, with its fields."),
        (
            lambda goal: goal.goal.order,
            "the goal that the client sent is goal_handle.request, with its fields.",
        ),
        (
            lambda goal: goal.publish_feedback([1]),
            "pass a feedback of the action, with (): MyAction.Feedback().",
        ),
        (lambda goal: goal.succed(), "did you mean `succeed`?"),
    ],
)
def test_mistake_in_an_execute_callback_has_a_hint(
    server_node: Node,
    client: ActionClient,
    until_done: Drive,
    capfd: pytest.CaptureFixture[str],
    callback: Callable[[ServerGoalHandle], Any],
    hint: str,
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", callback)
    until_done(send(client, until_done).get_result_async())
    assert f"hint: {hint}" in capfd.readouterr().err


def test_result_that_is_read_from_the_goal_handle_has_a_hint(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", lambda goal: Fibonacci.Result())
    handle: Any = send(client, until_done)
    with pytest.raises(AttributeError) as error:
        _ = handle.result
    assert find_hint(error.value).startswith("the result arrives later: goal_handle.get_result_async()")
