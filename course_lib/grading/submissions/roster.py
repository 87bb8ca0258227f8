"""The class list and the exports of learning platforms: tables of a class.

`roster.csv` has the ID, name, e-mail, section, group and GitHub login of each student. A platform's
export adds its own numbers of students and the times of submission.
"""

import codecs
import re
from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, fields
from datetime import datetime
from pathlib import Path
from typing import Any, Self
from zoneinfo import ZoneInfo

from course_lib.course.exercise import normalise
from course_lib.errors import CourseError, did_you_mean, format_count
from course_lib.grading.submissions.readers import fold_key, looks_like_time, parse_times, plain_digits
from course_lib.third_party import read_bytes, read_json

BOMS = {codecs.BOM_UTF8: "utf-8", codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}
DELIMITERS = (",", ";", "\t", "|")
EXCEL = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")  # the first bytes of .xlsx and .xls


@dataclass
class LmsFile:
    """The raw cells of a table, with quotes. `ends` contains the line ends of all rows."""

    bom: bytes
    encoding: str
    delimiter: str
    rows: list[list[str]]
    ends: list[str]

    @classmethod
    def read(cls, path: Path, least: int = 2) -> Self:
        """Read a file of any common encoding, delimiter and line ending.

        Args:
            path: The file.
            least: The required number of columns, 1 or 2.

        Raises:
            CourseError: It can't be read, or contains no table.
        """
        try:
            data = read_bytes(path)
        except OSError as error:
            raise CourseError(
                f"{path} can't be read: {error.strerror}. Pass the CSV file of a platform or a class."
            ) from error
        if data.startswith(EXCEL):
            raise CourseError(
                f"{path} is an Excel workbook, expected CSV. Open it and save it as CSV UTF-8, "
                "or export it from the platform as CSV."
            )
        bom = next((bom for bom in BOMS if data.startswith(bom)), b"")
        encoding = BOMS.get(bom) or _guess_encoding(data)
        try:
            text = data.removeprefix(bom).decode(encoding, "surrogatepass" if bom else "strict")
        except UnicodeError as error:
            reason = "byte order mark indicates it" if bom else "first bytes are like that"
            raise CourseError(
                f"{path} is not valid {encoding}, although its {reason}: {error}. Export it again."
            ) from error
        first = re.split("[\r\n]", text, maxsplit=1)[0]
        delimiter = max(DELIMITERS, key=first.count)
        columns = first.count(delimiter) + 1 if first.strip() else 0
        if columns < least or "\0" in text:
            raise CourseError(
                f"{path} is not a CSV: its first line has no columns. Export it from the platform."
            )
        return cls(bom, encoding, delimiter, *_split(text, delimiter))

    def to_bytes(self) -> bytes:
        """Return the bytes of the whole file."""
        lines = (self.delimiter.join(row) + end for row, end in zip(self.rows, self.ends, strict=True))
        return self.bom + "".join(lines).encode(self.encoding, "surrogatepass" if self.bom else "strict")

    def text(self, row: int, column: int) -> str:
        """Return a cell without its quotes, or "" if the row is too short."""
        cells = self.rows[row]
        cell = cells[column].strip() if column < len(cells) else ""
        quoted = len(cell) > 1 and cell[0] == cell[-1] == '"'
        return (cell[1:-1].replace('""', '"') if quoted else cell).strip()

    @property
    def headings(self) -> list[str]:
        """The cells of the first row."""
        return [self.text(0, place) for place in range(len(self.rows[0]))]

    def put(self, row: int, column: int, number: str) -> None:
        """Change a cell, keeping its quotes."""
        quote = '"' if self.rows[row][column].strip().startswith('"') else ""
        self.rows[row][column] = f"{quote}{number}{quote}"

    def column(self, name: str) -> int:
        """Return the index of a column, by its heading or the part before the number in `Week 1 (12345)`.

        Raises:
            CourseError: No column or several columns match.
        """
        headings = self.headings
        columns = [i for i, heading in enumerate(headings) if heading == name]
        columns = columns or [
            i for i, h in enumerate(headings) if re.fullmatch(re.escape(name) + r" \(\d+\)", h)
        ]
        if len(columns) != 1:
            known_headings = ", ".join(map(repr, headings))
            raise CourseError(
                f"{len(columns) or 'no'} columns are named {name!r}; expected one of {known_headings}"
            )
        return columns[0]


