"""Lesson 8's robot, a UR10 on an omnidirectional base; its painting node, and the wall."""

import math
import xml.etree.ElementTree as ET
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Unpack

import numpy as np
import numpy.typing as npt
from geometry_msgs.msg import Point, PoseStamped, TransformStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node, NodeOptions
from rclpy.time import Time
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformListener
from visualization_msgs.msg import Marker

from course_lib.arrays import Floats, Matrix
from course_lib.errors import CourseError
from course_lib.robots.kinematics import inverse, match_matrix_signs, motion_of, twist_of
from course_lib.robots.robot import Robot, from_text, resolve
from course_lib.robots.trajectory import period_of

# Forward and to the left [m/s], turning to the left [rad/s].
MAX_SPEED = np.array([0.5, 0.5, 0.8])
# Deceleration before a goal [m/s², rad/s²].
BRAKES = np.array([0.5, 0.5, 0.8])
# Indices into a twist: along x, along y, about z.
_PLANE = [0, 1, 5]
# Prefix of the arm's joint and link names.
PREFIX = "ur10"
ARM_URDF = "package://example-robot-data/robots/ur_description/urdf/ur10_robot.urdf"
# Initial positions [rad]; the other joints start at 0.
START = {f"{PREFIX}shoulder_lift_joint": -1.2, f"{PREFIX}elbow_joint": 0.5}
# Position of the arm in base_link [m], which is on the ground below the middle of the base. The arm
# is mounted so far ahead and so high that, stretched downwards, it touches neither the ground nor
# the base.
MOUNT = (0.9, 0.0, 1.2)
# The shapes of the base, with position and rotation.
_SHAPES = [
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
    """Drives by /cmd_vel or to the last /goal_pose, and publishes /odom and map → odom → base_link.

    A command is valid for `timeout`, then the base stops. It also cancels a goal. Odometry has no
    drift, so map and odom are the same and goals may be in either frame.

    Args:
        rate: Rate of motion, [Hz].
        timeout: Time for which a command is valid, [s].
        options: Options of any node.

    Raises:
        CourseError: The rate is not positive.
    """

    def __init__(
        self,
        *,
        rate: float = 20.0,
        timeout: float = 0.5,
        **options: Unpack[NodeOptions],
    ) -> None:
        # In seconds.
        self._period, self._timeout = period_of(rate), timeout
        super().__init__("omni_base", **options)
        # transform_base_to_odom and transform_goal_to_odom.
        self._pose = np.eye(4)
        self._goal: Matrix | None = None
        # The commanded speed, like MAX_SPEED, and the time for which it remains valid [s].
        self._speed, self._hold = np.zeros(3), 0.0
        self._odometry = self.create_publisher(Odometry, "odom", 10)
        self._broadcaster = TransformBroadcaster(self)
        odom_in_map = TransformStamped(child_frame_id="odom")
        odom_in_map.header.frame_id, odom_in_map.header.stamp = "map", self.get_clock().now().to_msg()
        StaticTransformBroadcaster(self).sendTransform(odom_in_map)
        self.create_subscription(Twist, "cmd_vel", self._on_command, 10)
        self.create_subscription(PoseStamped, "goal_pose", self._on_goal, 10)
        self.create_timer(self._period, self._update)

    def _on_command(self, twist: Twist) -> None:
        velocity = np.array([twist.linear.x, twist.linear.y, twist.angular.z])
        if np.isfinite(velocity).all():
            self._speed, self._hold, self._goal = (
                np.clip(velocity, -MAX_SPEED, MAX_SPEED),
                self._timeout,
                None,
            )
        else:
            self.get_logger().error(f"A command with numbers that are not finite is ignored: {velocity}.")

    def _on_goal(self, goal: PoseStamped) -> None:
        frame, place, turn = goal.header.frame_id, goal.pose.position, goal.pose.orientation
        yaw = 2 * math.atan2(turn.z, turn.w)
        if frame not in ("map", "odom"):
            self.get_logger().error(f"The goal is in frame {frame!r}, expected 'map' or 'odom'.")
        elif not np.isfinite([place.x, place.y, yaw]).all():
            self.get_logger().error("A goal with numbers that are not finite is ignored.")
        else:
            self._goal = motion_of(np.array([0.0, 0.0, 0.0, 0.0, 0.0, yaw]))
            self._goal[:2, 3] = place.x, place.y

    def _update(self) -> None:
        if self._goal is not None:
            # At most the speed that reaches the goal in one period, within all limits.
            way = twist_of(inverse(self._pose) @ self._goal)[_PLANE]
            distance = np.maximum(np.abs(way), 1e-12)
            # Rates relative to the remaining distance [1/s].
            fastest = np.minimum(MAX_SPEED, np.sqrt(2 * BRAKES * distance)) / distance
            self._speed = way * min(*fastest, 1 / self._period)
        elif self._hold <= 0:
            self._speed = np.zeros(3)
        self._hold -= self._period
        (x, y), yaw = self._pose[:2, 3].tolist(), math.atan2(self._pose[1, 0], self._pose[0, 0])
        z, w = match_matrix_signs(np.array([[0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)]]))[
            0, 2:
        ].tolist()
        odom_transform = TransformStamped(child_frame_id="base_link")
        odom_transform.header.frame_id, odom_transform.header.stamp = "odom", self.get_clock().now().to_msg()
        odom_transform.transform.translation.x, odom_transform.transform.translation.y = x, y
        odom_transform.transform.rotation.z, odom_transform.transform.rotation.w = z, w
        self._broadcaster.sendTransform(odom_transform)
        odometry = Odometry(header=odom_transform.header, child_frame_id="base_link")
        pose, twist = odometry.pose.pose, odometry.twist.twist
        pose.position.x, pose.position.y, pose.orientation.z, pose.orientation.w = x, y, z, w
        twist.linear.x, twist.linear.y, twist.angular.z = map(float, self._speed)
        self._odometry.publish(odometry)
        # The base rarely moves, so this saves work.
        if self._speed.any():
            motion = np.zeros(6)
            motion[_PLANE] = self._speed * self._period
            self._pose = self._pose @ motion_of(motion)


