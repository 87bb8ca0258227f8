"""Buffers of transforms when their node's clock jumps, as in tf2_ros."""

from collections.abc import Iterator

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.clock import ROSClock
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from tf2_ros import Buffer

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time import virtual_time
from course_lib.ros.time.time_lock import time_lock

WARNING = "[WARN] [1700000000.000000000] [tf2_buffer]: Detected jump back in time. Clearing tf buffer."


@pytest.fixture
def node() -> Iterator[Node]:
    virtual_time.install()
    with use_graph(Graph()), time_lock.hold():
        rclpy.init(args=["--ros-args", "-p", "use_sim_time:=true"])
        yield Node("listener")
        rclpy.shutdown()


def set_time(node: Node, seconds: float) -> None:
    clock = node.get_clock()
    assert isinstance(clock, ROSClock)
    clock.set_ros_time_override(Time(seconds=seconds, clock_type=node.get_clock().clock_type))


def stored(node: Node | None) -> Buffer:
    buffer = Buffer(node=node)
    for child, put in (("base", buffer.set_transform), ("laser", buffer.set_transform_static)):
        transform = TransformStamped(child_frame_id=child)
        transform.header.frame_id = "map"
        transform.header.stamp.sec = 10
        put(transform, "test")
    return buffer


def knows(buffer: Buffer, frame: str) -> bool:
    return bool(buffer.can_transform("map", frame, Time()))


@pytest.mark.parametrize(("to", "is_kept"), [(20.0, True), (9.001, True), (9.0, False)])
def test_backward_jump_of_a_second_clears_dynamic_transforms(
    node: Node, capfd: pytest.CaptureFixture[str], to: float, is_kept: bool
) -> None:
    set_time(node, 10.0)
    buffer = stored(node)
    set_time(node, to)
    assert knows(buffer, "base") is is_kept
    assert knows(buffer, "laser")
    assert capfd.readouterr().err == ("" if is_kept else f"{WARNING}\n")


def test_switch_of_the_time_source_clears_dynamic_transforms(node: Node) -> None:
    buffer = stored(node)
    node.set_parameters([Parameter("use_sim_time", value=False)])
    assert not knows(buffer, "base")


def test_buffer_without_a_node_keeps_its_transforms_as_in_tf2_ros(node: Node) -> None:
    set_time(node, 10.0)
    buffer = stored(None)
    set_time(node, 1.0)
    assert knows(buffer, "base")
