"""Finding what students handed in: notebooks, and the files that `course submit` writes."""

import hashlib
import json
import os
import re
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from zipfile import ZipFile
from zoneinfo import ZoneInfo

from course_lib.course.course_file import Counts
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.handin.archives import RECEIPT, opened_zip, read_member, working_files
from course_lib.grading.handin.notebook import MAX_BYTES, Notebook, claimed_id, exercise_named, parse_notebook
from course_lib.grading.handin.received import Ledger, Received

UTC = ZoneInfo("UTC")
SUFFIXES = (".ipynb", ".zip")
RESERVED = (".html", ".js")  # files that lie beside the students' folders of reports
PLAIN = (  # fields of plain data
    "student", "exercise", "claimed", "sha256", "problem", "key", "twins", "values_of", "id_flag", "id_note",
)  # fmt: skip
NO_EXERCISE = "is not an exercise of this course: expected a file like week01_exercise.ipynb"


@dataclass(frozen=True)
class Submission:
    """One handed-in exercise.

    Args:
        student: Who handed it in: the name of the folder it lies in, else the ID that it claims.
        exercise: "week01_exercise"; the file's own name if it names none.
        path: The file.
        received: When, and how that is known.
        notebook: Its cells and claims; None if it can't be read.
        files: Texts that came with it, by their paths from its folder.
        claimed: The ID that the file itself names.
        sha256: Of the notebook, and of its files if it has any.
        problem: Why it can't be graded, or "".
        key: Of its evidence, if it can be graded.
        twins: Others who handed in the same file.
        rivals: Files and folders that say to be this same student's: somebody may have taken the ID.
        values_of: The student whose personal values count; None is a guest.
        id_flag: What is wrong with the ID that the file names, in two or three words, or "".
        id_note: The same as a sentence.
        others: The student's other files of the exercise, which do not count.
        reason: A word for the problem, where it is not the file's.
    """

    student: str
    exercise: str
    path: Path
    received: Received
    notebook: Notebook | None = None
    files: Mapping[str, str] = field(default_factory=dict)
    claimed: str | None = None
    sha256: str = ""
    problem: str = ""
    key: str = ""
    twins: tuple[str, ...] = ()
    rivals: tuple[str, ...] = ()
    values_of: str | None = None
    id_flag: str = ""
    id_note: str = ""
    others: tuple[str, ...] = ()
    reason: str = ""

    @property
    def is_exercise(self) -> bool:
        """True if it is a readable exercise with a non-empty cell."""
        return not self.problem and self.notebook is not None and any(map(str.strip, self.notebook.cells))

    @property
    def notes(self) -> list[str]:
        """Notes for staff."""
        notes = [f"the same file as that of {', '.join(self.twins)}"] if self.twins else []
        if self.rivals:
            notes.append(f"this counts, of what says to be {self.student}'s in {', '.join(self.rivals)}")
        if self.others:
            notes.append(f"{self.path.name} counts, not {', '.join(self.others)}")
        notes += self.received.notes
        return [*notes, self.id_note] if self.id_note else notes

    def as_plain(self) -> dict[str, Any]:
        """Return the fields of a result file."""
        return {
            **{name: getattr(self, name) for name in PLAIN},
            "file": str(self.path),
            **self.received.as_plain(),
        }

    @classmethod
    def from_plain(cls, content: Mapping[str, Any]) -> "Submission":
        """Build a submission from a result file, without its notebook; its evidence is stored."""
        same = {name: content[name] for name in PLAIN if name in content}
        when = Received.from_plain(content)
        return cls(path=Path(content["file"]), received=when, **{**same, "twins": tuple(content["twins"])})


def find_submissions(top: Path, counts: Counts = "last", zone: ZoneInfo = UTC) -> list[Submission]:
    """Return the newest submission of each student and exercise; all, the oldest first, if the best counts.

    Args:
        top: One folder per student, or files that `course submit` wrote.
        counts: Which of several submissions counts.
        zone: Of times in received.csv that do not name theirs.

    Raises:
        CourseError: `top` is not a folder, holds no submission, or its received.csv is not a table.
    """
    if not top.is_dir():
        raise CourseError(
            f"{top} is not a folder. Name the one with a folder per student; what a platform gave first goes "
            "through course collect"
        )
    ledger = Ledger.read(top, zone)
    groups = defaultdict[tuple[str, str], list[Submission]](list)
    for path in _files(top):
        one = read_submission(path, ledger)
        groups[one.student, one.exercise].append(one)
    if not groups:
        raise CourseError(f"{top} holds no submission: expected STUDENT/week01_exercise.ipynb in it")
    ordered = [in_order(groups[key], top) for key in sorted(groups)]
    return [one for group in ordered for one in (group if counts == "best" else group[-1:])]


