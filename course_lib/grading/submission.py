"""Finding what students handed in: notebooks, and the files that `course submit` writes."""

import hashlib
import json
import os
import re
import zipfile
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import Any

from course_lib.course.course_file import Counts
from course_lib.errors import CourseError
from course_lib.grading.notebook import MAX_BYTES, Notebook, claimed_id, exercise_named, parse_notebook
from course_lib.grading.received import Received, received
from course_lib.grading.working_files import working_files

RECEIPT = "receipt.json"
SUFFIXES = (".ipynb", ".zip")
RESERVED = (".html", ".js")  # files that lie beside the students' folders of reports
PLAIN = (  # fields of plain data
    "student", "exercise", "claimed", "sha256", "problem", "key", "twins", "values_of", "id_flag", "id_note",
)  # fmt: skip
NO_EXERCISE = "is no exercise of this course: expected a file like week01_exercise.ipynb"


@dataclass(frozen=True)
class Submission:
    """One handed-in exercise.

    Args:
        student: Who handed it in: the name of the folder it lies in, else the ID that it claims.
        exercise: "week01_exercise"; the file's own name if that can't be told.
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

    @property
    def notes(self) -> list[str]:
        """What staff should know."""
        notes = [f"the same file as that of {', '.join(self.twins)}"] if self.twins else []
        if self.rivals:
            notes.append(f"this counts, of what says to be {self.student}'s in {', '.join(self.rivals)}")
        return [*notes, self.id_note] if self.id_note else notes

    def as_plain(self) -> dict[str, Any]:
        """What a result file says of it."""
        return {
            **{name: getattr(self, name) for name in PLAIN},
            "file": str(self.path),
            "received": self.received.time.isoformat(),
            "received_from": self.received.source,
        }

    @classmethod
    def from_plain(cls, content: Mapping[str, Any]) -> "Submission":
        """The one of a result file, without its notebook; its evidence is stored."""
        when = Received(datetime.fromisoformat(content["received"]), content["received_from"])
        same = {name: content[name] for name in PLAIN if name in content}
        return cls(path=Path(content["file"]), received=when, **{**same, "twins": tuple(content["twins"])})


def find_submissions(top: Path, counts: Counts = "last") -> list[Submission]:
    """The newest submission of each student and exercise; all of them, the oldest first, if the best counts.

    Raises:
        CourseError: `top` is no folder, or holds no submission.
    """
    if not top.is_dir():
        raise CourseError(
            f"{top} is no folder. Name the one with a folder per student; what a platform gave first goes "
            "through course collect"
        )
    found = [read_submission(path, top) for path in _files(top)]
    if not found:
        raise CourseError(f"{top} holds no submission: expected STUDENT/week01_exercise.ipynb in it")
    found.sort(key=lambda one: (one.student, one.exercise, one.received.time, _again(one.path)))
    places = defaultdict[tuple[str, str], set[str]](set)
    for one in found:
        places[one.student, one.exercise].add(one.path.relative_to(top).parts[0])
    rivals = {owner: tuple(sorted(names)) for owner, names in places.items() if len(names) > 1}
    found = [replace(one, rivals=rivals.get((one.student, one.exercise), ())) for one in found]
    newest = {(one.student, one.exercise): one for one in found}
    return found if counts == "best" else list(newest.values())


def read_submission(path: Path, top: Path) -> Submission:
    """Read one file; what is wrong with it is in its `problem`."""
    receipt: Mapping[str, Any] = {}
    notebook, claimed, sha256, problem = None, None, "", ""
    files: Mapping[str, str] = {}
    exercise = exercise_named(path.name)
    try:
        data, receipt = unpack(path)
        notebook = parse_notebook(data, str(receipt.get("exercise", path.name)))
        exercise, claimed = notebook.exercise, notebook.student or claimed_id(receipt)
        beside = path.parent != top or path.suffix.lower() == ".zip"
        files = working_files(path, notebook.cells) if beside else {}
        sha256 = content_hash(data, files)
        problem = "" if exercise else f"{path.name} {NO_EXERCISE}"
    except CourseError as error:
        problem = str(error)
    folders = path.relative_to(top).parts[:-1]
    student = claimed_id({"student": folders[0]}) or folders[0] if folders else claimed or path.stem
    if student.lower().endswith(RESERVED):
        student += "_"
    when = received(path, top, receipt)
    about = (notebook, files, claimed, sha256, problem)
    return Submission(student, exercise or path.name, path, when, *about)


def content_hash(data: bytes, files: Mapping[str, str]) -> str:
    """The SHA-256 of a notebook, with its files if it has any."""
    more = json.dumps(sorted(files.items())).encode() if files else b""
    return hashlib.sha256(data + more).hexdigest()


def unpack(path: Path) -> tuple[bytes, Mapping[str, Any]]:
    """A notebook's bytes and the receipt that came with it, if one did.

    Raises:
        CourseError: The file is missing, a folder, or no file that `course submit` wrote.
    """
    try:
        if path.suffix.lower() != ".zip":
            with path.open("rb") as file:
                return file.read(MAX_BYTES + 1), {}
        if path.stat().st_size > 2 * MAX_BYTES:  # a list of its files may be as long
            raise ValueError(f"it has more than {2 * MAX_BYTES} bytes")
        with zipfile.ZipFile(path) as archive:
            receipt = json.loads(_member(archive, RECEIPT))
            return _member(archive, f"{receipt['exercise']}.ipynb"), receipt
    except OSError as error:
        raise CourseError(f"{path} can't be read: {error.strerror or error}. Name a notebook.") from error
    except Exception as error:  # a broken or locked archive raises a dozen kinds; none is more than "no"
        raise CourseError(f"{path.name} is not a file that `course submit` wrote ({error})") from error


def _member(archive: zipfile.ZipFile, name: str) -> bytes:
    with archive.open(name) as member:
        data = member.read(MAX_BYTES + 1)  # what the archive says of its sizes need not be true
    if len(data) > MAX_BYTES:
        raise ValueError(f"{name} is larger than {MAX_BYTES} bytes")
    return data


def _again(path: Path) -> int:
    """The number at the end of a name, with which platforms and `course collect` mark another try, or 0."""
    number = re.search(r"-(\d+)$", path.stem)
    return int(number[1]) if number else 0


def _files(top: Path) -> Iterator[Path]:
    for folder, folders, names in os.walk(top):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for path in (Path(folder, name) for name in sorted(names) if not name.startswith(".")):
            if path.suffix.lower() in SUFFIXES and path.is_file() and not path.is_symlink():
                yield path
