"""■ while no cell runs, and in cells that await: Jupyter ignores it there, or waits for a free loop."""

import itertools
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from traceback import walk_stack
from types import FrameType
from typing import Any

from course_lib.ros.baton import baton
from course_lib.ros.busy import watch
from course_lib.ros.graph import current_graph
from course_lib.ros.own_line import is_own

KERNELS = "ipykernel.ipkernel"  # whose handler for cells that await only sets an event of the loop
DIRECTLY = 2  # interrupts that are raised where the callback is
LINES = 7  # of a callback, after which another one is raised in turn


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
    """Let ■ reach the callbacks that a kernel's cell drives, also where the cell awaits."""
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


live_interrupts = LiveInterrupts()
