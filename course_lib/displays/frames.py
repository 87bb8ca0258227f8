"""Transforms from tf frames to the fixed frame, and the time of a view.

The rules and texts are those of RViz2's FrameManager and TFFrameTransformer, and of
tf2_geometry_msgs for poses, which uses KDL. Numbers agree with RViz only if each step is the same,
so this module repeats KDL's conversions instead of calling a library of rotations.
"""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.statuses import Level
from course_lib.errors import CourseError
from course_lib.ros.tf2 import BufferCore, Transform, TransformException

# Nanoseconds per second.
NS = 1_000_000_000
# Value of a property that stands for the current fixed frame.
FIXED_FRAME = "<Fixed Frame>"


def frame_name(frame: str) -> str:
    """Return the name of a frame without a leading slash, which tf2 does not allow.

    Raises:
        CourseError: It is not a string; `map` without quotes is a built-in function.
    """
    if not isinstance(frame, str):
        type_text = getattr(frame, "__name__", repr(frame))
        raise CourseError(
            f'the fixed frame {type_text} is not a string. Write its name in quotes: fixed_frame="map"'
        )
    return frame.removeprefix("/")


class Frames:
    """The received transforms, and the fixed frame in which everything is shown."""

    def __init__(self, fixed_frame: str) -> None:
        self.buffer = BufferCore()
        self._fixed_frame = frame_name(fixed_frame)
        # The cached results, until the next transform.
        self._known: dict[tuple[str, int], Matrix | None] = {}

    @property
    def fixed_frame(self) -> str:
        """RViz's Fixed Frame."""
        return self._fixed_frame

    @fixed_frame.setter
    def fixed_frame(self, frame: str) -> None:
        self._fixed_frame = frame_name(frame)
        self._known.clear()

    def clear(self) -> None:
        """Discard all transforms."""
        self.buffer.clear()
        self._known.clear()

    def add_transforms(self, transforms: Iterable[Any], is_static: bool) -> tuple[str, ...]:
        """Add the transforms of a TFMessage, and return tf2's log messages about ignored ones."""
        complaints: tuple[str, ...] = ()
        self._known.clear()
        for message in transforms:
            # RViz2 logs this authority: the C++ listener cannot determine the node.
            transform = Transform.from_message(message)
            complaints += self.buffer.set_transform(transform, "Authority undetectable", is_static)
        return complaints

    def transform(self, frame: str, stamp_ns: int = 0) -> Matrix | None:
        """Return the transform from a frame to the fixed frame, shape (4, 4); None if unknown.

        Args:
            frame: The name of the frame; a leading slash is removed, as in RViz.
            stamp_ns: The time [ns]; 0 means the latest. The same array is returned until another
                transform is added.
        """
        key = (frame.removeprefix("/"), stamp_ns)
        if key not in self._known:
            try:
                self._known[key] = self.buffer.lookup(self.fixed_frame, *key).matrix()
            except TransformException:
                self._known[key] = None
        return self._known[key]

    def pose_value(self, label: str, frame: str, target: str = "") -> Any:
        """Return the ``Position`` or ``Orientation`` (x, y, z, w) of a frame, or "" if unknown.

        It is rounded for a row, and relative to the target or, without one, to the fixed frame.
        """
        try:
            transform = self.buffer.lookup(target or self.fixed_frame, frame)
        except TransformException:
            return ""
        numbers = transform.translation if label.endswith("Position") else transform.rotation
        return tuple(round(number, 6) for number in numbers)

    def problem(self, frame: str, stamp_ns: int = 0) -> str | None:
        """Return RViz's reason why a transform is unknown; None if it is known."""
        error = self.buffer.can_transform(self.fixed_frame, frame, stamp_ns)
        if error is None:
            return None
        frames = self.buffer.frames()
        if self.fixed_frame not in frames:
            return f"For frame [{frame}]: Fixed Frame [{self.fixed_frame}] does not exist"
        if frame not in frames:
            return f"For frame [{frame}]: Frame [{frame}] does not exist"
        return f"No transform to fixed frame [{self.fixed_frame}]. TF error: [{error}]"

    def is_too_old(self, frame: str, stamp_ns: int) -> bool:
        """Return whether a stamp [ns] is older than tf2's data, so that RViz drops the message."""
        return self.buffer.is_too_old(self.fixed_frame, frame.removeprefix("/"), stamp_ns)

    def global_status(self) -> tuple[Level, str]:
        """Return RViz's status of the fixed frame."""
        frames = self.buffer.frames()
        if self.fixed_frame in frames:
            return "ok", "OK"
        problem = f"Frame [{self.fixed_frame}] does not exist"
        return ("error", problem) if frames else ("warn", f"No tf data.  Actual error: {problem}")


