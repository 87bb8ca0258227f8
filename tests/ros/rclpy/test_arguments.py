from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.impl.arguments import parse
from rclpy.impl.implementation_singleton import RCLError, RCLInvalidROSArgsError, UnknownROSArgsError
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String
from std_srvs.srv import Trigger

from course_lib.ros.graph.graph import START_NS, Graph, use_graph
from course_lib.ros.hints import hint
from course_lib.ros.programs.program import run_files


def begin(*args: str) -> None:
    rclpy.init(args=["program", "--ros-args", *args], signal_handler_options=SignalHandlerOptions.NO)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("5", 5),
        ("0x10", 16),
        ("010", 8),  # as in C
        ("-3", -3),
        ("5.0", 5.0),
        ("1e3", 1000.0),
        (".inf", float("inf")),
        ("true", True),
        ("Y", True),
        ("off", False),
        ("hello", "hello"),
        ("'5'", "5"),
        ("1_000", "1_000"),
        ("99999999999999999999", 1e20),
        ("[1, 2]", [1, 2]),
        ("[a, 'b']", ["a", "b"]),
    ],
)
def test_command_line_values_have_the_types_of_rcl(text: str, value: Any) -> None:
    found = parse(["--ros-args", "-p", f"x:={text}"]).parameters("/any/node")["x"]
    assert found.value == value
    assert type(found.value) is type(value)


def test_command_line_parameters_override_defaults(graph: Graph) -> None:
    begin("-p", "speed:=2", "--param", "talker:name:=left", "-p", "other:name:=right")
    node = Node("talker")
    assert node.declare_parameter("speed", 1).value == 2
    assert node.declare_parameter("name", "").value == "left"


PARAMETERS = """
/**:
  ros__parameters:
    everywhere: 1
    speed: 1.0
talker:
  ros__parameters:
    speed: 2.0
    arm:
      joints: [a, b]
robot:
  talker:
    ros__parameters: {speed: 3.0}
/*/listener:
  ros__parameters: {speed: 4.0}
"""


@pytest.mark.parametrize(
    ("node", "speed"),
    [("/talker", 2.0), ("/robot/talker", 3.0), ("/robot/listener", 4.0), ("/a/b/listener", 1.0)],
)
def test_parameter_file_selects_nodes_by_name_namespace_and_wildcard(
    tmp_path: Path, node: str, speed: float
) -> None:
    file = tmp_path / "params.yaml"
    file.write_text(PARAMETERS)
    found = parse(["--ros-args", "--params-file", str(file)]).parameters(node)
    assert found["speed"].value == speed
    assert found["everywhere"].value == 1
    assert (node == "/talker") == ("arm.joints" in found)


@pytest.mark.parametrize(
    ("content", "first_file", "last_file"),
    [
        ("talker: {ros__parameters: {speed: 2.0}}", 9.0, 2.0),
        ("/**: {ros__parameters: {speed: 2.0}}", 9.0, 2.0),
        # rcl has one list of nodes, and -p adds to the entry of the file.
        (PARAMETERS, 2.0, 2.0),
    ],
)
def test_value_of_the_later_entry_of_nodes_or_within_an_entry_wins(
    tmp_path: Path, content: str, first_file: float, last_file: float
) -> None:
    file = tmp_path / "params.yaml"
    file.write_text(content)
    from_file, given = ["--params-file", str(file)], ["-p", "speed:=9.0"]
    assert parse(["--ros-args", *from_file, *given]).parameters("/talker")["speed"].value == first_file
    assert parse(["--ros-args", *given, *from_file]).parameters("/talker")["speed"].value == last_file


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("[{a: [x]}]", {"deep.ci.a": ["x"]}),
        ("[{a: [x], b: [z]}]", {"deep.ci.a": ["x"], "deep.ci.b": ["z"]}),
        ("[{a: 1}]", {"deep.ci.a": [1]}),
        ("[{a: {b: [x]}}]", {"deep.ci.a.b": ["x"]}),
        ("[{a: {b: 1}}]", {"deep.ci.a.b": [1]}),
        ("[[{a: [x]}]]", {"deep.ci.a": ["x"]}),
    ],
)
def test_list_around_a_map_is_ignored_as_in_rcl(tmp_path: Path, text: str, found: dict[str, Any]) -> None:
    file = tmp_path / "params.yaml"
    file.write_text(f"/**:\n  ros__parameters:\n    deep:\n      ci: {text}\n      near: 7\n    last: 4\n")
    parameters = parse(["--ros-args", "--params-file", str(file)]).parameters("/talker")
    values = {name: parameter.value for name, parameter in parameters.items()}
    assert values == {**found, "deep.near": 7, "last": 4}


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("speed: 5\n", "Cannot have a value before ros__parameters at line 1"),
        ("ros__parameters:\n  x: 1\n", "There are no node names before ros__parameters at line 1"),
        (
            "/**:\n  ros__parameters:\n    x: [1, a]\n",
            "Sequence should be of same type. Value type 'string' do not belong at line_num 3",
        ),
        (
            "/**:\n  ros__parameters:\n    x: [{a: [1]}, {b: [2]}]\n",
            "Sequences cannot hold lists or maps, at line 3",
        ),
        (
            "/**:\n  ros__parameters:\n    x: [{a: 1, b: 2}]\n",
            "Sequences cannot hold lists or maps, at line 3",
        ),
        ("/**:\n  ros__parameters:\n    x:\n", "No value at line 3"),
        ("a: [\n", "Error parsing a event near line 2"),
        (
            "# \xe9".encode("latin-1"),
            "Error parsing a event: it is not text in UTF-8: save it in this encoding",
        ),
        ("a: &x {}\nb: *x\n", "Will not support aliasing at line 2"),
    ],
)
def test_invalid_parameter_file_is_rejected_with_its_line(
    tmp_path: Path, text: str | bytes, complaint: str
) -> None:
    file = tmp_path / "params.yaml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(RCLInvalidROSArgsError) as caught:
        parse(["--ros-args", "--params-file", str(file)])
    start = f"Failed to parse ROS arguments: Couldn't parse params file: '--params-file {file}'. Error: "
    assert str(caught.value).startswith(start + complaint)


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        (
            ["-p", "speed=1"],
            "Couldn't parse parameter override rule: '-p speed=1'. Error: Expected name:=value",
        ),
        (["-p"], "Couldn't parse trailing -p flag. No parameter override rule found."),
        (["-r", "a"], "Couldn't parse remap rule: '-r a'. Error: Expected from:=to"),
        (["-r", "a:=b c"], "Couldn't parse remap rule: '-r a:=b c'. Error: Invalid topic name"),
        (
            ["--params-file", "no.yaml"],
            "Couldn't parse params file: '--params-file no.yaml'. Error: Error opening",
        ),
        (
            ["--log-level", "loud"],
            "Couldn't parse log level: '--log-level loud'. Error: 'loud' is not a level",
        ),
    ],
)
def test_invalid_argument_is_rejected(words: list[str], complaint: str) -> None:
    with pytest.raises(RCLInvalidROSArgsError) as caught:
        parse(["--ros-args", *words])
    assert str(caught.value).startswith(f"Failed to parse ROS arguments: {complaint}")


