"""The stage `report`: from a result to the student's report page."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from course_lib.course.state import write_atomically
from course_lib.errors import CourseError
from course_lib.grading.catalog import Catalog
from course_lib.grading.marks import MarkedResult, read_marks, task_mark
from course_lib.grading.records import HandMark, Result, TaskResult
from course_lib.grading.reports.scenes import figures, shared_script
from course_lib.grading.reports.table import Row, fill, scored_rows
from course_lib.grading.run.run import Run, plan_scenarios, unpack
from course_lib.grading.store import digest_of, evidence_path, final_exercises, marks_path, report_path
from course_lib.viewer.html import bundle_code

MAX_OUTPUT = 20_000  # characters
MAX_SCENES = 800_000  # characters of all scenes, which keeps a report below 1 MB
MAX_ALONE = 400_000  # [B] size of a report that includes the viewer
NOTE = 200  # [B] size of a note about a reduced scene
HEAD = 300  # characters at the beginning of a page that contain its digest


def report(result: Result, out: Path, catalog: Catalog) -> None:
    """Write OUT/reports/STUDENT/EXERCISE.html; all texts from students are escaped.

    Args:
        result: The stored result.
        out: The folder of records, with the points of graders and the evidence for the scenes.
        catalog: The tasks with hidden scenarios.
    """
    marks = _hand_marks(result, out)
    tasks = _sections(result, marks, out, catalog)
    script = shared_script(out / "reports") if any(task["figures"] for task in tasks) else ""
    page = _page(result, marks, out, catalog, tasks, script=script)
    write_atomically(report_path(out, result.submission.student, result.submission.exercise), page)


def standalone(result: Result, out: Path, catalog: Catalog) -> bytes:
    """Return the page including its viewer, in at most `MAX_ALONE` bytes if its text permits.

    Args:
        result: The stored result.
        out: The folder of records, with the points of graders and the evidence for the scenes.
        catalog: The tasks with hidden scenarios.
    """
    marks = _hand_marks(result, out)
    tasks, viewer = _sections(result, marks, out, catalog), bundle_code()
    sizes = [len(figure.view) for task in tasks for figure in task["figures"] if figure.view]
    if not sizes:
        return _page(result, marks, out, catalog, tasks)
    rest = len(_page(result, marks, out, catalog, tasks, viewer=viewer)) - sum(sizes) + NOTE * len(sizes)
    if rest + sum(sizes) > MAX_ALONE:
        tasks = _sections(result, marks, out, catalog, _max_scene_size(sizes, MAX_ALONE - rest))
    return _page(result, marks, out, catalog, tasks, viewer=viewer)


def _max_scene_size(sizes: Sequence[int], room: int) -> int:
    """Return the maximum size per scene so that all fit. Large scenes may use the room left by small ones."""
    for place, size in enumerate(sorted(sizes)):
        share = room // (len(sizes) - place)
        if size > share:
            return max(share, 0)
        room -= size
    return max(sizes)


def _hand_marks(result: Result, out: Path) -> list[HandMark]:
    """Return the points of graders."""
    return read_marks(marks_path(out, result.submission.student, result.submission.exercise))


def _page(
    result: Result,
    marks: Sequence[HandMark],
    out: Path,
    catalog: Catalog,
    tasks: Sequence[Mapping[str, Any]],
    *,
    script: str = "",
    viewer: str = "",
) -> bytes:
    """Return the page of a result, with the viewer's file name or with the viewer itself."""
    from markupsafe import Markup

    submission, shown = result.submission, MarkedResult(result, tuple(marks)).displayed_result
    week, course = submission.exercise.split("_")[0], catalog.course
    course.require_valid(week)
    zone, time = course.zone, submission.received.time
    judged = shown.judgement
    page = fill(
        "report.html",
        status=shown.status,
        reason=shown.reason,
        message=shown.message,
        mark=shown.mark,
        **{name: getattr(submission, name) for name in ("student", "exercise", "received")},
        received_at=time and time.astimezone(zone).isoformat(" ", "minutes"),
        deadline=course.deadline(week, submission.student) if week in course.weeks else None,
        zone=zone.key,
        percent=result.late.percent_per_day,
        max_percent=result.late.max_percent,
        rejection_reason=result.rejection_reason,
        isolation=judged.isolation if judged else "",
        whole=task_mark(marks) if judged is None else None,
        tasks=tasks,
        cell_errors=judged.cell_errors if judged else (),
        output=judged.output if judged else "",
        max_output=MAX_OUTPUT,
        script=script,
        viewer=Markup(viewer),
        has_scenes=bool(script or viewer),
        loads_viewer=bool(script),
        page_digest=_page_digest(result, marks, out),
    )
    return page.encode("utf-8", "replace")


