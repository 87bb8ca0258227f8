"""The stage `report`: from a result to a student's report page, and its feedback for a platform."""

import io
import re
import unicodedata
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically
from course_lib.grading import store
from course_lib.grading.marks import MarkedResult, read_marks, require_results, results_in, task_mark
from course_lib.grading.records import HandMark, Result, Run, TaskResult
from course_lib.grading.reports.rendering import (
    CheckRow,
    fill,
    join_few,
    print_line,
    replace_controls,
    scored_rows,
)
from course_lib.grading.reports.scenes import figures, shared_script
from course_lib.grading.run.run import plan_scenarios, unpack
from course_lib.grading.submissions.notebook import full_exercise_name
from course_lib.grading.submissions.readers import Platform, PlatformName, platform_name
from course_lib.grading.task import Catalog
from course_lib.viewer.html import bundle_code

MAX_OUTPUT = 20_000  # limit on the characters of an answer or output
MAX_SCENES = 800_000  # limit on the characters of all scenes: a report stays below 1 MB
MAX_ALONE = 400_000  # [B] size of a report that includes the viewer
NOTE = 200  # [B] size of a note about a reduced scene
HEAD = 300  # number of characters at the start of a page that contain its digest


def report(result: Result, out: Path, catalog: Catalog) -> None:
    """Write OUT/reports/STUDENT/EXERCISE.html. All text from students is escaped.

    Args:
        result: The stored result.
        out: The folder of records, with the points of graders and the evidence for the scenes.
        catalog: The tasks with hidden scenarios.
    """
    marks = _hand_marks(result, out)
    tasks = _sections(result, marks, out, catalog)
    script = shared_script(out / "reports") if any(task["figures"] for task in tasks) else ""
    page = _page(result, marks, out, catalog, tasks, script=script)
    student, exercise = result.submission.student, result.submission.exercise
    write_atomically(store.report_path(out, student, exercise), page)


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
    fixed_size = (
        len(_page(result, marks, out, catalog, tasks, viewer=viewer)) - sum(sizes) + NOTE * len(sizes)
    )
    if fixed_size + sum(sizes) > MAX_ALONE:
        tasks = _sections(result, marks, out, catalog, _max_scene_size(sizes, MAX_ALONE - fixed_size))
    return _page(result, marks, out, catalog, tasks, viewer=viewer)


def _max_scene_size(sizes: Sequence[int], room: int) -> int:
    """Return the maximum size per scene so that all fit.

    Large scenes may use the room left by small ones.
    """
    for place, size in enumerate(sorted(sizes)):
        share = room // (len(sizes) - place)
        if size > share:
            return max(share, 0)
        room -= size
    return max(sizes)


def _hand_marks(result: Result, out: Path) -> list[HandMark]:
    """Return the points that graders gave by hand."""
    return read_marks(store.marks_path(out, result.submission.student, result.submission.exercise))


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

    submission, displayed = result.submission, MarkedResult(result, tuple(marks)).displayed_result
    week, course = submission.exercise.split("_")[0], catalog.course
    course.require_valid(week)
    zone, time = course.zone, submission.received.time
    judgement = displayed.judgement
    page = fill(
        "report.html",
        status=displayed.status,
        reason=displayed.reason,
        message=displayed.message,
        mark=displayed.mark,
        **{name: getattr(submission, name) for name in ("student", "exercise", "received")},
        received_at=time and time.astimezone(zone).isoformat(" ", "minutes"),
        deadline=course.deadline(week, submission.student) if week in course.weeks else None,
        zone=zone.key,
        percent=result.late.percent_per_day,
        max_percent=result.late.max_percent,
        rejection_reason=result.rejection_reason,
        isolation=judgement.isolation if judgement else "",
        whole=task_mark(marks) if judgement is None else None,
        tasks=tasks,
        cell_errors=judgement.cell_errors if judgement else (),
        output=judgement.output if judgement else "",
        max_output=MAX_OUTPUT,
        script=script,
        viewer=Markup(viewer),
        has_scenes=bool(script or viewer),
        loads_viewer=bool(script),
        page_digest=_page_digest(result, marks, out),
    )
    return page.encode("utf-8", "replace")


