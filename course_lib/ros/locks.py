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
        self._owner = 0  # identifier of the thread that took it last
        self._taken_by_program = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire the lock as `threading.Lock` does; `timeout` in [s] of robot time."""
        waits = blocking and baton.governs()
        taken = self._wait(timeout) if waits else self._real.acquire(blocking, timeout)
        if taken:
            self._owner, self._taken_by_program = _thread.get_ident(), baton.governs()
        return taken

    def release(self) -> None:
        """Release the lock."""
        self._real.release()

    def locked(self) -> bool:
        """Say whether someone holds the lock."""
        return self._real.locked()

    def _wait(self, timeout: float) -> bool:
        until_ns = None if timeout < 0 else current_graph().now_ns + round(timeout * 1e9)
        while not self._real.acquire(False):
            if not self._taken_by_program and not baton.governs(self._owner):
                wall.sleep(BRIEFLY)  # whoever has it goes by the wall clock
                continue
            free = baton.wait(self._is_free, until_ns=until_ns, what="a lock", events_help=False)
            if not free and (until_ns is not None or self._returns_at_end):
                return False
        return True

    def _is_free(self) -> bool:
        return not self._real.locked()

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
    """Whether the program may use what is made here: also what a cell makes, between calls of the kit."""
    return baton.governs() or threading.current_thread() is threading.main_thread()


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
