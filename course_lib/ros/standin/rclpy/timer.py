"""Timers, and rates, which are based on timers."""

import threading
from collections.abc import Callable

from course_lib.ros.graph.graph import Alarm
from course_lib.ros.mistakes import Mistake, marked
from course_lib.ros.notices import print_notice
from course_lib.ros.time.time_lock import DeadlockError, time_lock
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock, ClockChange, ClockType, JumpHandle, JumpThreshold, TimeJump
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.exceptions import InvalidHandle, ROSInterruptException
from rclpy.impl.implementation_singleton import INVALID_CONTEXT, RCLError
from rclpy.impl.node_handle import Entity, NodeHandle, require_bool

# rcl stores periods as signed 64-bit nanoseconds.
_LONGEST_NS = 2**63 - 1
# A period of 0 means "as fast as possible". Callbacks take no robot time, so time needs a minimal
# step.
SHORTEST_NS = 1_000_000
# Time after which a sleeping rate checks whether anything spins its node.
_OVERDUE_NS = 1_000_000_000
_ANY_JUMP = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1))


class Timer(Entity):
    """A callback that runs once per period, first after one full period; created by `Node.create_timer`.

    Late calls keep their phase, missed calls are skipped (rcl/src/rcl/timer.c). With `use_sim_time`
    a timer is due when its clock jumps to the time of its next call or beyond it.
    """

    _course_mistake = Mistake.TIMER_CALLBACK

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
        if abs(timer_period_ns) > _LONGEST_NS:
            raise TypeError("__init__(): incompatible constructor arguments.")
        require_bool(autostart)
        if timer_period_ns < 0:
            raise RCLError("failed to create timer: timer period must be non-negative")
        if not node.context.is_valid:
            raise RCLError(f"failed to create timer: {INVALID_CONTEXT}")
        super().__init__(node, callback_group)
        self.callback = callback
        self._clock = clock
        self.__period_ns = timer_period_ns
        self.__graph = node.graph
        self.__last_ns = clock.handle.now_ns
        self.__alarm: Alarm | None = None
        # Whether a call is due that no executor has executed yet.
        self._course_is_due = False
        self.__canceled = not autostart
        self.__hinted = False
        self._course_is_destroyed = False
        self.__next_ns = clock.handle.now_ns + timer_period_ns
        # Time until the next call, measured before a jump; 0 if the clock showed no time yet.
        self.__left_ns = 0
        # The part of the remaining time that is kept when the clock's time source changes.
        self.__credit_ns = 0
        self.__jumps: JumpHandle | None = None
        if clock.clock_type is ClockType.ROS_TIME:
            self.__jumps = clock.create_jump_callback(
                _ANY_JUMP, pre_callback=self.__before_jump, post_callback=self.__after_jump
            )
        if autostart:
            self.__arm()
            self._course_node.record_work()

    @property
    def clock(self) -> Clock:
        """The clock that the timer follows."""
        return self._clock

    @property
    def timer_period_ns(self) -> int:
        """The period, [ns]. A new period applies after the next call."""
        return self.__require().__period_ns

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        self.__require().__period_ns = int(value)

    def _course_take(self) -> Callable[[], object] | None:
        """Return the callback if it is due, and schedule the next call in phase."""
        if not self._course_is_due:
            return None
        self._course_is_due = False
        now_ns = self.__last_ns = self.clock.handle.now_ns
        self.__next_ns += self.__period_ns
        if self.__next_ns <= now_ns:
            late_ns = now_ns - self.__next_ns
            missed = 1 + late_ns // self.__period_ns if self.__period_ns else 0
            self.__next_ns = self.__next_ns + missed * self.__period_ns if missed else now_ns
        self.__arm()
        if self.callback is None:
            raise marked(TypeError("'NoneType' object is not callable"), Mistake.NO_CALLBACK)
        return self.callback

    def _course_record_time_taken(self, span_ns: int) -> None:
        """Print a hint, once, if the callback took at least one period."""
        if self.__hinted or not 0 < self.__period_ns <= span_ns:
            return
        self.__hinted = True
        took, period = f"{span_ns * 1e-9:g} s", f"{self.__period_ns * 1e-9:g} s"
        name = f"{getattr(self.callback, '__name__', 'the callback')} of {self._course_node.full_name}"
        print_notice(
            f"hint: {name} took {took}, and its timer's period is {period}: it is always late, "
            "and callbacks in the same thread wait. Return at once, without time.sleep; the timer "
            "calls again."
        )

    def cancel(self) -> None:
        """Stop the timer until `reset`."""
        self.__require()
        self.__canceled = True
        self.__disarm()

    def reset(self) -> None:
        """Start a full period now, even after `cancel`."""
        self.__require()
        self.__disarm()
        self.__canceled = False
        self.__next_ns = self.clock.handle.now_ns + self.__period_ns
        self.__arm()

    def is_canceled(self) -> bool:
        """Return whether the timer is cancelled."""
        return self.__require().__canceled

    def is_ready(self) -> bool:
        """Return whether a call is due."""
        remaining_ns = self.time_until_next_call()
        return remaining_ns is not None and remaining_ns <= 0

    def time_since_last_call(self) -> int:
        """Return the time since the last call, or since the creation of the timer, [ns]."""
        return self.__require().clock.handle.now_ns - self.__last_ns

    def time_until_next_call(self) -> int | None:
        """Return the time until the next call, [ns]: negative if late, None if cancelled."""
        self.__require()
        return None if self.__canceled else self.__next_ns - self.clock.handle.now_ns

    def destroy(self) -> None:
        """Stop permanently. Call `Node.destroy_timer` instead."""
        self._course_is_destroyed = True
        self.__disarm()
        if self.__jumps is not None:
            self.__jumps.unregister()

    def __require(self) -> "Timer":
        if self._course_is_destroyed:
            raise InvalidHandle
        return self

    def __before_jump(self) -> None:
        """Store the time until the next call, which is kept if the time source changes."""
        now_ns = self.clock.handle.now_ns
        self.__left_ns = self.__next_ns - now_ns if now_ns else 0

    def __after_jump(self, jump: TimeJump) -> None:
        """Move the next call as rcl does, then become ready or wait."""
        now_ns = self.clock.handle.now_ns
        if jump.clock_change is not ClockChange.ROS_TIME_NO_CHANGE:
            self.__credit_ns = self.__left_ns or self.__credit_ns
            if now_ns and self.__credit_ns:
                self.__last_ns, self.__credit_ns = now_ns - self.__credit_ns, 0
                self.__next_ns = self.__last_ns + self.__period_ns
        elif now_ns < self.__next_ns and now_ns < self.__last_ns:
            self.__next_ns, self.__last_ns = now_ns + self.__period_ns, now_ns
        if self.__period_ns and not self.__canceled:
            self.__arm()

    def __arm(self) -> None:
        """Schedule the next call. A clock that follows /clock reaches its time by a jump."""
        if self.__alarm is not None:
            self.__alarm.cancel()
        if not self.clock.handle.is_overridden or not self.__period_ns:
            due_ns = self.__next_ns if self.__period_ns else self.__graph.now_ns + SHORTEST_NS
            self.__alarm = self.__graph.call_at(
                due_ns, self.__ring, node=self._course_node.id, entity=self._course_entity
            )
        elif self.__next_ns <= self.clock.handle.now_ns:
            self.__ring()
        else:
            self._course_is_due = False

    def __disarm(self) -> None:
        self._course_is_due = False
        if self.__alarm is not None:
            self.__alarm.cancel()

    def __ring(self) -> None:
        if not self._course_is_due:
            self._course_is_due = True
            self._course_node.mark_ready(self)


