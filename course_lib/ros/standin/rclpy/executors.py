"""Executors, which run the callbacks of their nodes."""

import os
import threading
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from course_lib.ros import pace
from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from course_lib.ros.program_thread import AtEnd
from rclpy.context import Context
from rclpy.exceptions import ConditionReachedException as ConditionReachedException
from rclpy.exceptions import ExternalShutdownException as ExternalShutdownException
from rclpy.exceptions import ShutdownException as ShutdownException
from rclpy.exceptions import TimeoutException as TimeoutException
from rclpy.impl.executor import Executor as Executor
from rclpy.impl.executor import RunningNodes
from rclpy.impl.node_handle import NodeHandle
from rclpy.task import Task
from rclpy.task import await_or_execute as await_or_execute
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
        """Begin no callback any more; returns whether those under way have ended within the time [s]."""
        super().shutdown(timeout_sec)
        limit_ns = timeout_sec_to_nsec(timeout_sec)
        until_ns = None if limit_ns < 0 else self.context.graph.now_ns + limit_ns
        with baton.known():
            return baton.wait(lambda: not self._running, until_ns=until_ns, what="callbacks under way")

    def _spin_once(self, limit_ns: int, condition: Callable[[], bool]) -> None:
        with suppress(ExternalShutdownException):  # as in rclpy, whose other executor raises it
            super()._spin_once(limit_ns, condition)

    def can_work(self) -> bool:
        """Return whether a callback is ready to be run and a thread is free for it."""
        return bool(self._failed) or (self._running < self._num_threads and super().can_work())

    def _next_task(self) -> Task | None:
        if self._failed:
            raise self._failed.pop(0)
        return super()._next_task() if self._running < self._num_threads else None

    def _execute(self, task: Task) -> None:
        self._running += 1
        threading.Thread(target=self._work, args=(task,), name="callback", daemon=True).start()

    def _work(self, task: Task) -> None:
        with baton.known(), baton.at_end(AtEnd.STOP):
            try:
                super()._execute(task)
            except Exception as error:  # the thread that spins raises it
                self._failed.append(error)
            finally:
                self._running -= 1


@dataclass
class _Global:
    """The executor that spins where none is passed."""

    executor: Executor | None = None


def get_global_executor() -> Executor:
    """Return the executor that spins where none is passed."""
    kept = current_graph().part(_Global)
    if kept.executor is None or not kept.executor.context.is_valid:
        kept.executor = SingleThreadedExecutor()
        kept.executor.context.on_shutdown(_drop_global_executor)
    return kept.executor


def _drop_global_executor() -> None:
    kept = current_graph().part(_Global)
    if kept.executor is not None:
        kept.executor.shutdown()
        kept.executor = None


def wait_driving_live_nodes(ready: Callable[[], bool], *, seconds: float | None) -> bool:
    """Run the notebook's live nodes until `ready()`, at most so much robot time [s]; returns `ready()`."""
    graph = current_graph()
    until_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)
    executor = get_global_executor()
    with executor.joined_by(graph.part(RunningNodes).nodes), pace.kept(graph):
        executor.spin_until(until_ns, ready)
    return ready()


def wait_until(node: NodeHandle, ready: Callable[[], bool], timeout_sec: float | None, what: str) -> None:
    """Wait until `ready()`, at most `timeout_sec` [s]; in a notebook live nodes run meanwhile."""
    if current_graph().part(RunningNodes).nodes and threading.current_thread() is threading.main_thread():
        wait_driving_live_nodes(ready, seconds=timeout_sec)
        return
    until_ns = None if timeout_sec is None else node.graph.now_ns + round(timeout_sec * 1e9)
    with baton.known():
        baton.wait(ready, until_ns=until_ns, what=what)
