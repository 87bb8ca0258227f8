import pytest
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import (
    Buffer,
    StaticTransformBroadcaster,
    StaticTransformListener,
    TransformBroadcaster,
    TransformListener,
)
from tf2_ros.transform_listener import DEFAULT_STATIC_TF_TOPIC, DEFAULT_TF_TOPIC

from course_lib.ros.graph.graph import Graph
from tests.ros.tf2.stamped import stamped


def spun(node: Node) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while executor._course_can_work() or node.handle.graph.advance():
        executor.spin_once(timeout_sec=0)


def test_one_or_several_transforms_can_be_sent(node: Node) -> None:
    buffer = Buffer()
    TransformListener(buffer, node)
    broadcaster = TransformBroadcaster(node)
    broadcaster.sendTransform(stamped("map", "a", 5))
    broadcaster.sendTransform(stamped(parent, child, 5) for parent, child in [("a", "b"), ("b", "c")])
    spun(node)
    assert buffer.can_transform("map", "c", Time(nanoseconds=5))


def test_late_joining_listener_receives_static_transforms(node: Node) -> None:
    broadcaster = StaticTransformBroadcaster(node)
    broadcaster.sendTransform(stamped("map", "a", x=1.0))
    broadcaster.sendTransform([stamped("map", "b", x=2.0)])
    buffer = Buffer()
    TransformListener(buffer, node)
    spun(node)
    assert buffer.lookup_transform("a", "b", Time()).transform.translation.x == pytest.approx(1.0)


@pytest.mark.parametrize("same_object", [False, True])
def test_static_transform_is_replaced_only_by_the_same_broadcaster(node: Node, same_object: bool) -> None:
    broadcaster, buffer = StaticTransformBroadcaster(node), Buffer()
    TransformListener(buffer, node)
    first = stamped("map", "a", x=1.0)
    broadcaster.sendTransform(first)
    second = first if same_object else stamped("map", "a")
    second.transform.translation.x = 2.0
    broadcaster.sendTransform(second)
    spun(node)
    x = buffer.lookup_transform("map", "a", Time()).transform.translation.x
    assert x == (2.0 if same_object else 1.0)


def test_unregistered_listener_receives_no_transforms(node: Node) -> None:
    buffer = Buffer()
    listener = TransformListener(buffer, node)
    listener.unregister()
    TransformBroadcaster(node).sendTransform(stamped("map", "a", 5))
    spun(node)
    assert buffer.all_frames_as_yaml() == "[]"


def test_static_listener_receives_static_transforms_only(node: Node) -> None:
    buffer = Buffer()
    listener = StaticTransformListener(buffer, node)
    TransformBroadcaster(node).sendTransform(stamped("map", "moving", 5))
    StaticTransformBroadcaster(node).sendTransform(stamped("map", "fixed"))
    spun(node)
    assert buffer.can_transform("map", "fixed", Time())
    assert "moving" not in buffer.all_frames_as_yaml()
    assert node.count_subscribers(DEFAULT_TF_TOPIC) == 0
    listener.unregister()
    assert node.count_subscribers(DEFAULT_STATIC_TF_TOPIC) == 0


def test_listener_subscribes_to_the_given_topics(node: Node) -> None:
    TransformListener(Buffer(), node, tf_topic="/robot/tf", tf_static_topic="/robot/tf_static")
    assert [node.count_subscribers(topic) for topic in ("/robot/tf", "/robot/tf_static", "/tf")] == [1, 1, 0]


def test_qos_of_tf_topics_agrees_with_ros(started_graph: Graph, node: Node) -> None:
    TransformBroadcaster(node)
    StaticTransformBroadcaster(node)
    TransformListener(Buffer(), node)
    found = {
        (end.topic, end.kind): (end.qos.depth, end.qos.durability)
        for end in started_graph.endpoints()
        if end.topic.startswith("/tf")
    }
    assert found == {
        ("/tf", "pub"): (100, "volatile"),
        ("/tf", "sub"): (100, "volatile"),
        ("/tf_static", "pub"): (1, "transient_local"),
        ("/tf_static", "sub"): (100, "transient_local"),
    }


def test_names_in_the_submodules_of_tf2_ros_can_be_imported_from_tf2_ros() -> None:
    import geometry_msgs.msg
    import rclpy.time
    import tf2_ros

    assert tf2_ros.TransformStamped is geometry_msgs.msg.TransformStamped  # the official URDF tutorial
    assert tf2_ros.Time is rclpy.time.Time
