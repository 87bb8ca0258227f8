"""Downloads as Moodle and Canvas write them: members have the time of the download, exports the real one."""

import csv
import io
import json
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

DOWNLOAD = (2026, 3, 11, 9, 0, 0)  # two days after the deadline
NAME = "week01_exercise.ipynb"
Files = Mapping[str, bytes] | Mapping[str | zipfile.ZipInfo, bytes]


@dataclass(frozen=True)
class Handed:
    """One student's files, and their time on the platform."""

    name: str
    number: int
    id: str
    time: str = ""
    files: Mapping[str, bytes] = field(default_factory=dict)
    late: bool = False


def notebook(code: str = "x = 1", **course: str) -> bytes:
    """Return an exercise with one cell."""
    cells = [{"cell_type": "code", "source": code}]
    return json.dumps({"nbformat": 4, "cells": cells, "metadata": {"course": course}}).encode()


def zipped(files: Files, time: tuple[int, ...] = DOWNLOAD) -> bytes:
    """Return an archive whose members all have one time, except members that are given as a ZipInfo."""
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            info = zipfile.ZipInfo(name, tuple(time)) if isinstance(name, str) else name  # type: ignore[arg-type]
            archive.writestr(info, content, zipfile.ZIP_DEFLATED)
    return data.getvalue()


def packed(code: str, student: str, time: str = "2026-03-01T00:00:00+00:00") -> bytes:
    """Return a file as `course submit` writes it."""
    receipt = {"exercise": "week01_exercise", "student": student, "time": time}
    return zipped({"receipt.json": json.dumps(receipt).encode(), NAME: notebook(code, student=student)})


def moodle_zip(path: Path, students: Iterable[Handed]) -> None:
    """Write the zip of Moodle's "Download all submissions"."""
    files = {
        f"{one.name}_{one.number}_assignsubmission_file_/{name}": data
        for one in students
        for name, data in (one.files or {NAME: notebook(f"x = {one.number}")}).items()
    }
    path.write_bytes(zipped(files))


def canvas_zip(path: Path, students: Iterable[Handed]) -> None:
    """Write the zip of Canvas's "Download submissions"."""
    files = {}
    for one in students:
        for place, (name, data) in enumerate((one.files or {NAME: notebook(f"x = {one.number}")}).items()):
            late = "_LATE" if one.late else ""
            files[f"{one.name}{late}_{one.number}_{one.number}0{place}_{name}"] = data
    path.write_bytes(zipped(files))


def table(path: Path, headings: Sequence[str], rows: Iterable[Sequence[Any]], delimiter: str = ",") -> None:
    """Write a platform's CSV, with the mark of its encoding as Moodle does."""
    with path.open("w", newline="", encoding="utf-8-sig") as file:
        writer = csv.writer(file, delimiter=delimiter, quoting=csv.QUOTE_ALL)
        writer.writerows([headings, *rows])


def canvas_json(path: Path, students: Iterable[Handed]) -> None:
    """Write the list of an assignment's submissions in the format of Canvas's API."""
    entries = [
        {
            "user_id": one.number,
            "submitted_at": datetime.fromisoformat(one.time).isoformat() if one.time else None,
            "graded_at": "2026-03-20T08:00:00Z",
            "late": one.late,
            "attachments": [{"id": int(f"{one.number}00"), "filename": NAME}],
        }
        for one in students
    ]
    path.write_text(json.dumps(entries))
