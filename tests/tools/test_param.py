from collections.abc import Iterator

import pytest
import rclpy
from rclpy.node import Node

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros import virtual_time
from course_lib.ros.driving import running_nodes
from course_lib.ros.graph import Graph, current_graph, use_graph
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource, RecordingSource


@pytest.fixture
def node() -> Iterator[Node]:
    virtual_time.install()
    with use_graph(Graph(notebook=True)):
        rclpy.init(args=[])
        node = Node("talker")
        node.declare_parameter("speed", 1)
        node.declare_parameter("names", ["a", "b"])
        running_nodes().append(node)
        yield node


def told(*words: str) -> str:
    lines: list[str] = []
    ros2(["param", *words], GraphSource(current_graph()), lines.append)
    return "".join(lines)


def test_a_nodes_parameters_are_listed(node: Node) -> None:
    names = "  names\n  speed\n  start_type_description_service\n  use_sim_time\n"
    assert told("list", "/talker") == names
    assert told("list") == f"/talker:\n{names}"


def test_a_value_is_shown_with_its_type(node: Node) -> None:
    assert told("get", "/talker", "speed") == "Integer value is: 1\n"
    assert told("get", "talker", "use_sim_time") == "Boolean value is: False\n"
    assert told("get", "/talker", "names") == "String values are: ['a', 'b']\n"


def test_a_value_is_set_or_refused_with_the_reason(node: Node) -> None:
    assert told("set", "/talker", "speed", "5") == "Set parameter successful\n"
    assert node.get_parameter("speed").value == 5
    wrong = "Wrong parameter type, expected 'Type.INTEGER' got 'Type.STRING'"
    assert told("set", "/talker", "speed", "fast") == f"Setting parameter failed: {wrong}\n"


def test_what_is_not_there_is_named(node: Node) -> None:
    with pytest.raises(CourseError, match=r"Node not found: /x\. There are: /talker\."):
        told("list", "/x")
    with pytest.raises(CourseError, match="Parameter not set"):
        told("get", "/talker", "x")
    running_nodes().clear()
    with pytest.raises(CourseError, match="/talker does not answer"):
        told("get", "/talker", "speed")
    with pytest.raises(CourseError, match="Parameters belong to nodes that run"):
        ros2(["param", "list"], RecordingSource(Recording(())), print)
