"""Executors, which run the callbacks of their nodes."""

import os
import threading
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time import pace
from course_lib.ros.time.time_lock import AtEnd, time_lock
from rclpy.context import Context, get_default_context
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

_ONE_THREAD = "MultiThreadedExecutor is used with a single thread.\nUse the SingleThreadedExecutor instead."


class SingleThreadedExecutor(Executor):
    """Runs callbacks one after the other, in the thread that spins."""


class MultiThreadedExecutor(Executor):
    """Runs each callback in its own thread, at most `num_threads` (default: CPUs) at a time.

    A callback that waits does not block the others.
    """

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        if num_threads == 1:
            warnings.warn(_ONE_THREAD, stacklevel=2)
        if num_threads is not None and num_threads <= 0:
            raise ValueError("max_workers must be greater than 0")
        self._course_threads = num_threads or os.cpu_count() or 2
        self.__running = 0
        self.__failed: list[BaseException] = []

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Start no more callbacks.

        Return whether the running ones have ended within `timeout_sec` [s].
        """
        super().shutdown(timeout_sec)
        limit_ns = timeout_sec_to_nsec(timeout_sec)
        until_ns = None if limit_ns < 0 else self.context.graph.now_ns + limit_ns
        with time_lock.hold():
            return time_lock.wait(lambda: not self.__running, until_ns=until_ns, what="callbacks under way")

    def _spin_once_impl(self, limit_ns: int, condition: Callable[[], bool]) -> None:
        # As in rclpy, where only the other executor raises it.
        with suppress(ExternalShutdownException):
            super()._spin_once_impl(limit_ns, condition)

    def _course_can_work(self) -> bool:
        """Return whether a callback is ready to be run and a thread is free for it."""
        return bool(self.__failed) or (self.__running < self._course_threads and super()._course_can_work())

    def _course_raise_failed(self) -> None:
        if self.__failed:
            raise self.__failed.pop(0)

    def _course_next_task(self) -> Task | None:
        self._course_raise_failed()
        return super()._course_next_task() if self.__running < self._course_threads else None

    def _course_execute(self, task: Task) -> None:
        self.__running += 1
        threading.Thread(target=self.__work, args=(task,), name="callback", daemon=True).start()

    def __work(self, task: Task) -> None:
        with time_lock.hold(), time_lock.at_end(AtEnd.STOP):
            try:
                super()._course_execute(task)
            # Kept for the thread that spins, which raises it.
            except Exception as error:
                self.__failed.append(error)
            finally:
                self.__running -= 1


class TimeoutObject:
    """A timeout that several waits share."""

    def __init__(self, timeout: float) -> None:
        self.timeout = timeout


@dataclass
class _Global:
    """The executor that `spin` uses if none is passed."""

    executor: Executor | None = None


def get_global_executor() -> Executor:
    """Return the executor that `spin` uses if none is passed."""
    kept = current_graph().part(_Global)
    if kept.executor is None or (not kept.executor.context.is_valid and get_default_context().is_valid):
        kept.executor = SingleThreadedExecutor()
        kept.executor.context.on_shutdown(_drop_global_executor)
    return kept.executor


def _drop_global_executor() -> None:
    kept = current_graph().part(_Global)
    if kept.executor is not None:
        kept.executor.shutdown()
        kept.executor = None


def wait_driving_live_nodes(ready: Callable[[], bool], *, seconds: float | None) -> bool:
    """Run the notebook's live nodes until `ready()`, at most `seconds` of robot time.

    Return `ready()`.
    """
    graph = current_graph()
    until_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)
    executor = get_global_executor()
    with executor._course_joined_by(graph.part(RunningNodes).nodes), pace.keep_pace(graph):
        executor._course_spin_until(until_ns, ready)
    return ready()


def wait_until(node: NodeHandle, ready: Callable[[], bool], timeout_sec: float | None, what: str) -> None:
    """Wait until `ready()`, at most `timeout_sec` [s].

    In a notebook, live nodes run during the wait.
    """
    if current_graph().part(RunningNodes).nodes and threading.current_thread() is threading.main_thread():
        wait_driving_live_nodes(ready, seconds=timeout_sec)
        return
    until_ns = None if timeout_sec is None else node.graph.now_ns + round(timeout_sec * 1e9)
    with time_lock.hold():
        time_lock.wait(ready, until_ns=until_ns, what=what)
