"""The tools for transforms, line by line as geometry2 prints them (its tf2_ros and tf2_tools)."""

from collections.abc import Iterator
from math import cos, pi, sin
from pathlib import Path

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.time import Time
from tf2_msgs.msg import TFMessage
from tf2_ros import TransformBroadcaster

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.graph.graph import Graph, Sample, use_graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize
from course_lib.ros.time.driving import running_nodes, spin_for
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource, RecordingSource, Source
from course_lib.tools.tf2 import dot, picture

START = 1_700_000_000 * 10**9  # [ns]
TF = "tf2_msgs/msg/TFMessage"


def sent(parent: str, child: str, stamp_ns: int, x: float = 0.0, yaw: float = 0.0) -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, Time(nanoseconds=stamp_ns).to_msg()
    message.transform.translation.x = x
    message.transform.rotation.z, message.transform.rotation.w = sin(yaw / 2), cos(yaw / 2)
    return message


def sample(stamp_ns: int, *transforms: TransformStamped, topic: str = "/tf") -> Sample:
    return Sample(stamp_ns, topic, TF, serialize(TFMessage(transforms=list(transforms))), Qos(), 1)


def moving(seconds: int = 11) -> RecordingSource:
    """A recording: world -> base at 10 Hz, received 2 ms after its stamp; base -> tool static, 1 s late."""
    samples = [sample(START + 10**9, sent("base", "tool", START, x=0.5, yaw=pi / 4), topic="/tf_static")]
    for tenth in range(seconds * 10 + 1):
        stamp_ns = START + tenth * 10**8
        samples.append(sample(stamp_ns + 2_000_000, sent("world", "base", stamp_ns, x=1.0)))
    return RecordingSource(Recording(tuple(sorted(samples, key=lambda one: one.stamp_ns))))


def output(line: str, source: Source) -> str:
    output: list[str] = []
    ros2(["run", *line.split()], source, output.append)
    return "".join(output)


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    with use_graph(Graph(notebook=True)) as graph:
        rclpy.init()
        yield graph


@pytest.fixture
def broadcaster(graph: Graph) -> Node:
    """Sends world -> base at 10 Hz."""
    node = Node("broadcaster")
    send = TransformBroadcaster(node).sendTransform
    node.create_timer(0.1, lambda: send(sent("world", "base", graph.now_ns)))
    running_nodes().append(node)
    return node


def test_echo_waits_and_then_prints_every_second_as_in_geometry2() -> None:
    text = output("tf2_ros tf2_echo world tool", moving(2))
    waiting, found = text.split("\n", 1)
    assert waiting == (
        "[INFO] [1700000000.002000000] [tf2_echo]: Waiting for transform world ->  tool: "
        'Invalid frame ID "tool" passed to canTransform argument source_frame - frame does not exist'
    )
    assert found.count("At time") == 2
    assert found.startswith(
        "At time 1700000001.0\n"
        "- Translation: [1.500, 0.000, 0.000]\n"
        "- Rotation: in Quaternion [0.000, 0.000, 0.383, 0.924]\n"
        "- Rotation: in RPY (radian) [0.000, -0.000, 0.785]\n"
        "- Rotation: in RPY (degree) [0.000, -0.000, 45.000]\n"
        "- Matrix:\n"
        "  0.707 -0.707  0.000  1.500\n"
        "  0.707  0.707  0.000  0.000\n"
        "  0.000  0.000  1.000  0.000\n"
        "  0.000  0.000  0.000  1.000\n"
    )


def test_echo_of_a_static_transform_has_time_0() -> None:
    assert "\nAt time 0.0\n" in output("tf2_ros tf2_echo base tool", moving())


def test_echo_accepts_a_rate() -> None:
    assert output("tf2_ros tf2_echo world base 5", moving(2)).count("At time") == 11  # both ends
    with pytest.raises(CourseError, match="argument echo_rate: Value must be positive"):
        output("tf2_ros tf2_echo world base 0", moving())


def test_tf2_echo_drives_live_nodes(graph: Graph, broadcaster: Node) -> None:
    lines = output("tf2_ros tf2_echo world base", GraphSource(graph)).splitlines()
    assert "Waiting for transform world ->  base" in lines[0]
    assert [line for line in lines if line.startswith("At time")] == [
        "At time 1700000000.900000000",
        *(f"At time 170000000{second}.900000000" for second in range(1, 5)),
    ]


def test_tf2_echo_reports_a_missing_frame_every_second(graph: Graph, broadcaster: Node) -> None:
    lines = output("tf2_ros tf2_echo world nowhere 10", GraphSource(graph)).splitlines()
    assert len(lines) == 6
    assert all('"nowhere" passed to canTransform argument source_frame' in line for line in lines[1:])


def test_monitor_prints_the_delays_of_all_frames() -> None:
    rate, delay = 107 / 10.5, (106 * 0.002 + 1.0) / 107  # 106 messages of base and one of tool in 10.5 s
    assert output("tf2_ros tf2_monitor", moving()) == (
        "Gathering data on all frames for 10 seconds...\n"
        "\n\n\nRESULTS: for all Frames\n"
        "\nFrames:\n"
        "Frame: base, published by <no authority available>, Average Delay: 0.002, Max Delay: 0.002\n"
        "Frame: tool, published by <no authority available>, Average Delay: 1, Max Delay: 1\n"
        "\nAll Broadcasters:\n"
        f"Node: <no authority available> {rate:g} Hz, Average Delay: {delay:g} Max Delay: 1\n"
    )


def test_monitor_of_two_frames_prints_their_chain() -> None:
    text = output("tf2_ros tf2_monitor world tool", moving(15))
    assert "Gathering data on world -> tool for 10 seconds...\n" in text
    assert "RESULTS: for world to tool\nChain is: world -> base -> tool\nNet delay     avg = " in text
    with pytest.raises(CourseError, match="needs two frames or none"):
        output("tf2_ros tf2_monitor world", moving())


