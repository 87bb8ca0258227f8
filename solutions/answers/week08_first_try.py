"""Answers to week 8 as students write them at first: each of the five is wrong in its own way."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import Point
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, TransformException, TransformListener
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import Marker

from course_lib.grading import my_values

WRIST = "ur10wrist_3_link"
UPPER_ARM, FOREARM = 0.612, 0.5723


def joint_at(start: float, goal: float, seconds: float, t: float) -> float:
    """Goes evenly, along a line."""
    return start + (goal - start) * min(max(t / seconds, 0.0), 1.0)


class SweepNode(Node):
    """Calls the joints as those of a UR10 that stands alone."""

    def __init__(self) -> None:
        super().__init__("sweep")
        self.publisher = self.create_publisher(JointTrajectory, "/arm_controller/joint_trajectory", 10)
        self.seconds = 0
        self.create_timer(1.0, self.tick)

    def tick(self) -> None:
        self.seconds += 1
        lifts = {1: 1.5, 5: my_values("week08.sweep_node")["lift"]}
        if self.seconds in lifts:
            names = [f"{name}_joint" for name in ("shoulder_pan", "shoulder_lift", "elbow")]
            names += [f"wrist_{number}_joint" for number in (1, 2, 3)]
            angles = [0.0, lifts[self.seconds], 0.5, 0.0, 0.0, 0.0]
            point = JointTrajectoryPoint(positions=angles, velocities=[0.0] * 6)
            point.time_from_start.sec = 3
            self.publisher.publish(JointTrajectory(joint_names=names, points=[point]))


class PaintNode(Node):
    """Never begins a new stripe."""

    def __init__(self) -> None:
        super().__init__("paint")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(Marker, "/visualization_marker", 10)
        self.height: float | None = None
        self.marker = Marker(id=0, type=Marker.LINE_STRIP, action=Marker.ADD)
        self.marker.header.frame_id = "map"
        self.marker.scale.x = 0.2
        self.marker.color.r = self.marker.color.g = self.marker.color.a = 1.0
        self.create_timer(0.1, self.tick)

    def place(self, frame: str, link: str) -> Any:
        found = self.buffer.lookup_transform(frame, link, Time()).transform.translation
        return found.x, found.y, found.z

    def tick(self) -> None:
        try:
            height = self.place("base_link", WRIST)[2]
        except TransformException:
            return
        before, self.height = self.height, height
        if before is not None and abs(height - before) > 0.01 and height > 0.5:
            x, y, z = self.place("map", WRIST)
            self.marker.points.append(Point(x=x, y=y, z=z))
            self.publisher.publish(self.marker)


def lift_and_elbow(ahead: float, up: float) -> tuple[float, float]:
    """Stretches the arm where the place is out of reach, and says nothing."""
    cosine = (ahead**2 + up**2 - UPPER_ARM**2 - FOREARM**2) / (2 * UPPER_ARM * FOREARM)
    elbow = math.acos(np.clip(cosine, -1, 1))
    beyond = math.atan2(FOREARM * math.sin(elbow), UPPER_ARM + FOREARM * math.cos(elbow))
    return -math.atan2(up, ahead) - beyond, elbow


def coverage(stripes: Sequence[Sequence[float]], width: float, height: float) -> float:
    """Adds up the stripes: what two of them share counts twice."""
    return sum(0.2 * (high - low) for _, low, high in stripes) / (width * height)
