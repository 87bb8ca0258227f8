"""Timers, and the rates that are made of them."""

from collections.abc import Callable

from course_lib.ros.baton import DeadlockError, baton
from course_lib.ros.clock import Alarm
from course_lib.ros.mistakes import Mistake, marked
from course_lib.ros.notices import say
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock, ClockChange, ClockType, JumpHandle, JumpThreshold, TimeJump
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import InvalidHandle, RCLError, ROSInterruptException
from rclpy.impl.node_handle import Entity, NodeHandle

SHORTEST_NS = 1_000_000  # [ns] a period of 0 means "as fast as possible"; callbacks take no robot time
_ANY_JUMP = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))


class Timer(Entity):
    """A callback once per period, first after one full period; made by `Node.create_timer`.

    Calls that are late keep their phase, calls that are missed are skipped (rcl/src/rcl/timer.c). Under
    `use_sim_time` a timer is due when its clock has jumped to the time of its call, or past it.
    """

    mistake = Mistake.TIMER_CALLBACK

    def __init__(
        self,
        node: NodeHandle,
        callback: Callable[[], object] | None,
        callback_group: CallbackGroup,
        timer_period_ns: int,
        clock: Clock,
        *,
        autostart: bool = True,
    ) -> None:
        if timer_period_ns < 0:
            raise RCLError("failed to create timer: timer period must be non-negative")
        super().__init__(node, callback_group)
        self.callback = callback
        self.clock = clock
        self.timer_period_ns = timer_period_ns
        self._graph = node.graph
        self._last_ns = clock.handle.now_ns
        self._alarm: Alarm | None = None
        self._due = False  # it has become ready and was not taken yet
        self._canceled = not autostart
        self._hinted = False
        self.is_destroyed = False
        self._next_ns = clock.handle.now_ns + timer_period_ns
        self._left_ns = 0  # until the next call, before a jump; 0 if the clock showed no time yet
        self._credit_ns = 0  # of that, what counts when the clock gets another source of time
        self._jumps: JumpHandle | None = None
        if clock.clock_type is ClockType.ROS_TIME:
            self._jumps = clock.create_jump_callback(
                _ANY_JUMP, pre_callback=self._before_jump, post_callback=self._after_jump
            )
        if autostart:
            self._arm()

    def take(self) -> Callable[[], object] | None:
        """Return the callback if its time has come, and schedule the next call, in phase."""
        if not self._due:
            return None
        self._due = False
        now_ns = self._last_ns = self.clock.handle.now_ns
        self._next_ns += self.timer_period_ns
        if self._next_ns <= now_ns:
            late_ns = now_ns - self._next_ns
            missed = 1 + late_ns // self.timer_period_ns if self.timer_period_ns else 0
            self._next_ns = self._next_ns + missed * self.timer_period_ns if missed else now_ns
        self._arm()
        if self.callback is None:
            raise marked(TypeError("'NoneType' object is not callable"), Mistake.NO_CALLBACK)
        return self.callback

    def note_time_taken(self, span_ns: int) -> None:
        """Print a hint, once, if the callback took a whole period or more."""
        if self._hinted or not 0 < self.timer_period_ns <= span_ns:
            return
        self._hinted = True
        took, period = f"{span_ns * 1e-9:g} s", f"{self.timer_period_ns * 1e-9:g} s"
        name = f"{getattr(self.callback, '__name__', 'the callback')} of {self.node_handle.full_name}"
        say(
            f"hint: {name} took {took}, and its timer's period is {period}: the node is always late, and its "
            "other callbacks wait. Return at once, without time.sleep; the timer calls again."
        )

    def cancel(self) -> None:
        """Stop calling back, until `reset`."""
        self._require()
        self._canceled = True
        self._disarm()

    def reset(self) -> None:
        """Begin a full period now, also after `cancel`."""
        self._require()
        self._disarm()
        self._canceled = False
        self._next_ns = self.clock.handle.now_ns + self.timer_period_ns
        self._arm()

    def is_canceled(self) -> bool:
        """Return whether it was cancelled."""
        return self._require()._canceled

    def is_ready(self) -> bool:
        """Return whether a call is due."""
        remaining_ns = self.time_until_next_call()
        return remaining_ns is not None and remaining_ns <= 0

    def time_since_last_call(self) -> int:
        """Return the time since the last call, or since its making, [ns]."""
        return self._require().clock.handle.now_ns - self._last_ns

    def time_until_next_call(self) -> int | None:
        """Return the time until the next call, [ns], negative if it is late; None if it was cancelled."""
        self._require()
        return None if self._canceled else self._next_ns - self.clock.handle.now_ns

    def destroy(self) -> None:
        """Stop for good; call `Node.destroy_timer` instead."""
        self.is_destroyed = True
        self._disarm()
        if self._jumps is not None:
            self._jumps.unregister()

    def _require(self) -> "Timer":
        if self.is_destroyed:
            raise InvalidHandle
        return self

    def _before_jump(self) -> None:
        """Note the time until the next call: it counts on in the time of another source."""
        now_ns = self.clock.handle.now_ns
        self._left_ns = self._next_ns - now_ns if now_ns else 0

    def _after_jump(self, jump: TimeJump) -> None:
        """Move the next call as rcl does, then become due, or wait."""
        now_ns = self.clock.handle.now_ns
        if jump.clock_change is not ClockChange.ROS_TIME_NO_CHANGE:
            self._credit_ns = self._left_ns or self._credit_ns
            if now_ns and self._credit_ns:
                self._last_ns, self._credit_ns = now_ns - self._credit_ns, 0
                self._next_ns = self._last_ns + self.timer_period_ns
        elif now_ns < self._next_ns and now_ns < self._last_ns:
            self._next_ns, self._last_ns = now_ns + self.timer_period_ns, now_ns
        if self.timer_period_ns and not self._canceled:
            self._arm()

    def _arm(self) -> None:
        """Become due at the time of the next call; a clock that follows /clock comes there by a jump."""
        if self._alarm is not None:
            self._alarm.cancel()
        if not self.clock.handle.is_overridden or not self.timer_period_ns:
            due_ns = self._next_ns if self.timer_period_ns else self._graph.now_ns + SHORTEST_NS
            self._alarm = self._graph.call_at(
                due_ns, self._ring, node=self.node_handle.id, entity=self.entity
            )
        elif self._next_ns <= self.clock.handle.now_ns:
            self._ring()
        else:
            self._due = False

    def _disarm(self) -> None:
        self._due = False
        if self._alarm is not None:
            self._alarm.cancel()

    def _ring(self) -> None:
        if not self._due:
            self._due = True
            self.node_handle.mark_ready(self)


