"""`course collect`: what a learning platform gives, sorted into submissions."""

import csv
import errno
import io
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from zoneinfo import ZoneInfo

from course_lib.course.state import write_whole
from course_lib.errors import CourseError, counted
from course_lib.grading.handin.archives import Arrival, Arrivals
from course_lib.grading.handin.ids import PLATFORM, ROSTER
from course_lib.grading.handin.received import COLUMNS, ID_FROM, LIST, TIMESTAMP
from course_lib.grading.handin.roster import Times, read_ids, read_times
from course_lib.grading.handin.sender import NBGRADERS, Sender, platform_name, sender_of
from course_lib.grading.reports.table import harmless, printable

KEPT = (".ipynb", ".zip", ".rviz", ".yaml", ".yml", ".py")
BAD_PATHS = (errno.ENOTDIR, errno.EISDIR, errno.EEXIST, errno.ENAMETOOLONG, errno.EINVAL, errno.EILSEQ)
LATE = {True: "yes", False: "no", None: ""}
NO_TIMES = {
    "moodle": "Moodle's zip has no times of submission: add --roster WORKSHEET.csv, the assignment's grading "
    "worksheet",
    "canvas": "Canvas's zip has no times of submission, only LATE: add --times SUBMISSIONS.json, the API's "
    "list of the assignment's submissions",
    "anonymous": "Canvas hid the students (anon_…), so no mark finds its way back: turn off anonymous "
    "grading and download again, or add --times SUBMISSIONS.json, with user_id and anonymous_id",
}


@dataclass
class Collection:
    """The result of collecting: what was kept, refused, or needs a look, a line each."""

    count: int = 0
    students: set[str] = field(default_factory=set)
    refused: list[str] = field(default_factory=list)
    notes: set[str] = field(default_factory=set)
    rows: dict[str, dict[str, str]] = field(default_factory=dict)  # of received.csv, by file

    def refuse(self, name: str, why: str) -> None:
        """Note one that is left out."""
        self.refused.append(printable(f"refused: {name}: {why}"))

    def summary(self, out: Path) -> str:
        """Return how much there is, and what to type next."""
        late = sum(row.get("late") == "yes" for row in self.rows.values())
        said = f", {late} late by the platform's word" if late else ""
        said += f", {len(self.refused)} refused" if self.refused else ""
        files, students = counted(self.count, "file"), counted(len(self.students), "student")
        return f"Collected {files} of {students} into {out}{said}. Next: course grade {out} --out graded"


@dataclass(frozen=True)
class Exports:
    """Additions of the platform's exports to its download: IDs by its numbers, and times."""

    ids: Mapping[str, str] = field(default_factory=dict)
    times: Sequence[Times] = ()

    def time(self, sender: Sender) -> tuple[datetime | None, str]:
        """Return when a file was submitted, and which export says so."""
        named = sender.named
        known = [(t.of(named.number, named.attachment), t.source) for t in self.times] if named else []
        return next((pair for pair in known if pair[0]), (None, ""))


def collect(
    source: Path,
    out: Path,
    zone: ZoneInfo,
    roster: Path | None = None,
    id_column: str = "",
    times: Sequence[Path] = (),
) -> Collection:
    """Sort a folder or zip into OUT/STUDENT/, with the platform's times in OUT/received.csv.

    Args:
        source: The platform's download: Moodle's or Canvas's names, or a folder per student.
        out: Files already there stay; one of the same name and other content is put beside it.
        zone: Of the times in the platform's exports.
        roster: The platform's CSV, which has each student's ID beside the platform's number, and perhaps
            the times of submission.
        id_column: The heading of the ID in it; "" to find the column.
        times: More files with times of submission: CSV, or the JSON of Canvas's API.

    Raises:
        CourseError: A file can't be read, `out` lies in `source`, or nothing is in it.
    """
    if out.resolve().is_relative_to(source.resolve()):
        raise CourseError(f"{out} lies in {source}. Name a folder elsewhere: --out DIR")
    done = Collection(rows=_rows(out / LIST))
    exports = _exports(source, zone, roster, id_column, times, done)
    for arrival in Arrivals(done.refuse, _owner).read(source):
        _keep_or_refuse(arrival, out, zone, done, exports)
    if not done.count and not done.refused:
        raise CourseError(f"{source} holds no file. Name what the platform gave.")
    write_list(out / LIST, done.rows.values())
    return done


def _keep_or_refuse(arrival: Arrival, out: Path, zone: ZoneInfo, done: Collection, exports: Exports) -> None:
    try:
        sender = sender_of(arrival.parts, exports.ids)
        _keep(arrival, sender, out, zone, done, exports)
    except CourseError as error:
        done.refuse("/".join(arrival.parts), str(error))
    except OSError as error:
        if error.errno not in BAD_PATHS:
            raise
        done.refuse("/".join(arrival.parts), f"can't be kept: {error.strerror}")
    else:
        done.notes |= set(_notes(sender, exports))


def _exports(
    source: Path, zone: ZoneInfo, roster: Path | None, id_column: str, times: Sequence[Path], done: Collection
) -> Exports:
    """Read the platform's exports; their columns are found by the numbers in the download."""
    if roster is None and not times:
        return Exports()
    arrived = Arrivals(lambda name, why: None, _owner).read(source)
    named = {sender.named for sender in _senders(arrived) if sender.named}
    numbers = {name.number for name in named}
    if not numbers:
        done.notes.add("note: the download's names have no numbers of a platform: its exports are not used")
        return Exports()
    read = [found for path in times if (found := read_times(path, zone, numbers))]
    ids = {hidden: user for found in read for hidden, user in found.users.items() if hidden in numbers}
    if roster is not None:
        shown = {ids.get(number, number) for number in numbers}
        by_number, heading = read_ids(roster, id_column, shown)
        ids = {**by_number, **{hidden: by_number.get(user, user) for hidden, user in ids.items()}}
        read += [found] if (found := read_times(roster, zone, shown)) else []
        done.notes.add(f"note: students are named by the column {heading!r} of {roster.name}")
    done.notes |= {_time_note(one, zone) for one in read}
    return Exports(ids, [one for one in read if not one.unread])


