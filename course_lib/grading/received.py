"""When a submission was received, and how that is known."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo

from course_lib.errors import CourseError

LIST = "received.csv"  # columns: file (from the list's folder), received (ISO 8601 with an offset)
TIMESTAMP = "timestamp.txt"  # nbgrader's: "2026-10-11 15:58:23.948203 UTC"


@dataclass(frozen=True)
class Received:
    """A time with its time zone, and where it was written down."""

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
    for folder in path.parents:
        listed = _listed(folder / LIST, path)
        if listed is not None:
            return Received(listed, LIST)
        if folder == top:
            break
    stamp = path.with_name(TIMESTAMP)
    if stamp.is_file():
        return Received(_stamp(stamp), TIMESTAMP)
    try:
        return Received(_aware(datetime.fromisoformat(receipt["time"])), "receipt")
    except (KeyError, TypeError, ValueError):
        return Received(datetime.fromtimestamp(path.stat().st_mtime, UTC), "file time")


def _listed(path: Path, file: Path) -> datetime | None:
    if not path.is_file():
        return None
    try:
        with path.open(newline="", encoding="utf-8-sig") as rows:
            for row in csv.DictReader(rows):
                if path.parent / row["file"] == file:
                    return _aware(datetime.fromisoformat(row["received"]))
    except (KeyError, TypeError, ValueError, OSError) as error:
        example = "week01/a.ipynb,2026-10-11T23:59:00+02:00"
        raise CourseError(
            f"{path}: {error}. Expected columns file,received and rows like {example}"
        ) from error
    return None


def _stamp(path: Path) -> datetime:
    try:
        time, zone = path.read_text(encoding="utf-8").strip().rsplit(" ", 1)
        return datetime.fromisoformat(time).replace(tzinfo=ZoneInfo(zone))
    except (ValueError, KeyError, OSError) as error:
        raise CourseError(f"{path}: {error}. Expected a line like 2026-10-11 23:59:00.000000 UTC") from error


def _aware(time: datetime) -> datetime:
    if time.tzinfo is None:
        raise ValueError(f"{time.isoformat()} says no time zone")
    return time
