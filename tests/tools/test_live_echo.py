"""`ros2 topic echo` on nodes: it drives those that run live."""

from collections.abc import Iterator
from functools import partial

import pytest
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool, String

from course_lib.errors import CourseError
from course_lib.ros.driving import running_nodes
from course_lib.ros.graph import Graph, use_graph
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    graph = Graph(notebook=True)
    with use_graph(graph):
        yield graph


@pytest.fixture
def talker(graph: Graph) -> Node:
    """Says "hello 1", "hello 2", … on /chatter, once a second."""
    rclpy.init()
    node = Node("talker")
    publisher = node.create_publisher(String, "chatter", 10)
    numbers = iter(range(1, 1000))
    node.create_timer(1.0, lambda: publisher.publish(String(data=f"hello {next(numbers)}")))
    running_nodes().append(node)
    return node


def echo(graph: Graph, line: str) -> str:
    written: list[str] = []
    ros2(["topic", "echo", *line.split()], GraphSource(graph), written.append)
    return "".join(written)


def test_once_prints_the_next_message(graph: Graph, talker: Node) -> None:
    assert echo(graph, "/chatter --once") == "data: hello 1\n---\n"
    assert echo(graph, "chatter --once --field data") == "hello 2\n---\n"


def test_without_a_page_echo_ends_and_says_so(graph: Graph, talker: Node) -> None:
    lines = echo(graph, "/chatter").splitlines()
    assert lines[:3] == ["data: hello 1", "---", "data: hello 2"]
    assert lines[-1] == "No page is watching: ros2 topic echo stopped after 5 s of robot time."


def test_a_timeout_ends_quietly(graph: Graph, talker: Node) -> None:
    assert echo(graph, "/chatter --timeout 2.5") == "data: hello 1\n---\ndata: hello 2\n---\n"


def test_echo_leaves_no_node_behind(graph: Graph, talker: Node) -> None:
    echo(graph, "/chatter --once")
    assert [node.name for node in graph.nodes()] == ["talker"]


def test_a_latched_message_reaches_echo(graph: Graph, talker: Node) -> None:
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    talker.create_publisher(String, "map", latched).publish(String(data="kept"))
    assert echo(graph, "/map --once") == "data: kept\n---\n"


def test_a_silent_topic_is_one_sentence_that_says_why(graph: Graph, talker: Node) -> None:
    talker.create_subscription(String, "silent", partial(print), 10)
    with pytest.raises(CourseError, match=r"No message came on /silent in 5 s .* Nobody publishes on it\."):
        echo(graph, "/silent")
    with pytest.raises(CourseError, match=r"incompatible QoS: DURABILITY\. Topics here: /chatter, "):
        echo(graph, "/chatter --qos-durability transient_local")
    running_nodes().clear()
    with pytest.raises(CourseError, match=r"No node is running: start one"):
        echo(graph, "/chatter --once")


def test_mixed_publishers_are_all_heard(graph: Graph, talker: Node) -> None:
    talker.create_publisher(String, "chatter", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    assert echo(graph, "/chatter --once") == (
        "Some, but not all, publishers are offering QoSReliabilityPolicy.RELIABLE. Falling back to "
        "QoSReliabilityPolicy.BEST_EFFORT as it will connect to all publishers\ndata: hello 1\n---\n"
    )


def test_a_publisher_of_another_type_is_named(graph: Graph, talker: Node) -> None:
    talker.create_publisher(String, "/other", 1)
    talker.create_publisher(Bool, "/other", 1)
    with pytest.raises(CourseError, match=r"more than one type: \[std_msgs/msg/Bool, std_msgs/msg/String\]"):
        echo(graph, "/other")


def test_without_rclpy_echo_says_how_to_start(graph: Graph) -> None:
    with pytest.raises(CourseError, match=r"rclpy is not started: call rclpy.init\(\)"):
        echo(graph, "/rosout --once")