def test_unknown_ros_argument_is_reported_and_user_arguments_are_ignored() -> None:
    with pytest.raises(UnknownROSArgsError, match=r"^\['--fast'\]$"):
        parse(["program", "--slow", "--ros-args", "--fast"])
    assert parse(["program", "--slow", "--ros-args", "-p", "x:=1", "--", "--fast"]).remaps == []


def test_topics_and_services_are_remapped(graph: Graph) -> None:
    begin("-r", "chatter:=/robot/talk", "-r", "~/go:=start", "-r", "listener:chatter:=hear")
    talker, listener = Node("talker"), Node("listener")
    assert talker.create_publisher(String, "chatter", 1).topic_name == "/robot/talk"
    assert talker.create_service(Trigger, "~/go", lambda q, a: a).service_name == "/start"
    assert listener.resolve_topic_name("chatter") == "/robot/talk"  # the first rule that fits counts
    assert listener.resolve_topic_name("chatter", only_expand=True) == "/chatter"


def test_remapping_rule_can_be_limited_to_a_node_name(graph: Graph) -> None:
    begin("-r", "listener:chatter:=hear")
    assert Node("listener").resolve_topic_name("chatter") == "/hear"
    assert Node("talker").resolve_topic_name("chatter") == "/chatter"


def test_node_and_namespace_remapping_rules_rename_a_node(graph: Graph) -> None:
    begin("-r", "__node:=speaker", "-r", "__ns:=/robot")
    node = Node("talker")
    assert node.get_fully_qualified_name() == "/robot/speaker"
    assert node.get_logger().name == "robot.speaker"
    assert node.resolve_topic_name("x") == "/robot/x"


def test_node_arguments_override_global_arguments_which_can_be_disabled(graph: Graph) -> None:
    begin("-p", "x:=1", "-r", "a:=b")
    own = ["--ros-args", "-p", "x:=2", "-r", "a:=c"]
    node = Node("own", cli_args=own)
    assert (node.declare_parameter("x", 0).value, node.resolve_topic_name("a")) == (2, "/c")
    alone = Node("alone", use_global_arguments=False)
    assert (alone.declare_parameter("x", 0).value, alone.resolve_topic_name("a")) == (0, "/a")


def test_log_level_is_set_for_all_loggers_or_for_one(graph: Graph) -> None:
    begin("--log-level", "warn", "--log-level", "talker:=debug")
    assert Node("talker").get_logger().get_effective_level() == LoggingSeverity.DEBUG
    assert Node("other").get_logger().get_effective_level() == LoggingSeverity.WARN