def test_monitor_measures_the_delivery_delay_of_live_nodes(graph: Graph, broadcaster: Node) -> None:
    text = output("tf2_ros tf2_monitor", GraphSource(graph))
    assert (
        "Frame: base, published by <no authority available>, Average Delay: 0.001, Max Delay: 0.001" in text
    )


def test_static_transform_is_published_with_the_text_of_ros(graph: Graph) -> None:
    flags = "--x 1 --z -0.5 --yaw 1.5707963 --frame-id base --child-frame-id arm"
    text = output(f"tf2_ros static_transform_publisher {flags}", GraphSource(graph))
    assert text.startswith("[INFO] [1700000000.000000000] [static_transform_publisher_")
    assert text.endswith(
        "]: Spinning until stopped - publishing transform\n"
        "translation: ('1.000000', '0.000000', '-0.500000')\n"
        "rotation: ('0.000000', '0.000000', '0.707107', '0.707107')\nfrom 'base' to 'arm'\n"
    )
    spin_for(1.0)
    assert "- Translation: [1.000, 0.000, -0.500]" in output("tf2_ros tf2_echo base arm", GraphSource(graph))


@pytest.mark.parametrize(
    "words", ["1 0 -0.5 1.5707963 0 0 base arm", "1 0 -.5 0 0 0.707107 0.707107 base arm"]
)
def test_old_style_arguments_are_accepted_with_a_warning(graph: Graph, words: str) -> None:
    text = output(f"tf2_ros static_transform_publisher {words}", GraphSource(graph))
    warning = "Old-style arguments are deprecated; see --help for new-style arguments"
    assert text.startswith(f"[WARN] [1700000000.000000000] []: {warning}\n[INFO]")
    assert "rotation: ('0.000000', '0.000000', '0.707107', '0.707107')\nfrom 'base' to 'arm'" in text


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("--child-frame-id a", "^error parsing command line arguments: Frame id must not be empty$"),
        ("0 0 0 0 0 0 a", "Extra unparsed arguments on command-line"),
        ("0 0 0 0 0 0 a b --x 1", "Cannot specify both new-style"),
        ("0 0 far 0 0 0 a b", "Failed to parse z argument as float"),
        ("--frame-id a --child-frame-id a", "cannot publish static transform from 'a' to 'a', exiting"),
        ("--frame-id a --child-frame-id b --qx 1 --yaw 1", "Cannot specify both quaternion and Euler"),
        ("--frame-id a --child-frame-id b --x far", "argument --x: invalid float value: 'far'"),
    ],
)
def test_contradictory_options_are_rejected(graph: Graph, words: str, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        output(f"tf2_ros static_transform_publisher {words}", GraphSource(graph))


def test_transforms_cannot_be_published_into_a_recording() -> None:
    with pytest.raises(CourseError, match="A recording cannot receive messages"):
        output("tf2_ros static_transform_publisher --frame-id a --child-frame-id b", moving())


def test_view_frames_writes_a_dot_file_and_a_pdf(tmp_path: Path) -> None:
    text = output(f"tf2_tools view_frames -o {tmp_path}/frames", moving(2))
    assert "[view_frames]: Listening to tf data for 5.0 seconds...\n" in text
    assert f"[view_frames]: Exporting graph in {tmp_path}/frames.pdf file...\n" in text
    assert (tmp_path / "frames.gv").read_text() == (
        "digraph G {\n"
        '"world" -> "base"[label=" Broadcaster: default_authority\\nAverage rate: 10.5\\nBuffer length: 2.0'
        '\\nMost recent transform: 1700000002.0\\nOldest transform: 1700000000.0\\n"];\n'
        '"base" -> "tool"[label=" Broadcaster: default_authority\\nAverage rate: 10000.0\\nBuffer length: 0.0'
        '\\nMost recent transform: 0.0\\nOldest transform: 0.0\\n"];\n'
        "edge [style=invis];\n"
        ' subgraph cluster_legend { style=bold; color=black; label ="view_frames Result";\n'
        '"Recorded at time: 1700000005.002"[ shape=plaintext ] ;\n'
        '}->"world";\n}'
    )
    assert (tmp_path / "frames.pdf").read_bytes().startswith(b"%PDF")


def test_view_frames_without_data_reports_missing_transforms() -> None:
    assert dot({}, START) == 'digraph G { "No tf data received" }'
    assert b"No tf data received" in picture({}, START, "svg")


def about(parent: str) -> dict[str, object]:
    return dict.fromkeys(
        ["broadcaster", "rate", "buffer_length", "most_recent_transform", "oldest_transform"], 1.0
    ) | {"parent": parent}


def test_image_shows_every_frame_and_is_deterministic() -> None:
    frames = {"odom": about("map"), "base": about("odom"), "beacon": about("map"), "arm": about("other")}
    drawn = picture(frames, START, "svg")
    for name in ("map", "odom", "base", "beacon", "other", "arm", "Broadcaster: 1.0"):
        assert f">{name}<".encode() in drawn
    assert picture(frames, START, "svg") == drawn


def test_frame_loop_is_drawn_without_an_endless_traversal() -> None:
    frames = {"a": about("b"), "b": about("a")}
    assert b">a<" in picture(frames, START, "svg")
    assert '"b" -> "a"' in dot(frames, START)


def test_image_is_displayed_in_a_notebook(
    graph: Graph, broadcaster: Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[object] = []
    monkeypatch.setattr("IPython.display.display", shown.append)
    output("tf2_tools view_frames -t 1", GraphSource(graph))
    assert "base in world" in shown[0].data  # type: ignore[attr-defined]