class Rate:
    """Sleeps such that a loop keeps a frequency; created by `Node.create_rate`.

    Another thread must spin the node, because the rate's timer needs an executor like any other.
    """

    def __init__(self, timer: Timer, *, context: Context) -> None:
        self._timer = timer
        self.__context = context
        # Behaves like a threading.Event: a tick before `sleep` ends it immediately, so that a loop
        # which spins the node and sleeps in the same thread continues.
        self.__has_ticked = False
        self.__sleepers = 0
        self.__has_reminded = False
        self._is_destroyed = False
        timer.callback = self.__tick

    def sleep(self) -> None:
        """Block until the next tick.

        Raise ROSInterruptException if the context is shut down during the sleep.
        """
        if self._is_destroyed:
            raise RuntimeError("Rate cannot sleep because it has been destroyed")
        if self._timer._course_is_destroyed:
            raise InvalidHandle("Rate cannot sleep because the timer has been destroyed")
        executor = self._timer._course_node.executor
        if not self.__has_ticked and executor is not None and executor._course_holds_up(self._timer):
            raise DeadlockError(
                "Rate.sleep() waits for a tick that comes only after this callback has ended. Use "
                "a timer, or a MultiThreadedExecutor."
            )

        def wakes() -> bool:
            is_over = self._is_destroyed or self._timer._course_is_destroyed or self.__context.is_shut_down
            return is_over or self.__has_ticked

        awaited = "a rate's next tick, for which another thread has to spin the node"
        node, sleeper = self._timer._course_node, threading.get_ident()
        overdue_ns = node.graph.now_ns + 2 * self._timer.timer_period_ns + _OVERDUE_NS
        reminder = node.graph.call_at(
            overdue_ns, lambda: self.__remind(sleeper), node=node.id, entity=self._timer._course_entity
        )
        self.__sleepers += 1
        try:
            with time_lock.hold():
                time_lock.wait(wakes, until_ns=None, awaited=awaited)
        except KeyboardInterrupt:
            self.__remind(sleeper)
            raise
        finally:
            reminder.cancel()
            self.__sleepers -= 1
            if not self.__sleepers:
                self.__has_ticked = False
        if not self.__context.is_valid or time_lock.is_shut_down():
            raise ROSInterruptException

    def __remind(self, sleeper: int) -> None:
        """Print a hint once, with the line of a thread that sleeps while no thread spins the node."""
        from course_lib.ros.tracebacks import line_of_thread

        node = self._timer._course_node
        is_spun = node.executor is not None and node.executor._course_runs(node)
        if self.__has_reminded or is_spun or not self._timer._course_is_due:
            return
        self.__has_reminded = True
        print_notice(
            f"hint: {line_of_thread(sleeper).rstrip(':') or 'Rate.sleep()'}: the tick does not "
            f"come, as no thread spins {node.full_name}. Spin it in a thread: "
            "threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start(). Or use a "
            "timer, without a rate."
        )

    def destroy(self) -> None:
        """Wake the sleeping threads and reject further sleeps."""
        self._is_destroyed = True

    def __tick(self) -> None:
        self.__has_ticked = True
