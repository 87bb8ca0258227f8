"""A platform's exports: which ID belongs to its number of a student, and when that student submitted."""

import re
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

from course_lib.course.identity import normalise
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.handin.platform_files import LmsFile, looks_like_time, parse_times, plain_digits

ID_HEADINGS = ("ID number", "SIS User ID", "SIS Login ID")  # Moodle's, Canvas's
SUBMISSION = re.compile("submi", re.IGNORECASE)  # in Moodle's and Canvas's heading of the time
NUMBER = re.compile(r"(\D*)(\d+)")  # "Participant 4101000", "Teilnehmer/in4101000", or the number alone
EXPORTS = (
    "Export it for the same assignment: in Moodle the grading worksheet, in Canvas the gradebook (IDs) or "
    "the API's list of submissions (times)"
)


@dataclass(frozen=True)
class Times:
    """Times of submission, by the keys of a platform's export.

    Args:
        source: The file and the column.
        by_number: By the platform's number of the student.
        by_attachment: By Canvas's number of the file.
        users: Canvas's numbers of students by their anonymous IDs.
        unread: A time of the column, if its times can't be read.
    """

    source: str
    by_number: Mapping[str, datetime] = field(default_factory=dict)
    by_attachment: Mapping[str, datetime] = field(default_factory=dict)
    users: Mapping[str, str] = field(default_factory=dict)
    unread: str = ""

    def of(self, number: str, attachment: str) -> datetime | None:
        """Return the time of a file's submission, None where the export does not have it."""
        return self.by_attachment.get(attachment) or self.by_number.get(number)


def read_ids(path: Path, id_column: str, numbers: Collection[str]) -> tuple[dict[str, str], str]:
    """Return each student's ID by the platform's number, and the heading of the IDs.

    Args:
        path: The platform's CSV.
        id_column: The heading of the IDs; "" to find the column.
        numbers: Those in the download, by which the column of numbers is found.

    Raises:
        CourseError: A column can't be found, or has a value twice.
    """
    file = LmsFile.read(path)
    place = _number_column(file, numbers, path)
    id_place = file.column(id_column) if id_column else _id_column(file, place)
    cells = [(_number(file.text(row, place)), file.text(row, id_place)) for row in range(1, len(file.rows))]
    rows = [(number, normalise(id_)) for number, id_ in cells if number and id_]
    for column, which in ((place, 0), (id_place, 1)):
        if twice := next(
            (one for one, count in Counter(row[which] for row in rows).items() if count > 1), ""
        ):
            raise CourseError(
                f"{path.name} has {twice!r} twice in {file.headings[column]!r}: "
                f"name the IDs' with --id-column; columns: {_listed(file)}"
            )
    return dict(rows), file.headings[id_place]


def read_class(path: Path, id_column: str) -> list[str]:
    """Return the IDs of a class in the roster's order.

    Args:
        path: The platform's CSV.
        id_column: The heading of the IDs; "" to find the column.

    Raises:
        CourseError: The column can't be found, is empty, or has an ID twice.
    """
    file = LmsFile.read(path, least=1)
    place = file.column(id_column) if id_column else _id_column(file, -1)
    cells = [file.text(row, place) for row in range(1, len(file.rows))]
    ids = [normalise(cell) for cell in cells if cell]
    if twice := [one for one, count in Counter(ids).items() if count > 1]:
        raise CourseError(f"{path.name} has {twice[0]!r} twice in {file.headings[place]!r}; delete a row")
    if not ids:
        raise CourseError(f"{path.name} has no student in {file.headings[place]!r}. {EXPORTS}")
    return ids


def read_times(path: Path, zone: ZoneInfo, numbers: Collection[str]) -> Times | None:
    """Read times of submission from a platform's CSV, or from the JSON of Canvas's API.

    Args:
        path: The file.
        zone: Of times that do not name theirs.
        numbers: Those in the download, by which the column of numbers is found.

    Returns:
        The times; none where a column of them can't be read; None where a CSV has no such column.

    Raises:
        CourseError: The file can't be read, or has none of the numbers.
    """
    if path.suffix.lower() == ".json":
        return _from_api(path, zone)
    file = LmsFile.read(path)
    place = _number_column(file, numbers, path)
    rows = [row for row in range(1, len(file.rows)) if _number(file.text(row, place)) in numbers]
    columns = {}
    for column in (column for column in range(len(file.headings)) if column != place):
        times = parse_times([file.text(row, column) for row in rows], zone)
        if 2 * sum(time is not None for time in times) >= len(rows):
            columns[column] = times
    if not columns:
        return _unread(file, path, rows)
    chosen = _submitted(file, columns)
    keys = [_number(file.text(row, place)) for row in rows]
    known = {key: time for key, time in zip(keys, columns[chosen], strict=True) if time}
    return Times(f"{path.name}, {file.headings[chosen]}", known)


