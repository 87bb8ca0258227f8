"""The end that the kit's robots have in common: their nodes spin until Ctrl+C."""

from collections.abc import Sequence

import rclpy
from rclpy.executors import Executor, ExternalShutdownException
from rclpy.node import Node


def spin_all(executor: Executor, nodes: Sequence[Node], text: str) -> None:
    """Log a text, and run nodes until Ctrl+C."""
    for node in nodes:
        executor.add_node(node)
    nodes[0].get_logger().info(text)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
