import pytest
from typer.main import get_command

from course_lib.cli import app
from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.graph.graph import Graph, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import message_class, serialize
from course_lib.tools.ros2 import _NOT_OFFERED, COMMANDS, VERBS, ros2
from course_lib.tools.sources import GraphSource, RecordingSource, Source
from course_lib.tools.verb import COURSE_OPTIONS, LINK_OPTIONS

STRING = "std_msgs/msg/String"
START = 1_700_000_000_000_000_000  # [ns]


def output(line: str, source: Source) -> str:
    output: list[str] = []
    ros2(line.split(), source, output.append)
    return "".join(output)


def recorded(*topics: str, type_name: str = STRING, qos: Qos | None = None) -> RecordingSource:
    """A recording of one message per topic, a second apart."""
    cdr = serialize(message_class(type_name)())
    return RecordingSource(
        Recording(
            tuple(
                Sample(START + i * 10**9, topic, type_name, cdr, qos or Qos(), 1)
                for i, topic in enumerate(topics)
            )
        )
    )


@pytest.mark.parametrize("line", ["", "-h", "topic", "topic --help"])
def test_commands_and_verbs_are_listed_without_a_verb_as_in_ros2cli(line: str) -> None:
    path = line.replace("-h", "").replace("-elp", "").split()[:1] if "topic" in line else []
    prog = " ".join(["ros2", *path])
    text = output(line, recorded())
    assert text.startswith(f"usage: {prog} [-h]")
    assert text.endswith(f"\n\n  Call `{prog} <command> -h` for more detailed usage.\n")
    listed = text[text.index("Commands:\n") :].splitlines()[1:-2]
    assert {line.split()[0] for line in listed} == {
        verb.words[len(path)] for verb in VERBS if verb.words[: len(path)] == path
    }
    assert listed == sorted(listed)


@pytest.mark.parametrize("verb", VERBS, ids=lambda verb: f"{verb.command} {verb.name}")
def test_every_verb_has_help(verb: object) -> None:
    text = output(f"{verb.command} {verb.name} --help", recorded())  # type: ignore[attr-defined]
    assert text.startswith(f"usage: ros2 {verb.command} {verb.name}")  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("topic lst", r"^ros2 topic: error: argument Call `ros2 topic <command> -h` for more detailed usage."
         r": invalid choice: 'lst' \(choose from 'bw', .*\)\. Did you mean list\?$"),
        ("topc list", r"^ros2: error: .*invalid choice: 'topc' .*Did you mean topic\?$"),
        ("multicast send", r"^ros2: error: .*invalid choice: 'multicast' .*\. No network is used here\. "),
        ("component list", r"^ros2: error: .*`ros2 node list` lists them"),
        ("--version", r"^ros2: error: unrecognized arguments: --version$"),
        ("topic --version", r"^ros2 topic: error: unrecognized arguments: --version$"),
        ("xyz", r"invalid choice: 'xyz' \(choose from .*\)$"),
    ],
)  # fmt: skip
def test_unknown_verb_is_rejected_as_in_ros2cli_with_the_closest(line: str, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        output(line, recorded())


def test_existing_commands_have_no_reason_for_being_absent() -> None:
    both = sorted(_NOT_OFFERED.keys() & COMMANDS.keys())
    assert both == [], "remove these from _NOT_OFFERED in course_lib/tools/ros2.py"


def test_misplaced_options_of_course_ros2_are_recognized() -> None:
    command = get_command(app).commands["ros2"]  # type: ignore[attr-defined]  # a group
    options = {flag for parameter in command.params for flag in parameter.opts if flag.startswith("--")}
    assert options == COURSE_OPTIONS | LINK_OPTIONS, "course_lib/tools/verb.py lists the options"


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("topic echo", "the following arguments are required: topic_name"),
        ("topic echo /a --ounce", "unrecognized arguments: --ounce. Did you mean --once"),
        ("topic echo /a --seconds 2", "course come first: course ros2 --seconds … topic echo …"),
        ("topic echo /a --call /a", "course come first: course ros2 --call … topic echo …"),
        ("topic echo /a --truncate-length x", "value must be non-negative integer"),
        ("topic echo /a --truncate-length -5", "value must be non-negative integer"),
        ("topic echo /a --qos-depth x", "invalid int value: 'x'"),
        ("topic echo /a --timeout inf", "Value must be in 1e-09 … 1e.09"),
        ("topic echo /a --spin-time nan", "'nan' is not a time in seconds"),
    ],
)
def test_invalid_argument_is_reported_in_one_line_after_the_usage(
    line: str, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    output: list[str] = []
    with pytest.raises(CourseError, match=f"^ros2 topic echo: error: .*{text}") as raised:
        ros2(line.split(), recorded("/a"), output.append)
    assert "\n" not in str(raised.value)
    assert (output, raised.value.exit_code) == ([], 2)
    assert capsys.readouterr().err.startswith("usage: ros2 topic echo [-h]")


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("topic type /b", "Unknown topic '/b'"),
        ("topic info /b", "Unknown topic '/b'"),
        ("service type /b", "Unknown service '/b'"),
        ("action type /b", "Unknown action '/b'"),
        ("node info /b", "Unable to find node '/b'"),
        ("interface show std_msgs/msg/Strin", "Could not find the interface"),
    ],
)
def test_command_that_fails_has_the_exit_code_of_ros2cli(line: str, text: str) -> None:
    with pytest.raises(CourseError, match=text) as raised:
        ros2(line.split(), recorded("/a"), print)
    assert raised.value.exit_code == 1


