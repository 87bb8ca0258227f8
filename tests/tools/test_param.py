from collections.abc import Iterator
from pathlib import Path

import pytest
import rclpy
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.node import Node

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.graph.graph import Graph, current_graph, use_graph
from course_lib.ros.time import virtual_time
from course_lib.ros.time.driving import running_nodes
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


def run_param(*words: str) -> str:
    lines: list[str] = []
    ros2(["param", *words], GraphSource(current_graph()), lines.append)
    return "".join(lines)


def test_parameters_of_a_node_are_listed(node: Node) -> None:
    names = "  names\n  speed\n  start_type_description_service\n  use_sim_time\n"
    assert run_param("list", "/talker") == names
    assert run_param("list") == f"/talker:\n{names}"


def test_value_is_printed_with_its_type(node: Node) -> None:
    assert run_param("get", "/talker", "speed") == "Integer value is: 1\n"
    assert run_param("get", "talker", "use_sim_time") == "Boolean value is: False\n"
    assert run_param("get", "/talker", "names") == "String values are: ['a', 'b']\n"


def test_value_is_set_or_rejected_with_the_reason(node: Node, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_param("set", "/talker", "speed", "5") == "Set parameter successful\n"
    assert node.get_parameter("speed").value == 5
    wrong = "Wrong parameter type, expected 'Type.INTEGER' got 'Type.STRING'"
    assert run_param("set", "/talker", "speed", "fast") == ""
    assert capsys.readouterr().err == f"Setting parameter failed: {wrong}\n"


def test_missing_nodes_and_parameters_are_reported(node: Node) -> None:
    with pytest.raises(CourseError, match=r"Node not found: /x\. There are: /talker\."):
        run_param("list", "/x")
    with pytest.raises(CourseError, match=r"^Parameter not set: spee\. Did you mean speed\?$"):
        run_param("get", "/talker", "spee")
    with pytest.raises(CourseError, match="Parameter not set"):
        run_param("get", "/talker", "x")
    running_nodes().clear()
    with pytest.raises(CourseError, match="/talker does not respond"):
        run_param("get", "/talker", "speed")
    with pytest.raises(CourseError, match="Parameters need a running node"):
        ros2(["param", "list"], RecordingSource(Recording(())), print)


def test_nodes_are_listed_by_name_without_namespace_and_hidden_ones_are_not(node: Node) -> None:
    for name, namespace in (("base", "/robot"), ("_hidden", "/"), ("arm", "/z")):
        running_nodes().append(Node(name, namespace=namespace))
    lines = run_param("list").splitlines()
    nodes = [line for line in lines if line.endswith(":")]
    assert nodes == ["/z/arm:", "/robot/base:", "/talker:"]
    assert "use_sim_time" in run_param("list", "/_hidden")


def test_list_can_be_filtered_and_show_types(node: Node) -> None:
    node.declare_parameter("arm.speed", 1.5)
    assert run_param("list", "/talker", "--param-prefixes", "arm") == "  arm.speed\n"
    output = run_param("list", "/talker", "--filter", "n|s.*d$", "--param-type")
    assert output == "  names (type: string array)\n  speed (type: integer)\n"
    assert run_param("get", "/talker", "names", "--hide-type") == "['a', 'b']\n"


def test_describe_shows_the_descriptor(node: Node) -> None:
    limits = IntegerRange(from_value=0, to_value=10, step=2)
    about = ParameterDescriptor(
        description="how many", read_only=True, integer_range=[limits], additional_constraints="even"
    )
    node.declare_parameter("count", 4, about)
    assert run_param("describe", "/talker", "count", "speed") == (
        "Parameter name: count\n  Type: integer\n  Description: how many\n  Constraints:\n"
        "    Read only: true\n    Min value: 0\n    Max value: 10\n    Step: 2\n"
        "    Additional constraints: even\n"
        "Parameter name: speed\n  Type: integer\n  Constraints:\n"
    )


def test_dumped_parameters_can_be_loaded(
    node: Node, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    node.declare_parameter("arm.speed", 1.5)
    dumped = run_param("dump", "/talker")
    assert dumped == (
        "/talker:\n  ros__parameters:\n    arm:\n      speed: 1.5\n    names:\n    - a\n    - b\n"
        "    speed: 1\n    start_type_description_service: true\n    use_sim_time: false\n\n"
    )
    file = tmp_path / "talker.yaml"
    file.write_text("/**:\n  ros__parameters:\n    speed: 3\n/talker:\n  ros__parameters:\n    names: 2\n")
    wrong = "Wrong parameter type, expected 'Type.STRING_ARRAY' got 'Type.INTEGER'"
    assert run_param("load", "/talker", str(file)) == "Set parameter speed successful\n"
    assert capsys.readouterr().err == f"Set parameter names failed: {wrong}\n"
    assert node.get_parameter("speed").value == 3
    file.write_text(dumped)
    printed = run_param("load", "/talker", str(file))
    assert printed.count("successful") == 4
    failed = "start_type_description_service failed: Trying to set a read-only parameter"
    assert failed in capsys.readouterr().err
    assert node.get_parameter("speed").value == 1
    file.write_text("speed: 3")
    with pytest.raises(CourseError, match=r"talker\.yaml is not a parameter file: YAML file is not a valid"):
        run_param("load", "/talker", str(file))


def test_only_dynamic_parameters_can_be_deleted(node: Node, capsys: pytest.CaptureFixture[str]) -> None:
    node.declare_parameter("free", 1, ParameterDescriptor(dynamic_typing=True))
    assert run_param("delete", "/talker", "free") == "Deleted parameter successfully\n"
    assert not node.has_parameter("free")
    assert run_param("delete", "/talker", "speed") == ""
    assert capsys.readouterr().err.startswith("Deleting parameter failed: ")


def test_missing_parameter_file_is_rejected_by_its_name(node: Node) -> None:
    with pytest.raises(CourseError, match=r"nothing\.yaml cannot be read: No such file or directory"):
        run_param("load", node.get_name(), "nothing.yaml")
