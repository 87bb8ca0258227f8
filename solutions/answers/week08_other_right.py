"""Right answers to week 8 that look nothing like ours: matrices, another order of joints, complex numbers."""

import cmath
import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Vector3
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import ColorRGBA, Header
from tf2_ros import Buffer, TransformListener
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import Marker

from course_lib.grading import my_values


def joint_at(start: float, goal: float, seconds: float, t: float) -> float:
    """Solves for the cubic that stands still at both ends."""
    ends = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [1.0, seconds, seconds**2, seconds**3],
        [0.0, 1.0, 2 * seconds, 3 * seconds**2],
    ]
    powers = np.linalg.solve(np.array(ends), np.array([start, 0.0, goal, 0.0]))
    return float(np.polyval(powers[::-1], np.clip(t, 0, seconds)))


class SweepNode(Node):
    """One timer for each command, which ends itself; joints in another order."""

    def __init__(self) -> None:
        super().__init__("sweeper")
        self.publisher = self.create_publisher(JointTrajectory, "arm_controller/joint_trajectory", 1)
        self.first = self.create_timer(1.0, lambda: self.send(self.first, 1.5))
        self.second = self.create_timer(
            5.0, lambda: self.send(self.second, my_values("week08.sweep_node")["lift"])
        )

    def send(self, timer: Any, lift: float) -> None:
        timer.cancel()
        goal = {"wrist_1": 0.0, "wrist_2": 0.0, "wrist_3": 0.0, "elbow": 0.5, "shoulder_lift": lift}
        goal["shoulder_pan"] = 0.0
        arrived = JointTrajectoryPoint(positions=list(goal.values()), velocities=np.zeros(6))
        arrived.time_from_start = Duration(seconds=3).to_msg()
        names = [f"ur10{name}_joint" for name in goal]
        self.publisher.publish(JointTrajectory(joint_names=names, points=[arrived]))


class PaintNode(Node):
    """Keeps all stripes as lists of points, and looks before it asks TF."""

    def __init__(self) -> None:
        super().__init__("painter")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(Marker, "visualization_marker", 5)
        self.stripes: list[list[Point]] = []
        self.heights = [math.nan]
        self.painted_from = (math.inf, math.inf, math.inf)
        self.create_timer(0.1, self.look)

    def where(self, frame: str, link: str) -> tuple[float, float, float]:
        found = self.buffer.lookup_transform(frame, link, Time()).transform.translation
        return found.x, found.y, found.z

    def look(self) -> None:
        if not self.buffer.can_transform("map", "ur10wrist_3_link", Time()):
            return
        self.heights = [*self.heights[-1:], self.where("base_link", "ur10wrist_3_link")[2]]
        if self.heights[-1] > 0.5 and abs(self.heights[-1] - self.heights[0]) > 0.01:
            base = self.where("map", "base_link")
            if not math.dist(base, self.painted_from) <= 0.1:
                self.stripes.append([])
            self.painted_from = base
            x, y, z = self.where("map", "ur10wrist_3_link")
            self.stripes[-1].append(Point(x=x, y=y, z=z))
            self.show(len(self.stripes))

    def show(self, number: int) -> None:
        header = Header(stamp=self.get_clock().now().to_msg(), frame_id="map")
        color, scale = ColorRGBA(r=1.0, g=1.0, b=0.0, a=1.0), Vector3(x=0.2)
        stripe = Marker(
            header=header, ns="paint", id=10 * number, type=Marker.LINE_STRIP, color=color, scale=scale
        )
        stripe.points = self.stripes[-1]
        self.publisher.publish(stripe)


def lift_and_elbow(ahead: float, up: float) -> list[float]:
    """Turns a folded arm until it points to the place: complex numbers, imaginary is down."""
    upper, fore, place = 0.612, 0.5723, complex(ahead, -up)
    if not abs(upper - fore) <= abs(place) <= upper + fore:
        return []
    elbow = math.pi - math.acos((upper**2 + fore**2 - abs(place) ** 2) / (2 * upper * fore))
    folded = upper + fore * cmath.exp(1j * elbow)
    return [cmath.phase(place / folded), elbow]


def coverage(stripes: Sequence[Sequence[float]], width: float, height: float) -> float:
    """Exact: between any two edges along y, the union of what is painted along z."""
    rows = [
        (max(y - 0.1, 0.0), min(y + 0.1, width), max(low, 0.0), min(high, height)) for y, low, high in stripes
    ]
    edges = sorted({edge for left, right, *_ in rows for edge in (left, right)})
    area = 0.0
    for left, right in pairwise(edges):
        top = 0.0
        for low, high in sorted((low, high) for a, b, low, high in rows if a <= left and b >= right):
            area += (right - left) * max(0.0, high - max(low, top))
            top = max(top, high)
    return area / (width * height)
