"""Executors: they run the callbacks of their nodes."""

import os
import threading
from collections.abc import Callable
from contextlib import suppress

from course_lib.ros.baton import baton
from rclpy.context import Context
from rclpy.impl.executor import Executor as Executor
from rclpy.impl.executor import ExternalShutdownException as ExternalShutdownException
from rclpy.impl.executor import await_or_execute as await_or_execute
from rclpy.task import Task
from rclpy.utilities import timeout_sec_to_nsec


class SingleThreadedExecutor(Executor):
    """Runs callbacks one after the other, in the thread that spins."""


class MultiThreadedExecutor(Executor):
    """Runs each callback in a thread of its own, at most `num_threads` (default: processors) at a time.

    One that waits does not hold up the others.
    """

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        self._num_threads = num_threads or os.cpu_count() or 2
        self._running = 0
        self._failed: list[BaseException] = []

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Begin nothing any more; True when the callbacks under way have ended within the time [s]."""
        super().shutdown(timeout_sec)
        limit_ns = timeout_sec_to_nsec(timeout_sec)
        until_ns = None if limit_ns < 0 else self.context.graph.now_ns + limit_ns
        with baton.known():
            return baton.wait(lambda: not self._running, until_ns=until_ns, what="callbacks under way")

    def _spin_once(self, limit_ns: int, condition: Callable[[], bool]) -> None:
        with suppress(ExternalShutdownException):  # as in rclpy, whose other executor raises it
            super()._spin_once(limit_ns, condition)

    def can_work(self) -> bool:
        """Say whether a callback is ready to be run and a thread is free for it."""
        return bool(self._failed) or (self._running < self._num_threads and super().can_work())

    def _next_task(self) -> Task | None:
        if self._failed:
            raise self._failed.pop(0)
        return super()._next_task() if self._running < self._num_threads else None

    def _execute(self, task: Task) -> None:
        self._running += 1
        threading.Thread(target=self._work, args=(task,), name="callback", daemon=True).start()

    def _work(self, task: Task) -> None:
        with baton.known():
            try:
                super()._execute(task)
            except Exception as error:  # it belongs to the thread that spins
                self._failed.append(error)
            finally:
                self._running -= 1