def _page_digest(result: Result, marks: Iterable[HandMark], out: Path) -> str:
    is_final = result.submission.exercise in store.final_exercises(out)
    return store.digest_of([result.digest, [asdict(mark) for mark in marks], is_final])


def section_of(page: str, task: str) -> str:
    """Return the section of a report on one task, or ""; every text in it is escaped."""
    _, _, after_heading = page.partition(f'<section aria-labelledby="{task}">')
    return after_heading.partition("</section>")[0]


def has_page(result: Result, out: Path) -> bool:
    """Return whether the page exists for this result and the current points."""
    digest = _page_digest(result, _hand_marks(result, out), out)
    path = store.report_path(out, result.submission.student, result.submission.exercise)
    try:
        with path.open(encoding="utf-8") as file:
            return digest in file.read(HEAD)
    except OSError:
        return False


def _sections(
    result: Result, marks: Sequence[HandMark], out: Path, catalog: Catalog, share: int | None = None
) -> list[dict[str, Any]]:
    """Return the template values of the tasks' sections.

    Each scene has at most `share` characters.
    """
    judgement = MarkedResult(result, tuple(marks)).displayed_result.judgement
    if judgement is None:
        return []
    tasks = catalog.tasks_of_week(result.submission.exercise.split("_")[0])
    try:
        packed_evidence = store.evidence_path(out, result.submission.key).read_bytes()
        runs = unpack(packed_evidence, plan_scenarios(tasks, catalog, with_hidden=True)).runs
    except (OSError, CourseError):
        # Without evidence, the page has no scenes.
        runs = ()
    share = MAX_SCENES // (2 * len(judgement.tasks)) if share is None else share
    is_final = result.submission.exercise in store.final_exercises(out)
    return [_section(task, runs, catalog, share, is_final=is_final) for task in judgement.tasks]


def _section(
    result: TaskResult, runs: Iterable[Run], catalog: Catalog, room: int, *, is_final: bool
) -> dict[str, Any]:
    """Return the template values of a task's section; each scene has at most `room` characters."""
    runs_of_task = [run for run in runs if run.evidence.task == result.task and not run.is_hidden]
    bonus = ", on top" if result.is_bonus else ""
    # The text that a grader marks, and the grader's comments.
    end = list(result.comments)
    if result.rubric:
        answers = [str(text)[:MAX_OUTPUT] for run in runs_of_task for text in run.evidence.returns]
        waits = ["A person reads and marks this task."] if result.manual is None else []
        end = [*answers, *end, *waits]
    return {
        "id": result.task,
        "title": result.title,
        "headline": f"{result.score:g} of {result.points:g} points{bonus}",
        "errors": result.errors,
        "rows": _sorted_rows(result, is_final=is_final),
        "has_hidden": not is_final and any(check.is_hidden for check in result.checks),
        "end": end,
        "figures": figures(catalog.task(result.task), runs_of_task, room) if runs_of_task else [],
    }


def _sorted_rows(result: TaskResult, *, is_final: bool) -> list[CheckRow]:
    """Return the rows of a task's table, failed checks first; hidden checks keep their numbers."""
    ranked = sorted(scored_rows(result.checks, show_hidden=is_final), key=lambda pair: pair[0])
    return [row for _, row in ranked]


FINAL = ("graded", "limit", "rejected")
EXERCISE = re.compile(r"week\d\d_exercise")
YEAR = (2000, 1, 1, 0, 0, 0)  # timestamp in the zip, so that equal reports give equal zips


@dataclass(frozen=True)
class Format:
    """The file names that a platform's bulk upload accepts, and the menu for it.

    Args:
        platforms: The names of downloads of this platform.
        name: The file name, a format string with the student's name and number, and the
            attachment's number.
        menu: The place where the zip is uploaded.
    """

    platforms: tuple[Platform, ...]
    name: str
    menu: str


