"""Robot time for program threads: `time`, sleeps, locks, threads and asyncio, behind their usual names.

Installed once. Every replacement asks whether the calling thread belongs to the program (`baton.governs()`);
for any other thread it is the original, so Jupyter's own threads keep the wall clock.
"""

import queue
import selectors
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros import locks, wall
from course_lib.ros.baton import baton
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import current_graph, program
from course_lib.ros.program_thread import ProgramThread

_real_start = threading.Thread.start
_real_join = threading.Thread.join
_real_select = selectors.DefaultSelector.select


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
        (threading, "Lock", locks.Lock),
        (threading, "RLock", locks.make_rlock),
        (threading, "_allocate_lock", locks.make_waiter),
        (threading, "_time", time.monotonic),  # imported by name there, as in queue
        (threading.Thread, "start", _start),
        (threading.Thread, "join", _join),
        (queue, "time", time.monotonic),
        (queue, "SimpleQueue", locks.SimpleQueue),
        (selectors.DefaultSelector, "select", _select),
        *((pool, "_setup_queues", _refused(vars(pool)["_setup_queues"])) for pool in (Pool, ThreadPool)),
        (ProcessPoolExecutor, "__init__", _refused(ProcessPoolExecutor.__init__)),
    )
    for owner, name, replacement in replacements:
        setattr(owner, name, replacement)
    streams = sys.modules.get("ipykernel.iostream")
    if streams is not None:  # a kernel's output is sent by a thread of Jupyter's
        streams.OutStream.flush = _by_the_wall_clock(streams.OutStream.flush)


def is_of_the_program(thread: threading.Thread) -> bool:
    """Say whether a program thread started this one."""
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
        wall.sleep(seconds)
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
