"""Executors for the stages `run` and `judge`: this process, a pool of processes, or Dask."""

import faulthandler
import gc
import io
import math
import os
import pickle
import re
import select
import signal
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from concurrent.futures import ThreadPoolExecutor as Threads
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from course_lib.errors import CourseError

Tag = TypeVar("Tag")
Result = TypeVar("Result")
TRIES = 2
CONNECT_SECONDS = 10  # [s]
_INTERRUPT = {signal.SIGINT}


class InlineExecutor(Executor):
    """An executor that calls functions immediately, in this process."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call the function and return a completed future."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class ProcessPool(Threads):
    """A pool of single-thread processes, which replaces a process that dies and repeats its call.

    A pool with several processes would lose all running calls if one process died.
    """

    def __init__(self, count: int) -> None:
        # The checks of a kernel import this module, and never need these packages.
        import multiprocessing
        from concurrent.futures import ProcessPoolExecutor
        from multiprocessing import resource_tracker

        # New processes inherit the blocked SIGINT, and unblock it once they can end on Ctrl+C
        # without a traceback.
        super().__init__(count, initializer=signal.pthread_sigmask, initargs=(signal.SIG_BLOCK, _INTERRUPT))
        # Start multiprocessing's tracker of semaphores here: a thread that starts it unblocks
        # Ctrl+C, and the first process would print a traceback. It would also warn about
        # semaphores that a second Ctrl+C leaves, which it then removes.
        sys.warnoptions.append("ignore:resource_tracker")
        try:
            resource_tracker.ensure_running()
        finally:
            sys.warnoptions.remove("ignore:resource_tracker")
        # A spawned process inherits none of this process's threads and locks.
        context = multiprocessing.get_context("spawn")
        self._start = partial(ProcessPoolExecutor, 1, context, _end_with_parent)
        self._local = threading.local()
        self._processes: list[Executor] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call the function in one of the processes."""
        return super().submit(self._call, partial(fn, *args, **kwargs))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all processes."""
        super().shutdown(wait, cancel_futures=cancel_futures)
        for process in self._processes:
            process.shutdown(wait)

    def _call(self, call: Callable[[], Any]) -> Any:
        for _ in range(TRIES):
            try:
                # Each thread has a process of its own.
                if getattr(self._local, "process", None) is None:
                    self._local.process = self._start()
                    self._processes.append(self._local.process)
                process: Executor = self._local.process
                return process.submit(call).result()
            except BrokenExecutor:
                self._local.process = None
        raise CourseError(
            f"the process that graded it died {TRIES} times: it was killed, or ran out of memory. "
            "Repeat the command with --resume and a smaller --jobs"
        )


def _end_with_parent() -> None:
    """End this process silently on Ctrl+C, and when its parent process ends."""
    from multiprocessing import parent_process

    signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _INTERRUPT)
    parent = parent_process()
    # While a check runs, os._exit is replaced by a function that raises an error.
    exit_process = os._exit

    def follow() -> None:
        if parent is not None:
            parent.join()
        exit_process(1)

    threading.Thread(target=follow, daemon=True).start()


@contextmanager
def executors(jobs: int, dask: str | None) -> Iterator[tuple[Executor, Executor, int]]:
    """Open the executors for running and judging.

    The block gets the executors and the number of submissions that may be pending. Judging always
    has processes of its own, because a check may crash one.

    Args:
        jobs: Number of processes on this machine. One runs submissions in this process.
        dask: Address of a Dask scheduler whose workers run submissions; judging stays on this
            machine.

    Raises:
        CourseError: No scheduler answers at the address.
    """
    judges = ProcessPool(jobs)
    try:
        if dask is None:
            yield InlineExecutor() if jobs == 1 else judges, judges, 1 if jobs == 1 else 2 * jobs
        else:
            with _client(dask) as client:
                threads = sum(client.nthreads().values())
                yield client.get_executor(pure=False), judges, 2 * max(threads, 1)
    finally:
        judges.shutdown(wait=False, cancel_futures=True)


def _client(address: str) -> Any:
    try:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port
    except ImportError as error:
        raise CourseError("--dask needs an extra package: pip install 'course-lib[dask]'") from error
    try:
        # Check the address first: a Client with an invalid one prints a traceback when it is
        # destroyed.
        get_address_host_port(address)
        return Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
    except (OSError, ValueError) as error:
        raise CourseError(
            f"--dask {address}: no scheduler answers ({error}). Start one with `dask scheduler` "
            "and pass its address, like tcp://127.0.0.1:8786"
        ) from error


def submit_in_window(
    executor: Executor,
    function: Callable[..., Any],
    calls: Iterable[tuple[Tag, Sequence[Any]]],
    window: int,
) -> Iterator[tuple[Tag, Future[Any]]]:
    """Submit calls (tag, arguments), `window` at a time, and yield (tag, future) as they end."""
    pending: dict[Future[Any], Tag] = {}
    for tag, arguments in calls:
        pending[executor.submit(function, *arguments)] = tag
        if len(pending) >= window:
            yield from _take_results(pending)
    while pending:
        yield from _take_results(pending)


def _take_results(pending: dict[Future[Any], Tag]) -> Iterator[tuple[Tag, Future[Any]]]:
    for future in wait(pending, return_when=FIRST_COMPLETED).done:
        yield pending.pop(future), future


CAN_FORK = sys.platform == "linux"  # the frameworks of macOS don't survive a fork
# A process that is busy for less than this share of the time waits for a file, a lock or the
# network, or looks for it again and again. A program that computes is busy all the time.
IDLE_SHARE = 0.05
# Wall time [s] after which an idle fork is replaced. A check that waits ends before, with its line.
STUCK_SECONDS = 60.0
_CRASH_LINE = re.compile(r'File "([^"]+)", line (\d+)')


class ChildDiedError(CourseError):
    """Raised if a forked process ends before its function returns.

    Args:
        reason: How it ended, "it ends the process with SIGSEGV".
        places: The files and lines that it ran, innermost first; empty if it was killed.
    """

    def __init__(self, reason: str, places: Sequence[tuple[str, int]]) -> None:
        super().__init__(reason)
        self.places = tuple(places)


def busy_seconds(process: int) -> float:
    """Return how long the main thread of a process has computed or waited for a processor.

    So the result does not depend on other programs of a busy machine, unlike processor time.

    Returns:
        The time [s]; only the processor time where the system has no more to tell about this
        process, and NaN where it tells nothing about another one.
    """
    try:
        running_ns, queued_ns, _ = map(int, Path(f"/proc/{process}/schedstat").read_text().split())
    except (OSError, ValueError):
        return time.thread_time() if process == os.getpid() else math.nan
    return (running_ns + queued_ns) * 1e-9


def call_in_child(function: Callable[[], Result]) -> Result:
    """Call a function in a fork of this process, and return its result.

    Code of the course runs in the process of the grader, where a crash of C code would end the
    grading of a class without a word. A fork that crashes can be reported.

    Raises:
        ChildDiedError: The process of the function crashed or was killed.
        CourseError: The function raised any exception, or its process stopped computing.
    """
    for _ in range(TRIES):
        try:
            data = _answer_of_child(function)
        except TimeoutError:
            # A lock that another thread held during the fork is never released in the child. The
            # next fork rarely finds the thread at the same place.
            continue
        result, error = pickle.loads(data)
        if error:
            raise CourseError(error)
        return result  # type: ignore[no-any-return]
    raise CourseError(f"the grader's process stopped computing {TRIES} times: run the command again")


def _answer_of_child(function: Callable[[], object]) -> bytes:
    """Return what `_answer` writes in a fork of this process.

    Raises:
        ChildDiedError: The fork crashed or was killed.
        TimeoutError: The fork was idle for `STUCK_SECONDS`.
    """
    reader, writer = os.pipe()
    with tempfile.TemporaryFile("w+") as crash, open(reader, "rb", buffering=0) as answer:
        with warnings.catch_warnings():
            # Python 3.12 warns if other threads run.
            warnings.simplefilter("ignore", DeprecationWarning)
            child = os.fork()
        if child == 0:
            _answer(function, writer, crash)
        os.close(writer)
        try:
            data, busy = bytearray(), 0.0
            while True:
                if select.select([answer], [], [], STUCK_SECONDS)[0]:
                    if not (part := answer.read(2**20)):
                        break
                    data += part
                before, busy = busy, busy_seconds(child)
                if not data and busy - before < IDLE_SHARE * STUCK_SECONDS:
                    raise TimeoutError
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        except BaseException:
            os.kill(child, signal.SIGKILL)
            os.waitpid(child, 0)
            raise
        crash.seek(0)
        places = [(match[1], int(match[2])) for match in _CRASH_LINE.finditer(crash.read())]
    if code != 0:
        how = signal.Signals(-code).name if code < 0 else f"the exit code {code}"
        raise ChildDiedError(f"it ends the process with {how}", places)
    return bytes(data)


def _answer(function: Callable[[], object], writer: int, crash: Any) -> NoReturn:
    """Write the result of a function, or its error, into a pipe, and end this forked process."""
    try:
        # Garbage of the parent must not be finalized here: a session of Zenoh would wait forever
        # for its threads, which the fork does not have. No time limit ends this wait, which is
        # outside Python.
        gc.freeze()
        # The streams may be locked by such a thread.
        sys.stdout = sys.stderr = io.StringIO()
        faulthandler.enable(crash, all_threads=False)
        try:
            answer = pickle.dumps((function(), ""))
        except BaseException as error:
            # sys.exit() and Ctrl+C must not run the parent's code in this process.
            answer = pickle.dumps((None, f"{type(error).__name__}: {error}"))
        with open(writer, "wb") as file:
            file.write(answer)
        os._exit(0)
    finally:
        os._exit(1)
