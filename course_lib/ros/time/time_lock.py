"""The time lock, which lets one program thread run at a time and decides when robot time advances.

With the operating system's scheduler, two runs of a program with threads would differ, and robot
time could not know whether a thread still computes or waits for it. So all threads of a program
share this lock. A thread passes it on only in a wait (`TimeLock.wait`): a sleep, a spin, a lock, a
join. The next holder is the next thread, in the order of creation, whose condition holds. If there
is none, the waiting thread runs the graph's next event, which advances robot time. So a run depends
on the program alone and repeats exactly.

Ordinary threads, for example a notebook's, hold the lock during calls of the kit only.
"""

import _thread
import itertools
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum, auto
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import THREADS, Graph, current_graph
from course_lib.ros.notices import print_notice

# Waits that return immediately after the end of a run, before the thread is ended.
WAITS_AFTER_THE_END = 200
# The same for waits with a timeout, during which robot time does not advance.
SLEEPS_AFTER_THE_END = 100


class EndBehavior(Enum):
    """The effect of the end of a run on a waiting thread."""

    # For cells, tests and tools: the wait returns.
    RETURN = auto()
    # For the main thread of a program: the wait raises KeyboardInterrupt, once.
    INTERRUPT = auto()
    # For other threads of a program: the wait returns, but only once if it has a timeout.
    SHUT_DOWN = auto()
    # For callbacks in their own threads: the thread ends.
    STOP = auto()


class ShutDown(Exception):  # noqa: N818 - the base of ROS's exceptions, whose names end otherwise
    """Raised by a call that a shutdown has ended.

    At the end of a run it ends a program silently.
    """


class CtrlC(KeyboardInterrupt):
    """Stands for Ctrl+C sent to a program in a thread, which may have its own handler."""


class StoppedProgram(KeyboardInterrupt):
    """Ends the main thread of a program that continues to wait after the end of the run."""


class StoppedThread(SystemExit):
    """Silently ends another thread that continues to wait after the end of the run."""


def never() -> bool:
    """Return False. The condition of a wait that ends only at its deadline."""
    return False


@dataclass(slots=True, eq=False, repr=False)
class Wait:
    """A wait of a program thread: the condition and deadline that end it, and its description."""

    graph: Graph
    ready: Callable[[], bool]
    awaited: str
    events_help: bool = True
    has_deadline: bool = False
    is_expired: bool = False

    def pass_deadline(self) -> None:
        """Mark the deadline as passed. Called by the event that ends the wait."""
        self.is_expired = True


