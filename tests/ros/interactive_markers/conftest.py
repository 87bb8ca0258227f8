"""The run and the node that rclpy's tests have, too."""

from tests.ros.rclpy.conftest import graph, node, started_graph

__all__ = ["graph", "node", "started_graph"]
