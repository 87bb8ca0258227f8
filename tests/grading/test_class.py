"""A class as a whole: stored evidence, policies, and where submissions run."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.grading.executors import CAN_FORK, InlineExecutor, ProcessPool, submit_in_window
from course_lib.grading.grade import grade
from course_lib.grading.marks import results_in
from course_lib.grading.run import run
from course_lib.grading.run.run import Job
from course_lib.grading.store import Course, catalog_of, rules_of
from tests.grading.graders import fingerprint, write_class

WriteNotebook = Callable[..., Path]
NAME = "week01_exercise.ipynb"


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    catalog_of.cache_clear()
    rules_of.cache_clear()


def marks(out: Path) -> dict[str, Any]:
    return {one.student: one.row.mark and one.row.mark.final for one in results_in(out)}


def count_runs(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Record the keys of all following runs."""
    runs: list[str] = []

    run_scenarios = run.run_scenarios

    def counted(job: Job) -> run.ExerciseRun:
        runs.append(job.key)
        return run_scenarios(job)

    monkeypatch.setattr(run, "run_scenarios", counted)
    return runs


def test_identical_files_are_run_once_and_reported_to_staff(
    course: Course,
    right: str,
    tmp_path: Path,
    write_notebook: WriteNotebook,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for student in ("ada", "dora"):
        path = write_notebook(tmp_path / "in" / student / NAME, right, student="ada")
        path.with_name("timestamp.txt").write_text("2026-10-11 12:00:00 UTC")
    runs = count_runs(monkeypatch)
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    assert len(runs) == 1  # as both have the same personal values
    assert marks(tmp_path / "out") == {"ada": 110, "dora": 110}
    output = capsys.readouterr().out
    assert "ada  week01_exercise  note: the same file as that of dora" in output
    assert "dora  week01_exercise  note: the file has the ID ada, but dora submitted it" in output


@pytest.mark.slow
def test_changed_checks_judge_stored_evidence_without_running_submissions(
    course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_class(tmp_path, 2)
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    before = marks(tmp_path / "out")
    change(course.exercises / "checks/week01.py", "expect_value(2.0", "expect_value(2.5")
    runs = count_runs(monkeypatch)
    grade(tmp_path / "in", tmp_path / "out", jobs=1, rejudge=True, course=course)
    after = marks(tmp_path / "out")
    assert runs == []
    assert all(after[student] < before[student] for student in before)


@pytest.mark.slow
def test_resume_runs_only_submissions_with_missing_evidence_or_changed_limits(
    course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_class(tmp_path, 1)
    out = tmp_path / "out"
    grade(tmp_path / "in", out, jobs=1, course=course)
    page, result = out / "reports/s0000/week01_exercise.html", out / "results/s0000/week01_exercise.json"
    before, written = page.read_bytes(), result.stat().st_mtime_ns
    runs = count_runs(monkeypatch)
    page.unlink()
    grade(tmp_path / "in", out, jobs=1, resume=True, course=course)
    assert (runs, page.read_bytes(), result.stat().st_mtime_ns) == ([], before, written)
    change(course.exercises / "course.toml", "cell_seconds = 30", "cell_seconds = 29")
    grade(tmp_path / "in", out, jobs=1, resume=True, course=course)
    assert len(runs) == 1


@pytest.mark.slow
def test_evidence_from_changed_inputs_is_not_reused(
    course: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_class(tmp_path, 1)
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    before = fingerprint(tmp_path / "out")
    change(course.solutions / "checks/week01.py", "Call(-7.0)", "Call(-8.0)")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, rejudge=True, course=course)
    assert "s0000  week01_exercise  no evidence for these inputs" in capsys.readouterr().out
    assert fingerprint(tmp_path / "out") == before


@pytest.mark.slow
def test_damaged_evidence_is_reported_as_a_grader_error(course: Course, tmp_path: Path) -> None:
    write_class(tmp_path, 1)
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    (evidence,) = (tmp_path / "out/evidence").glob("*.gz")
    evidence.write_bytes(evidence.read_bytes()[:100])
    assert not grade(tmp_path / "in", tmp_path / "out", jobs=1, rejudge=True, course=course)
    (result,) = results_in(tmp_path / "out")
    assert (result.row.status, result.row.mark) == ("grader_error", None)
    assert grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)


@pytest.mark.slow
def test_last_or_best_attempt_counts_and_extension_moves_one_deadline(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    for student in ("ada", "bob"):
        write_notebook(tmp_path / "in" / student / "1" / NAME, right, student=student)
        write_notebook(tmp_path / "in" / student / "2" / NAME, right + "\nhalf = None", student=student)
    times = {"1": "2026-10-13T10:00:00+02:00", "2": "2026-10-13T11:00:00+02:00"}
    rows = [f"{s}/{n}/{NAME},{time}" for s in ("ada", "bob") for n, time in times.items()]
    (tmp_path / "in/received.csv").write_text("\n".join(["file,received", *rows]))
    settings = course.exercises / "course.toml"
    change(
        settings,
        "[weeks.week01.bonus]",
        "[weeks.week01.extensions]\nbob = 2026-10-12T23:59:00\n[weeks.week01.bonus]",
    )
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    assert marks(tmp_path / "out") == {"ada": 56, "bob": 63}  # 70 points, two days late and one
    change(settings, 'title = "A course"', 'title = "A course"\ncounts = "best"')
    grade(tmp_path / "in", tmp_path / "out", jobs=1, resume=True, course=course)
    assert marks(tmp_path / "out") == {"ada": 88, "bob": 99}
    (ada, _) = results_in(tmp_path / "out")
    assert [attempt.final for attempt in ada.result.attempts] == [88, 56]


@pytest.mark.slow
def test_dask_workers_give_identical_results_and_are_sandboxed(course: Course, tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    write_class(tmp_path, 4)
    grade(tmp_path / "in", tmp_path / "here", jobs=1, course=course)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        grade(tmp_path / "in", tmp_path / "out", jobs=1, dask=cluster.scheduler_address, course=course)
    assert fingerprint(tmp_path / "out") == fingerprint(tmp_path / "here")


@pytest.mark.slow
def test_unreachable_dask_scheduler_is_reported(
    course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("course_lib.grading.executors.CONNECT_SECONDS", 0.2)
    write_class(tmp_path, 1)
    with pytest.raises(CourseError, match=r"--dask tcp://127\.0\.0\.1:9: no scheduler answers"):
        grade(tmp_path / "in", tmp_path / "out", jobs=1, dask="tcp://127.0.0.1:9", course=course)


CRASH = """
import ctypes
from course_lib.grading import Check, expect_value, passed
from course_lib.grading.task import Call, Scenario

def crash(evidence):
    if evidence.returns[0] != WHERE:
        ctypes.string_at(0)
    return passed("as expected")

HIDDEN = {"week01.half": (
    Scenario("other", calls=(Call(-7.0),), checks=(Check("a crash", crash), expect_value(-3.5))),)}
"""


@pytest.mark.parametrize("jobs", [1, 2])
def test_check_that_crashes_on_one_submission_is_reported_and_the_class_is_graded(
    jobs: int,
    course: Course,
    right: str,
    tmp_path: Path,
    write_notebook: WriteNotebook,
    capsys: pytest.CaptureFixture[str],
) -> None:
    hidden = course.solutions / "checks/week01.py"
    hidden.write_text(CRASH.replace("WHERE", "-3.5"))
    for student, code in {"ada": right, "bob": right.replace("length / 2", "length / 4")}.items():
        write_notebook(tmp_path / "in" / student / NAME, code, student=student)
    assert grade(tmp_path / "in", tmp_path / "out", jobs=jobs, course=course)
    rows = {one.row.student: one.row for one in results_in(tmp_path / "out")}
    assert {row.status for row in rows.values()} == {"graded", "needs_marking"}
    (line,) = [line for line in capsys.readouterr().out.splitlines() if "could not judge" in line]
    assert line.startswith("A check could not judge bob: week01.half, other, 'a crash': ")
    assert f"{hidden} line 8: it ends the process with SIGSEGV" in line


@pytest.mark.skipif(not CAN_FORK, reason="a crash is only found in a fork")
def test_check_that_crashes_on_the_solution_is_reported_before_grading(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    (course.solutions / "checks/week01.py").write_text(CRASH.replace("WHERE", "0"))
    write_notebook(course.solutions / "week01_solution.ipynb", right)
    write_notebook(tmp_path / "in/ada" / NAME, right)
    with pytest.raises(CourseError, match=r"checks/week01\.py line 8: it ends the process with SIGSEGV"):
        grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)


def die(number: int) -> int:
    if number == 1:
        os._exit(9)
    return number


@pytest.mark.slow
def test_killed_worker_process_fails_only_its_own_call() -> None:
    with ProcessPool(2) as processes:
        calls = ((number, [number]) for number in range(5))
        ended = {
            number: future.exception() or future.result()
            for number, future in submit_in_window(processes, die, calls, 4)
        }
    assert isinstance(ended.pop(1), CourseError)
    assert ended == {number: number for number in (0, 2, 3, 4)}


def test_number_of_concurrent_calls_is_limited_by_the_window() -> None:
    taken: list[int] = []

    def calls() -> Iterator[tuple[int, list[int]]]:
        for number in range(2, 11):
            taken.append(number)
            yield number, [number]

    for ended, _ in enumerate(submit_in_window(InlineExecutor(), die, calls(), 3)):
        assert len(taken) <= ended + 3
    assert len(taken) == 9
