"""Answers to week 2 as a student may hand them in at first."""

import math
from collections.abc import Sequence
from typing import Any

from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState, LaserScan
from visualization_msgs.msg import Marker

from course_lib.grading import my_values

NAMES = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"]
NAMES += ["wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]


class JointWaveNode(Node):
    """Forgets 2 pi: the frequency is taken for radians a second."""

    def __init__(self) -> None:
        super().__init__("joint_wave")
        self.publisher = self.create_publisher(JointState, "/joint_states", 10)
        self.time = 0.0
        self.create_timer(0.02, self.publish_state)

    def publish_state(self) -> None:
        amplitude = my_values("week02.joint_wave")["amplitude"]
        state = JointState(name=NAMES)
        state.header.stamp = self.get_clock().now().to_msg()
        pan, elbow = amplitude * math.sin(0.25 * self.time), 0.5 * math.sin(0.5 * self.time)
        state.position = [pan, -1.2, elbow, 0.0, 0.0, 0.0]
        self.publisher.publish(state)
        self.time += 0.02


def two_link(a: float, b: float, first: float, second: float) -> list[float]:
    """Mistake: both angles are from the x axis."""
    return [a * math.cos(first) + b * math.cos(second), a * math.sin(first) + b * math.sin(second)]


def tool_place(
    joints: Sequence[tuple[str, Sequence[float]]], angles: Sequence[float], tip: Sequence[float]
) -> list[float]:
    """Adds all shifts, as if no joint had turned."""
    shifts = [*(shift for _, shift in joints), tip]
    return [sum(shift[axis] for shift in shifts) for axis in range(3)]


class MendedStates(Node):
    """Mends the number of positions and the name, but leaves the degrees."""

    def __init__(self) -> None:
        super().__init__("states")
        self.publisher = self.create_publisher(JointState, "/joint_states", 10)
        self.steps = 0
        self.create_timer(0.05, self.publish_state)

    def publish_state(self) -> None:
        swing = math.sin(math.pi * self.steps * 0.05)
        state = JointState(name=NAMES)
        state.header.stamp = self.get_clock().now().to_msg()
        state.position = [30.0 * swing, -90.0, 60.0, -45.0, 90.0, 0.0]
        self.publisher.publish(state)
        self.steps += 1


class NearestNode(Node):
    """Mistake: the shortest range may be of a beam that does not count."""

    def __init__(self) -> None:
        super().__init__("nearest")
        self.publisher = self.create_publisher(Marker, "/nearest", 10)
        self.create_subscription(LaserScan, "/scan", self.find, qos_profile_sensor_data)

    def find(self, message: Any) -> None:
        distance = min(message.ranges)
        if not math.isfinite(distance):
            return
        angle = message.angle_min + list(message.ranges).index(distance) * message.angle_increment
        marker = Marker(header=message.header, type=Marker.SPHERE)
        marker.pose.position.x = distance * math.cos(angle)
        marker.pose.position.y = distance * math.sin(angle)
        marker.scale.x = marker.scale.y = marker.scale.z = 0.2
        marker.color.r = marker.color.a = 1.0
        self.publisher.publish(marker)
