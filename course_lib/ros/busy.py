"""The callback that is under way in a notebook: names its line if it takes long, interrupts it for Stop."""

import _thread
import contextvars
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from course_lib.ros import wall
from course_lib.ros.own_line import line_of_thread

PATIENCE = 3.0  # [s] of the wall clock that a callback takes before its line is named
LOOK = 0.25  # [s] between two looks
A_MOMENT = 0.5  # [s] that a callback has to end by itself once Stop was clicked


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
        """How long it has been under way, [s] of the wall clock."""
        return wall.monotonic() - self.since


def write_once(callback: Callback, line: str) -> None:
    """Write into the cell's output what keeps a node busy."""
    if not callback.named:
        callback.named = True
        sys.stdout.write(
            f"{callback.node} has been busy for {callback.seconds:.0f} s in {line} (■ stops it)\n"
        )


class Watch:
    """Looks at the callback under way now and then, from a thread of its own."""

    def __init__(self) -> None:
        self.under_way: Callback | None = None
        self.tell: Callable[[Callback, str], None] = write_once
        self._clicks: list[float] = []  # when each Stop that waits for a callback was clicked
        self._started = False

    @property
    def stop_waits(self) -> bool:
        """Whether an interrupt is this watch's, for a Stop that waits; else it is the user's ■."""
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
            _thread.start_new_thread(self._look_on, ())
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

    def _look_on(self) -> None:
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


watch = Watch()
