"""`course collect`: sort a learning platform's download into submissions.

The download is read twice. The first pass stores nothing: it determines the owner and the exercise
of each file, and rejects unsafe files. Files are written only after that is settled for the whole
download: `choice.py` determines which files count.
"""

import csv
import errno
import io
import os
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from zoneinfo import ZoneInfo

from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically
from course_lib.grading.reports.rendering import escape_formula, join_few, replace_controls
from course_lib.grading.submissions import readers
from course_lib.grading.submissions.archives import (
    ReceivedFile,
    ReceivedFileReader,
    empty_folders,
    list_paths,
)
from course_lib.grading.submissions.choice import (
    Choice,
    DownloadedFile,
    RejectedFile,
    choose,
    exercise_option,
    inspect_file,
)
from course_lib.grading.submissions.notebook import find_exercise_name, is_notebook_name
from course_lib.grading.submissions.roster import Times, has_key, read_ids, read_times
from course_lib.grading.submissions.submission import (
    COLUMNS,
    ID_FROM,
    LIST,
    OLD_COLUMNS,
    PLATFORM,
    ROSTER,
    UNFINISHED,
)

# Errors of a path that the file system does not accept.
BAD_PATHS = (
    errno.ENOTDIR,
    errno.EISDIR,
    errno.EEXIST,
    errno.ENAMETOOLONG,
    errno.EINVAL,
    errno.EILSEQ,
)
NO_SUCH_CHARACTERS = (
    "names of files on this system lack its characters. Set LC_ALL=C.UTF-8, and collect again"
)
LATE_TEXTS = {True: "yes", False: "no", None: ""}
MOST_LINES = 10  # limit on the rejected files of an owner that are listed
MAX_NAME = 100  # limit on the characters of a rejected file's name in received.csv
STAMP_DEPTH = 2  # depth of nbgrader's stamp in a student's folder: ASSIGNMENT/timestamp.txt


@dataclass
class Collection:
    """The result of collecting a download: kept and rejected files, and notes, a line each.

    Args:
        count: Number of files that were kept.
        students: Students with kept files.
        skipped: The owner of each file that was skipped, and a line.
        notes: Notes for the instructor.
        set_aside: A line for each file that does not count for this exercise.
        rows: Rows of received.csv, by file.
        late: Number of files that the platform marks as late.
        rejected_students: Students none of whose files was kept.
    """

    count: int = 0
    students: set[str] = field(default_factory=set)
    skipped: list[tuple[str, str]] = field(default_factory=list)
    notes: set[str] = field(default_factory=set)
    set_aside: list[str] = field(default_factory=list)
    rows: dict[str, dict[str, str]] = field(default_factory=dict)
    late: int = 0
    rejected_students: set[str] = field(default_factory=set)

    def reject(self, name: str, why: str, owner: str) -> None:
        """Record a file that is skipped."""
        self.skipped.append((owner, replace_controls(f"rejected: {name}: {why}")))

    @property
    def rejected_lines(self) -> list[str]:
        """A line for each skipped file. Beyond a limit, one line counts an owner's further files.

        The archive of one student may have a thousand files, which would hide those of the others.
        """
        lines_by_owner = defaultdict[str, list[str]](list)
        for owner, line in self.skipped:
            lines_by_owner[owner].append(line)
        listed = list[str]()
        for owner, lines in lines_by_owner.items():
            listed += lines[:MOST_LINES]
            if (more := len(lines) - MOST_LINES) > 0:
                listed.append(replace_controls(f"rejected: {format_count(more, 'more file')} of {owner}"))
        return listed

    def summary(self, out: Path) -> str:
        """Return a summary, and the next command to type."""
        details = f", {self.late} late according to the platform" if self.late else ""
        details += f", {format_count(len(self.skipped), 'file')} rejected" if self.skipped else ""
        aside_count = sum(not line.startswith("ignored:") for line in self.set_aside)
        details += f", {aside_count} set aside" if aside_count else ""
        if self.rejected_students:
            students = format_count(len(self.rejected_students), "student")
            details += f", {students} rejected (the gradebook has the reason)"
        files, students = format_count(self.count, "file"), format_count(len(self.students), "student")
        return f"Collected {files} of {students} into {out}{details}. Next: course grade {out} --out graded"


