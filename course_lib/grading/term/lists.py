"""Lists that an instructor keeps: exemptions, and the marks of quizzes."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

from course_lib.course.course_file import CourseFile
from course_lib.course.identity import normalise
from course_lib.errors import CourseError, did_you_mean
from course_lib.grading.handin.platform_files import LmsFile
from course_lib.grading.term.class_list import ClassList
from course_lib.grading.term.totals import FULL

EXEMPTIONS = ("id", "week", "reason")
QUIZZES = ("id", "week", "percent")


def read_exemptions(path: Path, members: ClassList, course: CourseFile) -> dict[str, dict[str, str]]:
    """Return the reason of each exemption, by student and week.

    Raises:
        CourseError: A column or a row is wrong; names it.
    """
    found = defaultdict[str, dict[str, str]](dict)
    for _, student, week, reason in _rows(path, EXEMPTIONS, members, course):
        found[student][week] = reason
    return dict(found)


def read_quizzes(path: Path, members: ClassList, course: CourseFile) -> dict[str, dict[str, float]]:
    """Return the percent of each quiz, by student and week.

    Raises:
        CourseError: A column or a row is wrong, or a percent is not a number from 0 to 100.
    """
    found = defaultdict[str, dict[str, float]](dict)
    for where, student, week, text in _rows(path, QUIZZES, members, course):
        found[student][week] = _percent(text, where)
    return dict(found)


def _percent(text: str, where: str) -> float:
    try:
        percent = float(text.replace(",", "."))
    except ValueError as error:
        raise CourseError(f"{where}: {text!r}, expected a number from 0 to 100") from error
    if not 0 <= percent <= FULL:
        raise CourseError(f"{where}: {text!r}, expected a number from 0 to 100")
    return percent


def _rows(
    path: Path, columns: tuple[str, ...], members: ClassList, course: CourseFile
) -> Iterator[tuple[str, str, str, str]]:
    """Yield the place, the student, the week and the last cell of each row.

    Raises:
        CourseError: There is no such student or week, or a pair is there twice.
    """
    file = LmsFile.read(path)
    headings: Mapping[str, int] = {name.casefold(): place for place, name in enumerate(file.headings)}
    if missing := [name for name in columns if name not in headings]:
        raise CourseError(f"{path} has no column {missing[0]!r}. Expected a first line {','.join(columns)}")
    known, seen = {week for week, settings in course.weeks.items() if settings.points}, set[tuple[str, str]]()
    for row in range(1, len(file.rows)):
        student, week, text = (file.text(row, headings[name]) for name in columns)
        if not any((student, week, text)):
            continue
        where = f"{path}, row {row + 1}"
        student = _known(student, members.by_id, f"{where}: no student", "in the class list")
        week = _known(week, dict.fromkeys(known), f"{where}: no week", "with points")
        if (student, week) in seen:
            raise CourseError(f"{where}: {student} {week} is there twice. Delete one of the rows")
        seen.add((student, week))
        yield where, student, week, text


def _known(text: str, there: Mapping[str, object], what: str, place: str) -> str:
    try:
        found = normalise(text)
    except CourseError as error:
        raise CourseError(f"{what} {text!r} {place}: {error}") from error
    if found not in there:
        meant = did_you_mean(found, there, 3)
        raise CourseError(f"{what} {text!r} {place}{meant or '.'}")
    return found
