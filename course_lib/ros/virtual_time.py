"""Robot time for program threads: `time`, sleeps, locks, threads and asyncio, behind their usual names.

Waiting for a lock hands the baton on. Installed once. Every replacement asks whether the calling thread
belongs to the program (`baton.governs()`); for any other thread it is the original, so Jupyter's own threads
keep the wall clock.
"""

import _thread
import queue
import selectors
import signal
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros import idle_loops, wall
from course_lib.ros.baton import baton
from course_lib.ros.cells import cell
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import current_graph, program
from course_lib.ros.own_signals import get_handler, set_handler
from course_lib.ros.program_thread import ProgramThread, ShutDown, StoppedThread

_real_start = threading.Thread.start
_real_join = threading.Thread.join
_real_select = selectors.DefaultSelector.select
_RealLock = threading.Lock
_RealRLock = threading.RLock
_RealSimpleQueue = queue.SimpleQueue
BRIEFLY = 0.001  # [s] of the wall clock


def install() -> None:
    """Put robot time behind the usual names; calling it again changes nothing."""
    if time.sleep is _sleep:
        return
    for name in ("time", "monotonic", "perf_counter"):
        origin_ns = 0 if name == "time" else START_NS
        setattr(time, name, _robot_clock(getattr(time, name), origin_ns, 1e-9))
        setattr(time, f"{name}_ns", _robot_clock(getattr(time, f"{name}_ns"), origin_ns, 1))
    from concurrent.futures.process import ProcessPoolExecutor
    from multiprocessing.pool import Pool, ThreadPool

    replacements: tuple[tuple[Any, str, Any], ...] = (
        (time, "sleep", _sleep),
        (signal, "signal", set_handler),
        (signal, "getsignal", get_handler),
        (threading, "Lock", Lock),
        (threading, "RLock", make_rlock),
        (threading, "_allocate_lock", make_waiter),
        (threading, "_time", time.monotonic),  # imported by name there, as in queue
        (threading.Thread, "start", _start),
        (threading.Thread, "join", _join),
        (queue, "time", time.monotonic),
        (queue, "SimpleQueue", SimpleQueue),
        (selectors.DefaultSelector, "select", _select),
        *((pool, "_setup_queues", _refused(vars(pool)["_setup_queues"])) for pool in (Pool, ThreadPool)),
        (ProcessPoolExecutor, "__init__", _refused(ProcessPoolExecutor.__init__)),
    )
    for owner, name, replacement in replacements:
        setattr(owner, name, replacement)
    idle_loops.install()
    streams = sys.modules.get("ipykernel.iostream")
    if streams is not None:  # a kernel's output is sent by a thread of Jupyter's
        streams.OutStream.flush = _by_the_wall_clock(streams.OutStream.flush)


def is_of_the_program(thread: threading.Thread) -> bool:
    """Return whether a program thread started this one."""
    return hasattr(thread, "_program_thread")


def _robot_clock(real: Callable[[], Any], origin_ns: int, unit: float) -> Callable[[], Any]:
    def now() -> Any:
        if not baton.governs():
            return real()
        baton.poll()
        return (current_graph().now_ns - origin_ns) * unit

    return now


def _sleep(seconds: float, /) -> None:
    if not baton.governs():
        cell.rest(seconds)
        return
    if seconds < 0:
        raise ValueError("sleep length must be non-negative")
    baton.sleep_until(current_graph().now_ns + round(seconds * 1e9), f"time.sleep({seconds:g})")


def _by_the_wall_clock(real: Callable[..., Any]) -> Callable[..., Any]:
    def call(*args: Any) -> Any:
        with baton.unknown():
            return real(*args)

    return call


def _start(thread: threading.Thread) -> None:
    """Start a thread; one that a program thread starts belongs to the program from its first line."""
    if not baton.governs():
        _real_start(thread)
        return
    program_thread = baton.new_thread(thread.name)
    run, of_program = thread.run, program.name

    def run_with_the_baton() -> None:
        program.name = of_program
        baton.enter(program_thread)
        try:
            run()
        except (StoppedThread, ShutDown):
            if not current_graph().ended:
                raise
        finally:
            baton.leave(program_thread)

    thread.run = run_with_the_baton  # type: ignore[method-assign]
    thread._program_thread = program_thread  # type: ignore[attr-defined]
    baton.line_up(program_thread)
    try:
        with baton.unknown():
            _real_start(thread)
    except RuntimeError:  # no more threads to be had
        baton.drop_out(program_thread)
        raise


