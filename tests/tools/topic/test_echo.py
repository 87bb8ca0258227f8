"""`ros2 topic echo` drives live nodes."""

from collections.abc import Callable
from functools import partial

import pytest
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool, String

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.messages import serialize
from course_lib.ros.time.driving import running_nodes

Run = Callable[[str], str]


def test_once_prints_the_next_message(run: Run, talker: Node) -> None:
    assert run("topic echo /chatter --once") == "data: hello 1\n---\n"
    assert run("topic echo chatter std_msgs/String --once --field data") == "hello 2\n---\n"


def test_echo_without_a_page_ends_with_a_notice(run: Run, talker: Node) -> None:
    lines = run("topic echo /chatter").splitlines()
    assert lines[:3] == ["data: hello 1", "---", "data: hello 2"]
    assert lines.count("---") == 49  # the fiftieth message is on its way
    assert lines[-1] == "No page is watching: ros2 topic echo stopped after 5 s of robot time."


def test_type_mismatch_is_reported_immediately(run: Run, graph: Graph, talker: Node) -> None:
    start_ns = graph.now_ns
    with pytest.raises(
        CourseError, match=r"^/chatter has the type std_msgs/msg/String, not std_msgs/msg/Bool"
    ):
        run("topic echo /chatter std_msgs/msg/Bool --once")
    assert graph.now_ns == start_ns


def test_timeout_ends_echo_silently(run: Run, talker: Node) -> None:
    assert run("topic echo /chatter --timeout 0.25") == "data: hello 1\n---\ndata: hello 2\n---\n"


def test_echo_removes_its_node(run: Run, graph: Graph, talker: Node) -> None:
    run("topic echo /chatter --once")
    assert [node.name for node in graph.nodes()] == ["talker"]


def test_latched_message_reaches_echo(run: Run, talker: Node) -> None:
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    talker.create_publisher(String, "map", latched).publish(String(data="kept"))
    assert run("topic echo /map --once") == "data: kept\n---\n"


def test_silent_topic_is_explained_in_one_sentence(run: Run, talker: Node) -> None:
    talker.create_subscription(String, "silent", partial(print), 10)
    with pytest.raises(CourseError, match=r"No message came on /silent in 5 s .* It has no publisher\."):
        run("topic echo /silent")
    with pytest.raises(CourseError, match=r"incompatible QoS: DURABILITY\. Topics here: /chatter, "):
        run("topic echo /chatter --qos-durability transient_local")
    running_nodes().clear()
    with pytest.raises(CourseError, match=r"No node is running: start one"):
        run("topic echo /chatter --once")


def test_echo_receives_from_reliable_and_best_effort_publishers(run: Run, talker: Node) -> None:
    talker.create_publisher(String, "chatter", QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT))
    assert run("topic echo /chatter --once") == (
        "Some, but not all, publishers are offering QoSReliabilityPolicy.RELIABLE. Falling back to "
        "QoSReliabilityPolicy.BEST_EFFORT as it will connect to all publishers\ndata: hello 1\n---\n"
    )


def test_publisher_of_another_type_is_reported(run: Run, talker: Node, other: Node) -> None:
    talker.create_publisher(String, "/other", 1)
    other.create_publisher(Bool, "/other", 1)
    with pytest.raises(CourseError, match=r"more than one type: \[std_msgs/msg/Bool, std_msgs/msg/String\]"):
        run("topic echo /other")


def test_echo_before_rclpy_init_is_an_error(run: Run) -> None:
    with pytest.raises(CourseError, match=r"rclpy is not initialized: call rclpy.init\(\)"):
        run("topic echo /rosout --once")


def test_filter_receives_the_message_or_the_field(run: Run, talker: Node) -> None:
    assert run("topic echo /chatter --once --filter m.data.endswith('3')") == "data: hello 3\n---\n"
    assert run("topic echo /chatter --once --field data --filter '6'in(m)") == "hello 6\n---\n"
    with pytest.raises(CourseError, match=r"--filter 'm.dat' fails: AttributeError: 'String' object has no"):
        run("topic echo /chatter --filter m.dat")
    with pytest.raises(CourseError, match=r"--filter 'm\(' is not a Python expression"):
        run("topic echo /chatter --filter m(")


def test_raw_prints_the_serialized_bytes(run: Run, talker: Node) -> None:
    assert run("topic echo /chatter --once --raw") == f"{serialize(String(data='hello 1'))!r}\n---\n"


def test_qos_profile_can_be_selected_and_modified(run: Run, talker: Node) -> None:
    assert run("topic echo /chatter --once --qos-profile parameters --qos-depth 1") == "data: hello 1\n---\n"
    with pytest.raises(CourseError, match="argument --qos-profile: invalid choice: 'sensor'"):
        run("topic echo /chatter --qos-profile sensor")


def test_message_info_precedes_the_message(run: Run, talker: Node) -> None:
    lines = run("topic echo /chatter --once -i").splitlines()
    source, received = (int(lines[number].rsplit(" ", 1)[1]) for number in (3, 1))
    assert received - source == 1_000_000  # latency [ns]
    assert lines == [
        "publication_sequence_number: null",
        f"received_timestamp: {received}",
        "reception_sequence_number: null",
        f"source_timestamp: {source}",
        *("---", "data: hello 1", "---"),
    ]
    numbers = run("topic echo /chatter --once -i --csv").split(",")
    assert (int(numbers[1]) - int(numbers[0]), numbers[2:]) == (1_000_000, ["None", "None", "hello 2\n"])
    raw = run("topic echo /chatter --once --include-message-info --field data").splitlines()
    assert raw[0] == "---Got new message, message info:---"
    assert raw[2:] == ["---Message data:---", "hello 3", "---"]
