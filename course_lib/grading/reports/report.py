"""One page per student and exercise: the mark, the reasons, and their scenes to play and turn around."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from course_lib.course.course_file import CourseFile
from course_lib.course.state import write_whole
from course_lib.grading.judge import Run, TaskResult
from course_lib.grading.marks.mark import Result
from course_lib.grading.reports.scenes import Figure, figures, shared_script
from course_lib.grading.reports.table import fill, rows
from course_lib.grading.task import Task

MAX_OUTPUT = 20_000  # characters
MAX_SCENES = 800_000  # characters of all scenes: a report stays under 1 MB


def write_report(result: Result, out: Path, course: CourseFile) -> None:
    """Write OUT/reports/STUDENT/EXERCISE.html; everything that comes from students is escaped."""
    submission, run = result.submission, result.run
    pairs = list(zip(run.tasks, run.results, strict=True)) if run else []
    room = MAX_SCENES // (2 * max(len(pairs), 1))
    runs = run.runs if run else ()
    tasks = [_shown(marks, figures(task, runs, room), _by_hand(task, marks, runs)) for task, marks in pairs]
    week = submission.exercise.split("_")[0]
    zone, time = course.zone, submission.received.time
    page = fill(
        "report.html",
        **vars(result),
        mark=result.mark,
        **{name: getattr(submission, name) for name in ("student", "exercise", "received")},
        received_at=time and time.astimezone(zone).isoformat(" ", "minutes"),
        deadline=course.deadline(week, submission.student) if week in course.weeks else None,
        zone=zone.key,
        percent=result.percent_per_day,
        isolation=result.isolation,
        tasks=tasks,
        cell_errors=run.cell_errors if run else (),
        output=run.log.output if run else "",
        max_output=MAX_OUTPUT,
        script=shared_script(out / "reports") if any(task["figures"] for task in tasks) else "",
    )
    path = out / "reports" / submission.student / f"{submission.exercise}.html"
    write_whole(path, page.encode("utf-8", "replace"))


def _by_hand(task: Task, marks: TaskResult, runs: Iterable[Run]) -> list[str]:
    """What a person reads of a task, and says of it."""
    if not task.rubric:
        return list(marks.comments)
    own = (run.evidence for run in runs if run.evidence.task == task.id and not run.hidden)
    answers = [str(text)[:MAX_OUTPUT] for evidence in own for text in evidence.returns]
    waits = ["A person reads and marks this task."] if marks.manual is None else []
    return [*answers, *marks.comments, *waits]


def _shown(marks: TaskResult, scenes: list[Figure], end: list[str]) -> dict[str, Any]:
    bonus = ", on top" if marks.bonus else ""
    return {
        "id": marks.task,
        "title": marks.title,
        "headline": f"{marks.score:g} of {marks.points:g} points{bonus}",
        "errors": marks.errors,
        "rows": _worst_first(marks),
        "has_hidden": any(check.hidden for check in marks.checks),
        "end": end,
        "figures": scenes,
    }


def _worst_first(marks: TaskResult) -> list[tuple[str, str, str, str]]:
    """The rows of a task's table: what failed, then what passed; hidden checks keep their numbers."""
    ranked = sorted(zip(marks.checks, rows(marks.checks), strict=True), key=lambda pair: pair[0].score)
    return [row for _, row in ranked]
