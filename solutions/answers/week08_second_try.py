"""Answers to week 8 as students write them next: each of the five is wrong in another way."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import Point
from numpy.typing import NDArray
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, TransformException, TransformListener
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import Marker

from course_lib.grading import my_values

WRIST = "ur10wrist_3_link"
UPPER_ARM, FOREARM = 0.612, 0.5723


def joint_at(start: float, goal: float, seconds: float, t: float) -> float:
    """Goes on beyond the end, as the polynomial does."""
    u = t / seconds
    return start + (goal - start) * (3 * u**2 - 2 * u**3)


class SweepNode(Node):
    """Sends the first command at once, before anybody listens."""

    def __init__(self) -> None:
        super().__init__("sweep")
        self.publisher = self.create_publisher(JointTrajectory, "/arm_controller/joint_trajectory", 10)
        self.sent = 0
        self.send(1.5)
        self.create_timer(5.0, self.tick)

    def tick(self) -> None:
        if self.sent < 2:
            self.send(my_values("week08.sweep_node")["lift"])

    def send(self, lift: float) -> None:
        names = [f"ur10{name}_joint" for name in ("shoulder_pan", "shoulder_lift", "elbow")]
        names += [f"ur10wrist_{number}_joint" for number in (1, 2, 3)]
        point = JointTrajectoryPoint(positions=[0.0, lift, 0.5, 0.0, 0.0, 0.0], velocities=[0.0] * 6)
        point.time_from_start.sec = 3
        self.publisher.publish(JointTrajectory(joint_names=names, points=[point]))
        self.sent += 1


class PaintNode(Node):
    """Paints at any height: the second half of rule 1 is missing."""

    def __init__(self) -> None:
        super().__init__("paint")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(Marker, "/visualization_marker", 10)
        self.height: float | None = None
        self.base: Any = None
        self.marker = self.new_stripe(0)
        self.create_timer(0.1, self.tick)

    def new_stripe(self, number: int) -> Marker:
        marker = Marker(id=number, type=Marker.LINE_STRIP, action=Marker.ADD)
        marker.header.frame_id = "map"
        marker.scale.x = 0.2
        marker.color.r = marker.color.g = marker.color.a = 1.0
        return marker

    def place(self, frame: str, link: str) -> NDArray[np.float64]:
        found = self.buffer.lookup_transform(frame, link, Time()).transform.translation
        return np.array([found.x, found.y, found.z])

    def tick(self) -> None:
        try:
            height, base = self.place("base_link", WRIST)[2], self.place("map", "base_link")
        except TransformException:
            return
        before, self.height = self.height, height
        if before is None or abs(height - before) <= 0.01:
            return
        if self.base is not None and math.dist(base, self.base) > 0.1:
            self.marker = self.new_stripe(self.marker.id + 1)
        self.base = base
        x, y, z = self.place("map", WRIST)
        self.marker.points.append(Point(x=x, y=y, z=z))
        self.publisher.publish(self.marker)


def lift_and_elbow(ahead: float, up: float) -> list[float]:
    """Mistake: the angles are in degrees."""
    cosine = (ahead**2 + up**2 - UPPER_ARM**2 - FOREARM**2) / (2 * UPPER_ARM * FOREARM)
    if abs(cosine) > 1:
        return []
    elbow = math.acos(cosine)
    beyond = math.atan2(FOREARM * math.sin(elbow), UPPER_ARM + FOREARM * math.cos(elbow))
    return [math.degrees(-math.atan2(up, ahead) - beyond), math.degrees(elbow)]


def coverage(stripes: Sequence[Sequence[float]], width: float, height: float) -> float:
    """Also counts paint beside the wall: its squares cover all stripes."""
    y, z = np.arange(-1.0, 6.0, 0.01) + 0.005, np.arange(-2.0, 10.0, 0.01) + 0.005
    painted = np.zeros((len(y), len(z)), bool)
    for middle, low, high in stripes:
        painted |= np.outer(abs(y - middle) < 0.1, (z > low) & (z < high))
    return float(painted.sum() * 0.01**2 / (width * height))