def _time_note(times: Times, zone: ZoneInfo) -> str:
    if not times.unread:
        return f"note: times are those of {times.source}, read as {zone.key}"
    return printable(
        f"note: {times.source}: times like {times.unread!r} can't be read, and are not used. Set the site to "
        f"another language or calendar and export again, or write the times into {LIST}"
    )


def _senders(arrived: Iterator[Arrival]) -> Iterator[Sender]:
    for arrival in arrived:
        try:
            yield sender_of(arrival.parts, {})
        except CourseError:  # it is refused when it is collected
            continue


def _owner(parts: tuple[str, ...]) -> str:
    """Return whose archives share a limit: a student, else the outermost file or folder."""
    first = parts[1] if parts[0] in NBGRADERS and len(parts) > 1 else parts[0]
    named = platform_name(first)
    return f"{named.name} ({named.number})" if named else first


def _notes(sender: Sender, exports: Exports) -> Iterator[str]:
    """Yield what an instructor should know of a file's names and times."""
    named = sender.named
    if named is None:
        return
    if exports.ids and named.number not in exports.ids:
        yield printable(f"note: {named.name} is not in the roster, and is named {sender.student}")
    if named.platform == "anonymous" and named.number not in exports.ids:
        yield f"note: {NO_TIMES['anonymous']}"
    elif not exports.times:
        yield f"note: {NO_TIMES[named.platform]}; or write them into {LIST}. Without a time nobody is late"
    elif exports.time(sender)[0] is None:
        yield printable(f"note: {named.name} has no time of submission in {exports.times[0].source}")


def _keep(
    arrival: Arrival, sender: Sender, out: Path, zone: ZoneInfo, done: Collection, exports: Exports
) -> None:
    name = sender.path.name
    in_archive = any(part.lower().endswith(".zip") for part in arrival.parts)  # where students write times
    is_stamp = name == TIMESTAMP and not sender.named and not in_archive
    if sender.path.suffix.lower() not in KEPT and not is_stamp:
        raise CourseError(f"it is none of {', '.join(KEPT)}")
    path = _place(out / sender.path, arrival.data)
    write_whole(path, arrival.data)
    seconds = arrival.time.timestamp()
    os.utime(path, (seconds, seconds))
    if sender.named:
        file = path.relative_to(out).as_posix()
        row = _row(arrival, sender, zone, exports)
        done.rows[file] = {"file": file, **_corrected(row, done.rows.get(file, {}), done)}
    done.count += not is_stamp
    done.students.add(sender.student)


def _row(arrival: Arrival, sender: Sender, zone: ZoneInfo, exports: Exports) -> dict[str, str]:
    """Return what received.csv has of a file that a platform named."""
    assert sender.named is not None
    time, source = exports.time(sender)
    return {
        "received": time.astimezone(zone).isoformat() if time else "",
        "late": LATE[sender.named.late],
        "source": harmless(source),
        "name": harmless(sender.named.name),
        "handed_in_as": harmless("/".join(arrival.parts)),
        ID_FROM: ROSTER if sender.named.number in exports.ids else PLATFORM,
    }


def _corrected(row: dict[str, str], before: Mapping[str, str], done: Collection) -> dict[str, str]:
    """Return a row with the time that the list had: the instructor may have corrected it."""
    if not before.get("received"):
        return row
    if row["received"] not in ("", before["received"]):
        done.notes.add(
            printable(
                f"note: {before['file']}: {LIST} keeps {before['received']}; by {row['source']} it is "
                f"{row['received']}: clear the cell and collect again to take that"
            )
        )
    return {**row, "received": before["received"], "source": before.get("source", "")}


def _place(path: Path, data: bytes) -> Path:
    """Return where to put a file: beside those of its name that have another content."""
    number, place = 1, path
    while place.exists() and place.read_bytes() != data:
        number += 1
        place = path.with_stem(f"{path.stem}-{number}")
    return place


def _rows(path: Path) -> dict[str, dict[str, str]]:
    if not path.is_file():
        return {}
    with path.open(newline="", encoding="utf-8-sig") as file:
        return {row["file"]: row for row in csv.DictReader(file)}


def write_list(path: Path, rows: Iterable[Mapping[str, str]]) -> None:
    """Write received.csv."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS, restval="", extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_whole(path, text.getvalue().encode("utf-8", "replace"))


@dataclass(frozen=True)
class PlatformTime:
    """The platform's word on one student's files.

    Args:
        time: As the platform writes it, or "".
        source: Of the time.
        named: Whether a roster names the student.
    """

    time: str
    source: str
    named: bool


def write_receipts(top: Path, receipts: Mapping[str, PlatformTime]) -> None:
    """Write TOP/received.csv with a row for each file in the students' folders."""
    rows = list[dict[str, str]]()
    for student, receipt in receipts.items():
        known = {"received": harmless(receipt.time), "source": receipt.source}
        known[ID_FROM] = ROSTER if receipt.named else PLATFORM
        for path in sorted(path for path in (top / student).rglob("*") if path.is_file()):
            rows.append({"file": path.relative_to(top).as_posix(), **known})
    write_list(top / LIST, rows)
