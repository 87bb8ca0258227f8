"""The student's state: small JSON files in the folder's .course/, each written whole or not at all."""

import hashlib
import json
import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import cache, partial
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.foreign import read_json

STATE_FOLDER = ".course"
WRITTEN_FOLDER = "my_files"  # for what lessons and exercises write; the cells name it
CHECKS, PACKED = "checks", "packed_files"  # sections of the state
DIGITS = 12  # of a cell's digest


def write_whole(path: Path, data: bytes, mode: int = 0o666) -> None:
    """Write a file aside, on the disk for certain, then rename it; its folder is made.

    Args:
        path: The file.
        data: All of it.
        mode: Its permissions, less those that the umask takes away.

    Raises:
        OSError: It can't be written; names the file itself.
    """
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        draft.unlink(missing_ok=True)  # its permissions may be others
        with open(draft, "wb", opener=partial(os.open, mode=mode)) as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        draft.replace(path)
    except BaseException as error:
        with suppress(OSError):
            draft.unlink()  # on a full disk half a file would only be in the way
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def find_student_folder(start: Path | None = None) -> Path | None:
    """Return the student's folder that holds `start` (default: the working directory), or None."""
    here = (start or Path.cwd()).resolve()
    return next((folder for folder in (here, *here.parents) if (folder / STATE_FOLDER).is_dir()), None)


class State:
    """Sections of keys and plain values. Without a folder it lives as long as the process."""

    def __init__(self, folder: Path | None) -> None:
        self.folder = folder
        self._memory: dict[str, dict[str, Any]] = {}

    def section(self, name: str) -> dict[str, Any]:
        """Return all keys of one section, e.g. "predictions"; empty if nothing is stored."""
        path = self._path(name)
        if path is None:
            return dict(self._memory.get(name, {}))
        try:
            kept = read_json(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return {}
        except ValueError as error:
            raise CourseError(f"{path} is broken ({error}). Delete it and run the cell again.") from error
        return kept if isinstance(kept, dict) else {}

    def get(self, name: str, key: str, default: Any = None) -> Any:
        """Return one value of a section."""
        return self.section(name).get(key, default)

    def put(self, name: str, key: str, value: Any) -> None:
        """Keep one plain value (str, number, bool, list or dict of these)."""
        section = self.section(name) | {key: value}
        path = self._path(name)
        if path is None:
            self._memory[name] = section
        else:
            text = json.dumps(section, indent=1, ensure_ascii=False, sort_keys=True) + "\n"
            write_whole(path, text.encode())

    def _path(self, name: str) -> Path | None:
        return self.folder and self.folder / STATE_FOLDER / f"{name}.json"


_of_this_process = State(None)
_READ_ONLY = (
    "{} cannot be written, so what you enter here is kept only while this kernel lives. "
    "For a folder of your own, type in a terminal: course lab ~/my_course"
)


def student_state() -> State:
    """Return the state of the student's folder around the working directory, else of this process."""
    return state_of(find_student_folder())


def state_of(folder: Path | None) -> State:
    """Return the state of a student's folder; of this process, where there is none or it is read-only."""
    if folder is None:
        return _of_this_process
    if os.access(folder / STATE_FOLDER, os.W_OK):
        return State(folder)
    _say_once(_READ_ONLY.format(folder))
    return _of_this_process


@cache
def _say_once(text: str) -> None:
    print(text)  # noqa: T201  the cell's output, or the terminal's


@dataclass(frozen=True)
class LastCheck:
    """The last public check of one task.

    Args:
        time: When.
        passed: Whether every public check passed and something was filled in.
        cells: Digests of the cells that had been run by then.
    """

    time: datetime
    passed: bool
    cells: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Packed:
    """The last file that `course submit` made of an exercise.

    Args:
        time: When, in ISO format.
        file: Where it was written.
        source: The notebook's file.
        notebook: A digest of the notebook's cells.
        tasks: Short name of each task and a word for how it stood: "passed", "failed", "empty" …
    """

    time: str
    file: str
    source: str
    notebook: str
    tasks: tuple[tuple[str, str], ...] = ()

    @property
    def by_outcome(self) -> dict[str, list[str]]:
        """The tasks, by how they stood."""
        found: dict[str, list[str]] = {}
        for name, outcome in self.tasks:
            found.setdefault(outcome, []).append(name)
        return found


def cell_digest(text: str) -> str:
    """Return a short digest of a cell's source; blank lines around it do not count."""
    return hashlib.sha256(text.strip().encode("utf-8", "replace")).hexdigest()[:DIGITS]


def keep_check(state: State, task_id: str, *, passed: bool, cells: Iterable[str]) -> None:
    """Remember that a task was checked now, with these cells' sources."""
    time = datetime.now(UTC).isoformat(timespec="seconds")
    digests = sorted({cell_digest(cell) for cell in cells})
    state.put(CHECKS, task_id, {"time": time, "passed": passed, "cells": digests})


def last_check(state: State, task_id: str) -> LastCheck | None:
    """Return the last check of a task; None if there was none, or its entry cannot be read."""
    match state.get(CHECKS, task_id):
        case {"time": str(time), "passed": bool(passed), "cells": list(cells)}:
            try:
                return LastCheck(datetime.fromisoformat(time), passed, frozenset(map(str, cells)))
            except ValueError:
                return None
    return None


def keep_packed(state: State, exercise: str, packed: Packed) -> None:
    """Remember what `course submit` has packed."""
    state.put(PACKED, exercise, asdict(packed))


def last_packed(state: State, exercise: str) -> Packed | None:
    """Return what was packed last; None if nothing was, or its entry cannot be read."""
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
            return Packed(time, file, source, notebook, of_tasks)
    return None


def saved_at(path: Path) -> datetime:
    """Return when a file was last written."""
    return datetime.fromtimestamp(path.stat().st_mtime, UTC)
