"""tf2's buffer with ROS types, and what it raises."""

from typing import TypeAlias

import builtin_interfaces.msg
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from rclpy.duration import Duration
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.time import Time
from std_msgs.msg import Header

from course_lib.ros import tf2_core, tf2_frames, tf2_transform
from course_lib.ros.tf2_errors import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

__all__ = [
    "AnyTime",
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]

_log = RcutilsLogger()  # C++ names none
AnyTime: TypeAlias = Time | builtin_interfaces.msg.Time  # of any kind of clock: tf2 does not look


class BufferCore:
    """Remembers transforms and answers how one frame lies in another.

    Args:
        cache_time: How long dynamic transforms are remembered; default 10 s.
    """

    def __init__(self, cache_time: Duration | None = None) -> None:
        self._core = tf2_core.BufferCore(tf2_core.CACHE_NS if cache_time is None else cache_time.nanoseconds)

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Remember a transform; one that breaks tf2's rules is logged and ignored."""
        self._set(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Remember a transform that holds at any time."""
        self._set(transform, authority, is_static=True)

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: AnyTime) -> TransformStamped:
        """Return the transform that takes coordinates in the source frame to the target frame, at once.

        Args:
            target_frame: Frame to express things in.
            source_frame: Frame the things are given in.
            time: When; zero means the latest time at which all of the chain is known.

        Raises:
            TransformException: It is not known.
        """
        return _message(self._core.lookup(target_frame, source_frame, _ns(time)))

    def lookup_transform_full_core(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
    ) -> TransformStamped:
        """Return the transform from the source frame at one time to the target frame at another, at once."""
        when = _ns(target_time), _ns(source_time)
        found = self._core.lookup_full(target_frame, when[0], source_frame, when[1], fixed_frame)
        return _message(found)

    def can_transform_core(self, target_frame: str, source_frame: str, time: AnyTime) -> tuple[bool, str]:
        """Say whether a lookup would succeed, and why not."""
        problem = self._core.can_transform(target_frame, source_frame, _ns(time))
        return problem is None, problem or ""

    def can_transform_full_core(
        self,
        target_frame: str,
        target_time: AnyTime,
        source_frame: str,
        source_time: AnyTime,
        fixed_frame: str,
    ) -> tuple[bool, str]:
        """Say whether a full lookup would succeed, and why not."""
        when = _ns(target_time), _ns(source_time)
        problem = self._core.can_transform_full(target_frame, when[0], source_frame, when[1], fixed_frame)
        return problem is None, problem or ""

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Time:
        """Return the newest time at which the chain between two frames is known; zero if it is static."""
        return Time(nanoseconds=self._core.lookup(target_frame, source_frame).stamp_ns)

    def all_frames_as_yaml(self) -> str:
        """Describe all frames that have a parent, as YAML."""
        return tf2_frames.as_yaml(self._core)

    def all_frames_as_string(self) -> str:
        """Name all frames that have a parent, one in a line."""
        return self._core.described()

    def clear(self) -> None:
        """Forget all dynamic transforms."""
        self._core.clear()

    def _frameExists(self, frame_id: str) -> bool:  # noqa: N802  # tf2's name
        return frame_id in self._core.frames()

    def _getFrameStrings(self) -> list[str]:  # noqa: N802  # tf2's name
        return self._core.frames()

    def _set(self, message: TransformStamped, authority: str, *, is_static: bool) -> None:
        transform = tf2_transform.Transform.from_message(message)
        for complaint in self._core.set_transform(transform, authority, is_static):
            if complaint.startswith("TF_OLD_DATA"):
                _log.warning(complaint)
            else:
                _log.error(complaint)


def _ns(time: AnyTime) -> int:
    if isinstance(time, Time):
        return time.nanoseconds
    if isinstance(time, builtin_interfaces.msg.Time):
        return time.sec * 10**9 + time.nanosec
    raise TypeError("time must have sec and nanosec, or nanoseconds.")


def _message(found: tf2_transform.Transform) -> TransformStamped:
    seconds, nanoseconds = divmod(found.stamp_ns, 10**9)
    (x, y, z), (qx, qy, qz, qw) = found.pose
    return TransformStamped(
        header=Header(
            stamp=builtin_interfaces.msg.Time(sec=seconds, nanosec=nanoseconds), frame_id=found.parent
        ),
        child_frame_id=found.child,
        transform=Transform(translation=Vector3(x=x, y=y, z=z), rotation=Quaternion(x=qx, y=qy, z=qz, w=qw)),
    )
