"""Interrupts of callbacks in a notebook: ■, Stop, and the watch, which reports lines that take long.

Jupyter ignores ■ while no cell runs, and for cells that await it only sets an event, which waits
until the event loop is free. A callback that does not end would block both, so SIGINT is handled
here.
"""

import _thread
import contextvars
import itertools
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from traceback import walk_stack
from types import FrameType
from typing import Any

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.notices import print_notice
from course_lib.ros.student_code import is_student_file
from course_lib.ros.time import wall
from course_lib.ros.time.time_lock import real_getsignal, real_signal, time_lock
from course_lib.ros.tracebacks import line_of_thread, line_of_traceback

# Wall time after which the line of a running callback is reported [s].
PATIENCE = 3.0
# Interval between checks [s].
LOOK = 0.25
# Time that a callback has to end by itself after Stop was clicked [s].
A_MOMENT = 0.5
# Module of the kernel's signal handler for awaiting cells,
# which only sets an event of the event loop.
KERNELS = "ipykernel.ipkernel"
# Number of interrupts that are raised at the callback's current line.
DIRECTLY = 2
# Later interrupts are raised after fewer than this many further lines of the callback.
LINES = 7
# As in a shell, the exit code after a signal is the sum of this and the signal's number.
SIGNALED = 128


@dataclass(eq=False, repr=False, slots=True)
class Callback:
    """A running callback: its node, its thread, and the function that reports it."""

    node: str
    report: "Callable[[Callback, str], None]"
    ident: int = field(default_factory=_thread.get_ident)
    # A kernel's output goes to the cell that this context identifies.
    context: contextvars.Context = field(default_factory=contextvars.copy_context)
    since: float = field(default_factory=wall.monotonic)
    is_reported: bool = False
    # Number of interrupts so far.
    attempts: int = 0
    # When its end was requested, in wall time [s].
    stop_requested_since: float | None = None

    @property
    def seconds(self) -> float:
        """The wall time since the callback began [s]."""
        return wall.monotonic() - self.since


def write_once(callback: Callback, line: str) -> None:
    """Report the line that keeps a node busy in the cell's output, once per callback."""
    if not callback.is_reported:
        callback.is_reported = True
        sys.stdout.write(
            f"{callback.node} has been busy for {callback.seconds:.0f} s in {line} (■ stops it)\n"
        )


@dataclass(eq=False, repr=False)
class Watch:
    """A thread that watches the running callback."""

    running_callback: Callback | None = None
    report: Callable[[Callback, str], None] = write_once
    # Times at which Stop was clicked while a callback ran.
    clicks: list[float] = field(default_factory=list)
    # Number of threads that the watch has started: 1 after the first callback.
    threads: int = 0
    _started: bool = False

    def interrupt_callback(self) -> None:
        """Interrupt the running callback, if there is one, until it ends."""
        if self.running_callback is not None and self.running_callback.stop_requested_since is None:
            self.running_callback.stop_requested_since = wall.monotonic()

    def begin(self, node: str) -> None:
        """Register that the calling thread starts a callback.

        At its end the caller restores the previous callback.
        """
        if not self._started:
            self._started = True
            is_running = _thread.allocate_lock()
            is_running.acquire()
            _thread.start_new_thread(self._watch_callbacks, (is_running,))
            # Wait for the thread to run, because only then Python counts it.
            is_running.acquire()
            self.threads = 1
        self.running_callback = Callback(node, self.report)

    @contextmanager
    def stopping(self) -> Iterator[None]:
        """Interrupt the main thread in the block if a callback for which Stop waits does not end."""
        click_time = wall.monotonic()
        self.clicks.append(click_time)
        try:
            yield
        finally:
            self.clicks.remove(click_time)

    def _watch_callbacks(self, is_running: _thread.LockType) -> None:
        is_running.release()
        while True:
            wall.sleep(LOOK)
            callback = self.running_callback
            if callback is None:
                continue
            requests = [*self.clicks, *filter(None, [callback.stop_requested_since])]
            if requests and wall.monotonic() - min(requests) > A_MOMENT:
                interrupt_main_thread()
            line = line_of_thread(callback.ident) if callback.seconds > PATIENCE else ""
            if line and callback is self.running_callback:
                callback.context.run(callback.report, callback, line)