# The arm in the configuration START, in simple shapes: shape, position, rotation.
_ARM = [
    ('<cylinder radius="0.09" length="0.16"/>', "0.9 0 1.28", "0 0 0"),
    ('<cylinder radius="0.06" length="0.612"/>', "1.01 0 1.61", "0 0.3708 0"),
    ('<cylinder radius="0.05" length="0.5723"/>', "1.34 0 2.08", "0 0.8708 0"),
]
_ARM_JOINTS = [
    ('<cylinder radius="0.08" length="0.2"/>', at, "1.5708 0 0") for at in ("0.9 0 1.327", "1.122 0 1.897")
]
_ARM_JOINTS.append(('<box size="0.12 0.2 0.12"/>', "1.559 0 2.266", "0 0.8708 0"))
# RViz colors all shapes of a link alike, so each color has a link of its own.
_SIMPLE_LINKS = {
    "base_link": (_SHAPES, "0.55 0.6 0.65 1"),
    "arm": (_ARM, "0.85 0.85 0.88 1"),
    "arm_joints": (_ARM_JOINTS, "0.2 0.5 0.85 1"),
}


@lru_cache(maxsize=1)
def simple_painter() -> Robot:
    """Return the mobile manipulator as a few boxes and cylinders, which are fast to draw.

    Its arm is rigid. `mobile_manipulator` returns the robot with its joints and meshes.
    """
    links = ""
    for name, (shapes, color) in _SIMPLE_LINKS.items():
        looks = f'<material name="{name}"><color rgba="{color}"/></material>'
        visuals = "".join(
            f'<visual><origin xyz="{at}" rpy="{turn}"/><geometry>{shape}</geometry>{looks}</visual>'
            for shape, at, turn in shapes
        )
        links += f'<link name="{name}">{visuals}</link>'
        if name != "base_link":
            ends = f'<parent link="base_link"/><child link="{name}"/>'
            links += f'<joint name="{name}_mount" type="fixed">{ends}</joint>'
    return from_text(f'<robot name="painter">{links}</robot>')


