"""The submissions in a folder: whose they are, when they were received, and which runs they need.

A submission is a notebook, or a file written by `course submit`. `received.csv` has the time of
receipt of each one, and its source. The ID in a notebook counts only if it belongs to the student
who submitted it.

OUT/places.json has the folder of submissions of each student and exercise, relative to OUT. Results
do not contain folders, so that records can be moved to another machine.
"""

import csv
import fnmatch
import hashlib
import json
import os
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import lru_cache
from heapq import nsmallest
from itertools import groupby
from pathlib import Path
from typing import Any
from zipfile import ZipFile
from zoneinfo import ZoneInfo

from course_lib.course.course_file import Counts
from course_lib.course.exercise import normalise
from course_lib.course.material import exercises_dir, lessons_dir
from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.grading.marks import attempt_of, dates_of
from course_lib.grading.records import (
    MISMATCH,
    NO_ID,
    RECEIPT_TIME,
    UNKNOWN,
    UNVERIFIED,
    ReceiptTime,
    Result,
    Submission,
    to_plain,
)
from course_lib.grading.reports.rendering import MOST_NAMED, join_few, replace_controls
from course_lib.grading.run.run import Job, plan_scenarios
from course_lib.grading.store import Course, catalog_of, digest_of, rules_of
from course_lib.grading.submissions.archives import RECEIPT, open_zip, read_member, working_files
from course_lib.grading.submissions.notebook import (
    MAX_BYTES,
    MAX_WITH_OUTPUTS,
    Notebook,
    claimed_id,
    find_exercise_name,
    parse_notebook,
    without_outputs,
)
from course_lib.grading.submissions.readers import STAMP, YEARS, parse_times, platform_name
from course_lib.grading.submissions.roster import LmsFile
from course_lib.third_party import check_regular, read_bytes, read_json

UTC = ZoneInfo("UTC")
NAMES = re.compile(r"\.(ipynb(\.txt|\.json)?|zip)$|^week\d\d_exercise.*\.json$", re.IGNORECASE)
RESERVED = (".html", ".js")  # suffixes of files next to the students' folders of reports
NO_EXERCISE = "is not an exercise of this course: expected a file like week01_exercise.ipynb"
# Reason of a result if `course collect` stored no file, or the file is a link.
NOT_COLLECTED = "not collected"
MANY = 3  # limit on the names in a note
LESSON_SHARE = 0.5  # fraction of a lesson's cells from which a notebook is a lesson
LIST = "received.csv"
UNFINISHED = ".collecting"  # exists while `course collect` writes the folder
ID_FROM = "id_from"  # whether the student's ID is from the roster
ROSTER, PLATFORM = "roster", "platform"  # values of the column ID_FROM in received.csv
COLUMNS = (
    "file", "received", "late", "source", "name", "download_path", ID_FROM, "exercise", "rejected",
)  # fmt: skip
# Columns of received.csv that had other names in earlier versions.
OLD_COLUMNS = {"rejected": "refused", "download_path": "handed_in_as"}
# levels below the top: STUDENT/ in folders made by hand, and nbgrader's STUDENT/ASSIGNMENT/
STAMP_DEPTHS = (1, 2)
MAX_STAMP = 200  # [B] limit on the size of a time stamp file
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
    download_path: str = ""
    exercise: str = ""
    rejection: str = ""


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

    def receipt_time(self, path: Path, receipt: Mapping[str, Any]) -> ReceiptTime:
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
        notes += [f"{path.as_posix()} is not trusted: only {LIST} at the top counts" for path in lists]
        receipt_time = None
        # A student can write anything into a receipt.
        with suppress(KeyError, TypeError, ValueError, OverflowError):
            written = datetime.fromisoformat(receipt["time"])
            receipt_time = written.astimezone(UTC) if written.tzinfo and written.year in YEARS else None
        time, source = (entry.time, entry.source) if entry else (None, "")
        stamp = self._stamp_of(path)
        if time is None and stamp is not None:
            if entry is None and not any(map(platform_name, path.relative_to(self.top).parts)):
                time, problem = _read_stamp(stamp)
                notes += [problem] if problem else []
                source = STAMP
            else:
                notes.append(f"{STAMP} is not trusted, because the platform's download contains no such file")
        is_late = entry.late if entry else None
        if time is None and is_late is not None:
            source = f"{LIST}: the platform's flag only"
        elif time is None:
            time, source = (receipt_time, RECEIPT_TIME) if receipt_time else (None, UNKNOWN)
        download_path = entry.download_path if entry else ""
        return ReceiptTime(time, source, is_late, receipt_time, tuple(notes), download_path)

    @property
    def rejected_files(self) -> Mapping[str, Entry]:
        """The files that `course collect` rejected, by path in the folder."""
        top = self.top.absolute()
        rows = {
            path.relative_to(top): entry
            for path, entry in self.entries.items()
            if entry.rejection and entry.exercise and path.is_relative_to(top)
        }
        # The folder itself may be given as ../submissions.
        return {file.as_posix(): entry for file, entry in rows.items() if ".." not in file.parts}

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
    headings = [heading for heading in (*COLUMNS, *OLD_COLUMNS.values()) if heading in file.headings]
    places = {heading: file.headings.index(heading) for heading in headings}
    rows = [{key: file.text(row, place) for key, place in places.items()} for row in range(1, len(file.rows))]
    times = parse_times([row["received"] for row in rows], zone)
    entries = {}
    for number, (row, time) in enumerate(zip(rows, times, strict=True), 2):
        note = ""
        if row["received"] and time is None:
            note = f"{LIST}, row {number}: {row['received']!r} is not a time. Expected {EXAMPLES[LIST]}"
        source = f"{LIST} ({row['source']})" if row.get("source") else LIST
        is_late = {"yes": True, "no": False}.get(row.get("late", "").casefold())
        row |= {new: row[old] for new, old in OLD_COLUMNS.items() if old in row}
        download_path = row.get("download_path", "")
        exercise = row.get("exercise", "").lstrip("'")
        rejection = row.get("rejected", "").lstrip("'")
        entry = Entry(time, source, is_late, note, download_path, exercise, rejection)
        entries[path.parent / row["file"]] = entry
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


