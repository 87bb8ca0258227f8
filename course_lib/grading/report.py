"""One page per student and exercise: the mark, the reasons, and their scenes to turn around."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.course.whole_file import write_whole
from course_lib.grading.exercise_run import ExerciseRun
from course_lib.grading.ghost import expected
from course_lib.grading.judge import TaskResult
from course_lib.grading.result import Result
from course_lib.grading.table import fill, rows
from course_lib.grading.task import Task
from course_lib.recording import Recording

if TYPE_CHECKING:
    from markupsafe import Markup

MAX_OUTPUT = 20_000  # characters
MAX_SCENE = 60_000  # characters of a scene: all of them and the one copy of the viewer stay under 1 MB


def write_report(result: Result, out: Path) -> None:
    """Write OUT/reports/STUDENT/EXERCISE.html; everything that comes from students is escaped."""
    from markupsafe import Markup

    from course_lib.viewer.html import bundle_script

    submission, run = result.submission, result.run
    tasks = [_task(run, *pair) for pair in zip(run.tasks, run.results, strict=True)] if run else []
    page = fill(
        "report.html",
        **vars(result),
        **{name: getattr(submission, name) for name in ("student", "exercise", "received")},
        isolation=result.isolation,
        tasks=tasks,
        cell_errors=run.cell_errors if run else (),
        output=run.log.output[:MAX_OUTPUT] if run else "",
        script=Markup(bundle_script()) if any(task["figures"] for task in tasks) else "",
    )
    path = out / "reports" / submission.student / f"{submission.exercise}.html"
    write_whole(path, page.encode("utf-8", "replace"))


def _task(run: ExerciseRun, task: Task, marks: TaskResult) -> dict[str, Any]:
    bonus = ", on top" if marks.bonus else ""
    return {
        "title": marks.title,
        "headline": f"{marks.score:g} of {marks.points:g} points{bonus}",
        "errors": marks.errors,
        "rows": rows(marks.checks),
        "end": [] if marks.checks else ["A person reads and marks this task."],
        "figures": _figures(run, task),
    }


def _figures(run: ExerciseRun, task: Task) -> "list[tuple[str, Markup | str]]":
    """What was published in the first public scenario, beside what was expected."""
    public = [r.evidence for r in run.runs if r.evidence.task == task.id and not r.hidden]
    if not public or not public[0].samples:
        return []
    figures = [("yours", _scene(public[0].recording))]
    if task.ghost:
        figures.append(("expected", _scene(expected(task, public[0].personal))))
    return figures


def _scene(recording: Recording) -> "Markup | str":
    from markupsafe import Markup

    from course_lib.displays.render import scene_of
    from course_lib.viewer.html import scene_fragment

    try:
        view = scene_fragment(scene_of(recording))
    except Exception as error:  # what students publish may be anything; the reasons matter more than the view
        return f"This scene can't be drawn: {error}"
    return Markup(view) if len(view) <= MAX_SCENE else "This scene is too large for the report."