# Moodle reads NAME_NUMBER_PLUGIN_TYPE_FILE. Canvas reads the first two parts that are numbers: the
# student's number, and the number of a submitted file; or, if it hides the students,
# anon_ID_NUMBER.
FORMATS: Mapping[str, Format] = {
    "moodle": Format(
        ("moodle",),
        "{name}_{number}_assignfeedback_file_{exercise}.html",
        "Moodle: the assignment's submissions, Upload multiple feedback files in a zip",
    ),
    "canvas": Format(
        ("canvas", "anonymous"),
        "{name}_{number}_{attachment}_{exercise}_report{suffix}",
        "Canvas: the assignment's menu in the gradebook, Re-upload submissions",
    ),
}
CANVAS_NOTE = (
    "note: Canvas shows a report under the name of the submitted file. If that is a zip, the "
    "report is in a zip; if it is a notebook, students save the report with the suffix .html"
)


def feedback(
    out: Path,
    lms: str,
    *,
    exercise: str = "",
    students: Collection[str] | None = None,
    course: store.Course | None = None,
) -> list[str]:
    """Write OUT/feedback/EXERCISE_LMS.zip for each exercise, and return lines for the terminal.

    Args:
        out: The folder that `course grade` wrote.
        lms: "moodle" or "canvas".
        exercise: "week01_exercise"; "" for all.
        students: Student IDs; None for all.
        course: The course with the tasks; default: this checkout.

    Raises:
        CourseError: The platform is unknown, there are no results, or no result is from that
            platform.
    """
    if lms not in FORMATS:
        raise CourseError(f"--lms {lms}: expected one of {', '.join(FORMATS)}")
    form = FORMATS[lms]
    course = course or store.this_course()
    results = _select_results(out, exercise, students)
    lines, ready = _find_reports(out, form, results)
    wrote = []
    for exercise, group in ready.items():
        path = out / "feedback" / f"{exercise}_{lms}.zip"
        files = {}
        for name, (result, platform_file) in group.items():
            page = standalone(result, out, store.catalog_of(course))
            # Canvas gives the report the suffix of the submitted file.
            in_zip = lms == "canvas" and _suffix(platform_file) == ".zip"
            files[name] = _zip({f"{exercise}.html": page}) if in_zip else page
        with store.writing(out):
            write_atomically(path, _zip(files))
        size = path.stat().st_size / 1e6
        wrote.append(f"Wrote {path}: {format_count(len(files), 'report')}, {size:.1f} MB. {form.menu}")
    notes = [CANVAS_NOTE] if lms == "canvas" else []
    return [replace_controls(line) for line in (*lines, *wrote, *notes)]


Reports = dict[str, tuple[Result, PlatformName]]  # by the file name in the zip


def _select_results(
    out: Path,
    exercise: str,
    students: Collection[str] | None,
) -> list[MarkedResult]:
    """Return the results of an exercise, for the given students.

    Raises:
        CourseError: There are none.
    """
    require_results(out)
    exercise = full_exercise_name(exercise)
    results = list(results_in(out))
    known_exercises = sorted({result.exercise for result in results})
    if exercise and exercise not in known_exercises:
        raise CourseError(
            f"{out} has no results for --exercise {exercise}; it has {', '.join(known_exercises)}"
        )
    selected = [
        result
        for result in results
        if exercise in ("", result.exercise) and (students is None or result.student in students)
    ]
    if not selected:
        raise CourseError(
            f"{out} has no results of {exercise or 'any exercise'} of this section's students. "
            "Choose another --section, or grade their submissions first"
        )
    return selected


