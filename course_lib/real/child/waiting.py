"""Replacements of the kit's time lock and graph under the real rclpy: threads wait in real time.

The kit's tf2_ros imports the modules `time_lock` and `graph` of `course_lib.ros`, which belong to
robot time. `program.py` installs this module under their names.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

# Polling period [s].
WAIT = 0.005


class TimeLock:
    """The interface of the kit's time lock, for threads that need no lock."""

    def is_program_thread(self) -> bool:
        """Return True, because nothing has to be run while a program waits."""
        return True

    def poll(self) -> None:
        """Do nothing, because other threads run anyway."""

    @contextmanager
    def hold(self) -> Iterator[None]:
        """Do nothing during a `with` block."""
        yield

    def wait(self, ready: Callable[[], bool], *, until_ns: int, awaited: str) -> None:
        """Wait until `ready()` is true or the monotonic clock reaches a time."""
        while not ready() and time.monotonic_ns() < until_ns:
            time.sleep(WAIT)


class MonotonicGraph:
    """A graph whose time is the monotonic clock."""

    notebook = False

    @property
    def now_ns(self) -> int:
        """The monotonic clock, [ns]."""
        return time.monotonic_ns()


def current_graph() -> MonotonicGraph:
    """Return the clock that `TimeLock.wait` uses."""
    return MonotonicGraph()


time_lock = TimeLock()
