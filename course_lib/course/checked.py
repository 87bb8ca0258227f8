"""What the student's folder remembers of checks and of packed files, beside the points."""

import hashlib
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path

from course_lib.course.state import State

CHECKS, PACKED = "checks", "packed_files"  # sections of the state
DIGITS = 12  # of a cell's digest


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