@lru_cache(maxsize=1)
def mobile_manipulator() -> Robot:
    """Return the robot of lesson 8, a UR10 arm on an omnidirectional base.

    Its root is base_link. The links of the arm are ur10base_link … ur10tool0; only the arm has
    movable joints.
    """
    shapes = [f'<origin xyz="{at}" rpy="{turn}"/><geometry>{shape}</geometry>' for shape, at, turn in _SHAPES]
    looks = '<material name="base"><color rgba="0.55 0.6 0.65 1"/></material>'
    base = "".join(f"<visual>{s}{looks}</visual><collision>{s}</collision>" for s in shapes)
    mount = f"""<joint name="{PREFIX}base_joint" type="fixed"><parent link="base_link"/>
        <child link="{PREFIX}base_link"/><origin xyz="{" ".join(map(str, MOUNT))}"/></joint>"""
    # The arm is a UR10 with renamed links and joints, without its link `world`.
    ur10 = ET.fromstring(resolve(ARM_URDF).read_text(encoding="utf-8"))
    arm = ""
    for element in (*ur10.findall("link"), *ur10.findall("joint")):
        if element.get("name") not in ("world", "world_joint"):
            element.set("name", PREFIX + element.get("name", ""))
            for end in (*element.findall("parent"), *element.findall("child")):
                end.set("link", PREFIX + end.get("link", ""))
            arm += ET.tostring(element, encoding="unicode")
    link = f'<link name="base_link">{base}</link>'
    return from_text(f'<robot name="mobile_manipulator">{link}{mount}{arm}</robot>')


# Side of the squares in which coverage is measured [m].
CELL = 0.002
# Thickness of the wall [m].
THICK = 0.1
# Points in map, shape (N, 3), [m].
Points = npt.ArrayLike
# Width of a stripe [m].
WIDTH = 0.2
# Period of the node's timer [s].
PERIOD = 0.1
# Minimum change of the wrist's height per period, and its minimum height above the ground [m].
LEAST_RISE, LEAST_HEIGHT = 0.01, 0.5
# Maximum distance [m] that the base may move within a time [s].
LONGEST_WAY, WINDOW = 0.1, 5.0


@dataclass(frozen=True)
class Wall:
    """A flat wall perpendicular to the x axis of the frame map.

    Args:
        x: Its position along x, [m].
        y: Its extent along y: minimum and maximum, [m].
        z: Its extent along z: minimum and maximum, [m].

    Raises:
        CourseError: A number is not finite, or the wall has no area.

    Example:
        >>> wall = Wall(2.0, y=(0.0, 1.0), z=(0.0, 1.0))
        >>> stripe = [(1.9, 0.0, 0.5), (1.9, 1.0, 0.5)]
        >>> round(wall.coverage([stripe], width=0.2), 2)
        0.2
    """

    x: float
    y: tuple[float, float]
    z: tuple[float, float]

    def __post_init__(self) -> None:
        """Raise a CourseError for invalid numbers."""
        if not (
            np.isfinite([self.x, *self.y, *self.z]).all() and self.y[0] < self.y[1] and self.z[0] < self.z[1]
        ):
            raise CourseError(f"{self} has no area; pass x, (y from, y to) and (z from, z to), [m].")

    def coverage(
        self,
        stripes: Iterable[Points],
        *,
        width: float = WIDTH,
        reach: float = 0.3,
    ) -> float:
        """Return the painted fraction of the wall, 0 … 1.

        Args:
            stripes: The paths of the wrist, which moves a round spot of paint along them.
            width: Diameter of the spot, [m].
            reach: Maximum distance from which paint reaches the wall, [m].
        """
        y, z = (np.arange(low + CELL / 2, high, CELL) for low, high in (self.y, self.z))
        painted = np.zeros((len(y), len(z)), bool)
        for begin, stop in _segments(stripes):
            # The crossings with both limits of the reach, as fractions of the segment.
            along, offset = stop - begin, begin[0] - self.x
            crossings = [(side - offset) / (along[0] or 1e-12) for side in (-reach, reach)]
            first, last = np.clip(sorted(crossings), 0.0, 1.0)
            if first >= last:
                continue
            # The end points (y, z) of the part within reach.
            start, end = (begin + first * along)[1:], (begin + last * along)[1:]
            low, high = np.minimum(start, end) - width / 2, np.maximum(start, end) + width / 2
            rows, columns = (slice(*np.searchsorted(c, (low[i], high[i]))) for i, c in enumerate((y, z)))
            cells = np.stack(np.meshgrid(y[rows], z[columns], indexing="ij"), axis=-1)
            way = end - start
            portion = np.clip((cells - start) @ way / max(way @ way, 1e-12), 0.0, 1.0)
            gap = cells - start - portion[..., np.newaxis] * way
            painted[rows, columns] |= np.linalg.norm(gap, axis=-1) <= width / 2
        return float(painted.mean())

    def marker(self) -> Marker:
        """Return a marker that draws the wall."""
        marker = Marker(ns="wall", type=Marker.CUBE, action=Marker.ADD)
        marker.header.frame_id, marker.pose.orientation.w = "map", 1.0
        center, size = marker.pose.position, marker.scale
        center.x, center.y, center.z = self.x + THICK / 2, sum(self.y) / 2, sum(self.z) / 2
        size.x, size.y, size.z = THICK, self.y[1] - self.y[0], self.z[1] - self.z[0]
        marker.color.r, marker.color.g, marker.color.b, marker.color.a = 0.8, 0.8, 0.8, 1.0
        return marker


