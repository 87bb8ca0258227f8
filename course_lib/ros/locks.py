"""Locks for program threads: waiting for one hands the baton on, and its time limit is robot time."""

import _thread
import queue
import threading
from typing import Any

from course_lib.ros import wall
from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph

BRIEFLY = 0.001  # [s]

_RealLock = threading.Lock
_RealRLock = threading.RLock
_RealSimpleQueue = queue.SimpleQueue


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
        """Say whether someone holds the lock."""
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
    """What `threading.Lock` names: a ProgramLock where the program may use it, else a real one."""

    def __new__(cls) -> Any:
        """Make the lock."""
        return ProgramLock() if _made_for_the_program() else _RealLock()


class SimpleQueue(_RealSimpleQueue[Any]):
    """What `queue.SimpleQueue` names: for the program the one in Python, which is built on our locks."""

    def __new__(cls) -> Any:
        """Make the queue."""
        if not _made_for_the_program():
            return super().__new__(cls)
        return queue._PySimpleQueue()  # type: ignore[attr-defined]  # the standard library's own fallback


def _made_for_the_program() -> bool:
    """Return whether the program may use what is made here: also what a cell makes, between calls of the kit.

    `current_thread()` would make an object with locks for a thread that Python has not started.
    """
    return baton.governs() or _thread.get_ident() == threading.main_thread().ident


def make_waiter() -> Any:
    """Make the lock on which a Condition waits."""
    return ProgramLock(returns_at_end=True) if baton.governs() else _thread.allocate_lock()


def make_rlock() -> Any:
    """Make what `threading.RLock()` makes: one on a ProgramLock where the program may use it."""
    if not _made_for_the_program():
        return _RealRLock()
    rlock = threading._PyRLock()  # type: ignore[attr-defined]  # the standard library's RLock in Python
    rlock._block = ProgramLock()
    return rlock