def in_order(group: Sequence[Submission], top: Path) -> list[Submission]:
    """Sort one student's files of one exercise, the one that counts last.

    A file that is not the exercise never displaces one that is. Newer is what was received later by trusted
    times, else what has the higher number in its name. A file that only claims the student's ID displaces
    none that lies in the student's folder; where several such files claim it, none counts.
    """
    owned = [one for one in group if len(one.path.relative_to(top).parts) > 1]
    timed = all(one.received.is_trusted for one in owned or group)
    order = sorted(group, key=lambda one: (one in owned, one.is_exercise, *_age(one, top, timed)))
    places = {one.path.relative_to(top).parts[0] for one in group}
    last = replace(
        order[-1],
        rivals=tuple(sorted(places)) if len(places) > 1 else (),
        others=tuple(_named(one, top) for one in order[:-1]),
    )
    claims = {} if owned else {_base(one): one.sha256 for one in order if one.is_exercise}
    if len(set(claims.values())) > 1:
        named = " and ".join(sorted(one.path.name for one in order if one.is_exercise))
        problem = f"{named} name {last.student}: put each into the folder of the student who handed it in"
        return [replace(last, notebook=None, problem=problem, reason="claimed twice")]
    return [*order[:-1], last]


def _age(one: Submission, top: Path, timed: bool) -> tuple[Any, ...]:
    """Return what sorts one student's files from the oldest to the newest."""
    time = one.received.time if timed else None
    folders = one.path.relative_to(top).parts[1:-1]
    tries = max((_try(folder)[1] for folder in folders), default=0)
    name, number = _try(_base(one, whole=True))
    written = one.received.receipt.timestamp() if one.received.receipt else one.path.stat().st_mtime
    return (time.timestamp() if time else 0.0, tries, number, name != "", written, one.path.as_posix())


def _base(one: Submission, *, whole: bool = False) -> str:
    """Return what a file's name has besides exercise and ID, without the number of the try unless `whole`."""
    rest = re.sub(r"^week\d\d(_exercise)?", "", one.path.stem, flags=re.IGNORECASE)
    for known in filter(None, (one.claimed, one.student)):
        rest = rest.casefold().replace(known, "")
    return (rest if whole else _try(rest)[0]).strip(" _-")


def _try(name: str) -> tuple[str, int]:
    """Split off the number by which platforms and browsers mark another try: "(1)", "-2", "copy 3"."""
    rest = re.sub(r"^week\d\d", "", name, flags=re.IGNORECASE)
    number = re.search(r"\W*(?:copy|kopie|copie|copia|v|try|attempt)?\W*(\d{1,3})\W*$", rest, re.IGNORECASE)
    return (rest[: number.start()], int(number[1])) if number else (rest, 0)


def _named(one: Submission, top: Path) -> str:
    name = one.path.relative_to(top).as_posix()
    return f"{name} ({one.problem})" if one.problem else name


def read_submission(path: Path, ledger: Ledger) -> Submission:
    """Read one file; what is wrong with it is in its `problem`."""
    receipt: Mapping[str, Any] = {}
    notebook, claimed, sha256, problem = None, None, "", ""
    files: Mapping[str, str] = {}
    exercise = exercise_named(path.name)
    try:
        data, receipt = unpack(path)
        notebook = parse_notebook(data, str(receipt.get("exercise", path.name)))
        exercise, claimed = notebook.exercise, notebook.student or claimed_id(receipt)
        beside = path.parent != ledger.top or path.suffix.lower() == ".zip"
        files = working_files(path, notebook.cells) if beside else {}
        sha256 = content_hash(data, files)
        problem = "" if exercise else f"{path.name} {NO_EXERCISE}"
    except CourseError as error:
        problem = str(error)
    folders = path.relative_to(ledger.top).parts[:-1]
    student = claimed_id({"student": folders[0]}) or folders[0] if folders else claimed or path.stem
    if student.lower().endswith(RESERVED):
        student += "_"
    about = (notebook, files, claimed, sha256, problem)
    return Submission(student, exercise or path.name, path, ledger.received(path, receipt), *about)


def content_hash(data: bytes, files: Mapping[str, str]) -> str:
    """Return the SHA-256 of a notebook, with its files if it has any."""
    more = json.dumps(sorted(files.items())).encode() if files else b""
    return hashlib.sha256(data + more).hexdigest()


def unpack(path: Path) -> tuple[bytes, Mapping[str, Any]]:
    """Return a notebook's bytes and the receipt that came with it, if one did.

    Raises:
        CourseError: The file is missing, a folder, or no file that `course submit` wrote.
    """
    try:
        with path.open("rb") as file:
            data = file.read(2 * MAX_BYTES + 1)
        if path.suffix.lower() != ".zip":
            return data[: MAX_BYTES + 1], {}
        if len(data) > 2 * MAX_BYTES:
            raise ValueError(f"it has more than {2 * MAX_BYTES} bytes")
        with opened_zip(data) as archive:
            receipt = read_json(_member(archive, RECEIPT))
            return _member(archive, f"{receipt['exercise']}.ipynb"), receipt
    except OSError as error:
        raise CourseError(f"{path} can't be read: {error.strerror or error}. Name a notebook.") from error
    except (CourseError, ValueError, LookupError, TypeError) as error:
        raise CourseError(f"{path.name} is not a file that `course submit` wrote ({error})") from error


def _member(archive: ZipFile, name: str) -> bytes:
    data = read_member(archive, name, MAX_BYTES)
    if len(data) > MAX_BYTES:
        raise CourseError(f"{name} is larger than {MAX_BYTES} bytes")
    return data


def _files(top: Path) -> Iterator[Path]:
    for folder, folders, names in os.walk(top):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for path in (Path(folder, name) for name in sorted(names) if not name.startswith(".")):
            if path.suffix.lower() in SUFFIXES and path.is_file() and not path.is_symlink():
                yield path
