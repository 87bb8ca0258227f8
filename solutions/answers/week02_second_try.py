"""Answers to week 2 with other mistakes."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState, LaserScan
from visualization_msgs.msg import Marker

from course_lib.grading import my_values

NAMES = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"]
NAMES += ["wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]


class JointWaveNode(Node):
    """Names the joints joint1 to joint6, as many examples do, and swings as a cosine."""

    def __init__(self) -> None:
        super().__init__("joint_wave")
        self.publisher = self.create_publisher(JointState, "/joint_states", 10)
        self.steps = 0
        self.create_timer(0.02, self.publish_state)

    def publish_state(self) -> None:
        amplitude = my_values("week02.joint_wave")["amplitude"]
        angle = 2 * math.pi * 0.25 * self.steps * 0.02
        state = JointState(name=[f"joint{number}" for number in range(1, 7)])
        state.header.stamp = self.get_clock().now().to_msg()
        state.position = [amplitude * math.cos(angle), -1.2, 0.5 * math.cos(2 * angle), 0.0, 0.0, 0.0]
        self.publisher.publish(state)
        self.steps += 1


def two_link(a: float, b: float, first: float, second: float) -> list[float]:
    """Exchanges sine and cosine."""
    both = first + second
    return [a * math.sin(first) + b * math.sin(both), a * math.cos(first) + b * math.cos(both)]


def turned(axis: str, angle: float) -> Any:
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(4)
    matrix[i, i] = matrix[j, j] = math.cos(angle)
    matrix[j, i], matrix[i, j] = math.sin(angle), -math.sin(angle)
    return matrix


def tool_place(
    joints: Sequence[tuple[str, Sequence[float]]], angles: Sequence[float], tip: Sequence[float]
) -> Any:
    """Chains from the wrong side: the last joint first."""
    place = np.eye(4)
    for (axis, shift), angle in zip(joints, angles, strict=True):
        moved = np.eye(4)
        moved[:3, 3] = shift
        place = moved @ turned(axis, angle) @ place
    return (place @ [*tip, 1.0])[:3]


class MendedStates(Node):
    """Mends the name and the degrees; the wrist without a position is simply not named."""

    def __init__(self) -> None:
        super().__init__("states")
        self.publisher = self.create_publisher(JointState, "/joint_states", 10)
        self.steps = 0
        self.create_timer(0.05, self.publish_state)

    def publish_state(self) -> None:
        swing = math.sin(math.pi * self.steps * 0.05)
        state = JointState(name=NAMES[:5])
        state.header.stamp = self.get_clock().now().to_msg()
        state.position = [math.radians(angle) for angle in (30.0 * swing, -90.0, 60.0, -45.0, 90.0)]
        self.publisher.publish(state)
        self.steps += 1


class NearestNode(Node):
    """Places the sphere as if the first beam looked straight ahead."""

    def __init__(self) -> None:
        super().__init__("nearest")
        self.publisher = self.create_publisher(Marker, "/nearest", 10)
        self.create_subscription(LaserScan, "/scan", self.find, qos_profile_sensor_data)

    def find(self, message: Any) -> None:
        counts = [r for r in message.ranges if message.range_min <= r <= message.range_max]
        if not counts:
            return
        angle = list(message.ranges).index(min(counts)) * message.angle_increment
        marker = Marker(header=message.header, type=Marker.SPHERE)
        marker.pose.position.x = min(counts) * math.cos(angle)
        marker.pose.position.y = min(counts) * math.sin(angle)
        marker.scale.x = marker.scale.y = marker.scale.z = 0.2
        marker.color.r = marker.color.a = 1.0
        self.publisher.publish(marker)
