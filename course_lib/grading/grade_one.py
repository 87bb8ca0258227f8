"""Grades one submission: run, keep the evidence, judge, mark, report, store."""

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from course_lib.course.whole_file import write_whole
from course_lib.grading.catalog import Catalog, load_catalog
from course_lib.grading.exercise_run import ExerciseRun, judge_exercise, run_scenarios
from course_lib.grading.jail.isolation import Need
from course_lib.grading.jail.launch import shared_template
from course_lib.grading.marks import count_days_late, mark
from course_lib.grading.report import write_report
from course_lib.grading.result import Result, Status
from course_lib.grading.store import evidence_bytes
from course_lib.grading.submission import Submission


@dataclass(frozen=True)
class Course:
    """Where tasks and hidden checks are; every grading process reads them for itself."""

    exercises: Path
    solutions: Path
    sandbox: Need = "partial"  # without it nothing is run


@lru_cache(maxsize=4)
def catalog_of(course: Course) -> Catalog:
    """The tasks with their hidden scenarios."""
    return load_catalog(course.exercises, course.solutions)


def grade_one(submission: Submission, course: Course, out: Path) -> dict[str, Any]:
    """Grade a submission and write evidence, report and result; returns its line of the gradebook."""
    try:
        result = _graded(submission, course, out)
    except Exception as error:  # any fault of the kit must end as `grader_error`, and the class goes on
        result = our_fault(submission, error)
    return stored(result, course, out)


def our_fault(submission: Submission, error: Exception) -> Result:
    """What becomes of a submission that could not be graded: no mark, and never a zero."""
    return Result(submission, "grader_error", type(error).__name__, str(error))


def stored(result: Result, course: Course, out: Path) -> dict[str, Any]:
    """Write report and result; returns its line of the gradebook."""
    try:
        write_report(result, out, catalog_of(course).course)
    except Exception as error:  # the marks are right without a report, and must not be lost with it
        result = replace(result, notes=(f"no report: {type(error).__name__}: {error}",))
    result.write(out)
    return result.row()


def _graded(submission: Submission, course: Course, out: Path) -> Result:
    catalog = catalog_of(course)
    week = submission.exercise.split("_")[0]
    tasks = catalog.of_week(week)
    if submission.notebook is None:
        return Result(submission, "rejected", "unreadable", submission.problem)
    if not tasks:
        problem = submission.problem or f"the course has no {submission.exercise}"
        return Result(submission, "rejected", "wrong exercise", problem)
    shared_template().isolation.demand(course.sandbox)
    cells, files = submission.notebook.cells, submission.files
    run = run_scenarios(cells, tasks, catalog, submission.claimed, hidden=True, files=files)
    path = out / "evidence" / submission.student / f"{submission.exercise}.msgpack"
    write_whole(path, evidence_bytes(run.runs))
    run = judge_exercise(run, catalog)
    late = catalog.course.late
    days = count_days_late(submission.received.time, catalog.course.deadline(week), late)
    message = f"{sum(task.fraction == 1 for task in run.results)} of {len(run.results)} tasks have full marks"
    return Result(submission, *_status(run), message, mark(run.results, days, late), run)


def _status(run: ExerciseRun) -> tuple[Status, str]:
    """Whether a person has to look, a limit was met, or all is done; with the limit's name."""
    stopped = [task.stopped for task in run.results if task.stopped]
    reason = stopped[0] if stopped else run.log.limit
    if any(task.kind == "written" for task in run.tasks):
        return "needs_marking", reason
    return ("limit", reason) if reason else ("graded", "")
