"""Matched, deadline and type events."""

from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.event_handler import (
    PublisherEventCallbacks,
    QoSOfferedDeadlineMissedInfo,
    QoSPublisherMatchedInfo,
    QoSRequestedDeadlineMissedInfo,
    SubscriptionEventCallbacks,
)
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from std_msgs.msg import Int64, String

from course_lib.ros.graph.graph import Graph

LIMITED = QoSProfile(depth=1, deadline=Duration(seconds=1))


def spin(node: Node, seconds: float) -> None:
    """Spin the node for some robot time."""
    end_ns = node.get_clock().now().nanoseconds + round(seconds * 1e9)
    while (left := end_ns - node.get_clock().now().nanoseconds) > 0:
        rclpy.spin_once(node, timeout_sec=left / 1e9)


def listen(node: Node, qos: Any = 1, **callbacks: Any) -> Any:
    events = SubscriptionEventCallbacks(**callbacks)
    return node.create_subscription(String, "t", lambda message: None, qos, event_callbacks=events)


def talk(node: Node, qos: Any = 1, **callbacks: Any) -> Publisher[String]:
    return node.create_publisher(String, "t", qos, event_callbacks=PublisherEventCallbacks(**callbacks))


def test_matched_callbacks_report_new_and_removed_endpoints_on_both_sides(node: Node) -> None:
    told: dict[str, list[QoSPublisherMatchedInfo]] = {"pub": [], "sub": []}
    talk(node, matched=told["pub"].append)
    subscription = listen(node, matched=told["sub"].append)
    spin(node, 0.1)
    assert told["pub"] == told["sub"] == [QoSPublisherMatchedInfo(1, 1, 1, 1)]
    node.destroy_subscription(subscription)
    listen(node, QoSProfile(depth=1, deadline=Duration(seconds=1)))  # does not fit
    spin(node, 0.1)
    assert told["pub"][1:] == [QoSPublisherMatchedInfo(1, 0, 0, -1)]
    assert len(told["sub"]) == 1


def test_missed_deadline_is_reported_on_both_sides_once_per_period(node: Node) -> None:
    told: dict[str, list[Any]] = {"pub": [], "sub": []}
    publisher = talk(node, LIMITED, deadline=told["pub"].append)
    listen(node, LIMITED, deadline=told["sub"].append)
    spin(node, 2.0)
    assert told == {"pub": [], "sub": []}  # the time begins with the first message
    for _ in range(4):
        publisher.publish(String())
        spin(node, 0.9)
    assert told == {"pub": [], "sub": []}
    spin(node, 1.5)
    classes = {"pub": QoSOfferedDeadlineMissedInfo, "sub": QoSRequestedDeadlineMissedInfo}
    assert told == {side: [kind(1, 1), kind(2, 1)] for side, kind in classes.items()}
    node.destroy_publisher(publisher)
    spin(node, 1.5)
    assert len(told["pub"]) == 2


def test_type_mismatch_on_a_topic_causes_a_warning_on_both_sides(
    started_graph: Graph, node: Node, capfd: pytest.CaptureFixture[str]
) -> None:
    received: list[Any] = []
    listen(node, incompatible_type=received.append)
    # Within a context Fast DDS refuses a second type.
    elsewhere = Context()
    elsewhere.init(args=[])
    Node("talker", context=elsewhere).create_publisher(Int64, "/t", 1)
    spin(node, 0.1)
    assert len(received) == 1
    warning = "[talker]: Incompatible type on topic '/t', no messages will be sent to it."
    assert capfd.readouterr().err.count(warning) == 1


def test_unsupported_event_is_a_type_error_as_in_python() -> None:
    with pytest.raises(TypeError, match=r"got an unexpected keyword argument 'message_lost'"):
        PublisherEventCallbacks(message_lost=print)  # type: ignore[call-arg]


def test_liveliness_callback_warns_that_it_runs_on_a_robot_only(
    node: Node, capfd: pytest.CaptureFixture[str]
) -> None:
    talk(node, liveliness=print)
    assert "its callback on 't' runs on a robot only" in capfd.readouterr().err
    talk(node, matched=print)
    assert not capfd.readouterr().err