def flatness(stripes: Iterable[Points]) -> float:
    """Return the extent of all stripes along x, [m]; 0 for flat ones.

    Args:
        stripes: The points of each stripe in map, shape (N, 3), [m].
    """
    return float(np.ptp([piece[:, 0] for piece in _segments(stripes)] or 0.0))


def _segments(stripes: Iterable[Points]) -> Iterator[Floats]:
    """Yield the segments of stripes, shape (2, 3)."""
    for stripe in stripes:
        points = np.asarray(stripe, float)
        if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
            raise CourseError(
                f"A stripe has shape {points.shape}; expected finite points x, y, z, shape (N, 3)."
            )
        yield from map(np.array, pairwise(points))


class PaintNode(Node):
    """Publishes stripes on /visualization_marker while the wrist moves up or down above 0.5 m.

    A stripe ends when the wrist pauses or the base has moved more than 0.1 m within 5 s. Its
    points, in map [m], are in `stripes`.

    Args:
        wrist: The link that paints.
        options: Options of any node.
    """

    def __init__(self, wrist: str = "ur10wrist_3_link", **options: Unpack[NodeOptions]) -> None:
        super().__init__("paint_path_node", **options)
        self.stripes: list[list[Floats]] = []
        # Height of the wrist [m].
        self._wrist, self._height = wrist, np.nan
        # Whether the next point starts a stripe.
        self._is_new = True
        # Recent positions of the base: time [s], position [m].
        self._track: deque[tuple[float, Floats]] = deque()
        self._buffer = Buffer()
        self._listener = TransformListener(self._buffer, self)
        self._publisher = self.create_publisher(Marker, "visualization_marker", 10)
        self.create_timer(PERIOD, self._update)

    def _update(self) -> None:
        if not self._buffer.can_transform("map", self._wrist, Time()):
            says = f"Nothing is painted: TF does not know {self._wrist} in map."
            self.get_logger().warning(says, throttle_duration_sec=5.0, skip_first=True)
            return
        before, self._height = self._height, self._base_position("base_link", self._wrist)[2]
        now = self.get_clock().now().nanoseconds / 1e9
        self._track.append((now, self._base_position("map", "base_link")))
        while now - self._track[0][0] > WINDOW:
            self._track.popleft()
        has_moved = (
            sum(float(np.linalg.norm(b - a)) for (_, a), (_, b) in pairwise(self._track)) > LONGEST_WAY
        )
        if has_moved:
            self._track.clear()
        if has_moved or not (abs(self._height - before) > LEAST_RISE and self._height > LEAST_HEIGHT):
            self._is_new = True
            return
        if self._is_new:
            self.stripes.append([])
            self._is_new = False
        self.stripes[-1].append(self._base_position("map", self._wrist))
        stripe = Marker(id=len(self.stripes) - 1, type=Marker.LINE_STRIP, action=Marker.ADD)
        stripe.header.frame_id, stripe.header.stamp = "map", self.get_clock().now().to_msg()
        stripe.scale.x, stripe.pose.orientation.w = WIDTH, 1.0
        # Yellow.
        stripe.color.r, stripe.color.g, stripe.color.a = 1.0, 1.0, 1.0
        stripe.points = [Point(x=x, y=y, z=z) for x, y, z in np.array(self.stripes[-1]).tolist()]
        self._publisher.publish(stripe)

    def _base_position(self, frame: str, link: str) -> Floats:
        translation = self._buffer.lookup_transform(frame, link, Time()).transform.translation
        return np.array([translation.x, translation.y, translation.z])