def _find_reports(
    out: Path, form: Format, results: Sequence[MarkedResult]
) -> tuple[list[str], dict[str, Reports]]:
    """Return a line for each report that is left out, and the other reports by exercise."""
    ready, lines = defaultdict[str, Reports](dict), list[str]()
    names_by_result = dict[int, PlatformName | None]()
    for result in results:
        # The path in the platform's download, as stored in received.csv.
        parts = result.result.submission.received.download_path.lstrip("'").split("/")
        parsed = (file for part in parts if (file := platform_name(part)))
        names_by_result[id(result)] = next((f for f in parsed if f.platform in form.platforms), None)
    if not any(names_by_result.values()):
        raise CourseError(
            f"no result in {out} is from a download of {form.menu.split(':')[0]}, so its student "
            "numbers are unknown. Run: course collect DOWNLOAD --out submissions, then course "
            f"grade submissions --out {out} --resume"
        )
    shared = Counter(
        (r.exercise, name) for r in results if (name := _report_name(r, names_by_result[id(r)], form))
    )
    for result in results:
        platform_file = names_by_result[id(result)]
        name = _report_name(result, platform_file, form)
        count, status = shared[result.exercise, name], result.row.status
        why = "" if status in FINAL else f"it is {status}"
        if not EXERCISE.fullmatch(result.exercise):
            why = "it is not an exercise of this course"
        elif not name:
            why = "the platform's download does not have it"
        elif count > 1:
            why = f"{count} results have the platform's number of this student"
        if why:
            lines.append(f"left out: {result.student} {result.exercise}: {why}")
        elif platform_file:
            ready[result.exercise][name] = (result.result, platform_file)
    return lines, ready


def _report_name(result: MarkedResult, platform_file: PlatformName | None, form: Format) -> str:
    """Return the name of a report in the zip.

    The student's name in it is for display, without underscores.
    """
    if platform_file is None:
        return ""
    is_anonymous = platform_file.platform == "anonymous"
    return form.name.format(
        name="anon"
        if is_anonymous
        # A word has no combining marks for `re`, but many letters have.
        else "".join(
            c
            for c in unicodedata.normalize("NFC", platform_file.name)
            if c in " .-" or (c != "_" and unicodedata.category(c)[0] in "LMN")
        ).strip(" .")
        or "student",
        number=platform_file.number,
        attachment=platform_file.attachment,
        exercise=re.sub(r"\W", "", result.exercise),
        suffix=_suffix(platform_file),
    )


def _suffix(platform_file: PlatformName) -> str:
    return ".zip" if platform_file.file.lower().endswith(".zip") else ".html"


def _zip(files: Mapping[str, bytes]) -> bytes:
    data = io.BytesIO()
    with ZipFile(data, "w") as archive:
        for name, content in files.items():
            archive.writestr(ZipInfo(name, YEAR), content, ZIP_DEFLATED)
    return data.getvalue()


OPEN = ("needs_marking", "grader_error")


def show_hidden_checks(
    out: Path, exercise: str, *, is_final: bool = True, course: store.Course | None = None
) -> str:
    """Write the reports of an exercise with or without hidden checks, now and in the future.

    Return a line for the terminal.

    Args:
        out: The folder that `course grade` wrote.
        exercise: "week01_exercise".
        is_final: Whether to show title and message of hidden checks; False hides them again.
        course: The course with the tasks; default: this checkout.

    Raises:
        CourseError: The exercise has no results, or some mark is not final.
    """
    require_results(out)
    exercise = full_exercise_name(exercise)
    catalog = store.catalog_of(course or store.this_course())
    with store.lock_folder(out, print_line), store.writing(out):
        every = list(results_in(out))
        results = [result for result in every if result.exercise == exercise]
        if not results:
            known_exercises = ", ".join(sorted({result.exercise for result in every}))
            raise CourseError(f"{out} has no results for --exercise {exercise}; it has {known_exercises}")
        waiting = [result.student for result in results if result.row.status in OPEN]
        if is_final and waiting:
            raise CourseError(
                f"{format_count(len(waiting), 'open mark')} of {exercise} "
                f"({join_few(waiting)}): mark or grade them first; gradebook.csv has the reasons"
            )
        exercises = store.final_exercises(out) - {exercise} | ({exercise} if is_final else set())
        content = "".join(f"{name}\n" for name in sorted(exercises))
        write_atomically(store.final_path(out), content.encode())
        for result in results:
            report(result.result, out, catalog)
    effect = "show hidden checks" if is_final else "hide hidden checks again"
    return f"{format_count(len(results), 'report')} of {exercise}: they {effect}, also after grading again"
