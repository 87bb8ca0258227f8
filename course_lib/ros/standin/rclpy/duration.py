"""Durations, and the number of nanoseconds in a second."""

from functools import total_ordering
from typing import NoReturn, SupportsIndex

import builtin_interfaces.msg

S_TO_NS = 1_000_000_000  # [ns] / [s]


# ROS stores durations as signed 64-bit nanoseconds.
_LIMIT = 2**63


@total_ordering
class Duration:
    """A duration with nanosecond resolution. May be negative, and has to fit into 64 bits."""

    def __init__(self, *, seconds: float = 0, nanoseconds: int = 0) -> None:
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if not -_LIMIT <= total < _LIMIT:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")
        self.__nanoseconds = total

    @property
    def nanoseconds(self) -> int:
        """The duration, [ns]."""
        return self.__nanoseconds

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        raise TypeError("cannot pickle 'rclpy._rclpy_pybind11.rcl_duration_t' object")

    def __copy__(self) -> "Duration":
        return Duration(nanoseconds=self.nanoseconds)

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self.nanoseconds})"

    def __str__(self) -> str:
        return "Infinite" if self == Infinite else f"{self.nanoseconds} nanoseconds"

    def __eq__(self, other: object) -> bool:
        return self.nanoseconds == other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __lt__(self, other: object) -> bool:
        return self.nanoseconds < other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def to_msg(self) -> builtin_interfaces.msg.Duration:
        """Convert the duration to a message."""
        seconds, nanoseconds = divmod(self.nanoseconds, S_TO_NS)
        return builtin_interfaces.msg.Duration(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: builtin_interfaces.msg.Duration) -> "Duration":
        """Create a duration from a message."""
        if not isinstance(msg, builtin_interfaces.msg.Duration):
            raise TypeError("Must pass a builtin_interfaces.msg.Duration object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)


Infinite = Duration(nanoseconds=_LIMIT - 1)
