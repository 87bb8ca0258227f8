"""Publishers and subscriptions, from end to end."""

from typing import Any

import pytest
import rclpy
from rclpy.context import Context
from rclpy.event_handler import (
    PublisherEventCallbacks,
    QoSRequestedIncompatibleQoSInfo,
    RmwPolicyKind,
    SubscriptionEventCallbacks,
)
from rclpy.exceptions import InvalidHandle
from rclpy.impl.endpoint import MessageInfo
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import Int32, Int32MultiArray, String

from course_lib.ros.graph.graph import START_NS

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_message_arrives_one_millisecond_after_publishing(node: Node) -> None:
    arrived: list[tuple[str, int]] = []
    node.create_subscription(
        String, "x", lambda m: arrived.append((m.data, node.get_clock().now().nanoseconds)), 10
    )
    node.create_publisher(String, "x", 10).publish(String(data="hello"))
    rclpy.spin_once(node)
    assert arrived == [("hello", START_NS + 1_000_000)]


def test_later_changes_of_a_published_message_have_no_effect_and_receivers_get_copies(
    node: Node,
) -> None:
    messages: list[Int32MultiArray] = []
    for _ in range(2):
        node.create_subscription(Int32MultiArray, "x", messages.append, 10)
    message = Int32MultiArray(data=[1, 2])
    node.create_publisher(Int32MultiArray, "x", 10).publish(message)
    message.data[0] = 99
    rclpy.spin_once(node)
    messages[0].data.append(3)
    rclpy.spin_once(node)
    assert [list(m.data) for m in messages] == [[1, 2, 3], [1, 2]]


def test_message_of_another_type_is_rejected_as_in_ros(node: Node) -> None:
    publisher = node.create_publisher(String, "x", 10)
    text = "^Expected <class 'std_msgs.msg._string.String'>, got <class 'std_msgs.msg._int32.Int32'>$"
    with pytest.raises(TypeError, match=text):
        publisher.publish(Int32())  # type: ignore[arg-type]  # the mistake under test


def test_serialized_bytes_are_published_unchanged_and_raw_subscriptions_receive_bytes(node: Node) -> None:
    messages: list[Any] = []
    node.create_subscription(String, "x", messages.append, 10)
    node.create_subscription(String, "x", messages.append, 10, raw=True)
    raw = serialize_message(String(data="raw"))
    node.create_publisher(String, "x", 10).publish(raw)
    rclpy.spin_once(node)
    rclpy.spin_once(node)
    assert messages == [String(data="raw"), raw]
    assert deserialize_message(raw, String) == messages[0]


def test_callback_with_two_arguments_receives_the_message_info(node: Node) -> None:
    infos: list[MessageInfo] = []
    node.create_subscription(String, "x", lambda _, info: infos.append(info), 10)
    node.create_publisher(String, "x", 10).publish(String())
    rclpy.spin_once(node)
    assert infos[0]["source_timestamp"] == START_NS
    assert infos[0]["received_timestamp"] == START_NS + 1_000_000


def test_callback_without_a_message_argument_is_rejected_as_in_ros(node: Node) -> None:
    with pytest.raises(RuntimeError, match="callback should be either be callable with one argument"):
        node.create_subscription(String, "x", lambda: None, 10)  # type: ignore[arg-type]  # the mistake under test
    assert node.count_subscribers("x") == 0


def test_full_queue_drops_its_oldest_message(node: Node) -> None:
    values: list[int] = []
    node.create_subscription(Int32, "x", lambda m: values.append(m.data), 2)
    publisher = node.create_publisher(Int32, "x", 10)
    for number in range(5):
        publisher.publish(Int32(data=number))
    node.get_clock().sleep_for(rclpy.duration.Duration(seconds=1))
    for _ in range(3):
        rclpy.spin_once(node, timeout_sec=0)
    assert values == [3, 4]


def test_publishers_and_subscriptions_count_their_matches(node: Node) -> None:
    publisher = node.create_publisher(String, "x", BEST_EFFORT)
    subscription = node.create_subscription(String, "x", print, BEST_EFFORT)
    elsewhere = Context()
    elsewhere.init(args=[])
    Node("other", context=elsewhere).create_subscription(Int32, "/x", print, BEST_EFFORT)
    assert (publisher.get_subscription_count(), subscription.get_publisher_count()) == (1, 1)


def test_destroyed_publisher_raises_invalid_handle(node: Node) -> None:
    publisher = node.create_publisher(String, "x", 10)
    node.destroy_publisher(publisher)
    with pytest.raises(InvalidHandle, match=r"^cannot use Destroyable because destruction was requested$"):
        publisher.publish(String())


def test_destroyed_subscription_receives_no_messages(node: Node) -> None:
    messages: list[String] = []
    subscription = node.create_subscription(String, "x", messages.append, 10)
    publisher = node.create_publisher(String, "x", 10)
    publisher.publish(String())
    node.get_clock().sleep_for(rclpy.duration.Duration(seconds=1))
    node.destroy_subscription(subscription)
    rclpy.spin_once(node, timeout_sec=1.0)
    assert messages == []


def test_late_joining_subscription_receives_the_messages_of_a_transient_local_publisher(node: Node) -> None:
    latched, volatile = node.create_publisher(Int32, "x", LATCHED), node.create_publisher(Int32, "y", 10)
    for number in range(3):
        latched.publish(Int32(data=number))
        volatile.publish(Int32(data=number))
    values: list[int] = []
    node.create_subscription(Int32, "x", lambda m: values.append(m.data), LATCHED)
    node.create_subscription(Int32, "y", lambda m: values.append(m.data), 10)
    rclpy.spin(node)
    assert values == [1, 2]


def test_incompatible_endpoints_cause_a_warning_on_both_sides(
    node: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    listener = Node("listener")
    node.create_publisher(String, "/t", BEST_EFFORT)
    listener.create_subscription(String, "/t", print, 10)
    assert capsys.readouterr().err.splitlines() == [
        "[WARN] [1700000000.000000000] [talker]: New subscription discovered on topic '/t', "
        "requesting incompatible QoS. No messages will be sent to it. Last incompatible policy: "
        "RELIABILITY",
        "[WARN] [1700000000.000000000] [listener]: New publisher discovered on topic '/t', "
        "offering incompatible QoS. No messages will be received from it. Last incompatible "
        "policy: RELIABILITY",
    ]


def test_incompatible_qos_callback_replaces_the_default_warning(
    node: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    messages: list[QoSRequestedIncompatibleQoSInfo] = []
    node.create_subscription(
        String,
        "x",
        print,
        LATCHED,
        event_callbacks=SubscriptionEventCallbacks(incompatible_qos=messages.append),
    )
    silent = PublisherEventCallbacks(use_default_callbacks=False)
    node.create_publisher(String, "x", 10, event_callbacks=silent)
    rclpy.spin_once(node, timeout_sec=0)
    assert messages == [QoSRequestedIncompatibleQoSInfo(1, 1, RmwPolicyKind.RMW_QOS_POLICY_DURABILITY)]
    assert capsys.readouterr().err == ""
