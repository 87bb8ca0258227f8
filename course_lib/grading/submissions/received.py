"""The time of receipt of a submission, and its source."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

from course_lib.errors import CourseError
from course_lib.grading.records import RECEIPT_TIME, ReceiptTime
from course_lib.grading.submissions.readers import STAMP, YEARS, LmsFile, parse_times, platform_name
from course_lib.third_party import check_regular

LIST = "received.csv"
UNFINISHED = ".collecting"  # exists while `course collect` writes the folder
ID_FROM = "id_from"  # whether the student's ID is from the roster
COLUMNS = ("file", "received", "late", "source", "name", "handed_in_as", ID_FROM, "exercise", "refused")
# levels below the top: STUDENT/ in folders made by hand, and nbgrader's STUDENT/ASSIGNMENT/
STAMP_DEPTHS = (1, 2)
MAX_STAMP = 200  # [B]
UNKNOWN = "unknown"
EXAMPLES = {
    LIST: "the columns file,received and rows like ada/week01_exercise.ipynb,2026-10-11T23:59:00+02:00",
    STAMP: "a line like 2026-10-11 23:59:00.000000 UTC",
}


@dataclass(frozen=True)
class Entry:
    """One row of received.csv."""

    time: datetime | None = None
    source: str = ""
    late: bool | None = None
    note: str = ""
    handed_in_as: str = ""
    exercise: str = ""
    refused: str = ""


@dataclass(frozen=True)
class Ledger:
    """The instructor's received.csv, in the folder of submissions or next to it.

    Args:
        top: The folder of all submissions.
        zone: The zone of times without one.
        entries: The rows by file.
    """

    top: Path
    zone: ZoneInfo
    entries: Mapping[Path, Entry] = field(default_factory=dict)

    @classmethod
    def read(cls, top: Path, zone: ZoneInfo) -> "Ledger":
        """Read the list if it exists.

        Raises:
            CourseError: It is not a table, or lacks a column.
        """
        entries: dict[Path, Entry] = {}
        for path in (top.absolute().parent / LIST, top.absolute() / LIST):
            if path.is_file():
                entries |= _entries(path, zone)
        return cls(top, zone, entries)

    def received(self, path: Path, receipt: Mapping[str, Any]) -> ReceiptTime:
        """Return the most reliable known time of a file.

        The list takes precedence, then nbgrader's time stamp next to the file, then the platform's
        flag, then the receipt. Data that a student can write is not trusted if the platform has
        better data.

        Args:
            path: The submitted file.
            receipt: The receipt written by `course submit`, or an empty mapping.
        """
        entry = self.entries.get(path.absolute())
        notes = [entry.note] if entry and entry.note else []
        # Students fill these folders, so a list in one of them is not evidence.
        inner = [folder for folder in path.parents if self.top in folder.parents]
        lists = [(folder / LIST).relative_to(self.top) for folder in inner if (folder / LIST).is_file()]
        notes += [f"{one.as_posix()} is not trusted: only {LIST} at the top counts" for one in lists]
        receipt_time = _receipt_time(receipt)
        time, source = (entry.time, entry.source) if entry else (None, "")
        stamp = self._stamp_of(path)
        if time is None and stamp is not None:
            if entry is None and not any(map(platform_name, path.relative_to(self.top).parts)):
                time, problem = _read_stamp(stamp)
                notes += [problem] if problem else []
                source = STAMP
            else:
                notes.append(f"{STAMP} is not trusted: the platform's download has none")
        is_late = entry.late if entry else None
        if time is None and is_late is not None:
            source = f"{LIST}: the platform's flag only"
        elif time is None:
            time, source = (receipt_time, RECEIPT_TIME) if receipt_time else (None, UNKNOWN)
        original_name = entry.handed_in_as if entry else ""
        return ReceiptTime(time, source, is_late, receipt_time, tuple(notes), original_name)

    @property
    def refused(self) -> Mapping[str, Entry]:
        """The files that `course collect` rejected, by path in the folder."""
        top = self.top.absolute()
        rows = {path: entry for path, entry in self.entries.items() if entry.refused and entry.exercise}
        return {
            path.relative_to(top).as_posix(): entry
            for path, entry in rows.items()
            if path.is_relative_to(top) and ".." not in path.parts
        }

    def _stamp_of(self, path: Path) -> Path | None:
        """Return the effective time stamp of a file: the outermost one at nbgrader's depth.

        Stamps further below may have been put there by a student.
        """
        folders = path.relative_to(self.top).parts[:-1]
        stamps = (
            self.top.joinpath(*folders[:depth], STAMP) for depth in STAMP_DEPTHS if depth <= len(folders)
        )
        return next((stamp for stamp in stamps if stamp.is_file()), None)


def _entries(path: Path, zone: ZoneInfo) -> dict[Path, Entry]:
    file = LmsFile.read(path)
    if missing := {"file", "received"} - set(file.headings):
        raise CourseError(f"{path} has no column {min(missing)!r}. Expected {EXAMPLES[LIST]}")
    places = {heading: file.headings.index(heading) for heading in COLUMNS if heading in file.headings}
    rows = [{key: file.text(row, place) for key, place in places.items()} for row in range(1, len(file.rows))]
    times = parse_times([row["received"] for row in rows], zone)
    entries = {}
    for number, (row, time) in enumerate(zip(rows, times, strict=True), 2):
        note = ""
        if row["received"] and time is None:
            note = f"{LIST}, row {number}: {row['received']!r} is not a time. Expected {EXAMPLES[LIST]}"
        source = f"{LIST} ({row['source']})" if row.get("source") else LIST
        is_late = {"yes": True, "no": False}.get(row.get("late", "").casefold())
        original_name = row.get("handed_in_as", "")
        about = (row.get("exercise", "").lstrip("'"), row.get("refused", "").lstrip("'"))
        entries[path.parent / row["file"]] = Entry(time, source, is_late, note, original_name, *about)
    return entries


def _read_stamp(path: Path) -> tuple[datetime | None, str]:
    """Return nbgrader's time stamp and "", or None and an error message."""
    try:
        if path.is_symlink():
            raise ValueError("it is a link")
        check_regular(path)
        with path.open("rb") as file:
            text = file.read(MAX_STAMP).decode().strip()
        match = re.fullmatch(r"(\S+ \S+) (\w+/\S+)", text)
        zone = ZoneInfo(match[2] if match else "UTC")
        (time,) = parse_times([match[1] if match else text.removesuffix(" UTC")], zone)
        if time is None:
            raise ValueError(f"{text!r} is not a time")
    except (OSError, ValueError, LookupError, OverflowError) as error:
        return None, f"{path.parent.name}/{path.name}: {error}. Expected {EXAMPLES[STAMP]}"
    return time, ""


def _receipt_time(receipt: Mapping[str, Any]) -> datetime | None:
    try:
        time = datetime.fromisoformat(receipt["time"])
        return time.astimezone(UTC) if time.tzinfo and time.year in YEARS else None
    except (KeyError, TypeError, ValueError, OverflowError):
        # A student can write anything into a receipt.
        return None
