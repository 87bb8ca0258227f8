"""`course collect`: what a learning platform gives, sorted into submissions."""

import csv
import io
import os
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from zoneinfo import ZoneInfo

from course_lib.course.identity import normalise
from course_lib.course.whole_file import write_whole
from course_lib.errors import CourseError, counted
from course_lib.grading.arrivals import Arrival, arrivals
from course_lib.grading.gradebook import harmless
from course_lib.grading.ids import ID_FROM, PLATFORM, ROSTER
from course_lib.grading.lms_file import LmsFile
from course_lib.grading.received import LIST, TIMESTAMP
from course_lib.grading.table import printable

KEPT = (".ipynb", ".zip", ".rviz", ".yaml", ".yml", ".py")
COLUMNS = ("file", "received", "late", "name", "handed_in_as", ID_FROM)
NBGRADERS = "submitted"  # its folder around the students'
NUMBERS = {"ID": "{}", "Identifier": "Participant {}"}  # a platform's column of its number of a student
# How platforms name what was handed in. Moodle keeps times, Canvas only says what it takes for late.
MOODLE = re.compile(r"(?P<name>.+)_(?P<number>\d+)_assignsubmission_file_?(?P<file>.*)")
CANVAS = re.compile(r"(?P<name>[^_]+)_(?P<late>LATE_)?(?P<number>\d+)_\d+_(?P<file>.+)")


@dataclass
class Collection:
    """What was collected, and what was refused or is to be looked at: a line each."""

    count: int = 0
    students: set[str] = field(default_factory=set)
    refused: list[str] = field(default_factory=list)
    notes: set[str] = field(default_factory=set)
    rows: dict[str, dict[str, str]] = field(default_factory=dict)  # of received.csv, by file

    def refuse(self, name: str, why: str) -> None:
        """Note one that is left out."""
        self.refused.append(printable(f"refused: {name}: {why}"))

    def summary(self, out: Path) -> str:
        """Say how much there is, and what to type next."""
        late = sum(row.get("late") == "yes" for row in self.rows.values())
        said = f", {late} late by the platform's word" if late else ""
        said += f", {len(self.refused)} refused" if self.refused else ""
        files, students = counted(self.count, "file"), counted(len(self.students), "student")
        return f"Collected {files} of {students} into {out}{said}. Next: course grade {out} --out graded"


@dataclass(frozen=True)
class Sender:
    """What a path says: where the file goes, whose it is, and what the platform knows of it."""

    student: str
    path: Path
    row: Mapping[str, str] = field(default_factory=dict)


def collect(
    source: Path, out: Path, zone: ZoneInfo, roster: Path | None = None, id_column: str = ""
) -> Collection:
    """Sort a folder or zip into OUT/STUDENT/, with what the platform knows of times in OUT/received.csv.

    Args:
        source: As the platform gave it: Moodle's or Canvas's names, or a folder per student.
        out: Files already there stay; one of the same name and other content is put beside it.
        zone: Of the times in a zip.
        roster: The platform's CSV, which has each student's ID beside the platform's number.
        id_column: The heading of the ID in it.

    Raises:
        CourseError: `source` or `roster` can't be read, `out` lies in `source`, or nothing is in it.
    """
    if out.resolve().is_relative_to(source.resolve()):
        raise CourseError(f"{out} lies in {source}. Name a folder elsewhere: --out DIR")
    ids = _ids(LmsFile.read(roster), id_column) if roster else {}
    done = Collection(rows=_rows(out / LIST))
    for arrival in arrivals(source, done.refuse):
        try:
            sender = _sender(arrival, zone, ids)
            _keep(arrival, sender, out, zone, done)
        except CourseError as error:
            done.refuse("/".join(arrival.parts), str(error))
        else:
            done.notes |= set(_notes(sender, ids))
    if not done.count and not done.refused:
        raise CourseError(f"{source} holds no file. Name what the platform gave.")
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS, restval="", extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(done.rows.values())
    write_whole(out / LIST, text.getvalue().encode("utf-8", "replace"))
    return done