@dataclass(frozen=True)
class Exports:
    """Data from the platform's exports: IDs by the platform's keys, and times of submission."""

    ids: Mapping[str, str] = field(default_factory=dict)
    times: Sequence[Times] = ()

    def id_of(self, download_name: readers.DownloadName) -> str:
        """Return the student's ID in the roster, or ""."""
        return next((self.ids[key] for key in download_name.keys if key in self.ids), "")

    def student(self, download_name: readers.DownloadName) -> str:
        """Return the student's ID in the roster, else the one in the name of the file."""
        return self.id_of(download_name) or download_name.student

    def time(self, download_name: readers.DownloadName) -> tuple[datetime | None, str]:
        """Return the time of submission and its source: the export or platform."""
        keys = (download_name.key, *download_name.keys)
        known_times = (
            (table.by_attachment.get(download_name.attachment) or table.by_number.get(key), table.source)
            for table in self.times
            for key in keys
        )
        return next(
            (pair for pair in known_times if pair[0]),
            (download_name.time, download_name.layout if download_name.time else ""),
        )


@dataclass(frozen=True)
class Download:
    """A platform's download: its path, its layout, and whether one folder contains all others."""

    source: Path
    layout: readers.Layout
    is_wrapped: bool = False

    def owner(self, path: tuple[str, ...]) -> str:
        """Return a name for the owner of a file. All archives of one owner share a limit.

        If all folders are in a single one, each of them may belong to a student.
        """
        if self.is_wrapped and len(path) > 2 and not readers.is_zip(path[1]):
            return "/".join(path[:2])
        return self.layout.owner(path)

    def read_files(
        self, done: Collection | None = None, rejected_files: list[tuple[str, str]] | None = None
    ) -> Iterator[ReceivedFile]:
        """Yield the files, including files in archives; record and skip unsafe files."""

        def reject(name: str, why: str) -> None:
            if done is not None:
                done.reject(name, why, self.owner(tuple(name.split("/"))))
            if rejected_files is not None:
                rejected_files.append((name, why))

        return ReceivedFileReader(reject, self.owner, lambda parts: not self.layout.is_extra(parts)).read(
            self.source
        )


def collect(
    source: Path,
    out: Path,
    zone: ZoneInfo,
    roster: Path | None = None,
    id_column: str = "",
    times: Sequence[Path] = (),
    *,
    exercise: str = "",
    layout: str = "",
) -> Collection:
    """Sort a folder or zip file into OUT/STUDENT/, with the platform's times in OUT/received.csv.

    Args:
        source: The platform's download, or a folder per student.
        out: The output folder. Existing files are kept; a file with the same name and other content
            gets a number.
        zone: The zone of times in the platform's exports.
        roster: The platform's CSV with each student's ID next to the platform's number or name, and
            perhaps the times of submission.
        id_column: The heading of the ID column; "" to find the column.
        times: Further files with times of submission: CSV, or the JSON of Canvas's API.
        exercise: The exercise that counts; "" to determine it, "*" for every exercise that a
            student has worked on.
        layout: The layout of the download; "" to determine it.

    Raises:
        CourseError: A file can't be read, `out` is inside `source`, there are no files, or the
            owners or the exercise can't be determined.
    """
    exercise = exercise_option(exercise)
    if out.resolve().is_relative_to(source.resolve()):
        raise CourseError(f"{out} is inside {source}. Choose another folder: --out DIR")
    collection = Collection(rows=_read_rows(out / LIST))
    download = _download(source, zone, layout)
    exports = _read_exports(download, zone, roster, id_column, times, collection)
    items, rejected_files = _inspect_all(download, collection)
    if not items and not collection.skipped:
        raise CourseError(f"{source} contains no files. Pass the platform's download.")
    if source.is_dir() and (empty := empty_folders(source)):
        collection.notes.add(f"note: folders without files: {join_few(empty)}")
    names = [*(item.download_name for item in items), *(file.download_name for file in rejected_files)]
    _reject_collisions(names, exports)
    choice = choose(items, rejected_files, download.layout, exercise)
    collection.set_aside = [replace_controls(line) for line in choice.lines]
    # The file remains if this process is killed or the disk is full, and `course grade` reports it.
    write_atomically(out / UNFINISHED, source.name.encode("utf-8", "replace"))
    store = Store(out, zone, exports, collection)
    store.store_all(download, choice)
    store.list_rejected(choice)
    write_list(out / LIST, collection.rows.values())
    (out / UNFINISHED).unlink(missing_ok=True)
    return collection


