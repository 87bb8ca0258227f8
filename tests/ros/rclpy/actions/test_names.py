"""Actions in the graph."""

from example_interfaces.action import Fibonacci
from rclpy.action import (
    ActionClient,
    ActionServer,
    get_action_names_and_types,
)
from rclpy.node import Node

from tests.ros.rclpy.actions.fibonacci import count


def test_graph_lists_actions_by_their_hidden_topics_and_services(
    node: Node, server_node: Node, client: ActionClient
) -> None:
    server = ActionServer(server_node, Fibonacci, "fibonacci", count)
    known = [("/fibonacci", ["example_interfaces/action/Fibonacci"])]
    assert get_action_names_and_types(node) == known
    topics = dict(node.get_topic_names_and_types())
    assert topics["/fibonacci/_action/feedback"] == ["example_interfaces/action/Fibonacci_FeedbackMessage"]
    assert topics["/fibonacci/_action/status"] == ["action_msgs/msg/GoalStatusArray"]
    services = dict(node.get_service_names_and_types())
    assert services["/fibonacci/_action/send_goal"] == ["example_interfaces/action/Fibonacci_SendGoal"]
    assert services["/fibonacci/_action/cancel_goal"] == ["action_msgs/srv/CancelGoal"]
    server.destroy()
    client.destroy()
    assert get_action_names_and_types(node) == []
