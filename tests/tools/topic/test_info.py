from collections.abc import Callable

import pytest
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Bool, String

from course_lib.errors import CourseError

Run = Callable[[str], str]


def test_info_counts_publishers_and_subscriptions(run: Run, talker: Node, other: Node) -> None:
    talker.create_subscription(String, "chatter", print, 10)
    assert run("topic info /chatter") == (
        "Type: std_msgs/msg/String\nPublisher count: 1\nSubscription count: 1\n"
    )
    other.create_publisher(Bool, "chatter", 10)
    assert run("topic info /chatter").startswith("Type: ['std_msgs/msg/Bool', 'std_msgs/msg/String']\n")


def test_verbose_option_describes_each_endpoint(run: Run, talker: Node) -> None:
    qos = QoSProfile(
        depth=5,
        reliability=ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.VOLATILE,
        deadline=Duration(seconds=2),
    )
    talker.create_subscription(String, "chatter", print, qos)
    blocks = run("topic info -v /chatter").split("\n\n")
    assert [blocks[0], blocks[1], blocks[3], blocks[5]] == [
        "Type: std_msgs/msg/String", "Publisher count: 1", "Subscription count: 1", "",
    ]  # fmt: skip
    lines = blocks[2].splitlines()
    assert lines[5].startswith("GID: 00.")
    assert [*lines[:5], *lines[6:]] == [
        "Node name: talker",
        "Node namespace: /",
        "Topic type: std_msgs/msg/String",
        "Topic type hash: RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
        "Endpoint type: PUBLISHER",
        "QoS profile:",
        "  Reliability: RELIABLE",
        "  History (Depth): KEEP_LAST (10)",
        "  Durability: VOLATILE",
        "  Lifespan: Infinite",
        "  Deadline: Infinite",
        "  Liveliness: AUTOMATIC",
        "  Liveliness lease duration: Infinite",
    ]
    assert "Endpoint type: SUBSCRIPTION\n" in blocks[4]
    assert "  Reliability: BEST_EFFORT\n  History (Depth): KEEP_LAST (5)\n" in blocks[4]
    assert "  Deadline: 2000000000 nanoseconds\n" in blocks[4]


def test_unknown_topic_error_suggests_the_closest(run: Run, talker: Node) -> None:
    with pytest.raises(CourseError, match=r"^Unknown topic '/chater'\. Did you mean /chatter\?$"):
        run("topic info /chater")
