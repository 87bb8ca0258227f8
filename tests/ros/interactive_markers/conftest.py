"""The run and the node that rclpy's tests have, too."""

from tests.ros.rclpy.conftest import begun, graph, node

__all__ = ["begun", "graph", "node"]
