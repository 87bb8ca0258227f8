"""Goals that are cancelled, if the server lets them."""

import pytest
from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.node import Node

from tests.ros.rclpy.actions.fibonacci import Drive, count, send


@pytest.mark.parametrize("answer", CancelResponse)
def test_goal_is_canceled_if_the_server_accepts_the_cancellation(
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


def test_goal_is_not_canceled_if_the_server_rejects_the_cancellation(
    server_node: Node, client: ActionClient, until_done: Drive
) -> None:
    ActionServer(server_node, Fibonacci, "fibonacci", count)
    response = until_done(send(client, until_done).cancel_goal_async())
    assert response.goals_canceling == []


def test_cancel_request_without_a_goal_id_cancels_all_goals(
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