def _guess_encoding(data: bytes) -> str:
    """Return the encoding of a table without a byte order mark."""
    # In UTF-16, every other byte of headings in Latin letters is 0.
    for encoding, first in (("utf-16-le", 1), ("utf-16-be", 0)):
        high_bytes = data[first:200:2]
        if len(data) % 2 == 0 and 2 * high_bytes.count(0) > len(high_bytes):
            return encoding
    try:
        data.decode()
    except UnicodeDecodeError:
        # latin-1 decodes any byte.
        return "latin-1"
    return "utf-8"


def _split(text: str, delimiter: str) -> tuple[list[list[str]], list[str]]:
    """Split a CSV string into rows of raw cells, and return them with each row's line ending."""
    d = re.escape(delimiter)
    cells = re.findall(rf'( *"(?:[^"]|"")*"[^{d}\r\n]*|[^{d}\r\n]*)({d}|\r\n|\r|\n|\Z)', text)
    rows, ends = [list[str]()], list[str]()
    for cell, end in cells:
        rows[-1].append(cell)
        if end != delimiter:
            ends.append(end)
            rows.append([])
    return rows[:-1], ends


# Headings of other programs.
OTHER_HEADINGS = {
    "e-mail": "email",
    "email address": "email",
    "github": "login",
    "github_username": "login",  # GitHub Classroom's columns: this and "identifier"
    "identifier": "id",
}
ONCE = ("id", "email", "login")  # columns with unique values
EXAMPLE = "a first line id,name,email,section,group,login, of which only id is required"


@dataclass(frozen=True)
class Member:
    """One student of a class; everything except the ID may be "".

    Args:
        id: The ID in normalized spelling.
        name: The name as written in the roster.
        email: The address in lower case.
        section: The section of the class.
        group: The group, whose members submit together.
        login: The GitHub login in lower case.
    """

    id: str
    name: str = ""
    email: str = ""
    section: str = ""
    group: str = ""
    login: str = ""


def read_class_list(path: Path) -> tuple[Member, ...]:
    """Read roster.csv in any common encoding and delimiter; unknown columns are ignored.

    Raises:
        CourseError: A row or a heading is invalid; the message states what was expected.
    """
    file = LmsFile.read(path, least=1)
    places, width = _find_columns(file, path), len(file.rows[0])
    for number, cells in enumerate(file.rows, 1):
        # Delimiters without quotes cause cells beyond the headings.
        if any(cell.strip() for cell in cells[width:]):
            raise CourseError(
                f"{path}, row {number}: {len(cells)} cells below {format_count(width, 'heading')}. "
                f"Put double quotes around cells that contain {file.delimiter!r}"
            )
    rows = [
        (row + 1, {name: file.text(row, place) for name, place in places.items()})
        for row in range(1, len(file.rows))
    ]
    members = [_member(texts, f"{path}, row {number}") for number, texts in rows if any(texts.values())]
    if not members:
        raise CourseError(f"{path} has no student. Expected {EXAMPLE}, and a row for each student")
    for name in ONCE:
        owners = defaultdict[str, list[str]](list)
        for member in members:
            owners[getattr(member, name)].append(member.id)
        for text, ids in owners.items():
            if text and len(ids) > 1:
                raise CourseError(
                    f"{path}: {name} {text!r} occurs {len(ids)} times ({', '.join(ids)}). "
                    "Delete or correct one of the rows"
                )
    return tuple(members)


def read_id(cell: str) -> str:
    """Return the normalized ID in a cell.

    Brightspace writes #0042, and others ="0042" or '0042, so that a spreadsheet keeps the zeros.

    Raises:
        CourseError: The cell contains no ID.
    """
    return normalise(re.sub(r"""^(#|'|=")|"$""", "", cell))


