"""A server's node, a client and an executor that spins both."""

from __future__ import annotations

from typing import Any

import pytest
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future

from course_lib.ros.graph.graph import Graph
from tests.ros.rclpy.actions.fibonacci import Drive


@pytest.fixture
def server_node(started_graph: Graph) -> Node:
    return Node("server")


@pytest.fixture
def client(node: Node) -> ActionClient:
    return ActionClient(node, Fibonacci, "fibonacci")


@pytest.fixture
def until_done(node: Node, server_node: Node) -> Drive:
    """Spin both nodes until a future is done. Return its result."""
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    executor.add_node(server_node)

    def drive(future: Future[Any]) -> Any:
        executor.spin_until_future_complete(future)
        return future.result()

    return drive