def _download(source: Path, zone: ZoneInfo, layout: str) -> Download:
    """Determine the layout of a download from its file names, and read the platform's list of owners."""
    paths = list_paths(source)
    if source.is_dir() and len(paths) == 1 and len(paths[0]) == 1 and readers.is_zip(paths[0][0]):
        inner = source / paths[0][0]
        # A zip file that is alone in a folder is a platform's download, or a student's submission.
        with suppress(CourseError):
            inner_paths = list_paths(inner) if not layout else []
            if inner_paths and readers.choose_layout(inner_paths, inner.name, zone).name != readers.FOLDERS:
                source, paths = inner, inner_paths
    if not paths:
        return Download(source, readers.Layout(readers.FOLDERS, zone))
    download_layout = readers.choose_layout(paths, source.name, zone, layout)
    if download_layout.name == "blackboard":
        download_layout = readers.add_blackboard_title(download_layout, paths)
    if download_layout.name == readers.GRADESCOPE:
        metadata_files = [
            *_read_extras(
                source, lambda path: download_layout.is_extra(path) and path[-1] == readers.METADATA
            )
        ]
        if not metadata_files:
            raise CourseError(
                f"{source} has Gradescope's folders, but not {readers.METADATA}, which has the "
                "students. Pass the whole export: Export Submissions"
            )
        download_layout = replace(
            download_layout, records=readers.gradescope_records(metadata_files[0].data, zone)
        )
    if download_layout.name == readers.SAKAI:
        stamps = _read_extras(source, lambda path: bool(readers.sakai_key(path)))
        times = {readers.sakai_key(s.components): {"time": readers.sakai_time(s.data)} for s in stamps}
        download_layout = replace(download_layout, records=times)
    is_wrapped = download_layout.name == readers.FOLDERS and len({path[0] for path in paths}) == 1
    return Download(
        source, download_layout, is_wrapped and len({path[1] for path in paths if len(path) > 2}) > 1
    )


def _read_extras(source: Path, is_wanted: Callable[[tuple[str, ...]], bool]) -> Iterator[ReceivedFile]:
    return ReceivedFileReader(lambda name, why: None, is_wanted=is_wanted).read(source)


def _inspect_all(
    download: Download, collection: Collection
) -> tuple[list[DownloadedFile], list[RejectedFile]]:
    """Return the files of a download and the rejected files of known owners, without storing anything."""
    items, rejected_files, unsafe = list[DownloadedFile](), list[RejectedFile](), list[tuple[str, str]]()
    for arrival in download.read_files(collection, unsafe):
        if _is_stamp(arrival, download.layout):
            continue
        try:
            download_name = download.layout.read(arrival.components)
        except CourseError as error:
            collection.reject("/".join(arrival.components), str(error), download.owner(arrival.components))
            continue
        try:
            items.append(inspect_file(arrival, download_name))
        except CourseError as error:
            collection.reject("/".join(arrival.components), str(error), download.owner(arrival.components))
            rejected_files.append(RejectedFile(download_name, download_name.below[-1], str(error)))
    for name, why in unsafe:
        try:
            download_name = download.layout.read(tuple(name.split("/")))
        except CourseError:
            continue
        rejected_files.append(RejectedFile(download_name, download_name.below[-1], why))
    return items, rejected_files


