"""Clocks. They show robot time, except a ROSClock whose time is overridden by a time source."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from enum import IntEnum

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.time_lock import time_lock
from rclpy.context import Context, get_default_context, require_context
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.time import ClockType as ClockType
from rclpy.time import Time


class ClockChange(IntEnum):
    """The change of a clock's time source at a jump."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4

    def __str__(self) -> str:
        return f"ClockChange.{self.name}"


class JumpThreshold:
    """The jumps of a clock that are reported to a callback.

    Args:
        min_forward: The shortest reported jump forwards, positive; None: forward jumps are not
            reported.
        min_backward: The shortest reported jump backwards, negative; None: backward jumps are not
            reported.
        on_clock_change: Whether activation and deactivation of ROS time are reported.
    """

    def __init__(
        self,
        *,
        min_forward: Duration | None,
        min_backward: Duration | None,
        on_clock_change: bool = True,
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
    """A jump of a clock: the change of its time source and the difference in time."""

    def __init__(self, clock_change: ClockChange, delta: Duration) -> None:
        if not isinstance(clock_change, ClockChange):
            raise TypeError("clock_change must be an instance of rclpy.clock.ClockChange")
        self._clock_change = clock_change
        self._delta = delta

    @property
    def clock_change(self) -> ClockChange:
        """The change of the clock's time source."""
        return self._clock_change

    @property
    def delta(self) -> Duration:
        """The difference in time: negative for a jump back, zero at a change of the time source."""
        return self._delta

    def exceeds(self, handle: "JumpHandle") -> bool:
        """Return whether the jump has to be reported according to the threshold of a handle."""
        forward, backward = handle.limits
        changes = self._clock_change in (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED)
        return (
            (changes and handle.on_clock_change)
            or (forward is not None and self._delta >= forward)
            or (backward is not None and self._delta <= backward)
        )


class JumpHandle(AbstractContextManager["JumpHandle"]):
    """The callbacks before and after a clock's jumps, created by `Clock.create_jump_callback`."""

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
        self.limits = threshold.min_forward, threshold.min_backward
        self.on_clock_change = threshold.on_clock_change
        self.before = pre_callback or (lambda: None)
        self.after = post_callback or (lambda jump: None)
        self._clock: Clock | None = clock
        clock.handle.jump_handles.append(self)

    def unregister(self) -> None:
        """Unregister the callbacks."""
        if self._clock is not None:
            self._clock.handle.jump_handles.remove(self)
            self._clock = None

    def __exit__(self, *_: object) -> None:
        self.unregister()


@dataclass(eq=False, repr=False)
class ClockHandle:
    """A clock's state: the override of ROS time and its jump callbacks (rcl/src/rcl/time.c)."""

    is_overridden: bool = False
    # The override's time; 0 until one is set.
    override_ns: int = 0
    jump_handles: list[JumpHandle] = field(default_factory=list)

    @property
    def now_ns(self) -> int:
        """The current time of the clock, [ns]."""
        return self.override_ns if self.is_overridden else current_graph().now_ns

    def activate(self, enabled: bool) -> None:
        """Switch to the override's time if `enabled`, or back to robot time."""
        if self.is_overridden != enabled:
            change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
            self._jump(TimeJump(change, Duration()), enabled, self.override_ns)

    def override(self, now_ns: int) -> None:
        """Set the time of the override, [ns]."""
        if self.is_overridden:
            delta = Duration(nanoseconds=now_ns - self.override_ns)
            self._jump(TimeJump(ClockChange.ROS_TIME_NO_CHANGE, delta), True, now_ns)
        else:
            self.override_ns = now_ns

    def _jump(self, jump: TimeJump, overridden: bool, now_ns: int) -> None:
        """Change the time, with the jump callbacks before and after.

        A callback that raises prevents the callbacks after it, but not the jump.
        """
        concerned = [handle for handle in self.jump_handles if jump.exceeds(handle)]
        try:
            for handle in concerned:
                handle.before()
        finally:
            self.is_overridden, self.override_ns = overridden, now_ns
        for handle in concerned:
            handle.after(jump)


_WAKES = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=None)


class Clock:
    """A clock of one type. `Clock(clock_type=ClockType.ROS_TIME)` returns a ROSClock."""

    _clock_type: ClockType
    handle: ClockHandle

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> "Clock":
        """Create a clock of the requested type."""
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        clock = super().__new__(ROSClock if clock_type is ClockType.ROS_TIME else cls)
        clock._clock_type = clock_type
        clock.handle = ClockHandle()
        return clock

    @property
    def clock_type(self) -> ClockType:
        """The type of the clock."""
        return self._clock_type

    def __repr__(self) -> str:
        return f"Clock(clock_type={self.clock_type.name})"

    def now(self) -> Time:
        """Return the current time."""
        time_lock.poll()
        return Time(nanoseconds=self.handle.now_ns, clock_type=self.clock_type)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], object] | None = None,
        post_callback: Callable[[TimeJump], object] | None = None,
    ) -> JumpHandle:
        """Register callbacks for jumps beyond a threshold, until the handle is unregistered."""
        # As in rclpy, an object that cannot be called is ignored as `post_callback`.
        after = post_callback if callable(post_callback) else None
        return JumpHandle(clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=after)

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until a time of this clock. Return False if the sleep ended earlier.

        It ends earlier at a shutdown, at the end of the run, and at the activation or deactivation
        of ROS time. While ROS time is overridden, only a jump wakes the sleeper, even if `until`
        has already passed, as in rclpy.
        """
        context = get_default_context() if context is None else context
        require_context(context, "ok")
        if not context.is_valid:
            raise NotInitializedException
        if until.clock_type != self.clock_type:
            raise ValueError("until's clock type does not match this clock's type")
        overridden, is_over = self.handle.is_overridden, False
        # Whether the clock's time source has changed, after which the deadline has no meaning.
        has_changed = False

        def on_jump(jump: TimeJump) -> None:
            """End the sleep if its deadline has passed or the clock's time source has changed."""
            nonlocal has_changed, is_over
            has_changed |= jump.clock_change is not ClockChange.ROS_TIME_NO_CHANGE
            is_over = has_changed or self.handle.now_ns >= until.nanoseconds

        awaited = f"{self!r}.sleep_until{', which follows /clock' if overridden else ''}"
        with time_lock.hold(), self.create_jump_callback(_WAKES, post_callback=on_jump):
            time_lock.wait(
                lambda: is_over or context.is_shut_down,
                until_ns=None if overridden else until.nanoseconds,
                awaited=awaited,
            )
        return context.is_valid and not has_changed and self.handle.now_ns >= until.nanoseconds

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a duration; otherwise like `sleep_until`."""
        return self.sleep_until(self.now() + rel_time, context)


class ROSClock(Clock):
    """The type of a node's clock. A TimeSource makes it follow the topic /clock."""

    def __new__(cls) -> "ROSClock":
        """Create a clock that shows ROS time."""
        clock = super().__new__(cls, clock_type=ClockType.ROS_TIME)
        assert isinstance(clock, ROSClock)
        return clock

    @property
    def ros_time_is_active(self) -> bool:
        """True while the clock shows an override, such as /clock, instead of robot time."""
        return self.handle.is_overridden

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        """Switch between the override's time and robot time. Only time sources call this."""
        self.handle.activate(enabled)

    def set_ros_time_override(self, time: Time) -> None:
        """Set the time that the clock shows while ROS time is active."""
        if not isinstance(time, Time):
            raise TypeError(f"Time must be specified as rclpy.time.Time. Received type: {type(time)}")
        self.handle.override(time.nanoseconds)