def find_submissions(
    top: Path,
    counts: Counts = "last",
    zone: ZoneInfo = UTC,
    *,
    with_rejected: bool = False,
    is_accepted: Callable[[Submission], bool] = lambda _: True,
) -> list[Submission]:
    """Return the newest submission per student and exercise, or all, oldest first, if the best one counts.

    Args:
        top: One folder per student, or files that `course submit` wrote.
        counts: Which of several submissions counts.
        zone: The zone of times in received.csv without one.
        with_rejected: Whether to include a submission without a file for each student whose files
            were all rejected by `course collect`, or are links.
        is_accepted: Whether the late policy accepts a submission. One that is not accepted never
            replaces one that is.

    Raises:
        CourseError: `top` is not a folder, has no submissions, or its received.csv is not a table.
    """
    if not top.is_dir():
        raise CourseError(
            f"{top} is not a folder. Pass the folder with a folder per student; sort a platform's "
            "download with course collect first"
        )
    ledger = Ledger.read(top, zone)
    groups = defaultdict[tuple[str, str], list[Submission]](list)
    for path, why in _walk(top):
        if not why and NAMES.search(path.name):
            submission = read_submission(path, ledger)
            groups[submission.student, submission.exercise].append(submission)
    ordered = {key: sort_submissions(group, top, counts, is_accepted) for key, group in groups.items()}
    entries = ledger.rejected_files.items()
    rejected = [(file, entry.exercise, entry.rejection) for file, entry in entries]
    exercises = sorted({exercise for _, exercise in ordered if find_exercise_name(exercise) == exercise})
    rejected += _rejected_links(top, exercises)
    for file, exercise, why in rejected if with_rejected else ():
        folder = file.split("/")[0].removesuffix(".ipynb")
        student = claimed_id({"student": folder}) or folder
        if previous := ordered.get((student, exercise)):
            rejected_files = (*previous[-1].rejected_files, file)
            previous[-1] = replace(previous[-1], rejected_files=rejected_files)
            continue
        path = top / file
        when = ledger.receipt_time(path, {})
        submission = Submission(student, exercise, path, when, problem=why, reason=NOT_COLLECTED)
        ordered[student, exercise] = [replace(submission, relative_path=file)]
    if not ordered:
        raise CourseError(f"{top} contains no submissions: expected STUDENT/week01_exercise.ipynb")
    groups_in_order = [ordered[key] for key in sorted(ordered)]
    return [s for group in groups_in_order for s in (group if counts == "best" else group[-1:])]


