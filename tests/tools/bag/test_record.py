from collections.abc import Callable
from pathlib import Path

import pytest
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.recording import read_bag
from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.time.driving import spin_for
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource, RecordingSource

Run = Callable[[str], str]


def counts(folder: str | Path) -> dict[str, int]:
    return {topic.name: topic.count for topic in read_bag(folder).topics()}


def test_selected_topics_are_recorded_with_the_output_of_rosbag2(talker: Node, run: Run) -> None:
    text = run("record /chatter nobody -o my_bag")
    assert counts("my_bag") == {"/chatter": 10}
    at = "[INFO] [1700000000.000000000] [rosbag2_recorder]: "
    end = "[INFO] [1700000005.000000000] [rosbag2_recorder]: "
    assert text == (
        f"{at}Listening for topics...\n{at}Subscribed to topic '/chatter'\n{at}Recording...\n"
        f"{end}Recording stopped\n"
    )


def test_discovery_stops_when_all_requested_topics_are_subscribed(talker: Node, run: Run) -> None:
    text = run("record /chatter /camera/image -o my_bag")
    lines = [line.partition("]: ")[2] for line in text.splitlines()]
    assert lines[3:] == [
        "Recording...",
        "All requested topics are subscribed. Stopping discovery...",
        "Recording stopped",
    ]


@pytest.mark.parametrize(
    ("options", "topics"),
    [
        ("-a", {"/chatter", "/camera/image"}),
        ("--all --include-hidden-topics", {"/chatter", "/camera/image", "/_x"}),
        ("-e cam", {"/camera/image"}),
        ("--regex ^/c --exclude-regex image$", {"/chatter"}),
        ("-a --exclude-topics chatter", {"/camera/image"}),
        ("--topic-types std_msgs/msg/String", {"/chatter", "/camera/image"}),
        ("-a --exclude-topic-types std_msgs/msg/String", set()),
        ("--topics /chatter --exclude-topics /chatter", set()),
    ],
)
def test_topics_are_selected_by_the_rules_of_rosbag2(
    talker: Node, run: Run, options: str, topics: set[str]
) -> None:
    run(f"record {options} -o chosen")
    assert set(counts("chosen")) - {"/parameter_events", "/rosout"} == topics


def test_topic_of_an_unknown_type_is_reported_once_and_left_out(graph: Graph, talker: Node, run: Run) -> None:
    for topic in ("/odd", "/odder"):
        graph.add_publisher(graph.add_node("robot", "/"), topic, "absent_msgs/msg/Odd", Qos())
    text = run("record /chatter /odd /odder -o chosen")
    assert text.count("' has unknown type 'absent_msgs/msg/Odd' associated. Only topics with known") == 1
    assert "[WARN]" in text
    assert "Subscribed to topic '/odd" not in text
    assert counts("chosen") == {"/chatter": 10}


def test_default_bag_name_is_the_current_time(talker: Node, run: Run) -> None:
    run("record -a")
    assert counts("rosbag2_2023_11_14-22_13_20")["/chatter"] == 10


def test_bag_is_filtered_into_another_bag(bag: Path) -> None:
    ros2(
        ["bag", "record", "-e", "b", "-o", str(bag.parent / "b")],
        RecordingSource(read_bag(bag)),
        lambda _: None,
    )
    assert counts(bag.parent / "b") == {"/b": 3}


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("record", r"\[ERROR\] \[ros2bag\]: Need to specify at least one option out of --all, --all-topics"),
        ("record -a -o five", r"^\[ERROR\] \[ros2bag\]: Output folder 'five' already exists\.$"),
        ("record -e ([", r"argument -e/--regex: '\(\[' is not a regular expression"),
        ("record -a -s sqlite3", "invalid choice: 'sqlite3'"),
    ],
)
def test_invalid_arguments_are_rejected_with_the_text_of_ros2(
    bag: Path, run: Run, line: str, text: str
) -> None:
    with pytest.raises(CourseError, match=text):
        run(line)


def test_interrupt_ends_the_recording_and_keeps_it(
    talker: Node, graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    source, output, wait = GraphSource(graph), list[str](), GraphSource.wait

    def interrupted(self: GraphSource, ready: Callable[[], bool], seconds: float | None) -> bool:
        if graph.now_ns > START_NS + 2 * 10**9:
            raise KeyboardInterrupt
        return wait(self, ready, seconds)

    monkeypatch.setattr(GraphSource, "wait", interrupted)
    ros2(["bag", "record", "-a", "-o", "kept"], source, output.append)
    assert counts("kept")["/chatter"] == 4
    assert output[-1].endswith("[rosbag2_recorder]: Recording stopped\n")


def test_latched_messages_are_recorded_at_the_start_of_the_bag(graph: Graph, run: Run) -> None:
    node = Node("latching")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_publisher(String, "/latched", latched).publish(String(data="before"))
    spin_for(7.0, node)
    run("record -a -o late")
    (sample,) = [s for s in read_bag("late").samples if s.topic == "/latched"]
    assert sample.stamp_ns == START_NS + 7 * 10**9
