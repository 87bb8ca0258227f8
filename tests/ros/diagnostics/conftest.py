"""The run and the node that rclpy's tests have, too."""

from tests.ros.rclpy.conftest import graph, node, notebook, started_graph

__all__ = ["graph", "node", "notebook", "started_graph"]
