"""Answers to week 4 as students write them at first: each of the five is wrong in its own way."""

import math
from collections.abc import Sequence
from typing import Any

import tf2_geometry_msgs
from geometry_msgs.msg import PointStamped, TransformStamped
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformListener

from course_lib.grading import my_values


def stamped(parent: str, child: str, stamp: Any, x: float, y: float, z: float, yaw: float) -> Any:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp = stamp
    message.transform.translation.x = x
    message.transform.translation.y = y
    message.transform.translation.z = z
    message.transform.rotation.z = math.sin(yaw / 2)
    message.transform.rotation.w = math.cos(yaw / 2)
    return message


def point_to_world(point: Sequence[float], x: float, y: float, yaw: float) -> list[float]:
    """Only shifts: right as long as the robot is not turned."""
    return [point[0] + x, point[1] + y, point[2]]


class FramesNode(Node):
    """Base of the two nodes that broadcast."""

    period = 0.02

    def __init__(self) -> None:
        super().__init__("first_try")
        self.broadcaster = TransformBroadcaster(self)
        self.static_broadcaster = StaticTransformBroadcaster(self)
        self.angle = 0.0
        self.static_broadcaster.sendTransform(self.fixed(self.get_clock().now().to_msg()))
        self.create_timer(self.period, self.move)

    def fixed(self, now: Any) -> list[Any]:
        """Transforms that never change."""
        raise NotImplementedError

    def move(self) -> None:
        """Broadcast what moves."""
        raise NotImplementedError


class RobotFramesNode(FramesNode):
    """Looks outward, as the angle says."""

    def fixed(self, now: Any) -> list[Any]:
        return [stamped("base_link", "camera_link", now, 0.2, 0.0, 0.6, 0.0)]

    def move(self) -> None:
        radius = my_values("week04.robot_frames")["radius"]
        now = self.get_clock().now().to_msg()
        x, y = radius * math.cos(self.angle), radius * math.sin(self.angle)
        self.broadcaster.sendTransform(stamped("map", "base_link", now, x, y, 0.0, self.angle))
        self.angle += 2 * math.pi / 400


class ObstacleNode(Node):
    """Mistake: the transform is the latest, not that of the obstacle's stamp."""

    def __init__(self) -> None:
        super().__init__("obstacle")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(PointStamped, "/obstacle_in_map", 10)
        self.create_subscription(PointStamped, "/obstacle", self.carry, 10)

    def carry(self, message: PointStamped) -> None:
        if not self.buffer.can_transform("map", message.header.frame_id, Time()):
            return
        latest = self.buffer.lookup_transform("map", message.header.frame_id, Time())
        carried = tf2_geometry_msgs.do_transform_point(message, latest)
        carried.header.stamp = message.header.stamp
        self.publisher.publish(carried)


class MendedArm(FramesNode):
    """Mends the stamp and the rotation, but not the name."""

    period = 0.05

    def fixed(self, now: Any) -> list[Any]:
        return [
            stamped("map", "base_link", now, 0.0, 0.0, 0.2, 0.0),
            stamped("base", "arm_link", now, 0.0, 0.0, 1.0, 0.0),
            stamped("hand_link", "finger_link", now, 0.1, 0.0, 0.0, 0.0),
        ]

    def move(self) -> None:
        now = self.get_clock().now().to_msg()
        self.broadcaster.sendTransform(stamped("arm_link", "hand_link", now, 0.4, 0.0, 0.0, self.angle))
        self.angle += 0.025


def in_between(first: Sequence[float], second: Sequence[float], ratio: float) -> list[float]:
    """Mistake: the turn goes the long way round."""
    return [a + ratio * (b - a) for a, b in zip(first, second, strict=True)]
