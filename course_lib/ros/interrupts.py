"""Interrupts of callbacks in a notebook: ■, Stop, and the watch that names a line that takes long.

Jupyter ignores ■ while no cell runs, and in cells that await it waits for a free loop.
"""

import _thread
import contextvars
import itertools
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from traceback import walk_stack
from types import FrameType
from typing import Any

from course_lib.ros import wall
from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from course_lib.ros.notices import say
from course_lib.ros.tracebacks import is_own, line_of_thread, line_of_traceback

PATIENCE = 3.0  # [s] of the wall clock that a callback takes before its line is named
LOOK = 0.25  # [s] between two looks
A_MOMENT = 0.5  # [s] that a callback has to end by itself once Stop was clicked
KERNELS = "ipykernel.ipkernel"  # whose handler for cells that await only sets an event of the loop
DIRECTLY = 2  # interrupts that are raised where the callback is
LINES = 7  # of a callback, after which another one is raised in turn


class Callback:
    """A callback under way: its node and its thread, and where to write about it."""

    __slots__ = ("attempts", "context", "ident", "named", "node", "since", "tell", "unwanted_since")

    def __init__(self, node: str, tell: "Callable[[Callback, str], None]") -> None:
        self.node = node
        self.tell = tell
        self.ident = _thread.get_ident()
        self.context = contextvars.copy_context()  # a kernel's output goes to the cell that this names
        self.since = wall.monotonic()
        self.named = False
        self.attempts = 0  # to interrupt it
        self.unwanted_since: float | None = None  # [s] of the wall clock

    @property
    def seconds(self) -> float:
        """The time that it has been under way, [s] of the wall clock."""
        return wall.monotonic() - self.since


def write_once(callback: Callback, line: str) -> None:
    """Write into the cell's output what keeps a node busy."""
    if not callback.named:
        callback.named = True
        sys.stdout.write(
            f"{callback.node} has been busy for {callback.seconds:.0f} s in {line} (■ stops it)\n"
        )


class Watch:
    """A thread that watches the callback under way."""

    def __init__(self) -> None:
        self.under_way: Callback | None = None
        self.tell: Callable[[Callback, str], None] = write_once
        self._clicks: list[float] = []  # when each Stop that waits for a callback was clicked
        self.threads = 0  # of its own: 1 once there was a callback
        self._started = False

    @property
    def stop_waits(self) -> bool:
        """True if an interrupt comes from this watch, for a Stop that waits; else it is the user's ■."""
        callback = self.under_way
        return bool(self._clicks) or (callback is not None and callback.unwanted_since is not None)

    def want_no_more(self) -> None:
        """Interrupt the callback under way, if there is one, until it has come to its end."""
        if self.under_way is not None and self.under_way.unwanted_since is None:
            self.under_way.unwanted_since = wall.monotonic()

    def begin(self, node: str) -> None:
        """Note that the calling thread begins a callback; put `under_way` back at its end."""
        if not self._started:
            self._started = True
            begun = _thread.allocate_lock()
            begun.acquire()
            _thread.start_new_thread(self._look_on, (begun,))
            begun.acquire()  # Python counts a thread only when it runs
            self.threads = 1
        self.under_way = Callback(node, self.tell)

    @contextmanager
    def stopping(self) -> Iterator[None]:
        """Interrupt the main thread while Stop waits for a callback that goes on and on."""
        clicked = wall.monotonic()
        self._clicks.append(clicked)
        try:
            yield
        finally:
            self._clicks.remove(clicked)

    def _look_on(self, begun: _thread.LockType) -> None:
        begun.release()
        while True:
            wall.sleep(LOOK)
            callback = self.under_way
            if callback is None:
                continue
            asked = [*self._clicks, *filter(None, [callback.unwanted_since])]
            if asked and wall.monotonic() - min(asked) > A_MOMENT:
                interrupt_main_thread()
            line = line_of_thread(callback.ident) if callback.seconds > PATIENCE else ""
            if line and callback is self.under_way:
                callback.context.run(callback.tell, callback, line)


def interrupt_main_thread() -> None:
    """Do what ■ does; where there are signals it also ends a wait for a lock."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


class LiveInterrupts:
    """The handler of SIGINT for nodes that run between the cells."""

    def __init__(self) -> None:
        self.asked = False  # ■ was pressed
        self._in_step = False

    @contextmanager
    def heard(self) -> Iterator[None]:
        """Raise KeyboardInterrupt in a callback that is under way, and set `asked`, if ■ is pressed."""
        before = signal.signal(signal.SIGINT, self._handle)
        self._in_step = True
        try:
            yield
        finally:
            self._in_step = False
            if before is not signal.SIG_IGN:  # else it goes on until `give_back`
                signal.signal(signal.SIGINT, before)

    def give_back(self) -> None:
        """Ignore ■ between the cells again, as Jupyter does."""
        self.asked = False
        if signal.getsignal(signal.SIGINT) == self._handle:
            signal.signal(signal.SIGINT, signal.SIG_IGN)

    def _handle(self, number: int, frame: FrameType | None) -> None:
        self.asked = self.asked or not watch.stop_waits
        if self._in_step and (watch.under_way is not None or not baton.is_held_here()):
            _interrupt(number, frame)


@contextmanager
def interruptible() -> Iterator[None]:
    """Pass ■ to the callbacks that a kernel's cell drives, also where the cell awaits."""
    before: Any = signal.getsignal(signal.SIGINT)
    is_main = threading.current_thread() is threading.main_thread()
    is_cells = before is signal.default_int_handler or getattr(before, "__module__", "") == KERNELS
    if not (is_main and is_cells and current_graph().notebook):
        yield
        return
    signal.signal(signal.SIGINT, _interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _interrupt(_number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt; in a callback that swallows it, later, at one of its next lines."""
    callback = watch.under_way
    if callback is not None:
        watch.want_no_more()
        callback.attempts += 1
        if callback.attempts > DIRECTLY and frame is not None and sys.gettrace() is None:
            _raise_at_a_line(frame, callback.attempts % LINES)
            return
    raise KeyboardInterrupt


def _raise_at_a_line(frame: FrameType, lines: int) -> None:
    """Raise KeyboardInterrupt when the callback has come so many lines further: outside of its `try`."""
    left = itertools.count(lines, -1)

    def trace(_frame: FrameType, event: str, _: Any) -> Any:
        if event == "line" and next(left) <= 0:
            sys.settrace(None)
            raise KeyboardInterrupt
        return trace

    for one, _line in walk_stack(frame):
        if one.f_code.co_name == "await_or_execute":  # what called the callback
            break
        if is_own(one.f_code.co_filename):
            one.f_trace = trace
    sys.settrace(lambda *_: None)


@contextmanager
def signals_kept() -> Iterator[None]:
    """Restore the handlers of Ctrl+C and SIGTERM afterwards: a program that never shut down leaves others."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    former = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in former.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


@contextmanager
def until_interrupted() -> Iterator[None]:
    """End quietly with one line when the student presses ■; nodes stay usable."""
    graph = current_graph()
    start_ns = graph.now_ns
    try:
        with interruptible():
            yield
    except KeyboardInterrupt as interrupt:
        line = line_of_traceback(interrupt.__traceback__)
        where = line and f", in {line}"
        if graph.ended:  # the end of a run, which is none that anybody pressed
            return
        say(f"Stopped after {(graph.now_ns - start_ns) * 1e-9:.1f} s of robot time{where}.")


watch = Watch()
live_interrupts = LiveInterrupts()
