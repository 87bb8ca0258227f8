"""The time of receipt of a submission, and its source."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

from course_lib.course.course_file import Late
from course_lib.errors import CourseError, counted
from course_lib.grading.handin.platform_files import YEARS, LmsFile, parse_times
from course_lib.grading.handin.sender import platform_name
from course_lib.grading.marks.marks import count_days_late

LIST = "received.csv"
ID_FROM = "id_from"  # whether the roster told the ID of the student
COLUMNS = ("file", "received", "late", "source", "name", "handed_in_as", ID_FROM)
TIMESTAMP = "timestamp.txt"  # nbgrader's
MAX_STAMP = 200  # [B]
UNKNOWN = "unknown"
RECEIPT_TIME = "receipt"
EXAMPLES = {
    LIST: "the columns file,received and rows like ada/week01_exercise.ipynb,2026-10-11T23:59:00+02:00",
    TIMESTAMP: "a line like 2026-10-11 23:59:00.000000 UTC",
}


@dataclass(frozen=True)
class Received:
    """The best known time of receipt.

    Args:
        time: In UTC; None if nothing tells it.
        source: Where it was written down: received.csv, timestamp.txt, receipt, or unknown.
        late: Whether the platform calls it late; None if it does not say.
        receipt: The time in the file of `course submit`, which the student's machine wrote.
        notes: Times that were there and could not be used.
        handed_in_as: The path that the platform's download had, or "".
    """

    time: datetime | None
    source: str
    late: bool | None = None
    receipt: datetime | None = None
    notes: tuple[str, ...] = ()
    handed_in_as: str = ""

    @property
    def is_trusted(self) -> bool:
        """True if the platform or the instructor wrote the time."""
        return self.time is not None and self.source != RECEIPT_TIME

    def days_late(self, deadline: datetime | None, policy: Late) -> int:
        """Return the started days after the deadline; 1 if the platform calls it late at no known time."""
        if deadline is None:
            return 0
        if self.time is None:
            return int(self.late is True)
        return count_days_late(self.time, deadline, policy)

    def remark(self, deadline: datetime | None, policy: Late) -> str:
        """Return what the gradebook says of a time that is not certain, or ""."""
        if deadline is None or self.is_trusted:
            return ""
        if self.time is not None:
            days = self.days_late(deadline, policy)
            return "late by the receipt alone, which the student's machine wrote" if days else ""
        if self.late is None:
            return "time of receipt unknown: not counted as late"
        return "late by the platform's word, time unknown: counted as 1 day" if self.late else (
            "time of receipt unknown: not late by the platform's word"
        )  # fmt: skip

    def contradictions(self, deadline: datetime | None, policy: Late) -> list[str]:
        """Return notes for staff where two sources disagree about lateness."""
        if deadline is None:
            return ["the platform calls it late, but course.toml has no deadline"] if self.late else []
        days = self.days_late(deadline, policy)
        notes = []
        if self.is_trusted and self.late is not None and self.late != (days > 0):
            said = "late" if self.late else "not late"
            notes.append(
                f"the platform calls it {said}, but by {self.source} it is {counted(days, 'day')} late"
            )
        if self.source != RECEIPT_TIME and self.receipt is not None:
            by_receipt = count_days_late(self.receipt, deadline, policy)
            if (by_receipt > 0) != (days > 0):
                notes.append(
                    f"by its receipt, which is not believed, it is {counted(by_receipt, 'day')} late"
                )
        return notes

    def as_plain(self) -> dict[str, Any]:
        """Return what a result file has of it."""
        return {
            "received": self.time and self.time.isoformat(),
            "received_from": self.source,
            "late": self.late,
            "receipt_time": self.receipt and self.receipt.isoformat(),
            "handed_in_as": self.handed_in_as,
        }

    @classmethod
    def from_plain(cls, content: Mapping[str, Any]) -> "Received":
        """Return the one of a result file."""
        time, receipt = (
            datetime.fromisoformat(text) if text else None
            for text in (content["received"], content.get("receipt_time"))
        )
        named = content.get("handed_in_as", "")
        return cls(time, content["received_from"], content.get("late"), receipt, handed_in_as=named)


@dataclass(frozen=True)
class Entry:
    """One row of received.csv."""

    time: datetime | None = None
    source: str = ""
    late: bool | None = None
    note: str = ""
    handed_in_as: str = ""


@dataclass(frozen=True)
class Ledger:
    """The instructor's received.csv, at the top of the submissions or beside their folder.

    Args:
        top: The folder of all submissions.
        zone: Of times that do not name theirs.
        entries: Its rows by file.
    """

    top: Path
    zone: ZoneInfo
    entries: Mapping[Path, Entry] = field(default_factory=dict)

    @classmethod
    def read(cls, top: Path, zone: ZoneInfo) -> "Ledger":
        """Read the list, if there is one.

        Raises:
            CourseError: It is not a table, or lacks a column.
        """
        entries: dict[Path, Entry] = {}
        for path in (top.absolute().parent / LIST, top.absolute() / LIST):
            if path.is_file():
                entries |= _entries(path, zone)
        return cls(top, zone, entries)

    def received(self, path: Path, receipt: Mapping[str, Any]) -> Received:
        """Return the best known time of a file.

        The list decides, then nbgrader's time stamp beside the file, then the platform's word in its name,
        then the receipt. What a student can write is not believed where the platform knows better.

        Args:
            path: The file that was handed in.
            receipt: What `course submit` wrote, or nothing.
        """
        entry = self.entries.get(path.absolute())
        notes = [entry.note] if entry and entry.note else []
        notes += self._not_believed(path)
        made = _receipt_time(receipt)
        time, source = (entry.time, entry.source) if entry else (None, "")
        stamp = path.with_name(TIMESTAMP)
        if time is None and stamp.is_file() and stamp.parent != self.top:
            if entry is None and not any(map(platform_name, path.relative_to(self.top).parts)):
                time, problem = _stamp(stamp)
                notes += [problem] if problem else []
                source = TIMESTAMP
            else:
                notes.append(f"{TIMESTAMP} is not believed: the platform's download has none")
        late = entry.late if entry else None
        if time is None and late is not None:
            source = f"{LIST}: the platform's word alone"
        elif time is None:
            time, source = (made, RECEIPT_TIME) if made else (None, UNKNOWN)
        named = entry.handed_in_as if entry else ""
        return Received(time, source, late, made, tuple(notes), named)

    def _not_believed(self, path: Path) -> list[str]:
        """Return notes on lists in folders that students fill."""
        inner = [folder for folder in path.parents if self.top in folder.parents]
        lists = [(folder / LIST).relative_to(self.top) for folder in inner if (folder / LIST).is_file()]
        return [f"{one.as_posix()} is not believed: only {LIST} at the top counts" for one in lists]


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
        late = {"yes": True, "no": False}.get(row.get("late", "").casefold())
        named = row.get("handed_in_as", "")
        entries[path.parent / row["file"]] = Entry(time, source, late, note, named)
    return entries


def _stamp(path: Path) -> tuple[datetime | None, str]:
    """Return nbgrader's time stamp, or None and what is wrong with it."""
    try:
        if path.is_symlink():
            raise ValueError("it is a link")
        with path.open("rb") as file:
            text = file.read(MAX_STAMP).decode().strip()
        named = re.fullmatch(r"(\S+ \S+) (\w+/\S+)", text)
        zone = ZoneInfo(named[2] if named else "UTC")
        (time,) = parse_times([named[1] if named else text.removesuffix(" UTC")], zone)
        if time is None:
            raise ValueError(f"{text!r} is not a time")
    except (OSError, ValueError, LookupError, OverflowError) as error:
        return None, f"{path.parent.name}/{path.name}: {error}. Expected {EXAMPLES[TIMESTAMP]}"
    return time, ""


def _receipt_time(receipt: Mapping[str, Any]) -> datetime | None:
    try:
        time = datetime.fromisoformat(receipt["time"])
        return time.astimezone(UTC) if time.tzinfo and time.year in YEARS else None
    except (KeyError, TypeError, ValueError, OverflowError):  # students can write anything into it
        return None