def ids_of_section(roster: Path | None, section: str) -> frozenset[str] | None:
    """Return the IDs of a section's students, or None without a section, which selects everybody.

    Raises:
        CourseError: The section does not exist, or only one of the two is given.
    """
    if not section and roster is None:
        return None
    if not section or roster is None:
        raise CourseError("--section and --roster are needed together: --section A --roster roster.csv")
    members = read_class_list(roster)
    student_ids = frozenset(m.id for m in members if m.section.casefold() == section.casefold())
    if not student_ids:
        known_sections = ", ".join(sorted({m.section for m in members if m.section})) or "none"
        raise CourseError(
            f"{roster} has no section {section!r}. Sections in its column 'section': {known_sections}"
        )
    return student_ids


def _find_columns(file: LmsFile, path: Path) -> dict[str, int]:
    """Return the index of each known column.

    Raises:
        CourseError: The ID column is missing, a column occurs twice, or a heading seems to be
            misspelled.
    """
    field_names = tuple(field.name for field in fields(Member))
    places: dict[str, int] = {}
    for place, heading in enumerate(file.headings):
        plain = heading.casefold()
        name = OTHER_HEADINGS.get(plain, plain)
        if name in places:
            raise CourseError(f"{path} contains the column {name!r} twice. Expected {EXAMPLE}")
        if name in field_names:
            places[name] = place
    for heading in file.headings:
        suggestion = did_you_mean(heading.casefold(), [name for name in field_names if name not in places])
        if heading.casefold() not in places and heading.casefold() not in OTHER_HEADINGS and suggestion:
            raise CourseError(f"{path} has a column {heading!r}{suggestion} Expected {EXAMPLE}")
    if "id" not in places:
        there = ", ".join(map(repr, file.headings))
        raise CourseError(f"{path} has no column 'id', it has {there}. Expected {EXAMPLE}")
    return places


def _member(cells: Mapping[str, str], where: str) -> Member:
    if not cells["id"]:
        raise CourseError(f"{where}: no id, but {next(filter(None, cells.values()))!r}")
    try:
        student = read_id(cells["id"])
    except CourseError as error:
        raise CourseError(f"{where}: {error}") from error
    folded_cells = {name: cells[name].casefold() for name in ("email", "login") if name in cells}
    return Member(**{**cells, **folded_cells, "id": student})


# headings in Moodle, Canvas, and the class list; Canvas's "ID" is its own number
ID_HEADINGS = ("ID number", "SIS User ID", "SIS Login ID", "id")
# Part of the headings of submission times in Moodle and Canvas.
SUBMISSION = re.compile("submi", re.IGNORECASE)
NUMBER = re.compile(r"(\D*)(\d+)")  # "Participant 4101000", "Teilnehmer/in4101000", or only the number
EXPORTS = (
    "Export it for the same assignment: in Moodle the grading worksheet, in Canvas the gradebook "
    "(IDs) or the API's list of submissions (times)"
)


@dataclass(frozen=True)
class Times:
    """Times of submission by the keys of a platform's export.

    Args:
        source: The file and the column.
        by_number: Times by the platform's number of the student.
        by_attachment: Times by Canvas's number of the file.
        users: Canvas's numbers of students by anonymous ID.
        unparsed: An example if the column's times can't be parsed, else "".
    """

    source: str
    by_number: Mapping[str, datetime] = field(default_factory=dict)
    by_attachment: Mapping[str, datetime] = field(default_factory=dict)
    users: Mapping[str, str] = field(default_factory=dict)
    unparsed: str = ""