def _is_stamp(arrival: ReceivedFile, layout: readers.Layout) -> bool:
    """Return whether a file is nbgrader's time stamp.

    On other platforms, a student may use its name.
    """
    if (
        layout.name != readers.NBGRADER
        or arrival.components[-1] != readers.STAMP
        or any(map(readers.is_zip, arrival.components))
    ):
        return False
    try:
        return len(layout.read(arrival.components).below) == STAMP_DEPTH
    except CourseError:
        return False


def _read_exports(
    download: Download,
    zone: ZoneInfo,
    roster: Path | None,
    id_column: str,
    times: Sequence[Path],
    collection: Collection,
) -> Exports:
    """Read the platform's exports.

    Their columns are found by the numbers and names in the download.
    """
    if roster is None and not times:
        return Exports()
    keys: set[str] = set()
    for path in list_paths(download.source):
        if not download.layout.is_extra(path):
            try:
                keys.update(download.layout.read(path).keys)
            except CourseError:
                # The file is rejected when it is collected.
                continue
    if not keys:
        collection.notes.add(
            "note: the download's names have no platform numbers, so the exports are ignored"
        )
        return Exports()
    tables = [path for path in (roster, *times) if path and path.suffix.lower() != ".json"]
    if download.layout.name == readers.FOLDERS and tables and not any(has_key(path, keys) for path in tables):
        collection.notes.add("note: no table has the names of the folders, so the exports are ignored")
        return Exports()
    time_tables = [table for path in times if (table := read_times(path, zone, keys))]
    ids = {
        anonymous_id: user
        for table in time_tables
        for anonymous_id, user in table.users.items()
        if anonymous_id.casefold() in keys
    }
    ids = {anonymous_id.casefold(): user for anonymous_id, user in ids.items()}
    if roster is not None:
        owner_ids = {ids.get(key, key) for key in keys}
        by_key, heading = read_ids(roster, id_column, owner_ids)
        ids = {**by_key, **{anonymous_id: by_key.get(user, user) for anonymous_id, user in ids.items()}}
        table = read_times(roster, zone, owner_ids)
        time_tables += [table] if table else []
        without_times = "" if time_tables else ", which has no times of submission"
        collection.notes.add(
            f"note: student IDs are from the column {heading!r} of {roster.name}{without_times}"
        )
    for table in time_tables:
        note = f"note: times are from {table.source}, interpreted as {zone.key}"
        if table.unparsed:
            note = replace_controls(
                f"note: {table.source}: times like {table.unparsed!r} can't be read and are "
                "ignored. Set the site to another language or calendar and export again, or write "
                f"the times into {LIST}"
            )
        collection.notes.add(note)
    return Exports(ids, [table for table in time_tables if not table.unparsed])


def _reject_collisions(files: Iterable[readers.DownloadName], exports: Exports) -> None:
    """Reject a download in which two of the platform's students would get the same ID.

    Raises:
        CourseError: The message has both students and options to pass.
    """
    owners, derived_ids = defaultdict[str, dict[str, str]](dict), set[str]()
    for download_name in files:
        if download_name.student:
            student = exports.student(download_name)
            owners[student][download_name.key] = download_name.name
            derived_ids |= set() if download_name.is_named else {student}
    for student, names in owners.items():
        if len(names) > 1 and student in derived_ids:
            first, second = list(names.values())[:2]
            raise CourseError(
                f"the files of {first!r} and of {second!r} would both belong to {student}, so "
                "nothing is collected. Identify the students by their IDs: --roster CSV, with a "
                "column of these names"
            )


