"""Right answers to week 2 that look nothing like ours: complex numbers, time instead of counting."""

from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Pose, Vector3
from numpy.typing import ArrayLike, NDArray
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import ColorRGBA, Header
from visualization_msgs.msg import Marker

from course_lib.grading import my_values


class States(Node):
    """Publishes what `positions` says of the time since the start, by joint."""

    period = 0.02

    def __init__(self) -> None:
        super().__init__(type(self).__name__.lower())
        self.start = self.get_clock().now()
        self.out = self.create_publisher(JointState, "joint_states", 1)
        self.create_timer(self.period, self.tell)

    def positions(self, seconds: float) -> dict[str, float]:
        """Publish the positions of the joints."""
        raise NotImplementedError

    def tell(self) -> None:
        now = self.get_clock().now()
        positions = self.positions((now - self.start).nanoseconds / 1e9)
        header = Header(stamp=now.to_msg())
        joints = [f"{name}_joint" for name in positions]
        self.out.publish(JointState(header=header, name=joints, position=np.array([*positions.values()])))


class JointWaveNode(States):
    def positions(self, seconds: float) -> dict[str, float]:
        pan = my_values("week02.joint_wave")["amplitude"] * np.sin(np.pi / 2 * seconds)
        still = dict.fromkeys(("wrist_3", "wrist_2", "wrist_1"), 0.0)
        return {**still, "elbow": 0.5 * np.sin(np.pi * seconds), "shoulder_lift": -1.2, "shoulder_pan": pan}


class MendedStates(States):
    period = 0.05

    def positions(self, seconds: float) -> dict[str, float]:
        wrists = {"wrist_1": -np.pi / 4, "wrist_2": np.pi / 2, "wrist_3": 0.0}
        pan = np.pi / 6 * np.sin(np.pi * seconds)
        return {"shoulder_pan": pan, "shoulder_lift": -np.pi / 2, "elbow": np.pi / 3, **wrists}


def two_link(a: float, b: float, first: float, second: float) -> NDArray[np.float64]:
    tip = np.exp(1j * first) * (a + b * np.exp(1j * second))
    return np.array([tip.real, tip.imag])


def tool_place(joints: Any, angles: ArrayLike, tip: ArrayLike) -> list[float]:
    """From the tool to the base, by Rodrigues' rule, without a matrix."""
    point = np.asarray(tip, float)
    for (axis, shift), angle in reversed(list(zip(joints, np.asarray(angles, float), strict=True))):
        along = np.array([axis == name for name in "xyz"], float)
        aside = np.cross(along, point)
        point = (
            point + np.sin(angle) * aside + (1 - np.cos(angle)) * np.cross(along, aside) + np.asarray(shift)
        )
    return [float(value) for value in point]


class NearestNode(Node):
    def __init__(self) -> None:
        super().__init__("looker")
        self.out = self.create_publisher(Marker, "nearest", 1)
        self.create_subscription(LaserScan, "scan", self.look, qos_profile_sensor_data)

    def look(self, scan: Any) -> None:
        ranges = np.nan_to_num(np.array(scan.ranges, float), nan=np.inf)
        ranges[(ranges < scan.range_min) | (ranges > scan.range_max)] = np.inf
        nearest = int(np.argmin(ranges))
        if np.isinf(ranges[nearest]):
            return
        end = ranges[nearest] * np.exp(1j * (scan.angle_min + nearest * scan.angle_increment))
        pose = Pose(position=Point(x=float(end.real), y=float(end.imag), z=0.0))
        size, red = Vector3(x=0.2, y=0.2, z=0.2), ColorRGBA(r=1.0, g=0.0, b=0.0, a=1.0)
        self.out.publish(Marker(header=scan.header, type=Marker.SPHERE, pose=pose, scale=size, color=red))
