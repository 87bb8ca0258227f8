from collections.abc import Callable
from typing import Any

import pytest
from geometry_msgs.msg import PoseStamped
from rclpy.node import Node
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph

Run = Callable[[str], str]


def received_by(node: Node, kind: type, topic: str) -> list[Any]:
    messages: list[Any] = []
    node.create_subscription(kind, topic, messages.append, 10)
    return messages


def test_once_publishes_one_message_with_the_output_of_ros2cli(run: Run, graph: Graph, talker: Node) -> None:
    received = received_by(talker, String, "ear")
    assert run("topic pub --once /ear std_msgs/msg/String {data: hi}") == (
        "publisher: beginning loop\npublishing #1: std_msgs.msg.String(data='hi')\n\n"
    )
    assert received == [String(data="hi")]
    assert [node.name for node in graph.nodes()] == ["talker"]


def test_times_rate_and_print_options_take_effect(run: Run, graph: Graph, talker: Node) -> None:
    received, start_ns = received_by(talker, String, "ear"), graph.now_ns
    text = run("topic pub -t 5 -r 4 -p 2 /ear std_msgs/String {data: hi}")
    assert len(received) == 5
    assert [line.split(":")[0] for line in text.splitlines() if line] == [
        "publisher", "publishing #2", "publishing #4",
    ]  # fmt: skip
    assert graph.now_ns - start_ns == 1_100_000_000  # four pauses, and --keep-alive's


def test_pub_without_a_page_stops_with_a_notice(run: Run, talker: Node) -> None:
    text = run("topic pub /nobody std_msgs/msg/String")
    assert text.count("publishing #") == 6
    assert text.endswith("No page is watching: ros2 topic pub stopped after 5 s of robot time.\n")


def test_now_and_auto_are_the_publishing_time_of_each_message(run: Run, talker: Node) -> None:
    received = received_by(talker, PoseStamped, "goal")
    run("topic pub -t 2 /goal geometry_msgs/msg/PoseStamped {header: auto, pose: {position: {x: 1}}}")
    run("topic pub --once /goal geometry_msgs/msg/PoseStamped {header: {stamp: now, frame_id: map}}")
    seconds = [one.header.stamp.sec + one.header.stamp.nanosec * 1e-9 - 1.7e9 for one in received]
    assert seconds == pytest.approx([0.0, 1.0, 1.1])
    assert [received[0].pose.position.x, received[0].pose.orientation.w, received[2].header.frame_id] == [
        1,
        1,
        "map",
    ]


def test_pub_waits_for_the_requested_number_of_subscriptions(run: Run, talker: Node) -> None:
    with pytest.raises(
        CourseError, match=r"^Timed out waiting for subscribers: Expected 1 subcribers but only got 0 subsc"
    ):
        run("topic pub --once --max-wait-time-secs 1.5 /ear std_msgs/msg/String")
    assert run.written == "Waiting for at least 1 matching subscription(s)...\n" * 2  # type: ignore[attr-defined]
    with pytest.raises(CourseError, match=r"^--max-wait-time-secs option is only effective with"):
        run("topic pub --max-wait-time-secs 1 /ear std_msgs/msg/String")


@pytest.mark.parametrize(
    ("line", "text"),
    [
        (
            "/a std_msgs/msg/Strin",
            "The passed message type is invalid: No message type 'std_msgs/msg/Strin' here. Did",
        ),
        ("a/ std_msgs/msg/String", "Invalid topic name: topic name must not end with a forward slash"),
        ("/a std_msgs/msg/String -r 0", "argument -r/--rate: Value must be positive"),
        (
            "/a std_msgs/msg/String {dat: 1}",
            "Failed to populate field: 'String' object has no attribute",
        ),
    ],
)
def test_errors_are_reported_before_publishing(run: Run, talker: Node, line: str, text: str) -> None:
    with pytest.raises(CourseError) as raised:
        run(f"topic pub {line}")
    assert text in str(raised.value)