def read_ids(path: Path, id_column: str, numbers: Collection[str]) -> tuple[dict[str, str], str]:
    """Return the students' IDs by platform number, and the heading of the ID column.

    Args:
        path: The platform's CSV.
        id_column: The heading of the ID column; "" to find the column.
        numbers: Numbers, user names or names in the download, by which their column is found.

    Raises:
        CourseError: A column can't be found, or has a duplicate value.
    """
    file = LmsFile.read(path)
    place = _number_column(file, numbers, path)
    id_place = file.column(id_column) if id_column else _id_column(file, place)
    ids = _read_ids(file, id_place, path)
    keys = {row: _key(file.text(row, place), numbers) for row in ids}
    rows = [(keys[row], student) for row, student in ids.items() if keys[row]]
    for column, which in ((place, 0), (id_place, 1)):
        if twice := next(
            (value for value, count in Counter(row[which] for row in rows).items() if count > 1), ""
        ):
            # A platform's folder of a group belongs to several rows, as two students of one name do.
            groups = (
                "if students have submitted in groups, copy each group's file into a folder of each "
                "member, STUDENT/week01_exercise.ipynb, and pass the folder of these to course grade. "
                "Otherwise "
            ) * (which == 0)
            raise CourseError(
                f"{path.name} contains {twice!r} twice in {file.headings[column]!r}: {groups}"
                "correct one of the rows, or select the ID column with --id-column; columns: "
                f"{_list_headings(file)}"
            )
    return dict(rows), file.headings[id_place]


def _read_ids(file: LmsFile, place: int, path: Path) -> dict[int, str]:
    """Return the ID of each row that has one. Raise a CourseError with the row of an invalid ID."""
    student_ids: dict[int, str] = {}
    for row in range(1, len(file.rows)):
        try:
            if cell := file.text(row, place):
                student_ids[row] = read_id(cell)
        except CourseError as error:
            column = file.headings[place]
            raise CourseError(f"{path}, row {row + 1}, column {column!r}: {error}") from None
    return student_ids


def has_key(path: Path, keys: Collection[str]) -> bool:
    """Return whether a cell of a CSV is a key of a student."""
    file = LmsFile.read(path)
    cells = (file.text(row, place) for row in range(1, len(file.rows)) for place in range(len(file.headings)))
    return any(_key(cell, keys) in keys for cell in cells)


def read_class(path: Path, id_column: str) -> list[str]:
    """Return the IDs of a class in the roster's order.

    Args:
        path: The platform's CSV.
        id_column: The heading of the ID column; "" to find the column.

    Raises:
        CourseError: The column can't be found, is empty, or has a duplicate ID.
    """
    file = LmsFile.read(path, least=1)
    place = file.column(id_column) if id_column else _id_column(file, -1)
    ids = list(_read_ids(file, place, path).values())
    if twice := [student_id for student_id, count in Counter(ids).items() if count > 1]:
        raise CourseError(
            f"{path.name} contains {twice[0]!r} twice in {file.headings[place]!r}; delete a row"
        )
    if not ids:
        raise CourseError(f"{path.name} has no student in {file.headings[place]!r}. {EXPORTS}")
    return ids


def read_times(path: Path, zone: ZoneInfo, numbers: Collection[str]) -> Times | None:
    """Read times of submission from a platform's CSV, or from the JSON of Canvas's API.

    Args:
        path: The file.
        zone: The zone of times without one.
        numbers: Numbers, user names or names in the download, by which their column is found.

    Returns:
        The times, without entries if their column can't be parsed; None if a CSV has no such
        column.

    Raises:
        CourseError: The file can't be read, or has none of the numbers.
    """
    if path.suffix.lower() == ".json":
        return _read_api_times(path, zone)
    file = LmsFile.read(path)
    place = _number_column(file, numbers, path)
    rows = [row for row in range(1, len(file.rows)) if _key(file.text(row, place), numbers) in numbers]
    columns = {}
    for column in (column for column in range(len(file.headings)) if column != place):
        times = parse_times([file.text(row, column) for row in rows], zone)
        if 2 * sum(time is not None for time in times) >= len(rows):
            columns[column] = times
    if not columns:
        for column, heading in enumerate(file.headings):
            texts = [cell for row in rows if looks_like_time(cell := file.text(row, column))]
            if texts and 2 * len(texts) >= len(rows):
                return Times(f"{path.name}, {heading}", {}, unparsed=texts[0])
        return None
    # The submission column has the heading, or is the first column without a predominant date:
    # platforms put the time of grading after it, and a due date is the same for most students.
    submission_columns = [place for place in columns if SUBMISSION.search(file.headings[place])]
    varied = [
        place
        for place, times in columns.items()
        if len(times) <= 2 or Counter(filter(None, times)).most_common(1)[0][1] <= len(times) / 2
    ]
    time_column = [*submission_columns, *varied, *columns][0]
    keys = [_key(file.text(row, place), numbers) for row in rows]
    times_by_student = {key: time for key, time in zip(keys, columns[time_column], strict=True) if time}
    return Times(f"{path.name}, {file.headings[time_column]}", times_by_student)