def skipped_files(top: Path) -> list[str]:
    """Return a line for each link or device, and for each student's folder without a submission."""
    walked = list(_walk(top))
    lines = [f"skipped: {path.relative_to(top).as_posix()}: {why}" for path, why in walked if why]
    found = (path for path, why in walked if not why and NAMES.search(path.name))
    owners = {path.relative_to(top).parts[0] for path in found}
    for folder in sorted(path for path in top.iterdir() if path.is_dir() and not path.is_symlink()):
        names = sorted(path.name for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
        if folder.name not in owners and not folder.name.startswith(".") and names:
            lines.append(
                f"skipped: {folder.name}: no notebook, and no zip of `course submit`, among {join_few(names)}"
            )
    return lines


def unfinished_lines(top: Path) -> list[str]:
    """Return a warning if `course collect` was killed while it wrote the folder, or the disk was full."""
    mark = top / UNFINISHED
    if not mark.is_file():
        return []
    source = replace_controls(mark.read_text(encoding="utf-8", errors="replace"))
    problem = f"course collect {source} --out {top} did not finish, so files of students may be missing"
    return [f"warning: {problem}. Collect again, then grade again"]


def _rejected_links(top: Path, exercises: Sequence[str]) -> Iterator[tuple[str, str, str]]:
    """Yield (file, exercise, reason) for each link or device with a submission's name.

    A link to a folder may stand for any exercise of the class.
    """
    for path, why in ((path, why) for path, why in _walk(top) if why):
        file, reason = path.relative_to(top).as_posix(), f"{why}. Copy the file that it stands for"
        if NAMES.search(path.name):
            yield file, find_exercise_name(path.name) or path.name, reason
        elif path.is_symlink() and path.is_dir():
            yield from ((file, exercise, reason) for exercise in exercises)


def _walk(top: Path) -> Iterator[tuple[Path, str]]:
    """Yield each file and the reason to skip it, which is "" unless it is a link or a device."""
    for folder, folders, names in os.walk(top):
        links = [name for name in folders if Path(folder, name).is_symlink()]
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for path in (Path(folder, name) for name in sorted((*names, *links)) if not name.startswith(".")):
            kind = "a link" if path.is_symlink() else "" if path.is_file() else "a pipe or a device"
            yield path, f"it is {kind}, not a file" if kind else ""


def sort_submissions(
    group: Sequence[Submission],
    top: Path,
    counts: Counts,
    is_accepted: Callable[[Submission], bool],
) -> list[Submission]:
    """Sort one student's files of one exercise. The effective one comes last.

    A file that is not the exercise never replaces one that is, nor does one that is too late to be
    accepted. Newer means received later by trusted times, else with the higher number in its name.
    A file that only contains the student's ID never replaces one in the student's folder; if
    several such files contain it, none counts.
    """
    owned = [file for file in group if len(file.path.relative_to(top).parts) > 1]
    timed = all(file.received.is_trusted for file in owned or group)
    order = sorted(group, key=lambda f: (f in owned, f.is_exercise, is_accepted(f), *_age(f, top, timed)))
    places = {file.path.relative_to(top).parts[0] for file in group}
    others = [(file.path.relative_to(top).as_posix(), file.problem) for file in order[:-1]]
    last = replace(
        order[-1],
        rivals=tuple(sorted(places)) if len(places) > 1 else (),
        uncounted_files=tuple(f"{name} ({problem})" if problem else name for name, problem in others),
        counts=counts,
    )
    claims = {} if owned else {_base_name(file): file.sha256 for file in order if file.is_exercise}
    if len(set(claims.values())) > 1:
        file_names = " and ".join(sorted(file.path.name for file in order if file.is_exercise))
        problem = (
            f"{file_names} have the ID {last.student}: move each into the folder of the student "
            "who submitted it"
        )
        return [replace(last, notebook=None, problem=problem, reason="claimed twice")]
    return [*order[:-1], last]


def _age(file: Submission, top: Path, timed: bool) -> tuple[Any, ...]:
    """Return a sort key that orders one student's files from oldest to newest."""
    time = file.received.time if timed else None
    folders = file.path.relative_to(top).parts[1:-1]
    tries = max((_split_attempt(folder)[1] for folder in folders), default=0)
    name, number = _split_attempt(_base_name(file, whole=True))
    written_at = file.received.receipt.timestamp() if file.received.receipt else file.path.stat().st_mtime
    return (time.timestamp() if time else 0.0, tries, number, name != "", written_at, file.path.as_posix())


def _base_name(file: Submission, *, whole: bool = False) -> str:
    """Return a file's name without exercise and ID, and without the number of the attempt unless `whole`."""
    name = re.sub(r"^week\d\d(_exercise)?|\.ipynb$", "", file.path.stem, flags=re.IGNORECASE)
    for student_id in filter(None, (file.claimed_id, file.student)):
        # Canvas's "-11" is an attempt, even of the student 11; `course submit` writes "_11".
        is_short = re.fullmatch(r"\d{1,3}", student_id)
        pattern = rf"(^|_){student_id}(?!\d)" if is_short else re.escape(student_id)
        name = re.sub(pattern, "", name.casefold())
    return (name if whole else _split_attempt(name)[0]).strip(" _-")


def _split_attempt(name: str) -> tuple[str, int]:
    """Split off the number by which platforms and browsers mark another attempt: "(1)", "-2", "copy 3"."""
    stem = re.sub(r"^week\d\d", "", name, flags=re.IGNORECASE)
    number = re.search(r"\W*(?:copy|kopie|copie|copia|v|try|attempt)?\W*(\d{1,3})\W*$", stem, re.IGNORECASE)
    return (stem[: number.start()], int(number[1])) if number else (stem, 0)


def read_submission(path: Path, ledger: Ledger) -> Submission:
    """Read one file; an error is stored in its `problem`."""
    receipt: Mapping[str, Any] = {}
    notebook, claimed, sha256, problem, reason = None, None, "", "", ""
    files: Mapping[str, str] = {}
    is_untouched = False
    exercise = find_exercise_name(path.name)
    try:
        data, receipt = unpack(path)
        notebook = parse_notebook(data, str(receipt.get("exercise", path.name)))
        exercise, claimed = notebook.exercise, notebook.student or claimed_id(receipt)
        has_own_folder = path.parent != ledger.top or path.suffix.lower() == ".zip"
        files = working_files(path, notebook.cells) if has_own_folder else {}
        sha256 = content_hash(data, files)
        problem = "" if exercise else f"{path.name} {NO_EXERCISE}"
        is_untouched = exercise is not None and notebook.digest == released_digest(exercise)
        if exercise and (lesson := lesson_of(notebook)):
            problem, reason = (
                f"{path.name} is {lesson}, not the exercise. Submit {exercise}.ipynb",
                "a lesson",
            )
            notebook = None
        elif exercise and not any(cell.strip() for cell in notebook.cells):
            problem = f"{path.name} has no code in its code cells. Open it, save it and submit it again"
            notebook, reason = None, "no code"
    except CourseError as error:
        # Results contain no absolute paths of this machine.
        problem = str(error).replace(str(path), path.name)
    folders = path.relative_to(ledger.top).parts[:-1]
    student = claimed_id({"student": folders[0]}) or folders[0] if folders else claimed or path.stem
    if student.lower().endswith(RESERVED):
        student += "_"
    return Submission(
        student,
        exercise or path.name,
        path,
        ledger.receipt_time(path, receipt),
        notebook,
        files,
        claimed,
        sha256,
        problem,
        reason=reason,
        relative_path=path.relative_to(ledger.top).as_posix(),
        is_untouched=is_untouched,
    )


def lesson_of(notebook: Notebook) -> str:
    """Return the lesson if a notebook with the name of an exercise is a lesson, else "".

    The metadata identify it, or its cells, because exercises have others.
    """
    cells = {cell.strip() for cell in notebook.cells if cell.strip()}
    shares = {name: len(cells & known) for name, known in _lesson_cells().items()}
    best = max(shares, key=lambda name: shares[name], default="")
    if best and len(cells) > 1 and shares[best] > LESSON_SHARE * len(cells):
        return f"the lesson {best}"
    return "a lesson" if notebook.is_lesson else ""


@lru_cache(maxsize=1)
def _lesson_cells() -> Mapping[str, frozenset[str]]:
    """Return the cells that occur only in lessons, by the name of the lesson."""
    exercises = frozenset[str]().union(*_cells_in(exercises_dir(), "week*_exercise.ipynb").values())
    return {name: cells - exercises for name, cells in _cells_in(lessons_dir(), "*.ipynb").items()}


def _cells_in(folder: Path, names: str) -> dict[str, frozenset[str]]:
    cells_by_name = {}
    for path in sorted(folder.glob(names)):
        try:
            cells = parse_notebook(read_bytes(path), path.name).cells
        except (OSError, CourseError):
            continue
        cells_by_name[path.stem] = frozenset(cell.strip() for cell in cells if cell.strip())
    return cells_by_name


@lru_cache(maxsize=100)
def released_digest(exercise: str) -> str:
    """Return the digest of the cells of an unchanged exercise, or "" if the course lacks it."""
    path = exercises_dir() / f"{exercise}.ipynb"
    try:
        return parse_notebook(read_bytes(path), path.name).digest
    except (OSError, CourseError):
        return ""


def content_hash(data: bytes, files: Mapping[str, str]) -> str:
    """Return the SHA-256 of a notebook and its files."""
    more = json.dumps(sorted(files.items())).encode() if files else b""
    return hashlib.sha256(data + more).hexdigest()


def unpack(path: Path) -> tuple[bytes, Mapping[str, Any]]:
    """Return a notebook's bytes and its receipt, which is empty for a plain notebook.

    Raises:
        CourseError: The file is missing, a folder, or a zip file that `course submit` did not
            write.
    """
    try:
        is_packed = path.suffix.lower() == ".zip"
        check_regular(path)
        with path.open("rb") as file:
            data = file.read((2 * MAX_BYTES if is_packed else MAX_WITH_OUTPUTS) + 1)
    except OSError as error:
        raise CourseError(f"{path} can't be read: {error.strerror or error}. Pass a notebook.") from error
    return read_packed_zip(data, path.name) if is_packed else (_limit_size(data), {})


def read_packed_zip(data: bytes, name: str) -> tuple[bytes, Mapping[str, Any]]:
    """Return the notebook's bytes and the receipt in a file of `course submit`.

    Raises:
        CourseError: `course submit` did not write it.
    """
    try:
        if len(data) > 2 * MAX_BYTES:
            raise ValueError(f"it has more than {2 * MAX_BYTES:,} bytes")
        with open_zip(data) as archive:
            receipt = read_json(_read_member(archive, RECEIPT, MAX_BYTES))
            return _read_member(archive, f"{receipt['exercise']}.ipynb", MAX_WITH_OUTPUTS), receipt
    except (CourseError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise CourseError(
            f"{name} is not a file that `course submit` wrote ({error}). Run `course submit` again, "
            "and submit its file unchanged"
        ) from error


def _limit_size(data: bytes) -> bytes:
    """Return a notebook's bytes, without its outputs if it is large."""
    return without_outputs(data) if MAX_BYTES < len(data) <= MAX_WITH_OUTPUTS else data


def _read_member(archive: ZipFile, name: str, max_bytes: int) -> bytes:
    data = _limit_size(read_member(archive, name, max_bytes))
    if len(data) > MAX_BYTES:
        raise CourseError(f"{name} is larger than {MAX_BYTES} bytes")
    return data


PLACES = "places.json"


def read_submission_folders(out: Path) -> dict[str, str]:
    """Return the stored folders of submissions by "STUDENT/EXERCISE"; empty for old records."""
    try:
        content = read_json((out / PLACES).read_text(encoding="utf-8"))
        return {str(key): str(folder) for key, folder in content.items()}
    except (OSError, ValueError, AttributeError):
        return {}


def store_submission_folders(out: Path, submissions: Path, submissions_found: Iterable[Submission]) -> None:
    """Store `submissions` as the folder of these submissions, and keep the entries of all others.

    Raises:
        OSError: It can't be written.
    """
    folder = Path(os.path.relpath(submissions.resolve(), out.resolve())).as_posix()
    places = {
        **read_submission_folders(out),
        **{f"{s.student}/{s.exercise}": folder for s in submissions_found},
    }
    write_atomically(out / PLACES, json.dumps(places, indent=1, sort_keys=True).encode("utf-8", "replace"))


def graded_file(submission: Submission, out: Path) -> Path:
    """Return the path of a result's file; results of older versions contain the full path."""
    folder = read_submission_folders(out).get(f"{submission.student}/{submission.exercise}")
    return submission.path if folder is None else out / folder / submission.path


def missing_file_lines(
    results: Iterable[Result], found_submissions: Iterable[Submission], submissions: Path, out: Path
) -> list[str]:
    """Return a line about students whose marks count although their file is missing.

    Args:
        results: All results; results of other folders are ignored.
        found_submissions: The submissions in the folder.
        submissions: The folder of submissions.
        out: The folder of records.
    """
    present = {(submission.student, submission.exercise) for submission in found_submissions}
    exercises, places = {exercise for _, exercise in present}, read_submission_folders(out)
    missing = list[str]()
    for result in results:
        student, exercise = result.submission.student, result.submission.exercise
        if (student, exercise) in present or result.status == "rejected":
            continue
        folder = places.get(f"{student}/{exercise}")
        file = result.submission.path
        file = file if folder is None else out / folder / file
        home = file.parent if folder is None else out / folder
        is_here = submissions.resolve() in (home.resolve(), *file.resolve().parents)
        # A missing folder has been moved. It was this one if it has the same exercise.
        is_moved = exercise in exercises and not home.exists()
        if is_here or is_moved:
            missing.append(f"{student} {exercise}")
    todo = f"Moved or withdrawn? Remove {out / 'results'}/STUDENT/EXERCISE.json, then grade again"
    return (
        [f"Please review: the file is gone, but its mark counts: {join_few(missing)}. {todo}"]
        if missing
        else []
    )


@dataclass(frozen=True)
class Attempts:
    """One student's submissions of one exercise: the last one, or all if the best one counts.

    Args:
        student: The folder's name, or the ID in the files.
        exercise: "week01_exercise".
        submissions: The submissions, oldest first.
        jobs: The jobs by the key of their evidence; none for a rejected submission.
        rules: Digest of the rules by which they are judged.
        digest: Digest of everything that the result depends on.
    """

    student: str
    exercise: str
    submissions: tuple[Submission, ...]
    jobs: Mapping[str, Job]
    rules: str
    digest: str


def plan_attempts(submissions: Sequence[Submission], course: Course, only: str) -> list[Attempts]:
    """Plan the jobs of the submissions that a pattern selects.

    Args:
        submissions: All submissions.
        course: The tasks and hidden checks.
        only: A pattern of STUDENT/EXERCISE.

    Raises:
        CourseError: The pattern matches no submission.
    """
    selected = [s for s in submissions if fnmatch.fnmatch(f"{s.student}/{s.exercise}", only)]
    if not selected:
        example = f"{submissions[0].student}/{submissions[0].exercise}"
        raise CourseError(
            f"--only {only} matches no submission: use a pattern like 'ada/*'; one submission is {example}"
        )
    faults = catalog_of(course).faults
    weeks = {s.exercise.split("_")[0] for s in selected}
    for week in sorted(weeks & faults.keys()):
        sound = min({s.exercise.split("_")[0] for s in submissions} - faults.keys(), default="")
        meanwhile = f". Until then, --only '*/{sound}*' grades one week" if sound else ""
        raise CourseError(f"nothing is graded: {faults[week]}{meanwhile}")
    owners = defaultdict[str, set[str]](set)
    for submission in selected:
        owners[submission.sha256].add(submission.student)
    groups = groupby(selected, lambda s: (s.student, s.exercise))
    return [_make_attempts(list(group), owners, course) for _, group in groups]


def _make_attempts(
    group: Sequence[Submission],
    owners: Mapping[str, set[str]],
    course: Course,
) -> Attempts:
    submissions, jobs = list[Submission](), dict[str, Job]()
    for submission in group:
        planned, job = _plan_job(submission, course)
        if job is not None:
            jobs[job.key] = job
        # Unchanged exercises are equal for all students.
        if planned.sha256 and not planned.is_untouched:
            twins = owners[planned.sha256] - {planned.student}
            shown_names = nsmallest(MOST_NAMED, twins)
            more = len(twins) - len(shown_names)
            planned = replace(planned, twins=(*shown_names, *[f"{more} more"] * bool(more)))
        submissions.append(planned)
    student, exercise = group[-1].student, group[-1].exercise
    rules, dates = rules_of(course, exercise), dates_of(catalog_of(course).course, student, exercise)
    digest = digest_of([rules, dates, [to_plain(attempt_of(s)) for s in submissions]])
    return Attempts(student, exercise, tuple(submissions), jobs, rules, digest)


def _plan_job(submission: Submission, course: Course) -> tuple[Submission, Job | None]:
    """Return a submission without its code but with the key of its evidence, and the job to run."""
    catalog = catalog_of(course)
    week = submission.exercise.split("_")[0]
    tasks = catalog.tasks_of_week(week)
    notebook, bare = submission.notebook, replace(submission, notebook=None, files={})
    if notebook is None:
        return bare, None
    if not tasks:
        return replace(bare, problem=bare.problem or f"the course has no {bare.exercise}"), None
    steps = tuple(step.without_checks() for step in plan_scenarios(tasks, catalog, with_hidden=True))
    limits, files = catalog.course.limits, catalog.with_assets(week, submission.files)
    own_values, forbidden_paths = submission.values_of, course.forbidden_paths
    job = Job(notebook.cells, own_values, steps, limits, files, course.sandbox, forbidden_paths)
    return replace(bare, key=job.key), job


# Moodle's names of folders without a roster.
PLATFORM_NAME = re.compile(r"participant_?\d+|.+_\d+_assignsubmission_.*")


def resolve_ids(submissions: Sequence[Submission], top: Path) -> list[Submission]:
    """Return the submissions with the ID that determines the personal values of each.

    The folder identifies the student, whose values count whatever ID is in the file. Only if the
    folder's name is the platform's number, because no roster was given, the file's ID counts; then
    it can't be verified, unless two students' files contain the same ID.

    Args:
        submissions: All submissions of a class.
        top: Their folder, with the received.csv written by `course collect`.
    """
    numbers = _platform_numbers(top)
    owners = defaultdict[str, set[str]](set)
    for submission in submissions:
        owners[submission.student].add(submission.student)
        if submission.claimed_id:
            owners[submission.claimed_id].add(submission.student)
    return [_resolve_id(submission, top, numbers, owners) for submission in submissions]


def _resolve_id(
    submission: Submission, top: Path, numbers: frozenset[str], owners: dict[str, set[str]]
) -> Submission:
    # An unreadable file has no ID to verify.
    if not submission.sha256:
        return submission
    is_number = submission.student in numbers or PLATFORM_NAME.fullmatch(submission.student)
    if submission.path.parent != top and not is_number:
        # The folder identifies the student.
        resolved = replace(submission, values_of=submission.student)
        if submission.claimed_id == submission.student:
            return resolved
        judging = f"judged with the personal values of {submission.student}"
        if submission.claimed_id is None:
            return replace(resolved, id_flag=NO_ID, id_note=f"the file has no ID: {judging}")
        note = (
            f"the file has the ID {submission.claimed_id}, but {submission.student} submitted it: {judging}"
        )
        return replace(resolved, id_flag=MISMATCH, id_note=note)
    if is_number and submission.claimed_id and owners[submission.claimed_id] != {submission.student}:
        note = f"the file has the ID {submission.claimed_id}, and so has another student's file"
        return replace(submission, values_of=submission.claimed_id, id_flag=MISMATCH, id_note=note)
    if submission.claimed_id is None:
        note = "the file has no ID: judged with the personal values of a guest"
        return replace(submission, id_flag=NO_ID, id_note=note)
    # Often all submissions are unverified, which is reported in a single line.
    return replace(submission, values_of=submission.claimed_id, id_flag=UNVERIFIED)


def _platform_numbers(top: Path) -> frozenset[str]:
    """Return the folders that `course collect` named by a platform's number because there was no roster."""
    path = top / LIST
    if not path.is_file():
        return frozenset()
    try:
        with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
            rows = [row for row in csv.DictReader(file) if row.get(ID_FROM) == PLATFORM]
    except (OSError, csv.Error):
        # Reading the times from the same file reports the error.
        return frozenset()
    numbers = set[str]()
    for row in rows:
        # The student's folder, normalized as in submissions.
        name = (row.get("file") or "").lstrip("'").split("/")[0]
        try:
            numbers.add(normalise(name))
        except CourseError:
            numbers.add(name)
    return frozenset(numbers)
