"""A transform between two named frames, its arithmetic, and the exceptions of tf2."""

from dataclasses import dataclass
from math import acos, sin, sqrt
from typing import Any, TypeAlias

import numpy as np

from course_lib.arrays import Floats, Vector

Quaternion: TypeAlias = tuple[float, float, float, float]  # (x, y, z, w)
Pose: TypeAlias = tuple[Vector, Quaternion]

IDENTITY: Pose = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class TransformException(Exception):  # noqa: N818 - ROS's name
    """Base of everything that tf2 raises."""


class ConnectivityException(TransformException):
    """Two frames are not part of one tree."""


class LookupException(TransformException):
    """A frame does not exist, or the tree has a loop."""


class ExtrapolationException(TransformException):
    """There is no data at the requested time, nor on both sides of it."""


class InvalidArgumentException(TransformException):
    """A frame name that tf2 does not accept."""


class TimeoutException(TransformException):
    """A transform did not arrive in time."""


for _error in (TransformException, *TransformException.__subclasses__()):
    _error.__module__ = "tf2"


@dataclass(frozen=True, slots=True)
class Transform:
    """The pose of a child frame in its parent: takes the child's coordinates to the parent's.

    The stamp is in [ns], the translation in [m], the rotation a quaternion (x, y, z, w).
    """

    parent: str
    child: str
    stamp_ns: int
    translation: Vector
    rotation: Quaternion

    @classmethod
    def from_message(cls, message: Any) -> "Transform":
        """Create a transform from a geometry_msgs/msg/TransformStamped."""
        stamp, v, q = message.header.stamp, message.transform.translation, message.transform.rotation
        stamp_ns = int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
        place, turn = (v.x, v.y, v.z), (q.x, q.y, q.z, q.w)
        return cls(message.header.frame_id, message.child_frame_id, stamp_ns, place, turn)

    @property
    def pose(self) -> Pose:
        """The translation and the rotation."""
        return self.translation, self.rotation

    def matrix(self) -> Floats:
        """Return the transform from child to parent, shape (4, 4)."""
        x, y, z, w = self.rotation
        px, py, pz = self.translation
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), px],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), py],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), pz],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )


def interpolated(older: Transform, newer: Transform, time_ns: int) -> Transform:
    """Return the transform at a time between two: linear in position, on the shorter arc in rotation."""
    if older.stamp_ns == newer.stamp_ns:
        return newer
    ratio = (time_ns - older.stamp_ns) / (newer.stamp_ns - older.stamp_ns)
    x, y, z = (a + ratio * (b - a) for a, b in zip(older.translation, newer.translation, strict=True))
    rotation = slerp(older.rotation, newer.rotation, ratio)
    return Transform(older.parent, older.child, time_ns, (x, y, z), rotation)


def slerp(start: Quaternion, end: Quaternion, ratio: float) -> Quaternion:
    """Turn from one unit quaternion (x, y, z, w) to another on the shorter arc."""
    dot = sum(a * b for a, b in zip(start, end, strict=True))
    theta = acos(min(abs(dot), 1.0))
    if theta == 0.0:
        return start
    of_start = sin((1.0 - ratio) * theta) / sin(theta)
    of_end = sin(ratio * theta) / sin(theta) * (-1.0 if dot < 0 else 1.0)
    x, y, z, w = (a * of_start + b * of_end for a, b in zip(start, end, strict=True))
    return (x, y, z, w)


def compose(outer: Pose, inner: Pose) -> Pose:
    """Return the pose that first applies `inner`, then `outer`."""
    x, y, z = _rotated(outer[1], inner[0])
    px, py, pz = outer[0]
    return (x + px, y + py, z + pz), _product(outer[1], inner[1])


def inverted(pose: Pose) -> Pose:
    """Return the pose that undoes a pose with a unit quaternion."""
    (px, py, pz), (x, y, z, w) = pose
    back = (-x, -y, -z, w)
    return _rotated(back, (-px, -py, -pz)), back


def normalized(rotation: Quaternion) -> Quaternion:
    """Return the unit quaternion (x, y, z, w), with the sign that tf2's way through a matrix gives."""
    x, y, z, w = scaled_to_one(rotation)
    leading = w if abs(w) > 0.5 else max((x, y, z), key=abs)
    return (-x, -y, -z, -w) if leading < 0 else (x, y, z, w)


def scaled_to_one(rotation: Quaternion) -> Quaternion:
    """Return the unit quaternion (x, y, z, w); no turn for one of zeros."""
    x, y, z, w = rotation
    length = sqrt(x * x + y * y + z * z + w * w)
    return (x / length, y / length, z / length, w / length) if length else IDENTITY[1]


def _product(a: Quaternion, b: Quaternion) -> Quaternion:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def _rotated(rotation: Quaternion, point: Vector) -> Vector:
    x, y, z, w = rotation
    px, py, pz = point
    tx, ty, tz = 2 * (y * pz - z * py), 2 * (z * px - x * pz), 2 * (x * py - y * px)
    return (px + w * tx + y * tz - z * ty, py + w * ty + z * tx - x * tz, pz + w * tz + x * ty - y * tx)
