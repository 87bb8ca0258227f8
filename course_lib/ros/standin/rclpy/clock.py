"""Clocks: all show robot time, unless a time source overrides that of a ROSClock."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from enum import IntEnum

from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from rclpy.clock_type import ClockType as ClockType
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.time import Time
from rclpy.utilities import get_default_context


class ClockChange(IntEnum):
    """The source of a clock's time before and after a jump."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class JumpThreshold:
    """The jumps of a clock that are reported.

    Args:
        min_forward: The shortest jump forwards, positive; None reports none.
        min_backward: The shortest jump backwards, negative; None reports none.
        on_clock_change: Whether ROS time's activation and deactivation are reported.
    """

    def __init__(
        self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True
    ) -> None:
        if min_forward is not None and min_forward.nanoseconds <= 0:
            raise ValueError("min_forward must be a positive non-zero duration")
        if min_backward is not None and min_backward.nanoseconds >= 0:
            raise ValueError("min_backward must be a negative non-zero duration")
        if min_forward is None and min_backward is None and not on_clock_change:
            raise ValueError("At least one jump threshold must be enabled")
        self.min_forward = min_forward
        self.min_backward = min_backward
        self.on_clock_change = on_clock_change


class TimeJump:
    """A jump of a clock: the change of its source, and the time that it moved by."""

    def __init__(self, clock_change: ClockChange, delta: Duration) -> None:
        if not isinstance(clock_change, ClockChange):
            raise TypeError("clock_change must be an instance of rclpy.clock.ClockChange")
        self._clock_change = clock_change
        self._delta = delta

    @property
    def clock_change(self) -> ClockChange:
        """The change of the clock's source."""
        return self._clock_change

    @property
    def delta(self) -> Duration:
        """The time that the clock moved by; negative backwards, zero at a change of its source."""
        return self._delta

    def exceeds(self, threshold: JumpThreshold) -> bool:
        """Return whether a threshold wants the jump reported."""
        forward, backward = threshold.min_forward, threshold.min_backward
        changes = self._clock_change in (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED)
        return (
            (changes and threshold.on_clock_change)
            or (forward is not None and self._delta >= forward)
            or (backward is not None and self._delta <= backward)
        )


class JumpHandle(AbstractContextManager["JumpHandle"]):
    """The callbacks before and after a clock's jumps; made by `Clock.create_jump_callback`."""

    def __init__(
        self,
        *,
        clock: "Clock",
        threshold: JumpThreshold,
        pre_callback: Callable[[], object] | None,
        post_callback: Callable[[TimeJump], object] | None,
    ) -> None:
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        for name, callback in (("pre_callback", pre_callback), ("post_callback", post_callback)):
            if callback is not None and not callable(callback):
                raise ValueError(f"{name} must be callable if given")
        self.threshold = threshold
        self.before = pre_callback or (lambda: None)
        self.after = post_callback or (lambda jump: None)
        self._clock: Clock | None = clock
        clock.handle.jump_handles.append(self)

    def unregister(self) -> None:
        """Call back no more."""
        if self._clock is not None:
            self._clock.handle.jump_handles.remove(self)
            self._clock = None

    def __exit__(self, *_: object) -> None:
        self.unregister()


class ClockHandle:
    """The state of a clock: the override of ROS time, and the callbacks of its jumps (rcl/src/rcl/time.c)."""

    def __init__(self) -> None:
        self.is_overridden = False
        self.override_ns = 0  # 0 until a time was set
        self.jump_handles: list[JumpHandle] = []

    @property
    def now_ns(self) -> int:
        """The time that the clock shows, [ns]."""
        return self.override_ns if self.is_overridden else current_graph().now_ns

    def activate(self, enabled: bool) -> None:
        """Show the override's time, or robot time."""
        if self.is_overridden != enabled:
            change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
            self._jump(TimeJump(change, Duration()), enabled, self.override_ns)

    def override(self, now_ns: int) -> None:
        """Set the override's time, [ns]."""
        if self.is_overridden:
            delta = Duration(nanoseconds=now_ns - self.override_ns)
            self._jump(TimeJump(ClockChange.ROS_TIME_NO_CHANGE, delta), True, now_ns)
        else:
            self.override_ns = now_ns

    def _jump(self, jump: TimeJump, overridden: bool, now_ns: int) -> None:
        """Set the time between its callbacks; one that raises prevents those after it, not the jump."""
        concerned = [one for one in self.jump_handles if jump.exceeds(one.threshold)]
        try:
            for one in concerned:
                one.before()
        finally:
            self.is_overridden, self.override_ns = overridden, now_ns
        for one in concerned:
            one.after(jump)