class Rate:
    """A sleep with which a loop keeps a frequency; made by `Node.create_rate`.

    Another thread must spin the node: the rate's timer is a callback like any other.
    """

    def __init__(self, timer: Timer, *, context: Context) -> None:
        self.timer = timer
        self._context = context
        self._ticks = 0
        self._destroyed = False
        timer.callback = self._tick

    def sleep(self) -> None:
        """Block until the next tick; raises ROSInterruptException if the context is shut down meanwhile."""
        if self._destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        if self.timer.is_destroyed:
            raise InvalidHandle("Rate cannot sleep because the timer has been destroyed")
        executor = self.timer.node_handle.executor
        if executor is not None and executor.is_held_up(self.timer):
            raise DeadlockError(
                "Rate.sleep() waits for a tick that comes only after this callback has ended. Use a timer, "
                "or a MultiThreadedExecutor."
            )
        ticks = self._ticks

        def wakes() -> bool:
            ended = self._destroyed or self.timer.is_destroyed or not self._context.is_valid
            return ended or self._ticks > ticks

        what = "a rate's next tick, for which another thread has to spin the node"
        with baton.known():
            baton.wait(wakes, until_ns=None, what=what)
        if not self._context.is_valid or baton.is_shut_down():
            raise ROSInterruptException

    def destroy(self) -> None:
        """Wake the thread that sleeps in it, and refuse further sleeps."""
        self._destroyed = True

    def _tick(self) -> None:
        self._ticks += 1
