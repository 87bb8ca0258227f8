"""Locks for program threads: waiting for one hands the baton on, and its time limit is robot time."""

import _thread
import queue
import threading
from types import TracebackType
from typing import Any

from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph

_RealLock = threading.Lock
_RealRLock = threading.RLock
_RealSimpleQueue = queue.SimpleQueue


class ProgramLock:
    """A lock made by a program thread.

    Args:
        returns_at_end: Whether `acquire` gives up at the end of the run (what Event and Condition wait on),
            or goes on until the thread that holds the lock has come to its end (a mutex).
    """

    def __init__(self, *, returns_at_end: bool = False) -> None:
        self._real = _thread.allocate_lock()
        self._returns_at_end = returns_at_end

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire the lock as `threading.Lock` does; `timeout` in [s] of robot time."""
        if self._real.acquire(False):
            return True
        if not blocking:
            return False
        if not baton.governs():
            return self._real.acquire(True, timeout)
        until_ns = None if timeout < 0 else current_graph().now_ns + round(timeout * 1e9)
        while True:
            free = baton.wait(self._is_free, until_ns=until_ns, what="a lock", events_help=False)
            if free and self._real.acquire(False):
                return True
            if not free and (until_ns is not None or self._returns_at_end):
                return False

    def release(self) -> None:
        """Release the lock."""
        self._real.release()

    def locked(self) -> bool:
        """Say whether someone holds the lock."""
        return self._real.locked()

    def _is_free(self) -> bool:
        return not self._real.locked()

    def _at_fork_reinit(self) -> None:
        self._real = _thread.allocate_lock()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        self.release()


class Lock:
    """What `threading.Lock` names: makes a ProgramLock for program threads, a real one for all others."""

    def __new__(cls) -> Any:
        """Make the lock."""
        return ProgramLock() if baton.governs() else _RealLock()


class SimpleQueue(_RealSimpleQueue[Any]):
    """What `queue.SimpleQueue` names: for program threads the one in Python, which is built on our locks."""

    def __new__(cls) -> Any:
        """Make the queue."""
        if not baton.governs():
            return super().__new__(cls)
        return queue._PySimpleQueue()  # type: ignore[attr-defined]  # the standard library's own fallback


def make_waiter() -> Any:
    """Make the lock on which a Condition waits."""
    return ProgramLock(returns_at_end=True) if baton.governs() else _thread.allocate_lock()


def make_rlock() -> Any:
    """Make what `threading.RLock()` makes: one on a ProgramLock for program threads."""
    if not baton.governs():
        return _RealRLock()
    rlock = threading._PyRLock()  # type: ignore[attr-defined]  # the standard library's RLock in Python
    rlock._block = ProgramLock()
    return rlock
