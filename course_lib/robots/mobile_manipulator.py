"""A UR10 on an omnidirectional base."""

import math
import xml.etree.ElementTree as ET
from functools import lru_cache
from typing import Unpack

import numpy as np
from geometry_msgs.msg import PoseStamped, TransformStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node, NodeOptions
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

from course_lib.arrays import Floats, Matrix
from course_lib.robots.kinematics import as_of_matrices
from course_lib.robots.period import period_of
from course_lib.robots.resources import resolve
from course_lib.robots.rigid_motions import inverse, motion_of, twist_of
from course_lib.robots.robot import Robot, from_text

MAX_SPEED = np.array([0.5, 0.5, 0.8])  # ahead and to the left [m/s], turning to the left [rad/s]
BRAKES = np.array([0.5, 0.5, 0.8])  # how it slows down before a goal, [m/s²], [rad/s²]
_PLANE = [0, 1, 5]  # which numbers of a motion a base has: along x, along y, about z
PREFIX = "ur10"  # before the names of the arm's joints and links
ARM_URDF = "package://example-robot-data/robots/ur_description/urdf/ur10_robot.urdf"
START = {f"{PREFIX}shoulder_lift_joint": -1.2, f"{PREFIX}elbow_joint": 0.5}  # [rad] the other joints at 0
# base_link is on the ground, below the middle of the base. The arm stands ahead of it and high: stretched
# down it ends above the ground, and does not touch the base.
MOUNT = (0.9, 0.0, 1.2)  # [m] of the arm in base_link
_SHAPES = [  # what the base is made of, where, turned by
    ('<box size="0.8 0.6 0.25"/>', "0 0 0.2", "0 0 0"),
    ('<box size="0.14 0.14 0.875"/>', "0.2 0 0.7625", "0 0 0"),
    ('<box size="0.9 0.2 0.05"/>', "0.575 0 1.175", "0 0 0"),
    *(
        ('<cylinder radius="0.1" length="0.08"/>', f"{x} {y} 0.1", "1.5708 0 0")
        for x in (-0.27, 0.27)
        for y in (-0.31, 0.31)
    ),
]


