"""Finding what students handed in: notebooks, and the files that `course submit` writes."""

import hashlib
import json
import os
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from course_lib.course.identity import normalise
from course_lib.errors import CourseError
from course_lib.grading.notebook import MAX_BYTES, Notebook, parse_notebook
from course_lib.grading.received import Received, received

RECEIPT = "receipt.json"
MAX_RECEIPT = 100_000  # [B]
SUFFIXES = (".ipynb", ".zip")


@dataclass(frozen=True)
class Submission:
    """One handed-in exercise.

    Args:
        student: Who handed it in: the name of the folder it lies in, else the ID that it claims.
        exercise: "week01_exercise"; the file's own name if that can't be told.
        path: The file.
        received: When, and how that is known.
        notebook: Its cells and claims; None if it can't be read.
        claimed: The ID that the file itself names; personal values derive from it.
        sha256: Of the notebook.
        problem: Why it can't be graded, or "".
        notes: For staff.
    """

    student: str
    exercise: str
    path: Path
    received: Received
    notebook: Notebook | None = None
    claimed: str | None = None
    sha256: str = ""
    problem: str = ""
    notes: tuple[str, ...] = ()


def find_submissions(top: Path) -> list[Submission]:
    """The newest submission of each student and exercise, by student and exercise.

    Raises:
        CourseError: `top` is no folder, or holds no submission.
    """
    if not top.is_dir():
        raise CourseError(f"{top} is no folder. Name the one with a folder per student: course grade FOLDER")
    newest: dict[tuple[str, str], Submission] = {}
    for path in _files(top):
        found = read_submission(path, top)
        key = found.student, found.exercise
        if key not in newest or newest[key].received.time <= found.received.time:
            newest[key] = found
    if not newest:
        raise CourseError(f"{top} holds no submission: expected STUDENT/week01_exercise.ipynb in it")
    return [newest[key] for key in sorted(newest)]


def read_submission(path: Path, top: Path) -> Submission:
    """Read one file; what is wrong with it is in its `problem`."""
    receipt: Mapping[str, Any] = {}
    folders = path.relative_to(top).parts[:-1]
    try:
        data, receipt = unpack(path)
        notebook = parse_notebook(data, path.name)
    except CourseError as error:
        student, named = folders[0] if folders else path.stem, exercise_of(None, path) or path.name
        return Submission(student, named, path, received(path, top, receipt), problem=str(error))
    claimed = _identity(notebook.student) or _identity(receipt.get("student"))
    student = folders[0] if folders else claimed or path.stem
    exercise = exercise_of(notebook, Path(str(receipt.get("exercise", path.name))))
    return Submission(
        student=student,
        exercise=exercise or path.name,
        path=path,
        received=received(path, top, receipt),
        notebook=notebook,
        claimed=claimed,
        sha256=hashlib.sha256(data).hexdigest(),
        problem="" if exercise else "no exercise of this course: expected a file like week01_exercise.ipynb",
        notes=_notes(student, claimed),
    )


def exercise_of(notebook: Notebook | None, path: Path) -> str | None:
    """Which exercise a notebook is, by its metadata, else by its file's name; None if neither says."""
    claims = notebook.exercise if notebook and notebook.exercise else path.name
    named = re.match(r"(week\d\d)_exercise", claims)
    return f"{named[1]}_exercise" if named else None


def unpack(path: Path) -> tuple[bytes, Mapping[str, Any]]:
    """A notebook's bytes and the receipt that came with it, if one did.

    Raises:
        CourseError: The file is missing, a folder, or no file that `course submit` wrote.
    """
    try:
        if path.suffix != ".zip":
            return path.read_bytes(), {}
        with zipfile.ZipFile(path) as archive:
            receipt = json.loads(_member(archive, RECEIPT, MAX_RECEIPT))
            return _member(archive, f"{receipt['exercise']}.ipynb", MAX_BYTES), receipt
    except OSError as error:
        raise CourseError(f"{path} can't be read: {error.strerror or error}. Name a notebook.") from error
    except (
        ValueError,
        KeyError,
        TypeError,
        RecursionError,
        NotImplementedError,
        zipfile.BadZipFile,
    ) as error:
        raise CourseError(f"{path.name} is not a file that `course submit` wrote ({error})") from error


def _member(archive: zipfile.ZipFile, name: str, limit: int) -> bytes:
    with archive.open(name) as member:
        data = member.read(limit + 1)  # what the archive says of its sizes need not be true
    if len(data) > limit:
        raise ValueError(f"{name} is larger than {limit} bytes")
    return data


def _files(top: Path) -> Iterator[Path]:
    for folder, folders, names in os.walk(top):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for name in sorted(names):
            path = Path(folder, name)
            if path.suffix in SUFFIXES and not name.startswith(".") and not path.is_symlink():
                yield path


def _identity(claim: Any) -> str | None:
    """An ID that a file claims, if it is one: it may become a folder's name."""
    try:
        return normalise(claim) if isinstance(claim, str) else None
    except CourseError:
        return None


def _notes(student: str, claimed: str | None) -> tuple[str, ...]:
    if claimed is None:
        return ("the file names no student: personal values are those of a guest",)
    if claimed.casefold() != student.casefold():
        return (f"the file names {claimed}, but {student} handed it in",)
    return ()
