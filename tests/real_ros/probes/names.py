# mypy: disable-error-code="import-not-found, untyped-decorator"
"""The attributes of the objects that programs subclass or make: names of rclpy's classes and instances."""

import rclpy
from probing import Fibonacci, main, probe
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from rclpy.qos import QoSProfile
from rclpy.task import Future
from rclpy.time_source import TimeSource
from std_msgs.msg import String
from std_srvs.srv import SetBool


def _names(thing: object) -> list[str]:
    """List the names of an object and of its classes, except the names of every object."""
    classes = [kind for kind in type(thing).__mro__ if kind.__module__.startswith("rclpy")]
    found = {name for kind in classes for name in vars(kind)} | set(getattr(thing, "__dict__", ()))
    return sorted(name for name in found if not (name.startswith("__") and name.endswith("__")))


@probe
def names() -> dict[str, list[str]]:
    node, managed = Node("plain", enable_logger_service=True), LifecycleNode("managed")
    executor = SingleThreadedExecutor()
    things: list[object] = [
        node,
        managed,
        executor,
        MultiThreadedExecutor(2),
        Future(),
        executor.create_task(print),
        node.create_publisher(String, "t", 1),
        managed.create_lifecycle_publisher(String, "u", 1),
        node.create_subscription(String, "t", print, 1),
        node.create_client(SetBool, "s"),
        node.create_service(SetBool, "s", print),
        node.create_timer(1.0, print),
        node.create_guard_condition(print),
        node.create_rate(1.0),
        MutuallyExclusiveCallbackGroup(),
        ReentrantCallbackGroup(),
        node.get_clock(),
        node.get_clock().now(),
        node.get_logger(),
        Duration(),
        Parameter("p"),
        QoSProfile(depth=1),
        ActionServer(node, Fibonacci, "f", print),
        ActionClient(node, Fibonacci, "f"),
        AsyncParameterClient(node, "plain"),
        ParameterEventHandler(node),
        TimeSource(node=node),
        rclpy.get_default_context(),
    ]
    return {type(thing).__name__: _names(thing) for thing in things}


if __name__ == "__main__":
    main()