def _number_column(file: LmsFile, numbers: Collection[str], path: Path) -> int:
    """Return the column that contains most of the download's platform numbers."""
    counts = {
        place: sum(_key(file.text(row, place), numbers) in numbers for row in range(1, len(file.rows)))
        for place in range(len(file.headings))
    }
    best = max(counts, key=lambda place: counts[place])
    if not counts[best]:
        example = min(numbers, default="none")
        raise CourseError(
            f"{path.name} has no column with the numbers or names in the download, like {example}; "
            f"its columns: {_list_headings(file)}. {EXPORTS}"
        )
    return best


def _key(cell: str, keys: Collection[str]) -> str:
    """Return a student's key in a cell: a user name or name of the download, else the number in the cell."""
    text = fold_key(cell)
    match = NUMBER.fullmatch(plain_digits(cell))
    return text if text in keys or not match else match[2]


def _id_column(file: LmsFile, number_place: int) -> int:
    """Return the column of the students' IDs: by its heading, else the only possible one.

    Raises:
        CourseError: No column or several columns are possible.
    """
    id_columns = [file.headings.index(heading) for heading in ID_HEADINGS if heading in file.headings]
    for place in id_columns:
        if any(file.text(row, place) for row in range(1, len(file.rows))):
            return place
    able = []
    for place in range(len(file.headings)):
        cells = [file.text(row, place) for row in range(1, len(file.rows)) if any(file.rows[row])]
        id_like = [cell for cell in cells if re.fullmatch(r"[\w.-]{3,64}", cell) and re.search(r"\d", cell)]
        # Most cells are distinct short words with a digit.
        if place != number_place and len(id_like) > len(cells) / 2 and len(set(id_like)) == len(id_like):
            able.append(place)
    if len(able) == 1:
        return able[0]
    suggested = repr(file.headings[able[0]]) if able else "HEADING"
    raise CourseError(
        f"which column of the roster has the students' IDs? Add --id-column {suggested}; "
        f"columns: {_list_headings(file)}"
    )


def _list_headings(file: LmsFile) -> str:
    return ", ".join(map(repr, file.headings))


def _read_api_times(path: Path, zone: ZoneInfo) -> Times:
    """Read the submissions of an assignment as listed by Canvas's API."""
    try:
        entries = list(_submissions_in(read_json(read_bytes(path).decode("utf-8-sig"))))
    except (OSError, ValueError) as error:
        raise CourseError(f"{path} can't be read: {error}. {EXPORTS}") from error
    by_number: dict[str, datetime] = {}
    by_attachment: dict[str, datetime] = {}
    users: dict[str, str] = {}
    for entry in entries:
        user, anonymous_id = (str(entry.get(key) or "") for key in ("user_id", "anonymous_id"))
        if user and anonymous_id:
            users[anonymous_id] = user
        (time,) = parse_times([str(entry.get("submitted_at") or "")], zone)
        if time is None:
            continue
        attached = entry.get("attachments")
        attachments = attached if isinstance(attached, list) else []
        files = [str(file["id"]) for file in attachments if isinstance(file, dict) and "id" in file]
        by_attachment |= dict.fromkeys(files, time)
        if not files:
            by_number |= {key: time for key in (user, anonymous_id) if key}
    if not by_number and not by_attachment:
        raise CourseError(f"{path.name} has no user_id with submitted_at. {EXPORTS}")
    return Times(f"{path.name}, submitted_at", by_number, by_attachment, users)


def _submissions_in(content: Any) -> Iterator[Mapping[str, Any]]:
    """Yield all objects with a time of submission, at any depth, including earlier attempts."""
    if isinstance(content, list):
        for item in content:
            yield from _submissions_in(item)
    elif isinstance(content, dict):
        for value in content.values():
            if isinstance(value, (list, dict)):
                yield from _submissions_in(value)
        if "submitted_at" in content:
            yield content
