# mypy: disable-error-code="import-not-found, untyped-decorator"
"""Nodes and entities after their destruction, and after the shutdown of their context."""

from collections.abc import Callable
from typing import Any

import rclpy
from probing import Fibonacci, lines, main, outcome, probe
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import Trigger

OF_NODE: dict[str, Callable[[Node], Any]] = {
    "get_name": lambda n: n.get_name(),
    "get_namespace": lambda n: n.get_namespace(),
    "get_fully_qualified_name": lambda n: n.get_fully_qualified_name(),
    "get_logger": lambda n: n.get_logger().name,
    "get_clock": lambda n: n.get_clock().now().nanoseconds > 0,
    "create_publisher": lambda n: bool(n.create_publisher(String, "u", 1)),
    "create_subscription": lambda n: bool(n.create_subscription(String, "u", print, 1)),
    "create_client": lambda n: bool(n.create_client(Trigger, "u")),
    "create_service": lambda n: bool(n.create_service(Trigger, "u", print)),
    "create_timer": lambda n: bool(n.create_timer(1.0, print)),
    "create_guard_condition": lambda n: bool(n.create_guard_condition(print)),
    "create_rate": lambda n: bool(n.create_rate(1.0)),
    "action_client": lambda n: bool(ActionClient(n, Fibonacci, "f")),
    "action_server": lambda n: bool(ActionServer(n, Fibonacci, "f", print)),
    "resolve_topic_name": lambda n: n.resolve_topic_name("x"),
    "resolve_service_name": lambda n: n.resolve_service_name("x"),
    "get_topic_names_and_types": lambda n: bool(n.get_topic_names_and_types()),
    "get_service_names_and_types": lambda n: bool(n.get_service_names_and_types()),
    "get_node_names": lambda n: bool(n.get_node_names()),
    "get_node_names_and_namespaces": lambda n: bool(n.get_node_names_and_namespaces()),
    "get_fully_qualified_node_names": lambda n: bool(n.get_fully_qualified_node_names()),
    "count_publishers": lambda n: n.count_publishers("t") >= 0,
    "count_subscribers": lambda n: n.count_subscribers("t") >= 0,
    "count_clients": lambda n: n.count_clients("t") >= 0,
    "count_services": lambda n: n.count_services("t") >= 0,
    "get_publishers_info_by_topic": lambda n: n.get_publishers_info_by_topic("/t") is not None,
    "get_subscriptions_info_by_topic": lambda n: n.get_subscriptions_info_by_topic("/t") is not None,
    "get_publisher_names_and_types_by_node": lambda n: bool(
        n.get_publisher_names_and_types_by_node("n", "/")
    ),
    "get_service_names_and_types_by_node": lambda n: bool(n.get_service_names_and_types_by_node("n", "/")),
    "declare_parameter": lambda n: n.declare_parameter("q", 2).value,
    "get_parameter": lambda n: n.get_parameter("p").value,
    "has_parameter": lambda n: n.has_parameter("p"),
    "set_parameters": lambda n: n.set_parameters([Parameter("p", value=2)])[0].successful,
    "list_parameters": lambda n: bool(n.list_parameters([], 0).names),
    "destroy_node": lambda n: n.destroy_node(),
    "spin_once": lambda n: rclpy.spin_once(n, timeout_sec=0.01),
    "add_to_executor": lambda n: SingleThreadedExecutor().add_node(n),
}


def _node() -> Node:
    node = Node("n")
    node.declare_parameter("p", 1)
    return node


def _destroyed(call: Callable[[Node], Any]) -> Callable[[], object]:
    def run() -> object:
        node = _node()
        node.destroy_node()
        return call(node)

    return run


def _shut_down(call: Callable[[Node], Any]) -> Callable[[], object]:
    def run() -> object:
        node = _node()
        rclpy.shutdown()
        return call(node)

    return run


lines("destroyed", **{name: _destroyed(call) for name, call in OF_NODE.items()})
lines("shut_down", **{name: _shut_down(call) for name, call in OF_NODE.items()})


@probe
def publisher_of_a_destroyed_node() -> list[str]:
    node = _node()
    publisher = node.create_publisher(String, "t", 1)
    node.destroy_node()
    return [outcome(publisher.publish, String()), outcome(publisher.get_subscription_count)]


@probe
def publisher_after_shutdown() -> list[str]:
    publisher = _node().create_publisher(String, "t", 1)
    rclpy.shutdown()
    return [
        outcome(publisher.publish, String()),
        outcome(publisher.publish, 3),
        outcome(lambda: publisher.topic_name),
        outcome(publisher.get_subscription_count),
    ]


@probe
def client_after_shutdown() -> list[str]:
    client = _node().create_client(Trigger, "t")
    rclpy.shutdown()
    return [
        outcome(lambda: type(client.call_async(Trigger.Request())).__name__),
        outcome(client.service_is_ready),
        outcome(client.wait_for_service, 0.1),
    ]


@probe
def spinning_after_shutdown() -> list[str]:
    node = _node()
    executors = [SingleThreadedExecutor(), MultiThreadedExecutor(2)]
    for executor in executors:
        executor.add_node(node)
    rclpy.shutdown()
    return [
        outcome(call)
        for executor in executors
        for call in (
            executor.spin,
            executor.spin_once,
            lambda executor=executor: executor.spin_once(timeout_sec=0.1),
            lambda executor=executor: executor.spin_once(timeout_sec=0),
            lambda executor=executor: executor.spin_until_future_complete(rclpy.Future(), 0.1),
        )
    ]


@probe
def executors_after_shutdown() -> list[str]:
    rclpy.shutdown()
    return [
        outcome(lambda: bool(SingleThreadedExecutor())),
        outcome(lambda: bool(MultiThreadedExecutor(2))),
        outcome(lambda: bool(Node("late"))),
        outcome(rclpy.shutdown),
        outcome(rclpy.ok),
    ]


@probe
def invalid_handle_is_a_runtime_error() -> object:
    node = _node()
    timer = node.create_timer(1.0, print)
    node.destroy_timer(timer)
    try:
        timer.reset()
    except RuntimeError as error:
        return type(error).__name__, str(error)
    return None


if __name__ == "__main__":
    main()