def _page_digest(result: Result, marks: Iterable[HandMark], out: Path) -> str:
    is_final = result.submission.exercise in final_exercises(out)
    return digest_of([result.digest, [asdict(mark) for mark in marks], is_final])


def section_of(page: str, task: str) -> str:
    """Return the section of a report on one task, or ""; every text in it is escaped."""
    _, _, rest = page.partition(f'<section aria-labelledby="{task}">')
    return rest.partition("</section>")[0]


def has_page(result: Result, out: Path) -> bool:
    """Return whether the page exists for this result and the current points."""
    digest = _page_digest(result, _hand_marks(result, out), out)
    path = report_path(out, result.submission.student, result.submission.exercise)
    try:
        with path.open(encoding="utf-8") as file:
            return digest in file.read(HEAD)
    except OSError:
        return False


def _runs(result: Result, out: Path, catalog: Catalog) -> tuple[Run, ...]:
    """Return the evidence from which scenes are drawn; without it the page has no scenes."""
    if result.judgement is None:
        return ()
    tasks = catalog.of_week(result.submission.exercise.split("_")[0])
    try:
        stored = evidence_path(out, result.submission.key).read_bytes()
        return unpack(stored, plan_scenarios(tasks, catalog, hidden=True)).runs
    except (OSError, CourseError):
        return ()


def _sections(
    result: Result, marks: Sequence[HandMark], out: Path, catalog: Catalog, share: int | None = None
) -> list[dict[str, Any]]:
    """Return the template values of the tasks' sections; each scene has at most `share` characters."""
    judged = MarkedResult(result, tuple(marks)).displayed_result.judgement
    if judged is None:
        return []
    runs = _runs(result, out, catalog)
    share = MAX_SCENES // (2 * len(judged.tasks)) if share is None else share
    is_final = result.submission.exercise in final_exercises(out)
    return [_section(task, runs, catalog, share, is_final=is_final) for task in judged.tasks]


def _section(
    result: TaskResult, runs: Iterable[Run], catalog: Catalog, room: int, *, is_final: bool
) -> dict[str, Any]:
    """Return the template values of a task's section; each scene has at most `room` characters."""
    own = [run for run in runs if run.evidence.task == result.task and not run.hidden]
    bonus = ", on top" if result.bonus else ""
    return {
        "id": result.task,
        "title": result.title,
        "headline": f"{result.score:g} of {result.points:g} points{bonus}",
        "errors": result.errors,
        "rows": _sorted_rows(result, is_final=is_final),
        "has_hidden": not is_final and any(check.hidden for check in result.checks),
        "end": _grader_texts(result, own),
        "figures": figures(catalog.task(result.task), own, room) if own else [],
    }


def _grader_texts(result: TaskResult, runs: Iterable[Run]) -> list[str]:
    """Return the text that a grader reads and marks, and the grader's comments."""
    if not result.rubric:
        return list(result.comments)
    answers = [str(text)[:MAX_OUTPUT] for run in runs for text in run.evidence.returns]
    waits = ["A person reads and marks this task."] if result.manual is None else []
    return [*answers, *result.comments, *waits]


def _sorted_rows(result: TaskResult, *, is_final: bool) -> list[Row]:
    """Return the rows of a task's table, failed checks first; hidden checks keep their numbers."""
    ranked = sorted(scored_rows(result.checks, show_hidden=is_final), key=lambda pair: pair[0])
    return [row for _, row in ranked]
