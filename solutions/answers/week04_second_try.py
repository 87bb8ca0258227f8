"""Answers to week 4 with other mistakes."""

import math
from collections.abc import Sequence
from typing import Any

import tf2_geometry_msgs
from geometry_msgs.msg import PointStamped, TransformStamped
from rclpy.node import Node
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
    """Turns clockwise."""
    c, s = math.cos(yaw), math.sin(yaw)
    return [c * point[0] + s * point[1] + x, -s * point[0] + c * point[1] + y, point[2]]


class RobotFramesNode(Node):
    """Broadcasts the robot as the parent of the map, and the camera as if it moved."""

    def __init__(self) -> None:
        super().__init__("second_try")
        self.broadcaster = TransformBroadcaster(self)
        self.angle = 0.0
        self.create_timer(0.02, self.move)

    def move(self) -> None:
        radius = my_values("week04.robot_frames")["radius"]
        now = self.get_clock().now().to_msg()
        x, y = radius * math.cos(self.angle), radius * math.sin(self.angle)
        yaw = self.angle + math.pi / 2
        robot = stamped("base_link", "map", now, x, y, 0.0, yaw)
        self.broadcaster.sendTransform([robot, stamped("base_link", "camera_link", now, 0.2, 0.0, 0.6, 0.0)])
        self.angle += 2 * math.pi / 400


class ObstacleNode(Node):
    """Asks for now: tf2 never knows it."""

    def __init__(self) -> None:
        super().__init__("obstacle")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(PointStamped, "/obstacle_in_map", 10)
        self.create_subscription(PointStamped, "/obstacle", self.carry, 10)

    def carry(self, message: PointStamped) -> None:
        now = self.get_clock().now()
        if self.buffer.can_transform("map", message.header.frame_id, now):
            found = self.buffer.lookup_transform("map", message.header.frame_id, now)
            self.publisher.publish(tf2_geometry_msgs.do_transform_point(message, found))


class MendedArm(Node):
    """Mends the name and the rotation, but leaves the stamp of the hand as it is: 0."""

    def __init__(self) -> None:
        super().__init__("arm")
        self.broadcaster = TransformBroadcaster(self)
        self.static_broadcaster = StaticTransformBroadcaster(self)
        now = self.get_clock().now().to_msg()
        self.static_broadcaster.sendTransform(
            [
                stamped("map", "base_link", now, 0.0, 0.0, 0.2, 0.0),
                stamped("base_link", "arm_link", now, 0.0, 0.0, 1.0, 0.0),
                stamped("hand_link", "finger_link", now, 0.1, 0.0, 0.0, 0.0),
            ]
        )
        self.angle = 0.0
        self.create_timer(0.05, self.turn)

    def turn(self) -> None:
        never = TransformStamped().header.stamp
        self.broadcaster.sendTransform(stamped("arm_link", "hand_link", never, 0.4, 0.0, 0.0, self.angle))
        self.angle += 0.025


def in_between(first: Sequence[float], second: Sequence[float], ratio: float) -> list[float]:
    """Mistake: the ratio is from the wrong end."""
    return [ratio * a + (1 - ratio) * b for a, b in zip(first, second, strict=True)]
