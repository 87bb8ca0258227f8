"""Poses of frames in the fixed frame, with RViz's words if one is not known.

The rules are RViz2's FrameManager and TFFrameTransformer, and tf2_geometry_msgs for poses (by way of KDL).
"""

from collections.abc import Iterable
from typing import Any

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.statuses import Level
from course_lib.errors import CourseError
from course_lib.ros.tf2_core import BufferCore
from course_lib.ros.tf2_transform import Transform, TransformException

NS = 1_000_000_000  # [ns] in a second
FIXED_FRAME = "<Fixed Frame>"  # as a property's value: the fixed frame, whatever it is


def frame_name(frame: str) -> str:
    """Return the name of a frame without the leading slash that tf2 does not know.

    Raises:
        CourseError: If it is not text: the built-in function `map` where the quotes of "map" were forgotten.
    """
    if not isinstance(frame, str):
        given = getattr(frame, "__name__", repr(frame))
        raise CourseError(f'the fixed frame {given} is not text. Write its name in quotes: fixed_frame="map"')
    return frame.removeprefix("/")


class Frames:
    """The transforms that have arrived, and the frame everything is shown in."""

    def __init__(self, fixed_frame: str) -> None:
        self.buffer = BufferCore()
        self._fixed_frame = frame_name(fixed_frame)
        self._known: dict[tuple[str, int], Matrix | None] = {}  # answers, until transforms arrive

    @property
    def fixed_frame(self) -> str:
        """RViz's Fixed Frame."""
        return self._fixed_frame

    @fixed_frame.setter
    def fixed_frame(self, frame: str) -> None:
        self._fixed_frame = frame_name(frame)
        self._known.clear()

    def take(self, transforms: Iterable[Any], is_static: bool) -> tuple[str, ...]:
        """Remember transforms of a tf2_msgs/msg/TFMessage; returns what tf2 logs of those it ignores."""
        complaints: tuple[str, ...] = ()
        self._known.clear()
        for message in transforms:
            complaints += self.buffer.set_transform(Transform.from_message(message), is_static=is_static)
        return complaints

    def transform(self, frame: str, stamp_ns: int = 0) -> Matrix | None:
        """Return the transform from a frame to the fixed frame, shape (4, 4); None if it is not known.

        Args:
            frame: Its name; RViz strips a leading slash.
            stamp_ns: [ns]; 0 takes the latest. The same array is returned until transforms arrive.
        """
        key = (frame.removeprefix("/"), stamp_ns)
        if key not in self._known:
            try:
                self._known[key] = self.buffer.lookup(self.fixed_frame, *key).matrix()
            except TransformException:
                self._known[key] = None
        return self._known[key]

    def problem(self, frame: str, stamp_ns: int = 0) -> str | None:
        """Return RViz's reason for not placing a frame; None if its pose is known."""
        error = self.buffer.can_transform(self.fixed_frame, frame, stamp_ns)
        if error is None:
            return None
        known = self.buffer.frames()
        if self.fixed_frame not in known:
            return f"For frame [{frame}]: Fixed Frame [{self.fixed_frame}] does not exist"
        if frame not in known:
            return f"For frame [{frame}]: Frame [{frame}] does not exist"
        return f"No transform to fixed frame [{self.fixed_frame}]. TF error: [{error}]"

    def global_status(self) -> tuple[Level, str]:
        """Return RViz's status of the fixed frame."""
        known = self.buffer.frames()
        if self.fixed_frame in known:
            return "ok", "OK"
        problem = f"Frame [{self.fixed_frame}] does not exist"
        return ("error", problem) if known else ("warn", f"No tf data.  Actual error: {problem}")


def nanoseconds(time: Any) -> int:
    """Return a builtin_interfaces Time or Duration in [ns]."""
    return int(time.sec) * NS + int(time.nanosec)


def placed(transform_frame_to_fixed: Matrix, pose: Any) -> Matrix:
    """Return the transform from a geometry_msgs/msg/Pose in a frame to the fixed frame, shape (4, 4).

    A quaternion (x, y, z, w) that is not of unit length turns as in RViz2: KDL makes a matrix of the raw
    numbers, reads a quaternion from the product, and only that is normalised.
    """
    q = pose.orientation
    raw = transform_frame_to_fixed[:3, :3] @ _kdl_matrix(q.x, q.y, q.z, q.w)
    result = np.eye(4)
    result[:3, :3] = raw if is_unit(q) else _kdl_matrix(*quaternion_of(raw))
    position = np.array([pose.position.x, pose.position.y, pose.position.z])
    result[:3, 3] = transform_frame_to_fixed[:3, :3] @ position + transform_frame_to_fixed[:3, 3]
    return result


def is_unit(q: Any, tolerance: float = 1e-6) -> bool:
    """Return whether a geometry_msgs/msg/Quaternion has length 1; the tolerance is that of its square."""
    return bool(abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) < tolerance)


def _kdl_matrix(x: float, y: float, z: float, w: float) -> Matrix:
    """Return KDL's matrix of a quaternion, scaled by its squared length, shape (3, 3)."""
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    return np.array(
        [
            [ww + xx - yy - zz, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), ww - xx + yy - zz, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), ww - xx - yy + zz],
        ]
    )


def quaternion_of(matrix: Matrix) -> Matrix:
    """Return KDL's quaternion (x, y, z, w) of a rotation, shape (3, 3), or more than that, normalised."""
    m = matrix
    trace = m[0, 0] + m[1, 1] + m[2, 2]
    turns = np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
    if trace > 1e-12:
        s = 0.5 / np.sqrt(trace + 1.0)
        quaternion = np.array([*(turns * s), 0.25 / s])
    else:
        i = 0 if m[0, 0] > m[1, 1] and m[0, 0] > m[2, 2] else 1 if m[1, 1] > m[2, 2] else 2
        s = 2.0 * np.sqrt(max(1.0 + 2 * m[i, i] - trace, 1e-12))
        quaternion = np.array([*((m[i] + m[:, i]) / s), turns[i] / s])
        quaternion[i] = 0.25 * s
    unit: Matrix = quaternion / np.linalg.norm(quaternion)
    return unit
