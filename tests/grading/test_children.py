"""Functions in a fork of the grader, and time limits of blocks that do not compute."""

import gc
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading import executors
from course_lib.grading.executors import call_in_child
from course_lib.grading.task import time_limit
from tests.patience import PATIENCE
from tests.processes import Program


def wait_for(lock: threading.Lock) -> None:
    lock.acquire()


def look_for(lock: threading.Lock) -> None:
    while not lock.acquire(blocking=False):
        time.sleep(0.002)


@pytest.mark.parametrize("take", [wait_for, look_for])
def test_fork_that_waits_for_a_lock_of_another_thread_is_replaced(
    tmp_path: Path, take: Callable[[threading.Lock], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(executors, "STUCK_SECONDS", 0.5)
    lock = threading.Lock()
    lock.acquire()

    def call() -> str:
        mark = tmp_path / "called"
        if not mark.exists():
            mark.touch()
            take(lock)
        return "the second fork"

    assert call_in_child(call) == "the second fork"


def test_fork_that_always_waits_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(executors, "STUCK_SECONDS", 0.3)
    lock = threading.Lock()
    lock.acquire()
    with pytest.raises(CourseError, match="stopped computing 2 times: run the command again"):
        call_in_child(lambda: wait_for(lock))


def test_fork_that_computes_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(executors, "STUCK_SECONDS", 0.2)

    def compute() -> int:
        with (tmp_path / "calls").open("a") as calls:
            calls.write("x")
        end = time.process_time() + 1.0
        while time.process_time() < end:
            pass
        return len("x" * 5_000_000)

    assert call_in_child(compute) == 5_000_000
    assert (tmp_path / "calls").read_text() == "x"


def test_time_limit_ends_a_block_that_looks_again_and_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.grading.task.WAIT_SECONDS", 0.5)
    lock = threading.Lock()
    lock.acquire()
    with pytest.raises(TimeoutError, match="it waits for something"), time_limit(PATIENCE):
        look_for(lock)


def test_time_limit_keeps_the_timer_of_its_caller() -> None:
    former = signal.setitimer(signal.ITIMER_REAL, PATIENCE)
    try:
        with time_limit(1.0):
            pass
        assert PATIENCE / 2 < signal.getitimer(signal.ITIMER_REAL)[0] <= PATIENCE
    finally:
        signal.setitimer(signal.ITIMER_REAL, *former)


def test_fork_does_not_finalize_objects_of_its_parent() -> None:
    """The garbage collector of a fork closed sessions of Zenoh, which never returned."""
    finalized = list[int]()

    class Session:
        def __init__(self) -> None:
            self.cycle = self

        def __del__(self) -> None:
            finalized.append(os.getpid())

    gc.disable()
    try:
        Session()
        assert call_in_child(lambda: [gc.collect(), *finalized][1:]) == []
    finally:
        gc.enable()
    gc.collect()
    assert finalized == [os.getpid()]


PARENT_OF_A_CHECK = """
import os, sys, time
from course_lib.grading.executors import ProcessPool
from course_lib.grading.task import limit_course_code

def check(mark):
    with limit_course_code(60.0):
        open(mark, "w").write(str(os.getpid()))
        while True:
            time.sleep(0.01)

if __name__ == "__main__":
    processes = ProcessPool(1)
    processes.submit(check, sys.argv[1])
    while not (os.path.exists(sys.argv[1]) and os.path.getsize(sys.argv[1])):
        time.sleep(0.01)
    os.kill(os.getpid(), 9)
"""


def test_process_that_runs_a_check_ends_with_its_killed_parent(tmp_path: Path) -> None:
    script, mark = tmp_path / "parent.py", tmp_path / "mark"
    script.write_text(PARENT_OF_A_CHECK)
    grader = Program(
        [sys.executable, str(script), str(mark)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    )
    # Returns when no process has the pipe open any more. Nothing else ends a check that computes
    # and waits in turn before PATIENCE.
    output, _ = grader.communicate(timeout=PATIENCE)
    assert mark.read_text()
    assert "RuntimeError" not in output