@dataclass
class Store:
    """The folder of submissions that a download is sorted into.

    Args:
        out: The folder.
        zone: The zone of times in its list of files.
        exports: The platform's exports.
        collection: The result, which is extended.
    """

    out: Path
    zone: ZoneInfo
    exports: Exports
    collection: Collection

    def store_all(self, download: Download, choice: Choice) -> None:
        """Read the download again, and store the chosen files."""
        collection, items_by_path = self.collection, {item.components: item for item in choice.kept}
        for arrival in download.read_files():
            if _is_stamp(arrival, download.layout):
                download_name = download.layout.read(arrival.components)
                path = self.out.joinpath(download_name.student, *download_name.path_in_folder)
                write_atomically(path, arrival.data)
            elif item := items_by_path.get(arrival.components):
                try:
                    self._store(arrival, item)
                except (OSError, UnicodeEncodeError) as error:
                    if isinstance(error, OSError) and error.errno not in BAD_PATHS:
                        raise
                    reason = error.strerror if isinstance(error, OSError) else NO_SUCH_CHARACTERS
                    why = f"can't be kept: {reason}"
                    owner = download.owner(arrival.components)
                    collection.reject("/".join(arrival.components), why, owner)
                else:
                    notes = _platform_notes(item.download_name, self.exports, download.layout)
                    collection.notes |= set(notes)

    def _store(self, arrival: ReceivedFile, item: DownloadedFile) -> None:
        download_name, collection, rows = item.download_name, self.collection, self.collection.rows
        student = self.exports.student(download_name)
        *folders, name = download_name.path_in_folder
        if item.kind == "notebook":
            name = re.sub(r"(\.ipynb)?\.(txt|json)$", ".ipynb", name, flags=re.IGNORECASE)
        # Never overwrite a file that has different content.
        path = preferred_path = self.out.joinpath(*filter(None, (student, *folders, name)))
        number = 1
        while path.exists() and path.read_bytes() != arrival.data:
            number += 1
            path = preferred_path.with_stem(f"{preferred_path.stem}-{number}")
        write_atomically(path, arrival.data)
        seconds = arrival.time.timestamp()
        os.utime(path, (seconds, seconds))
        file = path.relative_to(self.out).as_posix()
        if rows.get(file, {}).get("rejected"):
            del rows[file]
        if student and (
            not download_name.is_named or (download_name.keys and download_name.layout != readers.NBGRADER)
        ):
            row = self._row(download_name)
            rows[file] = {"file": file, **self._keep_corrected_time(row, rows.get(file, {}))}
            collection.late += row["late"] == "yes"
        if item.kind == "notebook":
            collection.students.add(student or name)
        if item.exercise:
            # The student has submitted the exercise since, so rows of rejected files are obsolete.
            for other, row in list(rows.items()):
                is_of_exercise = row.get("rejected") and row.get("exercise") == item.exercise
                if is_of_exercise and other.split("/")[0] == student:
                    del rows[other]
        collection.count += 1

    def list_rejected(self, choice: Choice) -> None:
        """Write a row with the reason for each student without a kept file, for `course grade`."""
        rows = self.collection.rows
        for download_name, exercise, why in choice.rejected:
            try:
                key = download_name.key.rsplit(".", 1)[0]
                student = self.exports.student(download_name) or readers.id_of(key)
            except CourseError:
                # No ID can be derived from the name, so only the line in the terminal reports it.
                continue
            name = re.sub(r"[^\w .()+-]", "_", download_name.below[-1])
            name = name[:MAX_NAME].strip(" .") or exercise
            # A file of this name may be rejected, or kept, for another exercise too: each has a row
            # of its own.
            file = f"{student}/{name}"
            is_of_other = is_notebook_name(name) and find_exercise_name(name) != exercise
            if is_of_other or rows.get(file, {}).get("exercise", exercise) not in ("", exercise):
                file = f"{student}/rejected {exercise} {name}"
            if (self.out / file).exists():
                file = f"{student}/rejected {name}"
            row = {"file": file, **self._row(download_name)}
            rows[file] = {
                **row,
                "exercise": exercise,
                "rejected": escape_formula(replace_controls(why)),
            }
            self.collection.rejected_students.add(student)

    def _row(self, download_name: readers.DownloadName) -> dict[str, str]:
        """Return the row of received.csv for a file with a platform's name."""
        time, source = self.exports.time(download_name)
        return {
            "received": time.astimezone(self.zone).isoformat() if time else "",
            "late": LATE_TEXTS[download_name.late],
            "source": escape_formula(source),
            "name": escape_formula(download_name.name),
            "download_path": escape_formula(download_name.download_path),
            ID_FROM: ROSTER if download_name.is_named or self.exports.id_of(download_name) else PLATFORM,
        }

    def _keep_corrected_time(self, row: dict[str, str], before: Mapping[str, str]) -> dict[str, str]:
        """Return a row with the time in the list, which the instructor may have corrected."""
        if not before.get("received"):
            return row
        if row["received"] not in ("", before["received"]):
            self.collection.notes.add(
                replace_controls(
                    f"note: {before['file']}: {LIST} keeps {before['received']}; according to "
                    f"{row['source']} it is {row['received']}: clear the cell and collect again "
                    "to use that"
                )
            )
        return {**row, "received": before["received"], "source": before.get("source", "")}


