"""`ros2 action …`, line by line as ros2cli writes it."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from course_lib.errors import CourseError

Run = Callable[[str], str]
TYPE = "example_interfaces/action/Fibonacci"


async def count(goal: ServerGoalHandle) -> Fibonacci.Result:
    numbers = [0, 1]
    while len(numbers) <= goal.request.order:
        numbers.append(numbers[-1] + numbers[-2])
        goal.publish_feedback(Fibonacci.Feedback(sequence=numbers))
    goal.succeed()
    return Fibonacci.Result(sequence=numbers)


def test_action_list_type_and_info_agree_with_ros2cli(run: Run, talker: Node) -> None:
    ActionServer(talker, Fibonacci, "fibonacci", count)
    ActionClient(talker, Fibonacci, "fibonacci")
    assert run("action list") == "/fibonacci\n"
    assert run("action list -t") == f"/fibonacci [{TYPE}]\n"
    assert run("action list -c") == "1\n"
    assert run("action type /fibonacci") == f"{TYPE}\n"
    assert run("action info /fibonacci -t") == (
        f"Action: /fibonacci\nAction clients: 1\n    /talker [{TYPE}]\n"
        f"Action servers: 1\n    /talker [{TYPE}]\n"
    )
    assert run("action info /x -c") == "Action: /x\nAction clients: 0\nAction servers: 0\n"
    assert "/fibonacci/_action/feedback" not in run("topic list")
    assert "/fibonacci/_action/feedback" in run("topic list --include-hidden-topics")
    assert "/fibonacci/_action" not in run("service list")
    assert "/fibonacci/_action/get_result" in run("service list --include-hidden-services")
    assert f"  Action Servers:\n    /fibonacci: {TYPE}\n" in run("node info /talker")


def test_send_goal_shows_feedback_and_the_result(run: Run, talker: Node) -> None:
    ActionServer(talker, Fibonacci, "fibonacci", count)
    output = run(f"action send_goal -f /fibonacci {TYPE} {{order: 3}}")
    assert re.sub("[0-9a-f]{32}", "<hex>", output) == (
        "Waiting for an action server to become available...\n"
        "Sending goal:\n     order: 3\n\n"
        "Goal accepted with ID: <hex>\n\n"
        "Feedback:\n    sequence:\n- 0\n- 1\n- 1\n\n"
        "Feedback:\n    sequence:\n- 0\n- 1\n- 1\n- 2\n\n"
        "Result:\n    sequence:\n- 0\n- 1\n- 1\n- 2\n\n"
        "Goal finished with status: SUCCEEDED\n"
    )
    assert "Feedback" not in run(f"action send_goal /fibonacci {TYPE} {{order: 3}}")


def test_rejected_goal_ends_the_command_with_a_notice(run: Run, talker: Node) -> None:
    ActionServer(talker, Fibonacci, "fibonacci", count, goal_callback=lambda goal: GoalResponse.REJECT)
    assert run(f"action send_goal /fibonacci {TYPE}").endswith("order: 0\n\nGoal was rejected.\n")


def test_interrupted_goal_is_canceled(run: Run, talker: Node) -> None:
    async def wait(goal: ServerGoalHandle) -> Fibonacci.Result:
        await Future()
        return Fibonacci.Result()

    ActionServer(talker, Fibonacci, "fibonacci", wait, cancel_callback=lambda goal: CancelResponse.ACCEPT)
    with pytest.raises(CourseError, match="The action does not respond"):
        run(f"action send_goal /fibonacci {TYPE}")
    assert run.written.endswith("Canceling goal...\nGoal canceled.\n")  # type: ignore[attr-defined]


def test_info_prints_the_namespace_of_a_server(run: Run, talker: Node) -> None:
    node = Node("arm", namespace="/demo")
    ActionServer(node, Fibonacci, "grasp", count)
    assert run("action info /demo/grasp").endswith("Action servers: 1\n    /demo/arm\n")


def test_invalid_goal_arguments_are_reported(run: Run, talker: Node) -> None:
    ActionServer(talker, Fibonacci, "fibonacci", count)
    with pytest.raises(
        CourseError, match=r"^No node serves the action '/fibonaci'\. Did you mean /fibonacci\?$"
    ):
        run(f"action send_goal /fibonaci {TYPE}")
    with pytest.raises(CourseError, match="Failed to populate message fields: 'Fibonacci_Goal' object"):
        run(f"action send_goal /fibonacci {TYPE} {{ordr: 3}}")
    with pytest.raises(
        CourseError, match=r"^The passed action type is invalid: .*/Fib\. Did you mean .*/Fibonacci\?"
    ):
        run("action send_goal /fibonacci example_interfaces/Fib")
    # A type of the same name in another package is closer than a similar name.
    with pytest.raises(CourseError, match=r"invalid: test_msgs/action/Fibonacci\. Did you mean example_i"):
        run("action send_goal /fibonacci test_msgs/action/Fibonacci")
