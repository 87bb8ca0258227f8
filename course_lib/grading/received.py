"""When a submission was received, and how that is known."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

from course_lib.errors import CourseError

LIST = "received.csv"
TIMESTAMP = "timestamp.txt"  # nbgrader's
YEARS = range(2000, 2100)  # at the ends of time there is no changing of the zone
EXAMPLES = {
    LIST: "the columns file,received and rows like week01/a.ipynb,2026-10-11T23:59:00+02:00",
    TIMESTAMP: "a line like 2026-10-11 23:59:00.000000 UTC",
}


@dataclass(frozen=True)
class Received:
    """A time in UTC, and where it was written down."""

    time: datetime
    source: str


def received(path: Path, top: Path, receipt: Mapping[str, Any]) -> Received:
    """The best known time: received.csv or timestamp.txt beside the file, else the receipt, else the file's.

    Args:
        path: The file that was handed in.
        top: The folder of all submissions: lists are looked for up to here.
        receipt: What `course submit` wrote, or nothing.

    Raises:
        CourseError: A list or a time stamp can't be read; names it.
    """
    folders = [folder for folder in path.parents if folder == top or top in folder.parents]
    for known in [*(folder / LIST for folder in folders), path.with_name(TIMESTAMP)]:
        try:
            time = (_listed if known.name == LIST else _stamp)(known, path) if known.is_file() else None
        except (KeyError, TypeError, ValueError, OverflowError, OSError) as error:
            raise CourseError(f"{known}: {error}. Expected {EXAMPLES[known.name]}") from error
        if time is not None:
            return Received(time, known.name)
    try:
        return Received(_in_utc(receipt["time"]), "receipt")
    except (KeyError, TypeError, ValueError, OverflowError):  # students can write anything into it
        return Received(datetime.fromtimestamp(path.stat().st_mtime, UTC), "file time")


def _listed(path: Path, file: Path) -> datetime | None:
    with path.open(newline="", encoding="utf-8-sig") as rows:
        known = (row for row in csv.DictReader(rows) if path.parent / row["file"] == file)
        times = (row["received"] for row in known if row["received"])
        return next(map(_in_utc, times), None)


def _stamp(path: Path, _: Path) -> datetime:
    time, zone = path.read_text(encoding="utf-8").strip().rsplit(" ", 1)
    return datetime.fromisoformat(time).replace(tzinfo=ZoneInfo(zone)).astimezone(UTC)


def _in_utc(text: str) -> datetime:
    time = datetime.fromisoformat(text)
    if time.tzinfo is None:
        raise ValueError(f"{text} says no time zone")
    if time.year not in YEARS:
        raise ValueError(f"{text} is in no year of a course")
    return time.astimezone(UTC)