def _platform_notes(
    download_name: readers.DownloadName, exports: Exports, layout: readers.Layout
) -> Iterator[str]:
    """Yield notes for the instructor on a file's name and time."""
    reader = layout.reader
    is_by_platform = reader is not None and download_name.layout == reader.layout != readers.NBGRADER
    if (
        (is_by_platform or layout.name == readers.FOLDERS)
        and exports.ids
        and not exports.id_of(download_name)
    ):
        yield replace_controls(
            f"note: {download_name.name} is not in the roster, and gets the ID {download_name.student}"
        )
    if reader is None or not is_by_platform:
        return
    if download_name.layout == "anonymous" and not exports.id_of(download_name):
        yield f"note: {reader.no_times}"
    elif exports.time(download_name)[0] is not None:
        return
    elif exports.times:
        yield replace_controls(
            f"note: {download_name.name} has no time of submission in {exports.times[0].source}"
        )
    else:
        why = reader.no_times or "a name of the download has no time of submission"
        yield f"note: {why}; or write them into {LIST}. Without a time no submission is late"


def _read_rows(path: Path) -> dict[str, dict[str, str]]:
    if not path.is_file():
        return {}
    with path.open(newline="", encoding="utf-8-sig") as file:
        return {
            row["file"]: row | {new: row[old] for new, old in OLD_COLUMNS.items() if old in row}
            for row in csv.DictReader(file)
        }


def write_list(path: Path, rows: Iterable[Mapping[str, str]]) -> None:
    """Write received.csv."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS, restval="", extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_atomically(path, text.getvalue().encode("utf-8", "replace"))


@dataclass(frozen=True)
class PlatformTime:
    """The platform's data about one student's files.

    Args:
        time: The time as the platform writes it, or "".
        source: The source of the time.
        is_named: Whether the student is in a roster.
    """

    time: str
    source: str
    is_named: bool


def write_receipts(top: Path, receipts: Mapping[str, PlatformTime]) -> None:
    """Write TOP/received.csv with a row for each file in the students' folders."""
    rows = list[dict[str, str]]()
    for student, receipt in receipts.items():
        receipt_row = {"received": escape_formula(receipt.time), "source": receipt.source}
        receipt_row[ID_FROM] = ROSTER if receipt.is_named else PLATFORM
        for path in sorted(path for path in (top / student).rglob("*") if path.is_file()):
            rows.append({"file": path.relative_to(top).as_posix(), **receipt_row})
    write_list(top / LIST, rows)
