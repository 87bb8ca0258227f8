"""The student's state: small JSON files in the folder's .course/.

A student may close the laptop, fill the disk or open two kernels at any moment. Each file is
therefore replaced as a whole by renaming a complete draft, so a reader never sees half of one. What
cannot be written is kept in memory: a full disk must not prevent a student from checking an answer.
"""

import errno
import hashlib
import json
import os
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.host import in_notebook
from course_lib.third_party import read_json, read_text

STATE_FOLDER = ".course"
# Folder for files written by lessons and exercises. Their cells contain this name.
WRITTEN_FOLDER = "my_files"
# Sections of the state.
CHECKS, PACKED = "checks", "packed_files"
# Length of a cell's digest.
DIGITS = 12


def find_student_folder(start: Path | None = None) -> Path | None:
    """Return the student's folder containing `start` (default: the working directory), or None."""
    top = (start or Path.cwd()).resolve()
    return next((folder for folder in (top, *top.parents) if (folder / STATE_FOLDER).is_dir()), None)


# Values of each file that could not be written.
_unsaved: dict[Path, dict[str, Any]] = {}


class State:
    """Sections of keys and plain values. Without a folder they exist until the process ends."""

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        self._memory: dict[str, dict[str, Any]] = {}

    def section(self, name: str) -> dict[str, Any]:
        """Return all keys of a section like "predictions"; empty if nothing is stored."""
        path = self._path(name)
        if path is None:
            return dict(self._memory.get(name, {}))
        try:
            content = read_json(read_text(path))
        except FileNotFoundError:
            content = {}
        except ValueError as error:
            raise CourseError(f"{path} is broken ({error}). Delete it and run the cell again.") from error
        return (content if isinstance(content, dict) else {}) | _unsaved.get(path, {})

    def get(self, name: str, key: str) -> Any:
        """Return a value of a section, or None."""
        return self.section(name).get(key)

    def put(self, name: str, key: str, value: Any) -> None:
        """Store a plain value (str, number, bool, list or dict of these).

        If the file cannot be written, the value is kept in memory, and written with the next one.
        """
        section = self.section(name) | {key: value}
        path = self._path(name)
        if path is None:
            self._memory[name] = section
            return
        text = json.dumps(section, indent=1, ensure_ascii=False, sort_keys=True) + "\n"
        try:
            write_atomically(path, text.encode())
        except OSError as error:
            _unsaved.setdefault(path, {})[key] = value
            advice = _FREE_SPACE if error.errno in (errno.ENOSPC, errno.EDQUOT) else _OTHER_FOLDER
            reason = f"{path.parent} cannot be written: {error.strerror}"
            _print_once(f"{reason}. What you enter here is kept only {memory_span()}. {advice}")
        else:
            _unsaved.pop(path, None)

    def is_saved(self, name: str) -> bool:
        """Return whether all values of a section are in its file."""
        path = self._path(name)
        return path is not None and path not in _unsaved

    def _path(self, name: str) -> Path | None:
        return self.folder and self.folder / STATE_FOLDER / f"{name}.json"


_of_this_process = State(None)
_OTHER_FOLDER = "For a folder of your own, type in a terminal: course lab ~/my_course"
_FREE_SPACE = "Delete files that you do not need, and run this cell again."
_READ_ONLY = f"{{}} cannot be written, so what you enter here is kept only {{}}. {_OTHER_FOLDER}"


def memory_span() -> str:
    """Return until when a value that cannot be written is kept, for a sentence."""
    return "while this kernel lives" if in_notebook() else "until this command ends"


def student_state() -> State:
    """Return the state of the student's folder around the working directory, otherwise of this process."""
    return state_of(find_student_folder())


def state_of(folder: Path | None) -> State:
    """Return the state of a student's folder, or of this process if the folder is missing or read-only."""
    if folder is None:
        return _of_this_process
    if os.access(folder / STATE_FOLDER, os.W_OK):
        return State(folder)
    _print_once(_READ_ONLY.format(folder, memory_span()))
    return _of_this_process


@cache
def _print_once(text: str) -> None:
    print(text)  # noqa: T201  the cell's output, or the terminal's


@dataclass(frozen=True)
class LastCheck:
    """The last public check of a task.

    Args:
        time: Time of the check.
        passed: Whether all public checks passed and the task was not empty.
        cells: Digests of the cells that had been run before.
        student: The ID whose personal values were checked, "" for a guest; None if it is unknown.
        replaced: Digests of those cells whose names later cells had defined again.
    """

    time: datetime
    passed: bool
    cells: frozenset[str] = frozenset()
    student: str | None = None
    replaced: frozenset[str] = frozenset()


@dataclass(frozen=True)
class PackedSubmission:
    """The last file that `course submit` wrote for an exercise.

    Args:
        time: Time of packing, in ISO format.
        file: Path of the packed file.
        source: Path of the notebook.
        notebook: Digest of the notebook's cells.
        tasks: Short name and outcome of each task, like "passed", "failed" or "empty".
    """

    time: str
    file: str
    source: str
    notebook: str
    tasks: tuple[tuple[str, str], ...] = ()

    @property
    def by_outcome(self) -> dict[str, list[str]]:
        """The names of the tasks by outcome."""
        tasks: dict[str, list[str]] = {}
        for name, outcome in self.tasks:
            tasks.setdefault(outcome, []).append(name)
        return tasks


def cell_digest(text: str) -> str:
    """Return a short digest of a cell's source, ignoring blank lines around it."""
    return hashlib.sha256(text.strip().encode("utf-8", "replace")).hexdigest()[:DIGITS]


def save_check(
    state: State,
    task_id: str,
    *,
    passed: bool,
    cells: Iterable[str],
    student: str | None,
    replaced: Iterable[str] = (),
) -> None:
    """Store the time of a check, the student, and digests of these cells."""
    time = datetime.now(UTC).isoformat(timespec="seconds")
    digests = {
        name: sorted({cell_digest(cell) for cell in some})
        for name, some in {"cells": cells, "replaced": replaced}.items()
    }
    check = {"time": time, "passed": passed, "student": student or "", **digests}
    state.put(CHECKS, task_id, check)


def last_check(state: State, task_id: str) -> LastCheck | None:
    """Return the last check of a task, or None if there is none or its entry is unreadable."""
    match state.get(CHECKS, task_id):
        case {"time": str(time), "passed": bool(passed), "cells": list(cells), **others}:
            # Version 0.3 did not store the student.
            student = None if "student" not in others else str(others["student"])
            stored = others.get("replaced")
            replaced = frozenset(map(str, stored if isinstance(stored, list) else []))
            try:
                moment = datetime.fromisoformat(time)
                return LastCheck(moment, passed, frozenset(map(str, cells)), student, replaced)
            except ValueError:
                return None
    return None


def save_packed_submission(state: State, exercise: str, packed: PackedSubmission) -> None:
    """Store the data of the file that `course submit` has written."""
    state.put(PACKED, exercise, asdict(packed))


def last_packed_submission(state: State, exercise: str) -> PackedSubmission | None:
    """Return the last packed submission, or None if there is none or its entry is unreadable."""
    match state.get(PACKED, exercise):
        case {
            "time": str(time),
            "file": str(file),
            "source": str(source),
            "notebook": str(notebook),
            "tasks": list(tasks),
        }:
            pairs = (pair for pair in tasks if isinstance(pair, list) and len(pair) == 2)
            of_tasks = tuple((str(name), str(stood)) for name, stood in pairs)
            return PackedSubmission(time, file, source, notebook, of_tasks)
    return None