class OmniBase(Node):
    """Drives by /cmd_vel, or to the last /goal_pose; publishes /odom and map → odom → base_link.

    A command holds for `timeout`, then the base stands; it also ends the drive to a goal. No wheel slips, so
    odom stays where map is, and goals may be in either.

    Args:
        rate: How often it moves, [Hz].
        timeout: How long one command holds, [s].
        options: What any node takes.

    Raises:
        CourseError: If the rate is not above 0.
    """

    def __init__(self, *, rate: float = 20.0, timeout: float = 0.5, **options: Unpack[NodeOptions]) -> None:
        self._period, self._timeout = period_of(rate), timeout  # [s]
        super().__init__("omni_base", **options)
        self._pose = np.eye(4)  # transform_base_to_odom
        self._goal: Matrix | None = None  # transform_goal_to_odom
        self._speed, self._hold = np.zeros(3), 0.0  # as MAX_SPEED, and for how long [s]
        self._odometry = self.create_publisher(Odometry, "odom", 10)
        self._broadcaster = TransformBroadcaster(self)
        odom_in_map = TransformStamped(child_frame_id="odom")
        odom_in_map.header.frame_id, odom_in_map.header.stamp = "map", self.get_clock().now().to_msg()
        StaticTransformBroadcaster(self).sendTransform(odom_in_map)
        self.create_subscription(Twist, "cmd_vel", self._on_command, 10)
        self.create_subscription(PoseStamped, "goal_pose", self._on_goal, 10)
        self.create_timer(self._period, self._update)

    def _on_command(self, twist: Twist) -> None:
        asked = np.array([twist.linear.x, twist.linear.y, twist.angular.z])
        if np.isfinite(asked).all():
            self._speed, self._hold, self._goal = np.clip(asked, -MAX_SPEED, MAX_SPEED), self._timeout, None
        else:
            self.get_logger().error(f"A command with numbers that are not finite is left out: {asked}.")

    def _on_goal(self, goal: PoseStamped) -> None:
        frame, place, turn = goal.header.frame_id, goal.pose.position, goal.pose.orientation
        yaw = 2 * math.atan2(turn.z, turn.w)
        if frame not in ("map", "odom"):
            self.get_logger().error(f"The goal is in frame {frame!r}, expected 'map' or 'odom'.")
        elif not np.isfinite([place.x, place.y, yaw]).all():
            self.get_logger().error("A goal with numbers that are not finite is left out.")
        else:
            self._goal = motion_of(np.array([0.0, 0.0, 0.0, 0.0, 0.0, yaw]))
            self._goal[:2, 3] = place.x, place.y

    def _update(self) -> None:
        if self._goal is not None:
            self._speed = _towards(inverse(self._pose) @ self._goal, self._period)
        elif self._hold <= 0:
            self._speed = np.zeros(3)
        self._hold -= self._period
        self._publish()
        if self._speed.any():  # it stands still most of the time
            motion = np.zeros(6)
            motion[_PLANE] = self._speed * self._period
            self._pose = self._pose @ motion_of(motion)

    def _publish(self) -> None:
        (x, y), yaw = self._pose[:2, 3].tolist(), math.atan2(self._pose[1, 0], self._pose[0, 0])
        z, w = as_of_matrices(np.array([[0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)]]))[0, 2:].tolist()
        moved = TransformStamped(child_frame_id="base_link")
        moved.header.frame_id, moved.header.stamp = "odom", self.get_clock().now().to_msg()
        moved.transform.translation.x, moved.transform.translation.y = x, y
        moved.transform.rotation.z, moved.transform.rotation.w = z, w
        self._broadcaster.sendTransform(moved)
        odometry = Odometry(header=moved.header, child_frame_id="base_link")
        pose, twist = odometry.pose.pose, odometry.twist.twist
        pose.position.x, pose.position.y, pose.orientation.z, pose.orientation.w = x, y, z, w
        twist.linear.x, twist.linear.y, twist.angular.z = map(float, self._speed)
        self._odometry.publish(odometry)


def _towards(gap: Matrix, period: float) -> Floats:
    """Return the speed to a goal in base_link, within all limits, that reaches it in a period [s] at most."""
    way = twist_of(gap)[_PLANE]
    far = np.maximum(np.abs(way), 1e-12)
    fastest = np.minimum(MAX_SPEED, np.sqrt(2 * BRAKES * far)) / far  # [1/s] of the way
    speed: Floats = way * min(*fastest, 1 / period)
    return speed


@lru_cache(maxsize=1)
def mobile_manipulator() -> Robot:
    """Return the robot: base_link, and ur10base_link … ur10tool0 on it; only the arm has joints."""
    shapes = [f'<origin xyz="{at}" rpy="{turn}"/><geometry>{shape}</geometry>' for shape, at, turn in _SHAPES]
    looks = '<material name="base"><color rgba="0.55 0.6 0.65 1"/></material>'
    base = "".join(f"<visual>{s}{looks}</visual><collision>{s}</collision>" for s in shapes)
    mount = f"""<joint name="{PREFIX}base_joint" type="fixed"><parent link="base_link"/>
        <child link="{PREFIX}base_link"/><origin xyz="{" ".join(map(str, MOUNT))}"/></joint>"""
    arm = "".join(ET.tostring(part, encoding="unicode") for part in _arm())
    link = f'<link name="base_link">{base}</link>'
    return from_text(f'<robot name="mobile_manipulator">{link}{mount}{arm}</robot>')


def _arm() -> list[ET.Element]:
    """Return the renamed links and joints of a UR10, without the link `world`."""
    arm = ET.fromstring(resolve(ARM_URDF).read_text(encoding="utf-8"))
    parts = [part for kind in ("link", "joint") for part in arm.findall(kind)]
    parts = [part for part in parts if part.get("name") not in ("world", "world_joint")]
    for element in parts:
        element.set("name", PREFIX + element.get("name", ""))
        for end in (*element.findall("parent"), *element.findall("child")):
            end.set("link", PREFIX + end.get("link", ""))
    return parts
