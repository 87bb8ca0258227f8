"""`course feedback`: the zip of reports that a learning platform's bulk upload takes."""

import io
import re
from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from course_lib.course.state import write_whole
from course_lib.errors import CourseError, counted
from course_lib.grading.handin.sender import Platform, PlatformName, platform_name
from course_lib.grading.marks.mark import Result, need_results, results_in
from course_lib.grading.records import Course, catalog_of, this_course, writing
from course_lib.grading.reports.report import standalone
from course_lib.grading.reports.table import printable

FINAL = ("graded", "limit", "rejected")
YEAR = (2000, 1, 1, 0, 0, 0)  # in the zip, so that the same reports are the same zip


@dataclass(frozen=True)
class Format:
    """The names that a platform's bulk upload takes, and where it is.

    Args:
        platforms: The names of downloads that belong to it.
        name: The file's name, with the student's name and number, and the attachment's number.
        menu: Where the zip is uploaded.
    """

    platforms: tuple[Platform, ...]
    name: str
    menu: str


# Moodle reads NAME_NUMBER_PLUGIN_TYPE_FILE. Canvas reads the first two parts that are numbers, the student's
# and that of a file which the student handed in; or, where it hides the students, anon_ID_NUMBER.
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
    "note: Canvas shows a report under the name of the file that was handed in. Where that is a zip, the "
    "report is in a zip; where it is a notebook, students save it with the ending .html"
)


def feedback(out: Path, lms: str, *, course: Course | None = None) -> list[str]:
    """Write OUT/feedback/EXERCISE_LMS.zip for each exercise; returns lines for the terminal.

    Args:
        out: The folder that `course grade` wrote.
        lms: "moodle" or "canvas".
        course: Where the tasks are; default: this checkout.

    Raises:
        CourseError: Another platform, no results, or no result came from that platform.
    """
    if lms not in FORMATS:
        raise CourseError(f"--lms {lms}: expected one of {', '.join(FORMATS)}")
    form = FORMATS[lms]
    course = course or this_course()
    lines, ready = _ready(out, form)
    wrote = []
    for exercise, group in ready.items():
        path = out / "feedback" / f"{exercise}_{lms}.zip"
        files = {name: _page(result, named, out, course, lms) for name, (result, named) in group.items()}
        with writing(out):
            write_whole(path, _zipped(files))
        size = path.stat().st_size / 1e6
        wrote.append(f"Wrote {path}: {counted(len(files), 'report')}, {size:.1f} MB. {form.menu}")
    notes = [CANVAS_NOTE] if lms == "canvas" else []
    return [printable(line) for line in (*lines, *wrote, *notes)]


Reports = dict[str, tuple[Result, PlatformName]]  # by the name of the file in the zip


def _ready(out: Path, form: Format) -> tuple[list[str], dict[str, Reports]]:
    """Return a line for each report that is left out, and the others by exercise."""
    ready, lines = defaultdict[str, Reports](dict), list[str]()
    need_results(out)
    results = list(results_in(out))
    named = {id(one): _named(str(one.get("handed_in_as", "")), form) for one in results}
    if not any(named.values()):
        raise CourseError(
            f"no result in {out} came in a download of {form.menu.split(':')[0]}, so its numbers of the "
            "students are not known. Type: course collect DOWNLOAD --out submissions, then "
            f"course grade submissions --out {out} --resume"
        )
    shared = Counter((one["exercise"], name) for one in results if (name := _file(one, named[id(one)], form)))
    for content in results:
        name, who = _file(content, named[id(content)], form), named[id(content)]
        if why := _held_back(content, shared[content["exercise"], name], name):
            lines.append(f"left out: {content['student']} {content['exercise']}: {why}")
        elif who:
            ready[content["exercise"]][name] = (Result.from_plain(content), who)
    return lines, ready


def _held_back(content: Mapping[str, Any], count: int, name: str) -> str:
    """Return why a report is not returned, or ""."""
    if not name:
        return "the platform's download does not have it"
    if count > 1:
        return f"{count} results have the platform's number of this student"
    status = content["row"]["status"]
    return "" if status in FINAL else f"it is {status}"


def _named(handed_in_as: str, form: Format) -> PlatformName | None:
    """Return the platform's name in a path of its download, as received.csv has it."""
    parts = handed_in_as.lstrip("'").split("/")
    found = (named for part in parts if (named := platform_name(part)) and named.platform in form.platforms)
    return next(found, None)


def _file(content: Mapping[str, Any], named: PlatformName | None, form: Format) -> str:
    """Return the name of a report in the zip; the student's name in it is for people, without underscores."""
    if named is None:
        return ""
    hidden = named.platform == "anonymous"
    return form.name.format(
        name="anon" if hidden else re.sub(r"[^\w .-]|_", "", named.name).strip(" .") or "student",
        number=named.number,
        attachment=named.attachment,
        exercise=re.sub(r"\W", "", str(content["exercise"])),
        suffix=_suffix(named),
    )


def _suffix(named: PlatformName) -> str:
    return ".zip" if named.file.lower().endswith(".zip") else ".html"


def _page(result: Result, named: PlatformName, out: Path, course: Course, lms: str) -> bytes:
    """Return the report, in a zip where Canvas will call it one."""
    page = standalone(result, out, catalog_of(course))
    in_zip = lms == "canvas" and _suffix(named) == ".zip"
    return _zipped({f"{result.submission.exercise}.html": page}) if in_zip else page


def _zipped(files: Mapping[str, bytes]) -> bytes:
    data = io.BytesIO()
    with ZipFile(data, "w") as archive:
        for name, content in files.items():
            archive.writestr(ZipInfo(name, YEAR), content, ZIP_DEFLATED)
    return data.getvalue()