class ProgramThread:
    """The scheduling state of one program thread.

    Args:
        index: The position in the order.
        name: The name in a DeadlockError.
        main: Whether it is Python's main thread.
        is_ordinary: Whether it is an ordinary thread that belongs to the program during one `with
            time_lock.hold()`.
    """

    def __init__(self, index: int, *, name: str, main: bool, is_ordinary: bool = False) -> None:
        self.index = index
        self.name = name
        self.is_main = main
        self.is_ordinary = is_ordinary
        # Held by the thread while it waits for its turn; released by the thread that passes the
        # time lock to it.
        self.turn = _thread.allocate_lock()
        self.turn.acquire()
        # The innermost wait, or None while the thread is running.
        self.wait: Wait | None = None
        self.depth = 1
        self.polls = 0
        # Describes the condition that the last poll waits for, or returns "" once it is met.
        self.describe_unmet: Callable[[], str] | None = None
        # Whether the thread is in a wait for that condition.
        self.is_polling = False
        self.at_end = EndBehavior.RETURN
        # Signal handlers that the thread's program has set.
        self.handlers: dict[int, Any] = {}
        self.waits_after_end = 0
        self.sleeps_after_end = 0
        self.is_stopped = False
        self.pending_error: BaseException | None = None
        self.is_done = False

    def handle_end(self, *, sleeps: bool) -> None:
        """Handle a wait that the end of the run has ended.

        `sleeps` states whether it has a timeout.
        """
        self.waits_after_end += 1
        self.sleeps_after_end += sleeps
        if self.at_end is EndBehavior.INTERRUPT and self.waits_after_end == 1:
            self.interrupt()
            return
        sleeps_left = 1 if self.at_end is EndBehavior.SHUT_DOWN else SLEEPS_AFTER_THE_END
        if (
            self.at_end is EndBehavior.STOP
            or self.sleeps_after_end > sleeps_left
            or self.waits_after_end > WAITS_AFTER_THE_END
        ):
            # A main thread that catches the interrupt is ended by the next one.
            is_ended = self.is_main or self.at_end is EndBehavior.INTERRUPT
            interrupts = is_ended and not self.is_stopped
            self.is_stopped = True
            raise StoppedProgram if interrupts else StoppedThread

    def interrupt(self) -> None:
        """Interrupt as Ctrl+C does: call the program's handler or raise KeyboardInterrupt."""
        handler = self.handlers.get(signal.SIGINT)
        # rclpy's handler shuts down the contexts and then calls the program's one, if it can be
        # called.
        hidden = hidden_handlers.get(signal.SIGINT)
        is_below_rclpy = hidden is not None and real_getsignal(signal.SIGINT) is hidden.handler
        if callable(handler):
            self.report_interrupted_polling()
            handler(signal.SIGINT, sys._getframe(1))
        elif handler is None or (handler is signal.SIG_DFL and not is_below_rclpy):
            raise KeyboardInterrupt

    def report_interrupted_polling(self) -> None:
        """Print the condition that the thread was polling, if any, once."""
        if self.is_polling and self.describe_unmet is not None:
            # Imported late, as it is needed only at the end of a run.
            from course_lib.ros.tracebacks import describe_interruption

            describe_interruption(self.describe_unmet())
            self.is_polling = False

    def raise_pending(self) -> None:
        """Raise the exception that an interrupt, or another thread, has set for this thread."""
        if self.pending_error is not None:
            error, self.pending_error = self.pending_error, None
            if not isinstance(error, CtrlC):
                raise error
            self.interrupt()

    def waits_in(self, graph: Graph) -> bool:
        """Return whether the thread is waiting in a run."""
        wait = self.wait
        return wait is not None and wait.graph is graph

    def can_run(self, graph: Graph) -> bool:
        """Return whether the thread is waiting in a run and its wait is over."""
        wait = self.wait
        if wait is None or wait.graph is not graph:
            return False
        return wait.is_expired or graph.ended or self.pending_error is not None or wait.ready()


# Number of calls without a wait after which a loop of such calls lets time advance.
POLLS_BEFORE_TIME_PASSES = 1_000
POLLS_PER_STEP = 10
POLL_STEP_NS = 1_000_000  # [ns]
# Interval at which a main thread that waits for its turn checks for signals [s].
LOOK = 0.5
LOOKS_BEFORE_NOTICE = 10
# CPU time of a main thread without a call of the kit after which its line is reported [s].
BUSY_SECONDS = 5.0
# Checks after which the turn is taken from a thread that does not release it.
LOOKS_AFTER_INTERRUPT = 2


class DeadlockError(CourseError):
    """All threads wait for each other, so none of them can ever continue."""