@pytest.mark.parametrize(
    ("text", "hint_start"),
    [
        ("camera:\n  rate: 5.0\n", "a parameter file has three levels"),
        ("camera:\n  ros_parameters:\n    rate: 5.0\n", "a parameter file has three levels"),
        ("ros__parameters:\n  rate: 5.0\n", "the first line is the name of the node"),
        ("camera:\n  ros__parameters:\n  rate: 5.0\n", "line 2 has no value, or wrong indentation"),
        ("camera:\n  ros__parameters:\n    rate:5.0\n", "line 3 has no value, or wrong indentation"),
        ("camera:\n\tros__parameters:\n", "indent the file with spaces: YAML has no tabs"),
        ("/front:\n  /camera:\n    ros__parameters:\n", "write only one slash between a namespace and the"),
        ("camera/:\n  ros__parameters:\n", "the name of a node in the file ends without a slash"),
        ("camera:\n  ros__parameters:\n    size: [1, 2.0]\n", "all values of a list are of one type"),
        (None, "is the name of the file right?"),
    ],
)
def test_wrong_parameter_file_has_a_hint(
    text: str | None, hint_start: str, tmp_path: Path, graph: Graph
) -> None:
    file = tmp_path / "parameters.yaml"
    if text is not None:
        file.write_text(text)
    with pytest.raises(RCLError) as error:
        begin("--params-file", str(file))
    assert hint(error.value).startswith(hint_start)


@pytest.mark.parametrize(
    ("words", "hint_start"),
    [
        (("-p", "rate=5.0"), "write -p name:=value"),
        (("-r", "a=b"), "write -r from:=to"),
    ],
)
def test_rule_without_its_colon_has_a_hint(words: tuple[str, ...], hint_start: str, graph: Graph) -> None:
    with pytest.raises(RCLError) as error:
        begin(*words)
    assert hint(error.value).startswith(hint_start)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("'5.0'", "write the number without quotes: 5.0."),
        ("5,0", "a decimal number has a point: 5.0."),
        ("5.0 Hz", "write the number without its unit: 5.0."),
        ("5", "write the number with a point"),
    ],
)
def test_value_of_another_type_has_a_hint(value: str, expected: str, graph: Graph) -> None:
    begin("-p", f"rate:={value}")
    with pytest.raises(InvalidParameterTypeException) as error:
        Node("camera").declare_parameter("rate", 10.0)
    assert hint(error.value).startswith(expected)


PROGRAM = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String
rclpy.init()
node = Node("camera")
node.declare_parameter("rate", 10.0)
node.create_publisher(String, "chatter", 10)
"""


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (
            "--ros-args -r /chater:=/a",
            "nothing is called /chater, so /chater:=/a has no effect. Did you mean /chatter?",
        ),
        ("--ros-args -p rat:=5.0", "no node declares the parameter rat. Did you mean rate?"),
        (
            "-p rate:=5.0",
            "-p rate:=5.0 is not read: write --ros-args before it, as in --ros-args -p rate:=5.0.",
        ),
        (
            "--ros-args --params-file other.yaml",
            "the parameters are for /other, and the program's node is /camera",
        ),
        ("--params-file other.yaml", "--params-file other.yaml is not read: write --ros-args before it"),
        (
            "--ros-args -p rate:=5.0 -p rate:=x",
            "the parameter rate is 5.0, not 'x': of values with different types",
        ),
        (
            "--ros-args -p rate:=3.0 --params-file both.yaml",
            "the parameter rate of /camera is 5.0, not 3.0: an entry of the parameter file replaces the "
            "value of -p. Write the name of the node, behind the file: -p camera:rate:=3.0.",
        ),
        ("--ros-args --params-file all.yaml -p rate:=3.0", "the parameter rate of /camera is 5.0, not 3.0"),
        ("--ros-args --params-file all.yaml -p rate:=3.0 -p camera:rate:=2.0", ""),
        ("--ros-args -p rate:=3.0 -p rate:=2.0", ""),
        ("--ros-args -r chatter:=b -p rate:=5.0", ""),
        ("--ros-args -r /scan:=/front/scan -p use_sim_time:=false -p gain:=1.0", ""),
        ("--ros-args --params-file both.yaml", ""),
        ("-p 5 --name:=x", ""),
    ],
)
def test_argument_without_effect_has_a_hint_at_the_end(
    words: str,
    expected: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("other.yaml").write_text("other:\n  ros__parameters:\n    rate: 5.0\n")
    Path("both.yaml").write_text(
        "other:\n  ros__parameters:\n    rate: 1.0\ncamera:\n  ros__parameters:\n    rate: 5.0\n"
    )
    everywhere = "/**:\n  ros__parameters:\n    gain: 1.0\n"
    Path("all.yaml").write_text(f"{everywhere}camera:\n  ros__parameters:\n    rate: 5.0\n")
    Path("program.py").write_text(PROGRAM)
    with use_graph(Graph(end_ns=START_NS + 10**9)):
        assert run_files([Path("program.py")], seed=1, args=words.split()) == 0
    printed = capfd.readouterr().err
    assert (f"hint: program.py: {expected}" in printed) if expected else "hint:" not in printed
