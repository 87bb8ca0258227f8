"""`course regrade`: requests to look at marks again, and their answers, which reports show."""

from collections.abc import Callable
from pathlib import Path

from course_lib.errors import CourseError, counted
from course_lib.grading.handin.notebook import exercise_named
from course_lib.grading.marks.by_hand import known_name
from course_lib.grading.marks.mark import Result, read_result
from course_lib.grading.marks.requests import (
    MAX_TEXT,
    RegradeRequest,
    add_answer,
    add_request,
    open_requests,
    read_requests,
    requests_path,
)
from course_lib.grading.records import Course, catalog_of, result_path, sole_use, this_course, writing
from course_lib.grading.reports.report import report
from course_lib.grading.reports.table import printable

SHOWN = 200  # characters of a request in the terminal
MAX_BYTES = 8 * MAX_TEXT
FILES = "STUDENT/week01_exercise.txt, with what the student wrote"


def take_in(out: Path, folder: Path, course: Course | None = None) -> list[str]:
    """Enter each file FOLDER/STUDENT/EXERCISE.txt as a request; returns a line for each, and the open ones.

    Args:
        out: The folder that `course grade` wrote.
        folder: Of texts; what is in it already counts once.
        course: Where the tasks are; default: this checkout.

    Raises:
        CourseError: `folder` holds no such file, or `out` is in use.
    """
    paths = sorted(path for path in folder.glob("*/*") if path.suffix in (".txt", ".md") and path.is_file())
    if not paths:
        raise CourseError(f"{folder} holds no request. Expected files like {FILES}")
    lines = []
    for path in paths:
        try:
            text = _text(path)
            student, exercise = _of(out, path.parent.name, exercise_named(path.name) or path.stem)
            known = [one.text for one in _there(out, student, exercise)]
            if text not in known:
                _change(out, student, exercise, course, add_request, text)
                lines.append(f"entered: {student} {exercise}")
        except CourseError as error:
            lines.append(f"refused: {path}: {error}")
    return [*map(printable, lines), *waiting(out)]


def answer(out: Path, student: str, exercise: str, text: str, course: Course | None = None) -> list[str]:
    """Answer a student's last request; returns the lines for the terminal.

    Raises:
        CourseError: There is no such result, or no request waits for an answer.
    """
    student, exercise = _of(out, student, exercise)
    _change(out, student, exercise, course, add_answer, text)
    return [f"{student} {exercise}: answered; the report shows it", *waiting(out)]


def waiting(out: Path) -> list[str]:
    """Return a line for each request without an answer, and their number."""
    found = list(open_requests(out))
    shown = (f"{student} {exercise}: {one.text[:SHOWN]}" for student, exercise, one in found)
    return [*map(printable, shown), f"{counted(len(found), 'request')} without an answer"]


def _there(out: Path, student: str, exercise: str) -> tuple[RegradeRequest, ...]:
    return read_requests(requests_path(out, student, exercise))


def _text(path: Path) -> str:
    """Return the text of a file that a student wrote.

    Raises:
        CourseError: It is a link, too large, or no text.
    """
    try:
        if path.is_symlink():
            raise CourseError("it is a link")
        with path.open("rb") as file:
            return file.read(MAX_BYTES).decode("utf-8-sig").strip()
    except (OSError, UnicodeError) as error:
        raise CourseError(f"it is not a text in UTF-8: {error}") from error


def _of(out: Path, student: str, exercise: str) -> tuple[str, str]:
    """Return student and exercise as the results have them."""
    student = known_name(student, out / "results", "student")
    return student, known_name(exercise, out / "results" / student, "exercise")


def _change(
    out: Path, student: str, exercise: str, course: Course | None, add: Callable[[Path, str], None], text: str
) -> None:
    """Store a request or an answer, as `add` does, and write the report again."""
    catalog = catalog_of(course or this_course())
    with sole_use(out), writing(out):
        add(requests_path(out, student, exercise), text)
        result = Result.from_plain(read_result(result_path(out, student, exercise)))
        report(result, out, catalog)
