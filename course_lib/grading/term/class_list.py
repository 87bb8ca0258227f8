"""roster.csv, the class list of a course: IDs, names, addresses, sections, groups, logins."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path

from course_lib.course.identity import normalise
from course_lib.errors import CourseError, did_you_mean
from course_lib.grading.handin.platform_files import LmsFile

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
