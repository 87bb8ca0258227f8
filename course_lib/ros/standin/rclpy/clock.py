"""Clocks; all of them show robot time."""

from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from rclpy.clock_type import ClockType as ClockType
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.time import Time
from rclpy.utilities import get_default_context


class Clock:
    """A clock of one kind; `Clock(clock_type=ClockType.ROS_TIME)` is a ROSClock."""

    clock_type: ClockType

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> "Clock":
        """Create a clock of the requested kind."""
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        clock = super().__new__(ROSClock if clock_type is ClockType.ROS_TIME else cls)
        clock.clock_type = clock_type
        return clock

    def __repr__(self) -> str:
        return f"Clock(clock_type={self.clock_type.name})"

    def now(self) -> Time:
        """Return the time that it is."""
        baton.poll()
        return Time(nanoseconds=current_graph().now_ns, clock_type=self.clock_type)

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until a time of this clock; False when a shutdown or the end of the run came first."""
        context = context or get_default_context()
        if not context.is_valid:
            raise NotInitializedException
        if until.clock_type != self.clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        what = f"{self!r}.sleep_until"
        with baton.known():
            baton.wait(lambda: not context.is_valid, until_ns=until.nanoseconds, what=what)
        return context.is_valid and current_graph().now_ns >= until.nanoseconds

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a span; otherwise as `sleep_until`."""
        return self.sleep_until(self.now() + rel_time, context)


class ROSClock(Clock):
    """The clock of nodes."""

    def __new__(cls) -> "ROSClock":
        """Create a clock that shows ROS time."""
        clock = super().__new__(cls, clock_type=ClockType.ROS_TIME)
        assert isinstance(clock, ROSClock)
        return clock

    @property
    def ros_time_is_active(self) -> bool:
        """False: here every clock shows the run's own time, not that of the topic /clock."""
        return False