def nanoseconds(time: Any) -> int:
    """Convert a builtin_interfaces Time or Duration to [ns]."""
    return int(time.sec) * NS + int(time.nanosec)


def pose_in_fixed_frame(transform_frame_to_fixed: Matrix, pose: Any) -> Matrix:
    """Return the transform from a Pose message in a frame to the fixed frame, shape (4, 4).

    A quaternion (x, y, z, w) without unit length is handled as in RViz2: KDL computes a matrix from
    the raw numbers, extracts a quaternion from the product, and normalizes only this quaternion.
    """
    q = pose.orientation
    raw = transform_frame_to_fixed[:3, :3] @ _kdl_matrix(q.x, q.y, q.z, q.w)
    result = np.eye(4)
    result[:3, :3] = raw if is_unit(q) else _kdl_matrix(*quaternion_of(raw))
    position = np.array([pose.position.x, pose.position.y, pose.position.z])
    result[:3, 3] = transform_frame_to_fixed[:3, :3] @ position + transform_frame_to_fixed[:3, 3]
    return result


def is_unit(q: Any, tolerance: float = 1e-6) -> bool:
    """Return whether the squared norm of a geometry_msgs/msg/Quaternion is 1 within a tolerance."""
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
    """Return KDL's normalized quaternion (x, y, z, w) of a rotation, possibly scaled, shape (3, 3)."""
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


# Frame rate while all pages are hidden [Hz]. It suffices for recordings without gaps, and keeps
# message queues from overflowing.
_HIDDEN_RATE = 10


class ViewTime:
    """Robot time, which paces the frames of a view, and ROS time, which its displays use.

    ROS time equals robot time or, with `use_sim_time`, the last time received on /clock.

    Args:
        start_ns: Robot time, [ns].
        use_sim_time: Whether ROS time follows /clock.
    """

    def __init__(self, start_ns: int, use_sim_time: bool) -> None:
        self.use_sim_time = use_sim_time
        self.frame_rate = 30  # frames per second of robot time
        # Whether the tabs of all pages are hidden.
        self.is_hidden: Callable[[], bool] = lambda: False
        self.robot_ns = start_ns
        # 0 until a message on /clock is received.
        self._sim_ns = 0
        # Robot time of the last message.
        self.message_ns = start_ns
        # Time of the last frame.
        self._frame_ns = start_ns
        # When the next frame is due, if one was requested.
        self._due_ns: int | None = None

    @property
    def now_ns(self) -> int:
        """ROS time of the last message or frame, [ns]."""
        return self.ros_ns(self.robot_ns)

    def ros_ns(self, robot_ns: int) -> int:
        """Convert the current robot time to ROS time, [ns]."""
        return self._sim_ns if self.use_sim_time else robot_ns

    def on_message(self, stamp_ns: int) -> None:
        """Record the robot time of a message."""
        self.robot_ns = self.message_ns = stamp_ns

    def on_clock(self, sim_ns: int) -> bool:
        """Set the time of /clock, and return whether it jumped back."""
        jumped, self._sim_ns = sim_ns < self._sim_ns, sim_ns
        return jumped

    def restart(self) -> None:
        """Discard all times: the next message sets them."""
        self.robot_ns, self._sim_ns, self._due_ns = 0, 0, None

    def request_frame(self) -> None:
        """Schedule a frame one interval after the last frame, or from now if that time has passed.

        Messages that follow each other more quickly than frames do not delay them.
        """
        if self._due_ns is None:
            # The last frame lies in the future if time has jumped back since.
            is_recent = 0 <= self.robot_ns - self._frame_ns < self._interval_ns
            self._due_ns = (self._frame_ns if is_recent else self.robot_ns) + self._interval_ns

    def overdue_ns(self, robot_ns: int) -> int | None:
        """Return the due time of a requested frame if a robot time [ns] has reached it, else None."""
        return self._due_ns if self._due_ns is not None and self._due_ns <= robot_ns else None

    def is_frame_due(self, robot_ns: int) -> bool:
        """Return whether a frame is due, requested or not: objects expire without messages."""
        return robot_ns >= (self._frame_ns + self._interval_ns if self._due_ns is None else self._due_ns)

    def begin_frame(self, robot_ns: int) -> None:
        """Record the robot time of a frame."""
        self.robot_ns = self._frame_ns = max(robot_ns, self.robot_ns)
        self._due_ns = None

    @property
    def _interval_ns(self) -> int:
        return NS // (min(self.frame_rate, _HIDDEN_RATE) if self.is_hidden() else self.frame_rate)
