"""Lists that an instructor keeps: the class list roster.csv, exemptions, and the marks of quizzes."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path

from course_lib.course.course_file import CourseFile
from course_lib.course.identity import normalise
from course_lib.errors import CourseError, did_you_mean
from course_lib.grading.handin.platform_files import LmsFile
from course_lib.grading.term.totals import FULL

OTHER_HEADINGS = {  # of a column, as other programs write it
    "e-mail": "email",
    "email address": "email",
    "github": "login",
    "github_username": "login",  # GitHub Classroom's classroom_roster.csv, with the next
    "identifier": "id",
}
ONCE = ("id", "email", "login")  # columns in which no two students share a text
EXAMPLE = "a first line id,name,email,section,group,login, of which only id must be there"


@dataclass(frozen=True)
class Member:
    """One student of a class; all but the ID may be "".

    Args:
        id: In one spelling, as folders of submissions have it.
        name: As it is written.
        email: In small letters.
        section: Of the class.
        group: Those of one group hand in together.
        login: On GitHub, in small letters.
    """

    id: str
    name: str = ""
    email: str = ""
    section: str = ""
    group: str = ""
    login: str = ""


@dataclass(frozen=True)
class ClassList:
    """All students of a class, in the roster's order."""

    members: tuple[Member, ...]

    @cached_property
    def by_id(self) -> Mapping[str, Member]:
        """The students by ID."""
        return {member.id: member for member in self.members}

    def group_of(self, student: str) -> tuple[Member, ...]:
        """Return all who hand in together with a student, the student included; nobody for a stranger."""
        member = self.by_id.get(student)
        if member is None or not member.group:
            return (member,) if member else ()
        return tuple(one for one in self.members if one.group == member.group)


def read_class_list(path: Path) -> ClassList:
    """Read roster.csv, of any usual encoding and delimiter; columns that it does not know are left out.

    Raises:
        CourseError: A row or a heading is wrong; names it and what was expected.
    """
    file = LmsFile.read(path, least=1)
    places = _places(file, path)
    file.refuse_long_rows(path)
    rows = [
        (row + 1, {name: file.text(row, place) for name, place in places.items()})
        for row in range(1, len(file.rows))
    ]
    members = [_member(cells, f"{path}, row {number}") for number, cells in rows if any(cells.values())]
    if not members:
        raise CourseError(f"{path} has no student. Expected {EXAMPLE}, and a row for each student")
    for problem in _twice(members):
        raise CourseError(f"{path}: {problem}. Delete or correct one of the rows")
    return ClassList(tuple(members))


def _places(file: LmsFile, path: Path) -> dict[str, int]:
    """Return the place of each known column.

    Raises:
        CourseError: The IDs are missing, a column is there twice, or a heading looks like a mistyped one.
    """
    known = tuple(field.name for field in fields(Member))
    places: dict[str, int] = {}
    for place, heading in enumerate(file.headings):
        plain = heading.casefold()
        name = OTHER_HEADINGS.get(plain, plain)
        if name in places:
            raise CourseError(f"{path} has the column {name!r} twice. Expected {EXAMPLE}")
        if name in known:
            places[name] = place
    for heading in file.headings:
        meant = did_you_mean(heading.casefold(), [name for name in known if name not in places])
        if heading.casefold() not in places and heading.casefold() not in OTHER_HEADINGS and meant:
            raise CourseError(f"{path} has a column {heading!r}{meant} Expected {EXAMPLE}")
    if "id" not in places:
        there = ", ".join(map(repr, file.headings))
        raise CourseError(f"{path} has no column 'id', it has {there}. Expected {EXAMPLE}")
    return places


def _member(cells: Mapping[str, str], where: str) -> Member:
    if not cells["id"]:
        raise CourseError(f"{where}: no id, but {next(filter(None, cells.values()))!r}")
    try:
        student = normalise(cells["id"])
    except CourseError as error:
        raise CourseError(f"{where}: {error}") from error
    folded = {name: cells[name].casefold() for name in ("email", "login") if name in cells}
    return Member(**{**cells, **folded, "id": student})


def _twice(members: Sequence[Member]) -> Iterator[str]:
    """Yield a sentence for each text that two students share in a column where they may not."""
    for name in ONCE:
        owners = defaultdict[str, list[str]](list)
        for member in members:
            owners[getattr(member, name)].append(member.id)
        for text, ids in owners.items():
            if text and len(ids) > 1:
                yield f"{name} {text!r} is there {len(ids)} times ({', '.join(ids)})"


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
    """Return the percent of each quiz, by student and week; 0 for who has none where others have.

    Raises:
        CourseError: A column or a row is wrong, or a percent is not a number from 0 to 100.
    """
    found = defaultdict[str, dict[str, float]](dict)
    for where, student, week, text in _rows(path, QUIZZES, members, course):
        found[student][week] = _percent(text, where)
    held = {week for percents in found.values() for week in percents}
    return {one.id: dict.fromkeys(held, 0.0) | found[one.id] for one in members.members}


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
