"""Faults while a class is graded leave the gradebook as it would be without them."""

import os
import random
import resource
import signal
import subprocess
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TypeVar

import psutil
import pytest

from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.store import Course, RecordsWriteError, lock_folder
from tests.grading.conftest import write_course
from tests.grading.graders import fingerprint, start_grader, write_class
from tests.patience import PATIENCE

T = TypeVar("T")
STUDENTS = 12
SECONDS = 300  # timeout of a grader on a busy machine [s]


@pytest.fixture(scope="module")
def top(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a course, a class in `in`, and its results without faults."""
    made = tmp_path_factory.mktemp("faults")
    write_class(made, STUDENTS)
    grade(made / "in", made / "undisturbed", jobs=1, course=write_course(made / "course"))
    return made


@pytest.fixture
def course(top: Path) -> Course:
    return Course(top / "course/exercises", top / "course/solutions")


@pytest.fixture
def undisturbed(top: Path) -> dict[str, str]:
    """Marks of the class without faults, by one job in this process."""
    return fingerprint(top / "undisturbed")


@pytest.mark.slow
def test_grading_with_two_jobs_gives_equal_evidence_and_marks(
    course: Course, top: Path, undisturbed: dict[str, str], tmp_path: Path
) -> None:
    grade(top / "in", tmp_path / "out", jobs=2, course=course)
    assert fingerprint(tmp_path / "out") == undisturbed
    kinds = Counter(Path(name).parts[0] for name in undisturbed)
    assert kinds["results"] == STUDENTS
    assert 3 <= kinds["evidence"] <= STUDENTS  # equal code with equal personal values has one


@pytest.mark.slow
def test_killed_grader_resumes_with_the_same_results(
    course: Course, undisturbed: dict[str, str], tmp_path: Path
) -> None:
    out, chance = tmp_path / "out", random.Random(5)
    finished: dict[Path, int] = {}
    for enough in chance.sample(range(STUDENTS), 2):
        grader = start_grader(course, out, 2, "resume")
        _wait_for_results(out, enough)
        time.sleep(chance.random() / 2)
        os.kill(grader.pid, signal.SIGKILL)
        grader.communicate()
        assert {path: path.stat().st_mtime_ns for path in finished} == finished  # nothing was graded twice
        finished = {path: path.stat().st_mtime_ns for path in out.glob("results/*/*.json")}
    last = start_grader(course, out, 2, "resume")
    output = last.communicate(timeout=SECONDS)[0]
    assert last.returncode == 0, output
    assert {path: path.stat().st_mtime_ns for path in finished} == finished
    assert fingerprint(out) == undisturbed


@pytest.mark.slow
def test_killed_worker_processes_do_not_change_marks(
    course: Course, undisturbed: dict[str, str], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    pauses = [tmp_path / "pause_1", tmp_path / "pause_4"]
    for pause in pauses:
        pause.touch()
    grader = start_grader(course, out, 2)
    # Two grading processes, and the template of each, from which submissions are forked.
    for pause, kind, enough in zip(pauses, ("spawn_main", "jail.template"), (2, 1), strict=True):
        _wait_until(pause.read_text)
        for process in _wait_until(partial(_below, grader.pid, kind, enough)):
            process.kill()
        pause.unlink()
    output = grader.communicate(timeout=SECONDS)[0]
    assert grader.returncode == 0, output
    assert fingerprint(out) == undisturbed


@pytest.mark.slow
def test_full_disk_stops_grading_with_one_line_and_resume_completes_it(
    course: Course, top: Path, undisturbed: dict[str, str], tmp_path: Path, small_disk: Path
) -> None:
    with pytest.raises(RecordsWriteError, match=r"No space left.*--resume") as stopped:
        grade(top / "in", small_disk / "out", jobs=1, course=course)
    assert "\n" not in str(stopped.value)
    subprocess.run(("mount", "-o", "remount,size=9m", str(small_disk)), check=True, timeout=PATIENCE)
    grade(top / "in", small_disk / "out", jobs=1, resume=True, course=course)
    assert fingerprint(small_disk / "out") == undisturbed


@pytest.mark.slow
def test_read_only_disk_is_reported_before_grading_starts(
    course: Course, top: Path, undisturbed: dict[str, str], tmp_path: Path, small_disk: Path
) -> None:
    subprocess.run(("mount", "-o", "remount,ro", str(small_disk)), check=True, timeout=PATIENCE)
    with pytest.raises(RecordsWriteError, match="Read-only file system"):
        grade(top / "in", small_disk / "out", jobs=1, course=course)
    subprocess.run(("mount", "-o", "remount,rw,size=9m", str(small_disk)), check=True, timeout=PATIENCE)
    grade(top / "in", small_disk / "out", jobs=1, resume=True, course=course)
    assert fingerprint(small_disk / "out") == undisturbed


@pytest.mark.slow
def test_clock_jump_does_not_change_marks(
    course: Course, top: Path, undisturbed: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, chance = time.time, random.Random(7)
    monkeypatch.setattr(time, "time", lambda: real() + chance.uniform(-1e8, 1e8))
    grade(top / "in", tmp_path / "out", jobs=1, course=course)
    assert fingerprint(tmp_path / "out") == undisturbed


def test_folder_on_a_full_disk_is_reported_with_its_path(tmp_path: Path) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        with (
            pytest.raises(RecordsWriteError, match=r"out can't be written: "),
            lock_folder(tmp_path / "out"),
        ):
            pass
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    with lock_folder(tmp_path / "out"):
        assert (tmp_path / "out/.lock").read_text().startswith("process ")


def test_second_grader_is_rejected_while_the_first_is_running(course: Course, tmp_path: Path) -> None:
    write_class(tmp_path, 1)
    with (
        lock_folder(tmp_path / "out"),
        pytest.raises(CourseError, match=f"in use by process {os.getpid()} on .*: wait"),
    ):
        grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    assert grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)


def test_partial_files_of_a_killed_grader_are_removed(tmp_path: Path) -> None:
    draft = tmp_path / "out/results/ada/.week01_exercise.json.4711"
    draft.parent.mkdir(parents=True)
    draft.write_text("{")
    with lock_folder(tmp_path / "out"):
        assert not draft.exists()


def _below(pid: int, kind: str, enough: int) -> list[psutil.Process]:
    """List the descendants of a process whose command contains a word; [] if there are too few."""
    found = []
    for process in psutil.Process(pid).children(recursive=True):
        with suppress(psutil.NoSuchProcess):
            found += [process] if any(kind in word for word in process.cmdline()) else []
    return found if len(found) >= enough else []


def _wait_for_results(out: Path, enough: int) -> None:
    _wait_until(lambda: len(list(out.glob("results/*/*.json"))) >= enough)


def _wait_until(ready: Callable[[], T]) -> T:
    end = time.monotonic() + SECONDS
    while not (found := ready()):
        assert time.monotonic() < end
        time.sleep(0.01)
    return found