def interrupt_main_thread() -> None:
    """Interrupt as ■ does. Where signals are supported, this also ends a wait for a lock."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


@dataclass(eq=False, repr=False)
class LiveInterrupts:
    """The handler of SIGINT for nodes that run between the cells."""

    # Whether ■ was pressed.
    was_pressed: bool = False
    _in_step: bool = False

    @contextmanager
    def handle(self) -> Iterator[None]:
        """During the block, ■ raises KeyboardInterrupt in a running callback and sets `was_pressed`."""
        previous = real_signal(signal.SIGINT, self._handle)
        self._in_step = True
        try:
            yield
        finally:
            self._in_step = False
            # Otherwise the handler stays installed until `ignore`.
            if previous is not signal.SIG_IGN:
                real_signal(signal.SIGINT, previous)

    def ignore(self) -> None:
        """Ignore ■ between the cells again, as Jupyter does."""
        self.was_pressed = False
        if real_getsignal(signal.SIGINT) == self._handle:
            real_signal(signal.SIGINT, signal.SIG_IGN)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        callback = watch.running_callback
        # A click on Stop raises the same signal as ■.
        was_stop = bool(watch.clicks) or (callback is not None and callback.stop_requested_since is not None)
        self.was_pressed = self.was_pressed or not was_stop
        if self._in_step and (callback is not None or not time_lock.is_held_by_caller()):
            _interrupt(number, frame)


@contextmanager
def interruptible() -> Iterator[None]:
    """Let ■ interrupt the callbacks that a kernel's cell drives, even if the cell awaits."""
    previous: Any = real_getsignal(signal.SIGINT)
    is_main = threading.current_thread() is threading.main_thread()
    is_of_cell = previous is signal.default_int_handler or getattr(previous, "__module__", "") == KERNELS
    if not (is_main and is_of_cell and current_graph().notebook):
        yield
        return
    real_signal(signal.SIGINT, _interrupt)
    try:
        yield
    finally:
        real_signal(signal.SIGINT, previous)


def _interrupt(_number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt.

    If a callback suppresses it, later interrupts are raised at one of its next lines.
    """
    callback = watch.running_callback
    if callback is not None:
        watch.interrupt_callback()
        callback.attempts += 1
        if callback.attempts > DIRECTLY and frame is not None and sys.gettrace() is None:
            # Raise it some lines later, because the current line may be in the callback's `try`.
            countdown = itertools.count(callback.attempts % LINES, -1)

            def trace(_frame: FrameType, event: str, _: Any) -> Any:
                if event == "line" and next(countdown) <= 0:
                    sys.settrace(None)
                    raise KeyboardInterrupt
                return trace

            for caller, _line in walk_stack(frame):
                # The function that has called the callback.
                if caller.f_code.co_name == "await_or_execute":
                    break
                if is_student_file(caller.f_code.co_filename):
                    caller.f_trace = trace
            sys.settrace(lambda *_: None)
            return
    raise KeyboardInterrupt


@contextmanager
def keep_signal_handlers() -> Iterator[None]:
    """Restore the handlers of SIGINT and SIGTERM after the block.

    A program that never shuts down leaves its own handlers behind.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = {number: real_getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in previous.items():
            real_signal(number, signal.SIG_DFL if handler is None else handler)


def exit_at_signals() -> None:
    """Let Python exit at SIGTERM, and at SIGHUP, which a closed terminal sends.

    By default both end the process without the functions of `atexit`, of which one stops a robot.
    """
    if threading.current_thread() is not threading.main_thread():
        return

    def on_signal(number: int, frame: FrameType | None) -> None:
        # rclpy's handler, which is installed later and ends the program itself, calls this one.
        if real_getsignal(number) is on_signal:
            sys.exit(SIGNALED + number)

    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        # `nohup` lets a program ignore SIGHUP. Windows has no SIGHUP.
        if number is not None and real_getsignal(number) == signal.SIG_DFL:
            real_signal(number, on_signal)


@contextmanager
def until_interrupted() -> Iterator[None]:
    """End quietly with a notice when the student presses ■. Nodes remain usable."""
    graph = current_graph()
    start_ns = graph.now_ns
    try:
        with interruptible():
            yield
    except KeyboardInterrupt as interrupt:
        line = line_of_traceback(interrupt.__traceback__)
        location = line and f", in {line}"
        # At the end of a run the interrupt is not from a user.
        if graph.ended:
            return
        print_notice(f"Stopped after {(graph.now_ns - start_ns) * 1e-9:.1f} s of robot time{location}.")


watch = Watch()
live_interrupts = LiveInterrupts()
