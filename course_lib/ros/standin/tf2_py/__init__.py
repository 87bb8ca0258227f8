"""tf2's buffer without a node, and its exceptions."""

from typing import Any

import builtin_interfaces.msg
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from rclpy.duration import Duration
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.time import Time
from std_msgs.msg import Header

from course_lib.ros import tf2
from course_lib.ros.tf2 import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]

# The logger has no name, as in C++.
_log = RcutilsLogger()


class BufferCore:
    """A buffer of transforms, which never waits.

    The time zero, `Time()`, stands for the latest time at which the whole chain is known. A failed
    lookup raises one of tf2's TransformExceptions.

    Args:
        cache_time: How long dynamic transforms are stored; default 10 s.
    """

    def __init__(self, cache_time: Duration | None = None) -> None:
        self._core = tf2.BufferCore(tf2.CACHE_NS if cache_time is None else _ns(cache_time, "duration"))

    def set_transform(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform. A transform that tf2 rejects is logged and ignored."""
        self.__set(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> None:
        """Store a transform that is valid at any time."""
        self.__set(transform, authority, is_static=True)

    def can_transform_core(self, target_frame: str, source_frame: str, time: Any) -> tuple[int, str]:
        """Return whether a lookup would succeed, 1 or 0, and the reason why not."""
        return _answer(self._core.can_transform(*_query(target_frame, source_frame, time)))

    def can_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> tuple[int, str]:
        """Return whether a full lookup would succeed, 1 or 0, and the reason why not."""
        query = _full_query(target_frame, target_time, source_frame, source_time, fixed_frame)
        return _answer(self._core.can_transform_full(*query))

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Any) -> TransformStamped:
        """Return the transform from the source frame to the target frame."""
        return _message(self._core.lookup(*_query(target_frame, source_frame, time)))

    def lookup_transform_full_core(
        self, target_frame: str, target_time: Any, source_frame: str, source_time: Any, fixed_frame: str
    ) -> TransformStamped:
        """Return the transform between two frames at two times, via a fixed frame."""
        query = _full_query(target_frame, target_time, source_frame, source_time, fixed_frame)
        return _message(self._core.lookup_full(*query))

    def get_latest_common_time(self, target_frame: str, source_frame: str, /) -> Time:
        """Return the newest time of the transform between two frames; 0 if it is static."""
        return Time(nanoseconds=self._core.latest_common_time(*_texts((1, target_frame), (2, source_frame))))

    def all_frames_as_yaml(self) -> str:
        """Describe all frames that have a parent, in YAML."""
        return tf2.as_yaml(self._core)

    def all_frames_as_string(self) -> str:
        """List all frames that have a parent, one per line."""
        return self._core.describe_frames()

    def clear(self) -> None:
        """Remove all dynamic transforms."""
        self._core.clear()

    def __set(self, message: TransformStamped, authority: str, *, is_static: bool) -> None:
        _texts((2, authority))
        transform = tf2.Transform.from_message(message)
        for complaint in self._core.set_transform(transform, authority, is_static):
            if complaint.startswith("TF_OLD_DATA"):
                _log.warning(complaint)
            else:
                _log.error(complaint)


def _query(target: str, source: str, time: Any) -> tuple[str, str, int]:
    """Return the checked arguments of a lookup."""
    _texts((1, target), (2, source))
    return target, source, _ns(time)


def _full_query(
    target: str, target_time: Any, source: str, source_time: Any, fixed: str
) -> tuple[str, int, str, int, str]:
    """Return the checked arguments of a lookup at two times."""
    _texts((1, target))
    target_ns = _ns(target_time)
    _texts((3, source))
    source_ns = _ns(source_time)
    _texts((5, fixed))
    return target, target_ns, source, source_ns, fixed


def _texts(*arguments: tuple[int, str]) -> list[str]:
    """Check that arguments, passed with their positions, are strings, and return them."""
    for position, value in arguments:
        if not isinstance(value, str):
            kind = "None" if value is None else type(value).__name__
            raise TypeError(f"argument {position} must be str, not {kind}")
    return [value for _, value in arguments]


def _ns(time: Any, noun: str = "time") -> int:
    """Return the nanoseconds of a time or a duration, of rclpy or a message."""
    if hasattr(time, "nanoseconds"):
        return int(time.nanoseconds)
    if hasattr(time, "sec") and hasattr(time, "nanosec"):
        return int(time.sec) * 10**9 + int(time.nanosec)
    raise TypeError(f"{noun} must have sec and nanosec, or nanoseconds.")


def _answer(problem: str | None) -> tuple[int, str]:
    return int(problem is None), problem or ""


def _message(transform: tf2.Transform) -> TransformStamped:
    seconds, nanoseconds = divmod(transform.stamp_ns, 10**9)
    (x, y, z), (qx, qy, qz, qw) = transform.pose
    return TransformStamped(
        header=Header(
            stamp=builtin_interfaces.msg.Time(sec=seconds, nanosec=nanoseconds), frame_id=transform.parent
        ),
        child_frame_id=transform.child,
        transform=Transform(translation=Vector3(x=x, y=y, z=z), rotation=Quaternion(x=qx, y=qy, z=qz, w=qw)),
    )
