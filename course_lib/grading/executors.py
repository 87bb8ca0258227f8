"""Executors that run and judge submissions: this process, several processes, or a Dask cluster."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from concurrent.futures import ProcessPoolExecutor as Pool
from concurrent.futures import ThreadPoolExecutor as Threads
from contextlib import contextmanager
from functools import partial
from typing import Any, TypeVar

from course_lib.errors import CourseError

Tag = TypeVar("Tag")
TRIES = 2
CONNECT_SECONDS = 10  # [s]


class Here(Executor):
    """An executor that calls in this process."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Call, and return a future that is done."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # whoever asks for the result gets it
            future.set_exception(error)
        return future


class ProcessPool(Threads):
    """Processes with one thread each, which replaces its process when that dies and repeats the call.

    A pool of several would lose all that is under way when one of them dies.
    """

    def __init__(self, count: int) -> None:
        # What they start has Ctrl+C blocked, too, until it is ready to die of it without a word.
        super().__init__(count, initializer=_mask_interrupts, initargs=(signal.SIG_BLOCK,))
        self._own = threading.local()
        self._all: list[Pool] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        """Call in one of the processes."""
        return super().submit(self._call, partial(fn, *args, **kwargs))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all processes."""
        super().shutdown(wait, cancel_futures=cancel_futures)
        for process in self._all:
            process.shutdown(wait)

    def _call(self, call: Callable[[], Any]) -> Any:
        for _ in range(TRIES):
            try:
                return self._process().submit(call).result()
            except BrokenExecutor:
                self._own.process = None
        raise CourseError(f"the process that graded it died, {TRIES} times: killed, or out of memory")

    def _process(self) -> Pool:
        if getattr(self._own, "process", None) is None:
            context = multiprocessing.get_context("spawn")  # no threads and no locks of this process in it
            self._own.process = Pool(1, mp_context=context, initializer=_end_with_parent)
            self._all.append(self._own.process)
        process: Pool = self._own.process
        return process


def _end_with_parent() -> None:
    """End this process on Ctrl+C without a message, and when its parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    _mask_interrupts(signal.SIG_UNBLOCK)
    parent = multiprocessing.parent_process()

    def follow() -> None:
        if parent is not None:
            parent.join()
        os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


def _mask_interrupts(how: int) -> None:
    signal.pthread_sigmask(how, {signal.SIGINT})


@contextmanager
def executors(jobs: int, dask: str | None) -> Iterator[tuple[Executor, Executor, int]]:
    """Open executors for running and judging, with the number of submissions that may be in progress.

    Args:
        jobs: Processes of this machine.
        dask: Address of a scheduler on whose workers submissions are run; judging stays here.

    Raises:
        CourseError: There is no scheduler.
    """
    local: Executor = Here() if jobs == 1 else ProcessPool(jobs)
    try:
        if dask is None:
            yield local, local, 1 if jobs == 1 else 2 * jobs
        else:
            with _client(dask) as client:
                threads = sum(client.nthreads().values())
                yield client.get_executor(pure=False), local, 2 * max(threads, 1)
    finally:
        local.shutdown(wait=False, cancel_futures=True)


def _client(address: str) -> Any:
    try:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port
    except ImportError as error:
        raise CourseError("--dask needs a package more: pip install 'course-lib[dask]'") from error
    try:
        get_address_host_port(address)  # half a client of no address ends with a traceback
        return Client(address, timeout=CONNECT_SECONDS, set_as_default=False)  # type: ignore[no-untyped-call]  # its own
    except (OSError, ValueError) as error:
        raise CourseError(
            f"--dask {address}: no scheduler answers ({error}). Start one with `dask scheduler`, "
            "and give its address, like tcp://127.0.0.1:8786"
        ) from error


def flow(
    executor: Executor, function: Callable[..., Any], calls: Iterable[tuple[Tag, Sequence[Any]]], window: int
) -> Iterator[tuple[Tag, "Future[Any]"]]:
    """Call for each (tag, arguments), `window` at a time; yields (tag, its future) as they end."""
    pending: dict[Future[Any], Tag] = {}
    for tag, arguments in calls:
        pending[executor.submit(function, *arguments)] = tag
        if len(pending) >= window:
            yield from _ended(pending)
    while pending:
        yield from _ended(pending)


def _ended(pending: dict["Future[Any]", Tag]) -> Iterator[tuple[Tag, "Future[Any]"]]:
    for future in wait(pending, return_when=FIRST_COMPLETED).done:
        yield pending.pop(future), future
