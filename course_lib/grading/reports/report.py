"""The stage `report`: from a result to the page that its student gets."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.catalog import Catalog
from course_lib.grading.judge import TaskResult
from course_lib.grading.marks.mark import Result
from course_lib.grading.marks.marks import HandMark, read_marks
from course_lib.grading.marks.requests import RegradeRequest, read_requests, requests_path
from course_lib.grading.records import digest_of, evidence_path, marks_path, report_path
from course_lib.grading.reports.scenes import figures, shared_script
from course_lib.grading.reports.table import Row, fill, scored_rows
from course_lib.grading.run.job import Run, plan
from course_lib.grading.run.run import unpack
from course_lib.viewer.html import bundle_script

MAX_OUTPUT = 20_000  # characters
MAX_SCENES = 800_000  # characters of all scenes: a report stays under 1 MB
MAX_ALONE = 400_000  # [B] of a report with its viewer in it
NOTE = 200  # [B] that a note on a smaller scene adds
HEAD = 300  # characters of a page in which its digest is


def report(result: Result, out: Path, catalog: Catalog) -> None:
    """Write OUT/reports/STUDENT/EXERCISE.html; every text that comes from students is escaped.

    Args:
        result: As it is stored.
        out: The folder of records, with the points of persons and the evidence for the scenes.
        catalog: The tasks with their hidden scenarios.
    """
    marks, asked = _from_persons(result, out)
    tasks = _sections(result, marks, out, catalog)
    script = shared_script(out / "reports") if any(task["figures"] for task in tasks) else ""
    page = _page(result, marks, asked, catalog, tasks, script=script)
    write_whole(report_path(out, result.submission.student, result.submission.exercise), page)


def standalone(result: Result, out: Path, catalog: Catalog) -> bytes:
    """Return the page with its viewer in it, in at most `MAX_ALONE` bytes where its text leaves room.

    Args:
        result: As it is stored.
        out: The folder of records, with the points of persons and the evidence for the scenes.
        catalog: The tasks with their hidden scenarios.
    """
    marks, asked = _from_persons(result, out)
    tasks, viewer = _sections(result, marks, out, catalog), bundle_script()
    sizes = [len(figure.view) for task in tasks for figure in task["figures"] if figure.view]
    if not sizes:
        return _page(result, marks, asked, catalog, tasks)
    rest = len(_page(result, marks, asked, catalog, tasks, viewer=viewer)) - sum(sizes) + NOTE * len(sizes)
    if rest + sum(sizes) > MAX_ALONE:
        tasks = _sections(result, marks, out, catalog, _share(sizes, MAX_ALONE - rest))
    return _page(result, marks, asked, catalog, tasks, viewer=viewer)


def _share(sizes: Sequence[int], room: int) -> int:
    """Return the most that each scene may have so that all fit: what small ones leave is for large ones."""
    for place, size in enumerate(sorted(sizes)):
        share = room // (len(sizes) - place)
        if size > share:
            return max(share, 0)
        room -= size
    return max(sizes)


def _from_persons(result: Result, out: Path) -> tuple[list[HandMark], tuple[RegradeRequest, ...]]:
    """Return the points of persons, and the student's requests with the answers."""
    place = out, result.submission.student, result.submission.exercise
    return read_marks(marks_path(*place)), read_requests(requests_path(*place))


def _page(
    result: Result,
    marks: Sequence[HandMark],
    asked: Sequence[RegradeRequest],
    catalog: Catalog,
    tasks: Sequence[Mapping[str, Any]],
    *,
    script: str = "",
    viewer: str = "",
) -> bytes:
    """Return the page of a result, with the name of the viewer's file or with the viewer itself."""
    from markupsafe import Markup

    submission, shown = result.submission, result.with_marks(marks)
    week, course = submission.exercise.split("_")[0], catalog.course
    course.demand(week)
    zone, time = course.zone, submission.received.time
    judged = shown.judgement
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
        script=script,
        viewer=Markup(viewer),
        asked=asked,
        page_digest=_page_digest(result.digest, marks, asked),
    )
    return page.encode("utf-8", "replace")


def _page_digest(result: str, marks: Iterable[HandMark], asked: Iterable[RegradeRequest]) -> str:
    return digest_of([result, [asdict(mark) for mark in marks], [asdict(one) for one in asked]])


def section_of(page: str, task: str) -> str:
    """Return the part of a report on one task, "" if it has none; every text in it is escaped."""
    _, _, rest = page.partition(f'<section aria-labelledby="{task}">')
    return rest.partition("</section>")[0]


def has_page(result: Result, out: Path) -> bool:
    """Return whether the page is there, of this result and of today's points and requests."""
    digest = _page_digest(result.digest, *_from_persons(result, out))
    path = report_path(out, result.submission.student, result.submission.exercise)
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


def _sections(
    result: Result, marks: Sequence[HandMark], out: Path, catalog: Catalog, share: int | None = None
) -> list[dict[str, Any]]:
    """Return the values of the tasks' parts of the page; each scene has at most `share` characters."""
    judged = result.with_marks(marks).judgement
    if judged is None:
        return []
    runs = _runs(result, out, catalog)
    share = MAX_SCENES // (2 * len(judged.tasks)) if share is None else share
    return [_section(task, runs, catalog, share) for task in judged.tasks]


def _section(result: TaskResult, runs: Iterable[Run], catalog: Catalog, room: int) -> dict[str, Any]:
    """Return the values of a task's part of the page, with the room that each of its scenes has."""
    own = [run for run in runs if run.evidence.task == result.task and not run.hidden]
    bonus = ", on top" if result.bonus else ""
    return {
        "id": result.task,
        "title": result.title,
        "headline": f"{result.score:g} of {result.points:g} points{bonus}",
        "errors": result.errors,
        "rows": _worst_first(result),
        "has_hidden": any(check.hidden for check in result.checks),
        "end": _by_hand(result, own),
        "figures": figures(catalog.task(result.task), own, room) if own else [],
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