def test_topic_list_includes_the_topics_of_every_node() -> None:
    graph = Graph()
    node = graph.add_node("talker", "/")
    graph.add_publisher(node, "/chatter", STRING, Qos())
    graph.add_publisher(node, "/_hidden/x", STRING, Qos())
    graph.add_subscription(node, 1, "/chatter", STRING, Qos(), lambda *_: None)
    source = GraphSource(graph)
    assert output("topic list", source) == "/chatter\n/parameter_events\n/rosout\n"
    assert output("topic list -c", source) == "3\n"
    assert "/_hidden/x\n" in output("topic list --include-hidden-topics", source)
    assert output("topic list -t", source) == (
        "/chatter [std_msgs/msg/String]\n"
        "/parameter_events [rcl_interfaces/msg/ParameterEvent]\n"
        "/rosout [rcl_interfaces/msg/Log]\n"
    )
    assert output("topic list -v", source) == (
        "Published topics:\n * /chatter [std_msgs/msg/String] 1 publisher\n\n"
        "Subscribed topics:\n * /chatter [std_msgs/msg/String] 1 subscriber\n\n"
    )


def test_topic_list_of_a_recording_lists_its_topics() -> None:
    assert output("topic list", recorded("/b", "/a")) == "/a\n/b\n"


def test_echo_prints_recorded_messages() -> None:
    assert output("topic echo /a", recorded("/a", "/b", "/a")) == "data: ''\n---\n" * 2
    assert output("topic echo a --once", recorded("/a", "/b", "/a")) == "data: ''\n---\n"
    assert output("topic echo a --timeout 1.5", recorded("/a", "/b", "/a")) == "data: ''\n---\n"


def test_echo_prints_one_field_as_in_python() -> None:
    poses = recorded("/pose", type_name="geometry_msgs/msg/PoseStamped")
    assert output("topic echo /pose --field pose.orientation.w", poses) == "1.0\n---\n"
    stamp = output("topic echo /pose --field header.stamp --flow-style", poses)
    assert stamp == "sec: 0\nnanosec: 0\n---\n"
    assert output("topic echo /pose --csv --field pose.position", poses) == "0.0,0.0,0.0\n"


def test_echo_of_an_unknown_field_lists_the_fields() -> None:
    with pytest.raises(
        CourseError,
        match=r"^Invalid field 'data.x': 'str' object has no attribute 'x'$",
    ):
        output("topic echo /a --field data.x", recorded("/a"))
    with pytest.raises(CourseError, match=r"no attribute 'dat'. It has data\.$"):
        output("topic echo /a --field dat", recorded("/a"))


def test_echo_of_an_unknown_topic_has_the_ros_error_and_lists_topics() -> None:
    output: list[str] = []
    text = (
        r"^Could not determine the type for the passed topic\. "
        r"Did you mean /chatter\? Topics here: /chatter, /tf\.$"
    )
    with pytest.raises(CourseError, match=text):
        ros2(["topic", "echo", "/chater"], recorded("/tf", "/chatter"), output.append)
    assert output == ["WARNING: topic [/chater] does not appear to be published yet\n"]


def test_echo_of_an_unknown_type_suggests_close_names() -> None:
    with pytest.raises(CourseError, match="Did you mean std_msgs/msg/String"):
        output("topic echo /a std_msgs/msg/Strin", recorded("/a"))