class TimeLock:
    """The right to run, passed between threads in an order that depends only on the program."""

    def __init__(self) -> None:
        # By thread identifier.
        self._threads: dict[int, ProgramThread] = {}
        # Number of polling calls. It survives between calls,
        # because a cell may call the kit in a loop.
        self._polls_in_cells = 0
        self._waiting: list[ProgramThread] = []
        self._holder: ProgramThread | None = None
        # Numbers of threads, ascending by creation.
        self._numbers = itertools.count(1)
        self._mutex = _thread.allocate_lock()
        self._is_signalled = False
        # Called when robot time cannot advance until the main thread calls the kit.
        self.on_stall: Callable[[], object] = lambda: None

    def record_signal(self) -> None:
        """Record a signal that ends the program, which a thread without pauses must not delay."""
        self._is_signalled = True

    def is_program_thread(self, ident: int | None = None) -> bool:
        """Return whether a thread, by default the calling one, is a program thread."""
        return (_thread.get_ident() if ident is None else ident) in self._threads

    def is_held_by_caller(self) -> bool:
        """Return whether the calling thread is a program thread and holds the lock."""
        me = self._threads.get(_thread.get_ident())
        return me is not None and self._holder is me

    def has_waiting_threads(self, graph: Graph) -> bool:
        """Return whether ordinary threads wait for the robot time of a run."""
        return any(thread.is_ordinary and thread.waits_in(graph) for thread in tuple(self._waiting))

    def hold(self) -> "HeldTimeLock":
        """Make the calling thread a program thread that holds the lock, within a `with` block."""
        return HeldTimeLock(self)

    @contextmanager
    def as_ordinary_thread(self) -> Iterator[None]:
        """Run a `with` block of a program thread as an ordinary thread.

        The thread keeps the lock.
        """
        ident = _thread.get_ident()
        me = self._threads.pop(ident, None)
        try:
            yield
        finally:
            if me is not None:
                self._threads[ident] = me

    def new_thread(
        self,
        name: str,
        *,
        main: bool = False,
        is_ordinary: bool = False,
    ) -> ProgramThread:
        """Create a thread's entry in the order of threads."""
        thread = ProgramThread(next(self._numbers), name=name, main=main, is_ordinary=is_ordinary)
        creator = self._threads.get(_thread.get_ident())
        if creator is not None and creator.at_end is not EndBehavior.RETURN:
            thread.at_end = EndBehavior.SHUT_DOWN
        return thread

    @contextmanager
    def at_end(self, at_end: EndBehavior) -> Iterator[None]:
        """Set the effect of the run's end on the calling program thread, within a `with` block."""
        me = self._threads[_thread.get_ident()]
        previous, me.at_end = me.at_end, at_end
        me.waits_after_end = me.sleeps_after_end = 0
        me.handlers = {}
        try:
            yield
        finally:
            me.at_end = previous
            me.handlers = {}

    def handlers(self) -> dict[int, Any] | None:
        """Return the signal handlers of the calling thread, if it is a program's main thread."""
        me = self._threads.get(_thread.get_ident())
        return None if me is None or me.at_end is not EndBehavior.INTERRUPT else me.handlers

    def is_interrupted_by_end(self) -> bool:
        """Return whether the calling thread is in a program and the run's end interrupts it."""
        me = self._threads.get(_thread.get_ident())
        return me is not None and me.at_end is not EndBehavior.RETURN

    def is_shut_down(self) -> bool:
        """Return whether the run has ended and the calling thread belongs to a program."""
        return self.is_interrupted_by_end() and current_graph().ended

    def enqueue(self, thread: ProgramThread) -> None:
        """Queue a thread that is about to start for its first turn."""
        thread.wait = Wait(current_graph(), lambda: True, "its start")
        self._waiting.append(thread)

    def dequeue(self, thread: ProgramThread) -> None:
        """Remove a thread whose wait is over, or which could not be started."""
        if thread in self._waiting:
            self._waiting.remove(thread)
        thread.wait = None

    def enter(self, me: ProgramThread) -> None:
        """Make the calling thread a program thread. Return when it holds the lock."""
        with self._mutex:
            self._threads[_thread.get_ident()] = me
            if me.wait is None:
                self.enqueue(me)
            self._pass_lock(None, me)
        self._await_turn(me)
        self.dequeue(me)

    def leave(self, me: ProgramThread) -> None:
        """Make the calling thread an ordinary thread and pass the lock on."""
        with self._mutex:
            me.is_done = True
            del self._threads[_thread.get_ident()]
            # Without the main thread, time does not advance.
            if me.is_main:
                ordinary = (t for t in self._waiting if t.is_ordinary)
                ready = (t for t in ordinary if t.wait is not None and t.can_run(t.wait.graph))
                successor = next(ready, None)
            else:
                successor = self._runnable(me, current_graph()) or next(
                    (t for t in self._waiting if t.is_main), None
                )
            self._pass_lock(me, successor)

    def wait(
        self,
        ready: Callable[[], bool],
        *,
        until_ns: int | None,
        awaited: str,
        events_help: bool = True,
    ) -> bool:
        """Block the calling program thread until `ready()` or `until_ns` [ns], while other threads run.

        Args:
            ready: The condition that ends the wait.
            until_ns: The robot time that ends it [ns], or None.
            awaited: Describes in a DeadlockError what the thread waits for.
            events_help: Whether an event can fulfil the condition. If not, only another thread can.

        Returns:
            The final value of `ready()`.

        Raises:
            DeadlockError: Nothing can happen anymore. Raised in the main thread if it waits, too.
        """
        if ready():
            return True
        graph, me = current_graph(), self._threads[_thread.get_ident()]
        me.polls = 0
        wait = Wait(graph, ready, awaited, events_help=events_help)
        outer_wait, me.wait = me.wait, wait
        alarm = None
        if until_ns is not None:
            wait.has_deadline = True
            alarm = graph.call_at(until_ns, wait.pass_deadline, node=THREADS, entity=me.index)
        try:
            # Otherwise this wait is inside an event, and the outer wait is already queued.
            if outer_wait is None:
                self._waiting.append(me)
            self._run_other_threads(me, graph)
        finally:
            me.wait = outer_wait
            if outer_wait is None:
                self.dequeue(me)
            if alarm is not None:
                alarm.cancel()
        # Without an interrupt, an end or a deadline, only the condition can have ended the wait.
        is_ready = me.pending_error is None and not graph.ended and not wait.is_expired
        me.raise_pending()
        is_ready = is_ready or ready()
        if graph.ended and not is_ready and not wait.is_expired:
            me.handle_end(sleeps=until_ns is not None)
        return is_ready

    def sleep_until(self, wake_ns: int, awaited: str) -> None:
        """Block the calling program thread until robot time `wake_ns` [ns]."""
        self.wait(never, until_ns=wake_ns, awaited=awaited)

    def poll(
        self,
        describe_unmet: Callable[[], str] | None = None,
        *,
        reads_clock: bool = False,
    ) -> None:
        """Count a call that does not wait.

        A program that makes such calls in a loop is waiting, so after many calls they let time
        advance.

        Args:
            describe_unmet: Describes the unmet condition, for the hint if the run ends during
                the loop.
            reads_clock: Whether the call only reads the clock, which a loop may do while it waits
                for the last poll's condition.
        """
        me = self._threads.get(_thread.get_ident())
        if me is None:
            return
        if not reads_clock:
            me.describe_unmet = describe_unmet
        me.polls += 1
        polls = me.polls
        if polls >= POLLS_BEFORE_TIME_PASSES and polls % POLLS_PER_STEP == 0:
            with self.polling():
                self.sleep_until(current_graph().now_ns + POLL_STEP_NS, "a loop that polls")
            # Counting continues, because it is still the same loop.
            me.polls = polls

    def set_unmet(self, describe_unmet: Callable[[], str] | None) -> None:
        """Set the unmet condition of the calling thread, without counting a poll."""
        me = self._threads.get(_thread.get_ident())
        if me is not None:
            me.describe_unmet = describe_unmet

    @contextmanager
    def polling(self) -> Iterator[None]:
        """If the run's end or Ctrl+C interrupts the block, print the polled condition."""
        me = self._threads.get(_thread.get_ident())
        if me is None:
            yield
            return
        me.is_polling = True
        try:
            yield
        except KeyboardInterrupt:
            me.report_interrupted_polling()
            raise
        finally:
            me.is_polling = False

    def finish_other_threads(self) -> None:
        """After the end of a run, let the other threads return from their waits and finish."""
        graph, me = current_graph(), self._threads[_thread.get_ident()]
        while any(thread.waits_in(graph) for thread in self._waiting):
            me.waits_after_end = me.sleeps_after_end = 0
            self.wait(never, until_ns=None, awaited="the others' ends")

    def interrupt(self, thread: threading.Thread) -> None:
        """Raise KeyboardInterrupt in a program thread, as the end of a run does."""
        state = self._threads.get(thread.ident or 0)
        if state is not None and not current_graph().ended:
            state.pending_error = CtrlC()

    def _run_other_threads(self, me: ProgramThread, graph: Graph) -> None:
        """Run other threads and events until the wait of the calling thread is over."""
        # `wait` has checked the condition immediately before.
        can_run = graph.ended or me.pending_error is not None
        # Even after the end of the run, other threads get a turn.
        has_yielded = False
        while not can_run or (graph.ended and not has_yielded):
            runnable_thread = self._runnable(me, graph)
            has_yielded = True
            if runnable_thread is not None:
                self._hand_over(me, runnable_thread)
            elif graph.ended:
                return
            # Ordinary threads may still enter, but time advances only while the main thread calls
            # the kit.
            elif not any(thread.is_main for thread in list(self._threads.values())):
                self.on_stall()
                self._hand_over(me, None)
            else:
                # Usually an event can end the calling thread's own wait, so that is checked first.
                can_events_help = me.wait is not None and me.wait.events_help
                if not can_events_help:
                    waits = [t.wait for t in self._waiting if t.wait is not None and t.waits_in(graph)]
                    can_events_help = any(wait.events_help or wait.has_deadline for wait in waits)
                if not can_events_help or not (graph.advance() or graph.ended):
                    self._report_deadlock(me, graph)
            can_run = me.can_run(graph)

    def _runnable(self, me: ProgramThread, graph: Graph) -> ProgramThread | None:
        """Find the next thread, in the order after `me`, whose wait is over."""
        # A shortcut for the usual case of a single thread.
        if len(self._waiting) == 1 and me in self._waiting:
            return None
        runnable = [t for t in self._waiting if t is not me and t.can_run(graph)]
        return min(runnable, key=lambda thread: (thread.index <= me.index, thread.index), default=None)

    def _report_deadlock(self, me: ProgramThread, graph: Graph) -> None:
        """Set a DeadlockError for the main thread, or for the caller if the main thread does not wait."""
        waits = ", ".join(
            f'thread "{t.name}" waits for {t.wait.awaited}'
            for t in self._waiting
            if t.wait is not None and t.wait.graph is graph
        )
        error = DeadlockError(
            f"The program cannot continue: {waits}. A wait must be ended by a timer, a message or "
            "another thread; give it a time limit, or let another thread spin."
        )
        next((t for t in self._waiting if t.is_main and t.waits_in(graph)), me).pending_error = error

    def _hand_over(self, me: ProgramThread, successor: ProgramThread | None) -> None:
        """Pass the lock to `successor`, or release it until the main thread is back.

        Block until it returns.
        """
        with self._mutex:
            self._pass_lock(me, successor or self._runnable(me, current_graph()))
        self._await_turn(me)

    def _await_turn(self, me: ProgramThread) -> None:
        """Block until the lock is passed to this thread.

        An interrupt during the wait is raised when the thread holds the lock.
        """
        looks, looks_with_interrupt, waiting, is_reported = 0, 0, True, False
        while waiting:
            is_impatient = False
            try:
                # Signals arrive in the main thread, so it must never wait without a timeout.
                waiting = not me.turn.acquire(timeout=LOOK if me.is_main else -1)
            except KeyboardInterrupt as interrupt:
                is_impatient = isinstance(me.pending_error, KeyboardInterrupt)
                me.pending_error = interrupt
            if not waiting:
                return
            looks += 1
            looks_with_interrupt += me.pending_error is not None or self._is_signalled
            if looks % LOOKS_BEFORE_NOTICE == 0 and not is_reported:
                is_reported = self._report_busy_thread()
            with self._mutex:
                # The holder runs code outside of the kit. It continues without the lock.
                if is_impatient or looks_with_interrupt > LOOKS_AFTER_INTERRUPT:
                    self._holder = me
                    self._is_signalled = False
                waiting = self._holder is not me
                if not waiting:
                    # The turn may have arrived just after the check.
                    me.turn.acquire(False)

    def _report_busy_thread(self) -> bool:
        """Print which thread holds the lock without pausing, while all other threads of the program wait.

        Nothing is printed during an import. Return whether a thread was reported.
        """
        from course_lib.ros.tracebacks import is_importing, line_of_thread

        is_reported = False
        for ident, thread in list(self._threads.items()):
            is_busy = thread is self._holder and thread.wait is None and not is_importing(ident)
            # On a busy machine the kit's own nodes may take seconds to load a robot or a map.
            if is_busy and (line := line_of_thread(ident)):
                is_reported = True
                print_notice(
                    f'Thread "{thread.name}" has been running without a pause ({line}). '
                    "Here one thread runs at a time, so the rest of the program waits for it: put "
                    "time.sleep(0.01) into its loop. Ctrl+C or ■ ends the program."
                )
        return is_reported

    @contextmanager
    def report_busy_main_thread(self, graph: Graph) -> Iterator[None]:
        """Report the main thread's line if it computes for long without calling the kit.

        For a `with` block. No other thread waits for the main thread, so a program that ends in
        `while True: pass` would print nothing.
        """
        end_of_block = _thread.allocate_lock()
        end_of_block.acquire()
        _thread.start_new_thread(self._watch_main_thread, (graph, end_of_block))
        try:
            yield
        finally:
            end_of_block.release()

    def _watch_main_thread(self, graph: Graph, end_of_block: _thread.LockType) -> None:
        from course_lib.ros.tracebacks import is_importing, line_of_thread

        ident, seen_ns, started_at = threading.main_thread().ident or 0, -1, 0.0
        while not end_of_block.acquire(timeout=LOOK):
            me = self._threads.get(ident)
            is_running = me is not None and self._holder is me and me.wait is None
            if not is_running or graph.now_ns != seen_ns or is_importing(ident):
                seen_ns, started_at = graph.now_ns, time.process_time()
            # CPU time, as a program may also wait for a key or a file.
            elif time.process_time() - started_at > BUSY_SECONDS and (line := line_of_thread(ident)):
                print_notice(
                    f"The main thread has computed for {BUSY_SECONDS:g} s without a call of ROS "
                    f"({line}). Robot time does not advance: put rclpy.spin_once(node) or "
                    "time.sleep(0.01) into a loop that waits. Ctrl+C ends the program."
                )
                return

    def _pass_lock(self, owner: ProgramThread | None, successor: ProgramThread | None) -> None:
        """Pass the lock on, under the mutex, unless an urgent interrupt has already taken it."""
        if self._holder is owner:
            self._holder = successor
            if successor is not None:
                successor.turn.release()


