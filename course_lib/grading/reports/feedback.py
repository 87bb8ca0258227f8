"""Final reports, and feedback as files for a platform's bulk upload."""

import io
import re
from collections import Counter, defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from course_lib.course.state import write_atomically
from course_lib.errors import CourseError, format_count
from course_lib.grading.marks import MarkedResult, require_results, results_in
from course_lib.grading.records import Result
from course_lib.grading.reports.report import report, standalone
from course_lib.grading.reports.table import join_few, printable, say
from course_lib.grading.store import (
    Course,
    catalog_of,
    final_exercises,
    final_path,
    lock_folder,
    this_course,
    writing,
)
from course_lib.grading.submissions.notebook import full_exercise_name
from course_lib.grading.submissions.readers import Platform, PlatformName, platform_name

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
    course: Course | None = None,
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
    course = course or this_course()
    results = _select_results(out, exercise, students)
    lines, ready = _find_reports(out, form, results)
    wrote = []
    for exercise, group in ready.items():
        path = out / "feedback" / f"{exercise}_{lms}.zip"
        files = {name: _page(result, named, out, course, lms) for name, (result, named) in group.items()}
        with writing(out):
            write_atomically(path, _zip(files))
        size = path.stat().st_size / 1e6
        wrote.append(f"Wrote {path}: {format_count(len(files), 'report')}, {size:.1f} MB. {form.menu}")
    notes = [CANVAS_NOTE] if lms == "canvas" else []
    return [printable(line) for line in (*lines, *wrote, *notes)]


Reports = dict[str, tuple[Result, PlatformName]]  # by the file name in the zip


def _select_results(out: Path, exercise: str, students: Collection[str] | None) -> list[MarkedResult]:
    """Return the results of an exercise, for the given students.

    Raises:
        CourseError: There are none.
    """
    require_results(out)
    exercise = full_exercise_name(exercise)
    results = list(results_in(out))
    known = sorted({one.exercise for one in results})
    if exercise and exercise not in known:
        raise CourseError(f"{out} has no results for --exercise {exercise}; it has {', '.join(known)}")
    chosen = [
        one
        for one in results
        if exercise in ("", one.exercise) and (students is None or one.student in students)
    ]
    if not chosen:
        raise CourseError(f"{out} has no results of {exercise or 'any exercise'} of this section's students")
    return chosen


def _find_reports(
    out: Path, form: Format, results: Sequence[MarkedResult]
) -> tuple[list[str], dict[str, Reports]]:
    """Return a line for each report that is left out, and the other reports by exercise."""
    ready, lines = defaultdict[str, Reports](dict), list[str]()
    named = {
        id(one): _find_platform_name(one.result.submission.received.handed_in_as, form) for one in results
    }
    if not any(named.values()):
        raise CourseError(
            f"no result in {out} is from a download of {form.menu.split(':')[0]}, so its student numbers "
            "are unknown. Run: course collect DOWNLOAD --out submissions, then "
            f"course grade submissions --out {out} --resume"
        )
    shared = Counter(
        (one.exercise, name) for one in results if (name := _report_name(one, named[id(one)], form))
    )
    for one in results:
        name, who = _report_name(one, named[id(one)], form), named[id(one)]
        if why := _exclusion_reason(one, shared[one.exercise, name], name):
            lines.append(f"left out: {one.student} {one.exercise}: {why}")
        elif who:
            ready[one.exercise][name] = (one.result, who)
    return lines, ready


def _exclusion_reason(marked: MarkedResult, count: int, name: str) -> str:
    """Return why a report is not returned, or ""."""
    if not EXERCISE.fullmatch(marked.exercise):
        return "it is not an exercise of this course"
    if not name:
        return "the platform's download does not have it"
    if count > 1:
        return f"{count} results have the platform's number of this student"
    return "" if marked.row.status in FINAL else f"it is {marked.row.status}"


def _find_platform_name(handed_in_as: str, form: Format) -> PlatformName | None:
    """Parse the platform's name in a path of its download, as stored in received.csv."""
    parts = handed_in_as.lstrip("'").split("/")
    found = (named for part in parts if (named := platform_name(part)) and named.platform in form.platforms)
    return next(found, None)


def _report_name(marked: MarkedResult, named: PlatformName | None, form: Format) -> str:
    """Return the name of a report in the zip.

    The student's name in it is for display, without underscores.
    """
    if named is None:
        return ""
    hidden = named.platform == "anonymous"
    return form.name.format(
        name="anon" if hidden else re.sub(r"[^\w .-]|_", "", named.name).strip(" .") or "student",
        number=named.number,
        attachment=named.attachment,
        exercise=re.sub(r"\W", "", marked.exercise),
        suffix=_suffix(named),
    )


def _suffix(named: PlatformName) -> str:
    return ".zip" if named.file.lower().endswith(".zip") else ".html"


def _page(result: Result, named: PlatformName, out: Path, course: Course, lms: str) -> bytes:
    """Return the report, inside a zip if Canvas will name it .zip."""
    page = standalone(result, out, catalog_of(course))
    in_zip = lms == "canvas" and _suffix(named) == ".zip"
    return _zip({f"{result.submission.exercise}.html": page}) if in_zip else page


def _zip(files: Mapping[str, bytes]) -> bytes:
    data = io.BytesIO()
    with ZipFile(data, "w") as archive:
        for name, content in files.items():
            archive.writestr(ZipInfo(name, YEAR), content, ZIP_DEFLATED)
    return data.getvalue()


OPEN = ("needs_marking", "grader_error")


def show_hidden_checks(
    out: Path, exercise: str, *, is_final: bool = True, course: Course | None = None
) -> str:
    """Write the reports of an exercise with or without hidden checks, now and in the future; return a line.

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
    catalog = catalog_of(course or this_course())
    with lock_folder(out, say), writing(out):
        every = list(results_in(out))
        results = [one for one in every if one.exercise == exercise]
        if not results:
            known = ", ".join(sorted({one.exercise for one in every}))
            raise CourseError(f"{out} has no results for --exercise {exercise}; it has {known}")
        waiting = [one.student for one in results if one.row.status in OPEN]
        if is_final and waiting:
            raise CourseError(
                f"{format_count(len(waiting), 'mark')} of {exercise} not final yet ({join_few(waiting)}): "
                "mark or grade them first; gradebook.csv has the reasons"
            )
        kept = final_exercises(out) - {exercise} | ({exercise} if is_final else set())
        write_atomically(final_path(out), "".join(f"{one}\n" for one in sorted(kept)).encode())
        for one in results:
            report(one.result, out, catalog)
    shown = "show hidden checks" if is_final else "hide hidden checks again"
    return f"{format_count(len(results), 'report')} of {exercise}: they {shown}, also after grading again"
