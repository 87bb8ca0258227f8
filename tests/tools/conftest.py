"""A notebook's graph with a node that talks, and the command line over it."""

from collections.abc import Callable, Iterator

import pytest
import rclpy
from geometry_msgs.msg import PointStamped
from rclpy.context import Context
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time.driving import running_nodes
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource

Run = Callable[[str], str]


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    graph = Graph(notebook=True)
    with use_graph(graph):
        yield graph


@pytest.fixture
def talker(graph: Graph) -> Node:
    """Publishes "hello 1", "hello 2", … on /chatter and a point on /place, ten times a second."""
    rclpy.init()
    node = Node("talker")
    chatter = node.create_publisher(String, "chatter", 10)
    place = node.create_publisher(PointStamped, "place", 10)
    numbers = iter(range(1, 10_000))

    def talk() -> None:
        chatter.publish(String(data=f"hello {next(numbers)}"))
        point = PointStamped()
        point.header.stamp = node.get_clock().now().to_msg()
        place.publish(point)

    node.create_timer(0.1, talk)
    running_nodes().append(node)
    return node


@pytest.fixture
def other(talker: Node) -> Node:
    """A node with its own context: within one context a topic has one type, as in Fast DDS."""
    context = Context()
    context.init(args=[])
    return Node("other", context=context)


@pytest.fixture
def run(graph: Graph) -> Run:
    """Return the output of a command, split at spaces except for a last argument in braces."""

    def run(line: str) -> str:
        words, brace, rest = line.partition("{")
        output: list[str] = []
        try:
            ros2([*words.split(), *([brace + rest] if brace else [])], GraphSource(graph), output.append)
        finally:
            run.written = "".join(output)  # type: ignore[attr-defined]  # what came before an error
        return "".join(output)

    return run
