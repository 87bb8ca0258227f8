"""Time limits on a busy machine exclude the time that a submission waits for a processor."""

import os
import sys
from collections.abc import Iterator
from contextlib import closing, suppress

import pytest

from course_lib.course.course_file import Limits
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.filters import descendants
from course_lib.grading.jail.launch import shared_template
from course_lib.grading.run import submission_run
from course_lib.grading.run.submission_run import (
    ENDED,
    MAX_EXTENSION,
    OWN_THREAD,
    CellLog,
    SubmissionRun,
    ThreadTimes,
    WaitingTime,
)
from course_lib.grading.task import Call, Scenario, Task
from course_lib.ros.time import wall
from tests.processes import Program

HOGS = 4  # processes that compete for the submission's processor
LIMIT = 0.6  # [s] of a cell and of a scenario
WORK = """import os
def work(seconds=0.3):
    end = sum(os.times()[:2]) + seconds
    while sum(os.times()[:2]) < end:
        sum(range(1000))  # in a loop that only looks, robot time passes
"""
BUSY = Task(
    "week01.work", "Work", "function", "work", ("a", "b", "c"), (Scenario("public", calls=(Call(0.3),)),)
)


@pytest.fixture
def starved() -> Iterator[None]:
    """Submissions share one processor with others."""
    if not (sys.platform == "linux" and os.path.exists("/proc/self/schedstat")):
        pytest.skip("the kernel does not count how long a process waits for a processor")
    template, cpus = shared_template().pid, os.sched_getaffinity(0)
    hogs = [Program([sys.executable, "-c", "while True: pass"]) for _ in range(HOGS)]
    own = (0, template, *descendants(template))  # a submission runs where the thread does that starts it
    give_processors({min(cpus)}, *own, *(hog.pid for hog in hogs))
    yield
    for hog in hogs:
        hog.kill()
        hog.wait()
    give_processors(cpus, *own)


def give_processors(cpus: set[int], *pids: int) -> None:
    for pid in pids:
        with suppress(ProcessLookupError):  # the last submission's processes have ended
            os.sched_setaffinity(pid, cpus)


def run_cells(*cells: str, scenario: float = LIMIT, total: float = 2 * LIMIT) -> tuple[Evidence, CellLog]:
    limits = Limits(cell_seconds=LIMIT, scenario_seconds=scenario, total_seconds=total)
    with closing(SubmissionRun(cells, {BUSY.id: {}}, limits)) as session:
        return session.run(BUSY, BUSY.scenarios[0]), session.log


@pytest.mark.slow
@pytest.mark.usefixtures("starved")
def test_cpu_wait_time_of_a_starved_submission_is_not_counted() -> None:
    evidence, log = run_cells(WORK, "work()", "work()")
    assert (log.limit, log.stopped, evidence.stopped, evidence.errors) == ("", {}, "", ())


@pytest.mark.sample(1)
@pytest.mark.usefixtures("starved")
@pytest.mark.parametrize("cell", ["while True: pass", "os.read(os.pipe()[0], 1)"])
def test_endless_code_is_stopped_on_a_busy_machine(cell: str) -> None:
    # Only the cell is to meet its limit.
    evidence, log = run_cells(WORK, cell, scenario=30.0, total=60.0)
    assert (log.limit, evidence.stopped) == ("time", "")
    assert log.stopped == {1: f"cell 2 was stopped after {LIMIT:g} s"}


# what the threads have done when a limit of 10 s is met 10 s after the beginning, and by what it
# grows [s]
THREADS = [
    ({1: ThreadTimes(10, 0)}, 0.0),
    ({1: ThreadTimes(2, 8)}, 8.0),
    ({1: ThreadTimes(0, 0.01)}, 0.0),  # it sleeps
    ({1: ThreadTimes(5, 5), 2: ThreadTimes(5, 5)}, 0.0),  # each waits for the other one only
    ({1: ThreadTimes(2, 7), 2: ThreadTimes(1, 9)}, 7.0),
    ({1: ThreadTimes(1, 4), OWN_THREAD: ThreadTimes(1, 5)}, 9.0),  # the grader is starved, too
    ({}, 0.0),  # the kernel does not count
]


@pytest.mark.parametrize(("threads", "grows"), THREADS)
def test_time_limit_grows_by_the_time_waited_for_other_threads(
    threads: dict[int, ThreadTimes], grows: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    now, known = [100.0], dict[int, ThreadTimes]()
    monkeypatch.setattr(wall, "monotonic", lambda: now[0])
    monkeypatch.setattr(submission_run, "_threads", lambda _: iter(known.items()))
    count = WaitingTime(1, 10.0)
    now[0] += 10.0
    known.update(threads)
    assert count.extend() == pytest.approx(grows)
    assert count.extend() == 0.0  # the same waiting counts once


@pytest.mark.skipif(sys.platform != "linux", reason="needs /proc")
def test_cpu_time_of_ended_processes_is_counted() -> None:
    before = dict(submission_run._threads(os.getpid()))
    for _ in range(10):
        pid = os.fork()
        if pid == 0:
            while sum(os.times()[:2]) < 0.05:
                pass
            os._exit(0)
        os.waitpid(pid, 0)
    after = dict(submission_run._threads(os.getpid()))
    assert after[ENDED].after(before[ENDED]).running >= 0.4


def test_extension_of_the_time_limit_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr(wall, "monotonic", lambda: now[0])
    monkeypatch.setattr(submission_run, "_threads", lambda _: iter([(1, ThreadTimes(0.0, now[0]))]))
    count = WaitingTime(1, 10.0)
    while now[0] < 10_000.0:
        now[0] += 10.0
        count.extend()
    assert count.granted == MAX_EXTENSION * 10.0