def _sender(arrival: Arrival, zone: ZoneInfo, ids: Mapping[str, str]) -> Sender:
    """Who handed a file in: the outermost part of its path that says so."""
    parts = arrival.parts[1:] if arrival.parts[0] == NBGRADERS else arrival.parts
    for place, part in enumerate(parts):
        is_last = place == len(parts) - 1
        if match := MOODLE.fullmatch(part) or CANVAS.fullmatch(part):
            student = ids.get(match["number"], "") or normalise(_default(match))
            row = {"name": match["name"], "late": "yes" if match.groupdict().get("late") else ""}
            row[ID_FROM] = ROSTER if match["number"] in ids else PLATFORM
            if match.re is MOODLE:
                row["received"] = _in(zone, arrival.time).isoformat()
            return Sender(student, Path(student, (match["file"] or part) if is_last else parts[-1]), row)
        if is_last:
            return Sender(part, Path(part))  # the file says who
        if not part.lower().endswith(".zip"):
            student = normalise(part)
            inner = any(name.lower().endswith(".zip") for name in parts[place + 1 : -1])
            return Sender(student, Path(student, *(parts[-1:] if inner else parts[place + 1 :])))
    raise AssertionError("a path has a last part")


def _notes(sender: Sender, ids: Mapping[str, str]) -> Iterator[str]:
    """What an instructor should know of it."""
    if sender.row and ids and sender.student not in ids.values():
        yield printable(f"note: {sender.row['name']} is not in the roster, and is named {sender.student}")
    if sender.row and "received" not in sender.row and sender.path.suffix.lower() != ".zip":
        yield f"note: Canvas tells no times; where there is no receipt, the download's counts: see {LIST}"


def _keep(arrival: Arrival, sender: Sender, out: Path, zone: ZoneInfo, done: Collection) -> None:
    name = sender.path.name
    in_archive = any(part.lower().endswith(".zip") for part in arrival.parts)  # where students write times
    is_stamp = name == TIMESTAMP and not sender.row and not in_archive
    if sender.path.suffix.lower() not in KEPT and not is_stamp:
        raise CourseError(f"it is none of {', '.join(KEPT)}")
    path = _place(out / sender.path, arrival.data)
    write_whole(path, arrival.data)
    time = _in(zone, arrival.time).timestamp()
    os.utime(path, (time, time))
    if sender.row:
        file = path.relative_to(out).as_posix()
        known = {"handed_in_as": "/".join(arrival.parts), **sender.row}
        done.rows[file] = {"file": file, **{key: harmless(value) for key, value in known.items()}}
    done.count += not is_stamp
    done.students.add(sender.student)


def _place(path: Path, data: bytes) -> Path:
    """Where to put a file: beside those of its name that have another content."""
    number, place = 1, path
    while place.exists() and place.read_bytes() != data:
        number += 1
        place = path.with_stem(f"{path.stem}-{number}")
    return place


def _in(zone: ZoneInfo, time: datetime) -> datetime:
    return time.astimezone(zone) if time.tzinfo else time.replace(tzinfo=zone)


def _default(match: re.Match[str]) -> str:
    """The platform's number as its CSV has it, so that marks find the way back."""
    return f"{'participant' if match.re is MOODLE else ''}{match['number']}"


def _ids(file: LmsFile, id_column: str) -> dict[str, str]:
    """Each student's ID by the platform's number."""
    known = next((heading for heading in NUMBERS if heading in file.headings), None)
    if known is None:
        raise CourseError(f"the roster has no column {' or '.join(NUMBERS)}, but {', '.join(file.headings)}")
    number, student = file.headings.index(known), file.column(id_column)
    cells = [(file.text(row, number), file.text(row, student)) for row in range(1, len(file.rows))]
    rows = [(number, normalise(id_)) for number, id_ in cells if number and id_]
    for heading, column in ((known, [row[0] for row in rows]), (id_column, [row[1] for row in rows])):
        if twice := next((one for one, count in Counter(column).items() if count > 1), ""):
            raise CourseError(
                f"the roster has {twice!r} twice in {heading!r}: name the IDs' with --id-column"
            )
    return {number.removeprefix(NUMBERS[known].format("")): id_ for number, id_ in rows}


def _rows(path: Path) -> dict[str, dict[str, str]]:
    if not path.is_file():
        return {}
    with path.open(newline="", encoding="utf-8-sig") as file:
        return {row["file"]: row for row in csv.DictReader(file)}
