"""Points in time, and the types of clocks that they are read from."""

from enum import IntEnum
from functools import total_ordering
from typing import NoReturn, SupportsIndex, overload

import builtin_interfaces.msg

from rclpy.duration import S_TO_NS, Duration


class ClockType(IntEnum):
    """The type of the clock that a time was read from. In the kit all of them show robot time."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3


# ROS stores times as signed 64-bit nanoseconds.
_LIMIT = 2**63


@total_ordering
class Time:
    """A point in time of one type of clock. Times of different clock types cannot be combined.

    `Time()` is zero, which tf2 interprets as "the latest".
    """

    def __init__(
        self,
        *,
        seconds: float = 0,
        nanoseconds: int = 0,
        clock_type: ClockType = ClockType.SYSTEM_TIME,
    ) -> None:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        if seconds < 0:
            raise ValueError("Seconds value must not be negative")
        if nanoseconds < 0:
            raise ValueError("Nanoseconds value must not be negative")
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if total >= _LIMIT:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self.__nanoseconds = total
        self.__clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        """Nanoseconds since the clock's epoch."""
        return self.__nanoseconds

    @property
    def clock_type(self) -> ClockType:
        """The type of the clock that this time belongs to."""
        return self.__clock_type

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Return the whole seconds and the remaining nanoseconds."""
        return divmod(self.nanoseconds, S_TO_NS)

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        raise TypeError("cannot pickle 'rclpy._rclpy_pybind11.rcl_time_point_t' object")

    def __copy__(self) -> "Time":
        return Time(nanoseconds=self.nanoseconds, clock_type=self.clock_type)

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self.nanoseconds}, clock_type={self.clock_type.name})"

    def __add__(self, other: Duration) -> "Time":
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return Time(nanoseconds=self.nanoseconds + other.nanoseconds, clock_type=self.clock_type)
        except OverflowError as error:
            raise OverflowError("Addition leads to overflow in C storage.") from error

    __radd__ = __add__

    @overload
    def __sub__(self, other: "Time") -> Duration: ...
    @overload
    def __sub__(self, other: Duration) -> "Time": ...
    def __sub__(self, other: "Time | Duration") -> "Time | Duration":
        if isinstance(other, Time):
            self.__require_same_clock(other, "subtract")
            return Duration(nanoseconds=self.nanoseconds - other.nanoseconds)
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return Time(nanoseconds=self.nanoseconds - other.nanoseconds, clock_type=self.clock_type)
        except ValueError as error:
            raise ValueError("Subtraction leads to negative time.") from error

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Time):
            return NotImplemented
        self.__require_same_clock(other, "compare")
        return self.nanoseconds == other.nanoseconds

    def __lt__(self, other: object) -> bool:
        if not isinstance(other, Time):
            return NotImplemented
        self.__require_same_clock(other, "compare")
        return self.nanoseconds < other.nanoseconds

    def to_msg(self) -> builtin_interfaces.msg.Time:
        """Convert the time to a message."""
        seconds, nanoseconds = self.seconds_nanoseconds()
        return builtin_interfaces.msg.Time(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(
        cls,
        msg: builtin_interfaces.msg.Time,
        clock_type: ClockType = ClockType.ROS_TIME,
    ) -> "Time":
        """Create a time from a message. The default clock type is ROS_TIME, unlike in `Time()`."""
        if not isinstance(msg, builtin_interfaces.msg.Time):
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)

    def __require_same_clock(self, other: "Time", verb: str) -> None:
        if self.clock_type != other.clock_type:
            raise TypeError(f"Can't {verb} times with different clock types")
