"""The stage `report`: from a result to the page that its student gets."""

from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.catalog import Catalog
from course_lib.grading.judge import TaskResult
from course_lib.grading.marks.mark import Result
from course_lib.grading.marks.marks import HandMark
from course_lib.grading.records import digest_of, evidence_path, report_path
from course_lib.grading.reports.scenes import figures, shared_script
from course_lib.grading.reports.table import Row, fill, scored_rows
from course_lib.grading.run.job import Run, plan
from course_lib.grading.run.run import unpack

MAX_OUTPUT = 20_000  # characters
MAX_SCENES = 800_000  # characters of all scenes: a report stays under 1 MB
HEAD = 300  # characters of a page in which its digest is


def report(result: Result, marks: Sequence[HandMark], out: Path, catalog: Catalog) -> None:
    """Write OUT/reports/STUDENT/EXERCISE.html; every text that comes from students is escaped.

    Args:
        result: As it is stored.
        marks: The points of persons.
        out: The folder of records, which has the evidence for the scenes.
        catalog: The tasks with their hidden scenarios.
    """
    submission, shown = result.submission, result.with_marks(marks)
    week, course = submission.exercise.split("_")[0], catalog.course
    zone, time = course.zone, submission.received.time
    judged = shown.judgement
    runs = _runs(result, out, catalog)
    tasks = [_section(task, runs, catalog, len(judged.tasks)) for task in judged.tasks] if judged else []
    page = fill(
        "report.html",
        **vars(shown),
        mark=shown.mark,
        **{name: getattr(submission, name) for name in ("student", "exercise", "received")},
        received_at=time and time.astimezone(zone).isoformat(" ", "minutes"),
        deadline=course.deadline(week, submission.student) if week in course.weeks else None,
        zone=zone.key,
        percent=result.percent_per_day,
        isolation=judged.isolation if judged else "",
        tasks=tasks,
        cell_errors=judged.cell_errors if judged else (),
        output=judged.output if judged else "",
        max_output=MAX_OUTPUT,
        script=shared_script(out / "reports") if any(task["figures"] for task in tasks) else "",
        page_digest=page_digest(result.digest, marks),
    )
    write_whole(report_path(out, submission.student, submission.exercise), page.encode("utf-8", "replace"))


def page_digest(result: str, marks: Iterable[HandMark]) -> str:
    """Return the digest of all that a page depends on: that of the result, and the points of persons."""
    return digest_of([result, [asdict(mark) for mark in marks]])


def is_current(path: Path, digest: str) -> bool:
    """Return whether there is a page with this digest."""
    try:
        with path.open(encoding="utf-8") as file:
            return digest in file.read(HEAD)
    except OSError:
        return False


def _runs(result: Result, out: Path, catalog: Catalog) -> tuple[Run, ...]:
    """Return the evidence that scenes are drawn from; without it the page has no scenes."""
    if result.judgement is None:
        return ()
    tasks = catalog.of_week(result.submission.exercise.split("_")[0])
    try:
        stored = evidence_path(out, result.submission.key).read_bytes()
        return unpack(stored, plan(tasks, catalog, hidden=True)).runs
    except (OSError, CourseError):
        return ()


def _section(result: TaskResult, runs: Iterable[Run], catalog: Catalog, tasks: int) -> dict[str, Any]:
    """Return the values of a task's part of the page, which shares the room for scenes with others."""
    own = [run for run in runs if run.evidence.task == result.task and not run.hidden]
    bonus = ", on top" if result.bonus else ""
    drawn = figures(catalog.task(result.task), own, MAX_SCENES // (2 * tasks)) if own else []
    return {
        "id": result.task,
        "title": result.title,
        "headline": f"{result.score:g} of {result.points:g} points{bonus}",
        "errors": result.errors,
        "rows": _worst_first(result),
        "has_hidden": any(check.hidden for check in result.checks),
        "end": _by_hand(result, own),
        "figures": drawn,
    }


def _by_hand(result: TaskResult, runs: Iterable[Run]) -> list[str]:
    """Return the text that a person reads and marks, and that person's comments."""
    if not result.rubric:
        return list(result.comments)
    answers = [str(text)[:MAX_OUTPUT] for run in runs for text in run.evidence.returns]
    waits = ["A person reads and marks this task."] if result.manual is None else []
    return [*answers, *result.comments, *waits]


def _worst_first(result: TaskResult) -> list[Row]:
    """Return the rows of a task's table, failed checks first; hidden checks keep their numbers."""
    ranked = sorted(scored_rows(result.checks), key=lambda pair: pair[0])
    return [row for _, row in ranked]