def _join(thread: threading.Thread, timeout: float | None = None) -> None:
    program_thread: ProgramThread | None = getattr(thread, "_program_thread", None)
    if program_thread is not None and baton.governs():
        until_ns = None if timeout is None else current_graph().now_ns + round(max(timeout, 0) * 1e9)
        what = f'the end of thread "{thread.name}"'
        if not baton.wait(lambda: program_thread.done, until_ns=until_ns, what=what, events_help=False):
            return
    _real_join(thread, timeout)


def _select(selector: Any, timeout: float | None = None) -> Any:
    """Wait for files or for robot time: what asyncio sleeps in."""
    if not baton.governs():
        return _real_select(selector, timeout)
    ready = _real_select(selector, 0)
    if ready or (timeout is not None and timeout <= 0):
        return ready
    until_ns = None if timeout is None else current_graph().now_ns + round(timeout * 1e9)
    baton.wait(lambda: bool(_real_select(selector, 0)), until_ns=until_ns, what="asyncio")
    return _real_select(selector, 0)


def _refused(real: Callable[..., Any]) -> Callable[..., Any]:
    """Refuse pools in robot time whose threads read pipes: they would hold the baton meanwhile."""

    def make(*args: Any, **kwargs: Any) -> Any:
        if baton.governs():
            raise CourseError(
                "multiprocessing's pools and ProcessPoolExecutor would wait for ever in robot time. Use "
                "concurrent.futures.ThreadPoolExecutor."
            )
        return real(*args, **kwargs)

    return make


class ProgramLock:
    """A lock made by a program thread.

    What Event and Condition wait on `returns_at_end`: `acquire` gives up at the end of the run. A mutex goes
    on until the thread that holds it has come to its end.
    """

    def __init__(self, *, returns_at_end: bool = False) -> None:
        self._real = _thread.allocate_lock()
        self._returns_at_end = returns_at_end
        self._owner: int | None = None  # identifier of the thread that holds it, once that is noted
        self._taken_by_program = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire the lock as `threading.Lock` does; `timeout` in [s] of robot time."""
        waits = blocking and baton.governs()
        taken = self._wait(timeout) if waits else self._real.acquire(blocking, timeout)
        if taken:
            self._owner, self._taken_by_program = _thread.get_ident(), baton.governs()
        return taken

    def release(self) -> None:
        """Release the lock; the former owner is forgotten before anyone can take it."""
        if self._real.locked():
            self._owner, self._taken_by_program = None, False
        self._real.release()

    def locked(self) -> bool:
        """Return whether a thread holds the lock."""
        return self._real.locked()

    def _wait(self, timeout: float) -> bool:
        until_ns = None if timeout < 0 else current_graph().now_ns + round(timeout * 1e9)
        while not self._real.acquire(False):
            if self._is_held_outside():
                wall.sleep(BRIEFLY)
                continue
            able = baton.wait(self._can_be_tried, until_ns=until_ns, what="a lock", events_help=False)
            if not able and (until_ns is not None or self._returns_at_end):
                return False
        return True

    def _is_held_outside(self) -> bool:
        """Return whether the holder goes by the wall clock: it does not belong to the program now.

        A thread of the program that has just taken the lock has noted it before another one can look.
        """
        if self._taken_by_program:
            return False
        return self._owner is None or not baton.governs(self._owner)

    def _can_be_tried(self) -> bool:
        return not self._real.locked() or self._is_held_outside()

    def _at_fork_reinit(self) -> None:
        self._real = _thread.allocate_lock()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()


class Lock:
    """The replacement of `threading.Lock`: a ProgramLock where the program may use it, else a real one."""

    def __new__(cls) -> Any:
        """Create the lock."""
        return ProgramLock() if _made_for_the_program() else _RealLock()


class SimpleQueue(_RealSimpleQueue[Any]):
    """The replacement of `queue.SimpleQueue`: for the program the one in Python, built on our locks."""

    def __new__(cls) -> Any:
        """Create the queue."""
        if not _made_for_the_program():
            return super().__new__(cls)
        return queue._PySimpleQueue()  # type: ignore[attr-defined]  # the standard library's own fallback


def _made_for_the_program() -> bool:
    """Return whether the program may use what is made here: also what a cell makes, between calls of the kit.

    `current_thread()` would make an object with locks for a thread that Python has not started.
    """
    return baton.governs() or _thread.get_ident() == threading.main_thread().ident


def make_waiter() -> Any:
    """Create the lock on which a Condition waits."""
    return ProgramLock(returns_at_end=True) if baton.governs() else _thread.allocate_lock()


def make_rlock() -> Any:
    """Create the replacement of `threading.RLock()`: on a ProgramLock where the program may use it."""
    if not _made_for_the_program():
        return _RealRLock()
    rlock = threading._PyRLock()  # type: ignore[attr-defined]  # the standard library's RLock in Python
    rlock._block = ProgramLock()
    return rlock