def _unread(file: LmsFile, path: Path, rows: Sequence[int]) -> Times | None:
    """Return the column that seems to have the times, without them; None where there is none."""
    for column in range(len(file.headings)):
        seen = [cell for row in rows if looks_like_time(cell := file.text(row, column))]
        if seen and 2 * len(seen) >= len(rows):
            return Times(f"{path.name}, {file.headings[column]}", {}, unread=seen[0])
    return None


def _submitted(file: LmsFile, columns: Mapping[int, Sequence[datetime | None]]) -> int:
    """Return the column of submission: by its heading, else the first one that is not mostly one date.

    Platforms put the time of grading behind it; a due date is the same for most students.
    """
    named = [place for place in columns if SUBMISSION.search(file.headings[place])]
    varied = [
        place
        for place, times in columns.items()
        if len(times) <= 2 or Counter(filter(None, times)).most_common(1)[0][1] <= len(times) / 2
    ]
    return [*named, *varied, *columns][0]


def _number_column(file: LmsFile, numbers: Collection[str], path: Path) -> int:
    """Return the column that has the most of the platform's numbers of the download."""
    found = {
        place: sum(_number(file.text(row, place)) in numbers for row in range(1, len(file.rows)))
        for place in range(len(file.headings))
    }
    best = max(found, key=lambda place: found[place])
    if not found[best]:
        example = min(numbers, default="none")
        raise CourseError(
            f"{path.name} has no column with the numbers in the download's names, like {example}; "
            f"its columns: {_listed(file)}. {EXPORTS}"
        )
    return best


def _number(cell: str) -> str:
    match = NUMBER.fullmatch(plain_digits(cell))
    return match[2] if match else ""


def _id_column(file: LmsFile, number_place: int) -> int:
    """Return the column of the students' IDs: by its heading, else the only one that can be it.

    Raises:
        CourseError: None or several can be it; names them.
    """
    named = [file.headings.index(heading) for heading in ID_HEADINGS if heading in file.headings]
    for place in named:
        if any(file.text(row, place) for row in range(1, len(file.rows))):
            return place
    able = [p for p in range(len(file.headings)) if p != number_place and _can_be_ids(file, p)]
    if len(able) == 1:
        return able[0]
    suggested = repr(file.headings[able[0]]) if able else "HEADING"
    raise CourseError(
        f"which column of the roster has the students' IDs? Add --id-column {suggested}; "
        f"columns: {_listed(file)}"
    )


def _can_be_ids(file: LmsFile, place: int) -> bool:
    """Return whether a column has a different short word with a digit for most students."""
    cells = [file.text(row, place) for row in range(1, len(file.rows)) if any(file.rows[row])]
    words = [cell for cell in cells if re.fullmatch(r"[\w.-]{3,64}", cell) and re.search(r"\d", cell)]
    return len(words) > len(cells) / 2 and len(set(words)) == len(words)


def _listed(file: LmsFile) -> str:
    return ", ".join(map(repr, file.headings))


def _from_api(path: Path, zone: ZoneInfo) -> Times:
    """Read what Canvas's API lists as the submissions of an assignment."""
    try:
        entries = list(_entries(read_json(path.read_text(encoding="utf-8-sig"))))
    except (OSError, ValueError) as error:
        raise CourseError(f"{path} can't be read: {error}. {EXPORTS}") from error
    by_number: dict[str, datetime] = {}
    by_attachment: dict[str, datetime] = {}
    users: dict[str, str] = {}
    for entry in entries:
        user, hidden = (str(entry.get(key) or "") for key in ("user_id", "anonymous_id"))
        if user and hidden:
            users[hidden] = user
        (time,) = parse_times([str(entry.get("submitted_at") or "")], zone)
        if time is None:
            continue
        attached = entry.get("attachments")
        listed = attached if isinstance(attached, list) else []
        files = [str(file["id"]) for file in listed if isinstance(file, dict) and "id" in file]
        by_attachment |= dict.fromkeys(files, time)
        if not files:
            by_number |= {key: time for key in (user, hidden) if key}
    if not by_number and not by_attachment:
        raise CourseError(f"{path.name} has no user_id with submitted_at. {EXPORTS}")
    return Times(f"{path.name}, submitted_at", by_number, by_attachment, users)


def _entries(content: Any) -> Iterator[Mapping[str, Any]]:
    """Yield all objects with a time of submission, at any depth, also earlier attempts."""
    if isinstance(content, list):
        for item in content:
            yield from _entries(item)
    elif isinstance(content, dict):
        for value in content.values():
            if isinstance(value, (list, dict)):
                yield from _entries(value)
        if "submitted_at" in content:
            yield content