class HeldTimeLock:
    """The `with` block of `TimeLock.hold`.

    A class because a generator takes twice as long, and each callback needs two such blocks.
    """

    __slots__ = ("_me", "_time_lock")

    def __init__(self, time_lock: TimeLock) -> None:
        self._time_lock = time_lock

    def __enter__(self) -> None:
        time_lock = self._time_lock
        me = time_lock._threads.get(_thread.get_ident())
        if me is not None:
            me.depth += 1
        else:
            thread = threading.current_thread()
            main = thread is threading.main_thread()
            me = time_lock.new_thread(thread.name, main=main, is_ordinary=not main)
            me.polls = time_lock._polls_in_cells if me.is_main and current_graph().notebook else 0
            time_lock.enter(me)
        self._me = me
        try:
            me.raise_pending()
        except BaseException:
            self.__exit__()
            raise

    def __exit__(self, *_: object) -> None:
        me, time_lock = self._me, self._time_lock
        me.depth -= 1
        if me.depth == 0:
            time_lock._polls_in_cells = me.polls if me.is_main else time_lock._polls_in_cells
            time_lock.leave(me)


time_lock = TimeLock()


real_signal, real_getsignal = signal.signal, signal.getsignal


@dataclass(frozen=True)
class HiddenHandler:
    """rclpy's handler of a signal, and the handler that it has replaced and calls.

    In ROS, rclpy's handler is written in C, so `signal.getsignal` returns the replaced one.
    """

    handler: Any
    replaced: Any


# By signal number.
hidden_handlers: dict[int, HiddenHandler] = {}


def set_handler(number: int, handler: Any) -> Any:
    """Set a handler as `signal.signal` does.

    The end of the run calls a program's handler of SIGINT, as Ctrl+C would.
    """
    handlers, previous = time_lock.handlers(), get_handler(number)
    if handlers is None or threading.current_thread() is threading.main_thread():
        real_signal(number, handler)
    if handlers is not None:
        handlers[number] = handler
    return previous


def get_handler(number: int) -> Any:
    """Return a handler as `signal.getsignal` does.

    A program does not see the handlers of the kit.
    """
    handlers = time_lock.handlers()
    if handlers is not None:
        default = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
        return handlers.get(number, default)
    handler = real_getsignal(number)
    hidden = hidden_handlers.get(number)
    return hidden.replaced if hidden is not None and handler is hidden.handler else handler