class _Sleep:
    """A sleep until a time of a clock, [ns], which jumps of the clock can end."""

    def __init__(self, clock: ClockHandle, until_ns: int) -> None:
        self._clock = clock
        self._until_ns = until_ns
        self.changed = False  # the source of the clock's time: the span has lost its meaning
        self.is_over = False

    def note(self, jump: TimeJump) -> None:
        """End at the time, or at a change of the source."""
        self.changed |= jump.clock_change is not ClockChange.ROS_TIME_NO_CHANGE
        self.is_over = self.changed or self._clock.now_ns >= self._until_ns


_WAKES = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=None)


class Clock:
    """A clock of one kind; `Clock(clock_type=ClockType.ROS_TIME)` is a ROSClock."""

    clock_type: ClockType
    handle: ClockHandle

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> "Clock":
        """Create a clock of the requested kind."""
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        clock = super().__new__(ROSClock if clock_type is ClockType.ROS_TIME else cls)
        clock.clock_type = clock_type
        clock.handle = ClockHandle()
        return clock

    def __repr__(self) -> str:
        return f"Clock(clock_type={self.clock_type.name})"

    def now(self) -> Time:
        """Return the time that it is."""
        baton.poll()
        return Time(nanoseconds=self.handle.now_ns, clock_type=self.clock_type)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], object] | None = None,
        post_callback: Callable[[TimeJump], object] | None = None,
    ) -> JumpHandle:
        """Call back before and after the jumps that exceed a threshold, until the handle is unregistered."""
        return JumpHandle(
            clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=post_callback
        )

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until a time of this clock; False when something else came first.

        That is a shutdown, the end of the run, or ROS time's activation or deactivation. Overridden ROS
        time wakes a sleeper when it moves; as in rclpy also one whose time had come before.
        """
        context = context or get_default_context()
        if not context.is_valid:
            raise NotInitializedException
        if until.clock_type != self.clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        sleep, overridden = _Sleep(self.handle, until.nanoseconds), self.handle.is_overridden
        what = f"{self!r}.sleep_until{', which follows /clock' if overridden else ''}"
        with baton.known(), self.create_jump_callback(_WAKES, post_callback=sleep.note):
            baton.wait(
                lambda: sleep.is_over or not context.is_valid,
                until_ns=None if overridden else until.nanoseconds,
                what=what,
            )
        return context.is_valid and not sleep.changed and self.handle.now_ns >= until.nanoseconds

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a span; otherwise as `sleep_until`."""
        return self.sleep_until(self.now() + rel_time, context)


class ROSClock(Clock):
    """The clock of nodes; a TimeSource makes it follow the topic /clock."""

    def __new__(cls) -> "ROSClock":
        """Create a clock that shows ROS time."""
        clock = super().__new__(cls, clock_type=ClockType.ROS_TIME)
        assert isinstance(clock, ROSClock)
        return clock

    @property
    def ros_time_is_active(self) -> bool:
        """True while the clock shows the time that was set, like that of /clock, not robot time."""
        return self.handle.is_overridden

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        """Show the time that was set, or robot time; only time sources call it."""
        self.handle.activate(enabled)

    def set_ros_time_override(self, time: Time) -> None:
        """Set the time that the clock shows while ROS time is active."""
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        self.handle.override(time.nanoseconds)
