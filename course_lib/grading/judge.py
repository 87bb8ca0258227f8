"""The stage `judge`: compute scores from evidence with pure functions, so equal evidence gets equal scores.

Executors run the jobs of `run` and `judge` in this process, in several processes, or on a Dask
cluster.
"""

import multiprocessing
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from concurrent.futures import ProcessPoolExecutor as Pool
from concurrent.futures import ThreadPoolExecutor as Threads
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from multiprocessing import resource_tracker
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from course_lib.errors import CourseError
from course_lib.grading.evidence import Check, Evidence, Verdict, all_checks
from course_lib.grading.records import CheckResult, Judgement, TaskResult
from course_lib.grading.run.run import Run
from course_lib.grading.task import Catalog, Task, time_limit

if TYPE_CHECKING:
    from course_lib.grading.run.run import ExerciseRun

Tag = TypeVar("Tag")
TRIES = 2
CONNECT_SECONDS = 10  # [s]


class InlineExecutor(Executor):
    """An executor that calls functions immediately, in this process."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
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
        # New processes inherit the blocked SIGINT, and unblock it once they can end on Ctrl+C
        # without a traceback.
        super().__init__(count, initializer=_mask_interrupts, initargs=(signal.SIG_BLOCK,))
        # Start multiprocessing's tracker of semaphores here: a thread that starts it unblocks
        # Ctrl+C, and the first process would print a traceback. It would also warn about
        # semaphores that a second Ctrl+C leaves, which it then removes.
        sys.warnoptions.append("ignore:resource_tracker")
        try:
            resource_tracker.ensure_running()
        finally:
            sys.warnoptions.remove("ignore:resource_tracker")
        self._local = threading.local()
        self._processes: list[Pool] = []

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
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
                return self._process().submit(call).result()
            except BrokenExecutor:
                self._local.process = None
        raise CourseError(
            f"the process that graded it died {TRIES} times: it was killed, or ran out of memory"
        )

    def _process(self) -> Pool:
        if getattr(self._local, "process", None) is None:
            context = multiprocessing.get_context(
                "spawn"
            )  # A spawned process inherits none of this process's threads and locks.
            self._local.process = Pool(1, mp_context=context, initializer=_end_with_parent)
            self._processes.append(self._local.process)
        process: Pool = self._local.process
        return process


def _end_with_parent() -> None:
    """End this process silently on Ctrl+C, and when its parent process ends."""
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
    """Open the executors for running and judging.

    The block gets the executors and the number of submissions that may be pending.

    Args:
        jobs: Number of processes on this machine.
        dask: Address of a Dask scheduler whose workers run submissions; judging stays on this
            machine.

    Raises:
        CourseError: No scheduler answers at the address.
    """
    local: Executor = InlineExecutor() if jobs == 1 else ProcessPool(jobs)
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
        raise CourseError("--dask needs an extra package: pip install 'course-lib[dask]'") from error
    try:
        # Check the address first: a Client with an invalid one prints a traceback when it is
        # destroyed.
        get_address_host_port(address)
        return Client(address, timeout=CONNECT_SECONDS, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise CourseError(
            f"--dask {address}: no scheduler answers ({error}). Start one with `dask scheduler` "
            "and pass its address, like tcp://127.0.0.1:8786"
        ) from error


def flow(
    executor: Executor,
    function: Callable[..., Any],
    calls: Iterable[tuple[Tag, Sequence[Any]]],
    window: int,
) -> Iterator[tuple[Tag, "Future[Any]"]]:
    """Submit calls for (tag, arguments), `window` at a time, and yield (tag, future) as they end."""
    pending: dict[Future[Any], Tag] = {}
    for tag, arguments in calls:
        pending[executor.submit(function, *arguments)] = tag
        if len(pending) >= window:
            yield from _take_completed(pending)
    while pending:
        yield from _take_completed(pending)


def _take_completed(pending: dict["Future[Any]", Tag]) -> Iterator[tuple[Tag, "Future[Any]"]]:
    for future in wait(pending, return_when=FIRST_COMPLETED).done:
        yield pending.pop(future), future


CHECK_SECONDS = 5.0  # [s] processor time of one check
TASK_SECONDS = 10.0  # [s] processor time of all checks of a task
LEAST_SECONDS = 0.1  # [s] minimum for a check if the others have used up the task's time
LONGEST = 500  # characters of an exception's text
NEEDS_ANOTHER = "another check must pass first"
TOO_LARGE = "the messages are too large to be checked in time"
CANNOT_JUDGE = (
    "this check raised an error on your messages: a fault in the course, which your instructor will look into"
)

# The exception's text may reveal a hidden input, so students don't see it. The evidence contains
# it.
HIDDEN_ERROR = "in a hidden scenario the code raises an exception, or ends too early"


def judge(run: "ExerciseRun", tasks: Sequence[Task], catalog: Catalog) -> Judgement:
    """Judge the evidence of a submission with the checks of its tasks."""
    results = tuple(
        judge_task(task, *catalog.points(task), [one for one in run.runs if one.evidence.task == task.id])
        for task in tasks
    )
    return Judgement(
        tasks=results,
        isolation=str(run.isolation),
        limit=next((result.stopped for result in results if result.stopped), run.log.limit),
        cell_errors=(*run.log.stopped.values(), *run.log.errors),
        output=run.log.output,
        digests={f"{r.evidence.task}/{r.scenario.name}": r.evidence.recording.digest() for r in run.runs},
    )


def judge_task(task: Task, points: float, bonus: bool, runs: Sequence[Run]) -> TaskResult:
    """Judge all runs of a task. A check that raises an exception loses only its own points."""
    judge = _Judge()
    checks = tuple(result for run in runs for result in judge.results(run))
    if task.rubric:
        # A person marks this task, so the checks only report.
        checks = tuple(replace(check, weight=0.0) for check in checks)
    errors = dict.fromkeys(error for run in runs if not run.hidden for error in run.evidence.errors)
    if any(
        set(run.evidence.errors) - errors.keys() for run in runs if run.hidden and not run.evidence.stopped
    ):
        errors[HIDDEN_ERROR] = None
    stopped = next((run.evidence.stopped for run in runs if run.evidence.stopped), "")
    return TaskResult(task.id, task.title, points, bonus, checks, tuple(errors), stopped, rubric=task.rubric)


class _Judge:
    """The judge of one task, with a limit of processor time for all of its checks."""

    def __init__(self) -> None:
        self._remaining = TASK_SECONDS
        self._verdicts: dict[Callable[[Evidence], Verdict], Verdict] = {}  # verdicts of the current run
        self._seconds: dict[Callable[[Evidence], Verdict], float] = {}

    def results(self, run: Run) -> list[CheckResult]:
        """Return a row for each check, then release the messages that were decoded for them."""
        self._verdicts = {}
        evidence = replace(run.evidence, checks=all_checks(run.scenario.checks))
        rows = [_row(check, run, self._verdict(check, evidence)) for check in run.scenario.checks]
        evidence.release()
        took = [self._seconds[check.judge] for check in run.scenario.checks]
        return [replace(row, seconds=seconds) for row, seconds in zip(rows, took, strict=True)]

    def _verdict(self, check: Check, evidence: Evidence) -> Verdict:
        """Return a check's verdict, with score 0 if a check that it requires fails.

        If the check itself passes, the message names the required check.
        """
        if check.judge not in self._verdicts:
            self._verdicts[check.judge] = self._run_check(check, evidence)
        verdict = self._verdicts[check.judge]
        for required in check.requires:
            failing = self._verdict(required, evidence)
            if failing.score >= 1 and not failing.broken:
                continue
            if verdict.score >= 1 or failing.broken:
                message = f'checked once "{required.title}" passes'
                return Verdict(0.0, message, NEEDS_ANOTHER, failing.broken)
            return replace(verdict, score=0.0)
        return verdict

    def _run_check(self, check: Check, evidence: Evidence) -> Verdict:
        begin = time.process_time()
        try:
            with time_limit(max(min(CHECK_SECONDS, self._remaining), LEAST_SECONDS)):
                verdict = check.judge(evidence)
                if not isinstance(verdict, Verdict):
                    raise TypeError(f"the check returned {verdict!r}, expected passed(...) or failed(...)")
                return replace(verdict, score=float(verdict.score), message=str(verdict.message))
        except Exception as error:
            # Student data can trigger errors in a check or in the kit; the student is not at fault.
            slow = evidence.large_message if isinstance(error, TimeoutError) else ""
            message = f"{TOO_LARGE}: {slow}; publish fewer points" if slow else CANNOT_JUDGE
            kind = TOO_LARGE if slow else CANNOT_JUDGE
            return Verdict(
                0.0, message, kind, f"{_location(check, error)}{type(error).__name__}: {error}"[:LONGEST]
            )
        finally:
            self._seconds[check.judge] = time.process_time() - begin
            self._remaining -= self._seconds[check.judge]


def _location(check: Check, error: Exception) -> str:
    """Return the location of an exception in a check, "week01.py line 12: ", or ""."""
    frames = traceback.extract_tb(error.__traceback__)
    check_frames = [frame for frame in frames if Path(frame.filename).parent.name == "checks"]
    if check_frames:
        # Three path components identify the check file; results contain no absolute paths of this
        # machine.
        return f"{'/'.join(Path(check_frames[-1].filename).parts[-3:])} line {check_frames[-1].lineno}: "
    code = getattr(check.judge, "__code__", None)
    if check.origin is None and code is not None:
        return f"{'/'.join(Path(code.co_filename).parts[-3:])} line {code.co_firstlineno}: "
    return f"{check.origin.place}: " if check.origin else ""


def _row(check: Check, run: Run, verdict: Verdict) -> CheckResult:
    # The comparison is also false for NaN.
    score = verdict.score if 0 <= verdict.score <= 1 else 0.0
    mistake = verdict.mistake or ("as expected" if score == 1 else "not as expected")
    return CheckResult(
        title=check.title,
        scenario=run.scenario.name,
        hidden=run.hidden,
        weight=check.weight,
        score=score,
        message=verdict.message,
        mistake=mistake,
        broken=verdict.broken,
    )
