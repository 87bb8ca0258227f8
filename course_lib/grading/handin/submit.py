"""`course submit`: one file to hand in, with a receipt and with warnings."""

import ast
import json
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any

from course_lib.course.exercise import find_notebook
from course_lib.course.hand_out import content_hash as digest_of_cells
from course_lib.course.identity import current_identity
from course_lib.course.installation import exercises_dir, first_lesson
from course_lib.course.state import (
    LastCheck,
    Packed,
    State,
    cell_digest,
    find_student_folder,
    keep_packed,
    last_check,
    saved_at,
    state_of,
)
from course_lib.errors import CourseError, counted
from course_lib.grading.catalog import shipped_catalog
from course_lib.grading.handin.archives import RECEIPT, WORKING_FOLDER, working_files
from course_lib.grading.handin.notebook import CodeCell, Notebook, parse_notebook
from course_lib.grading.handin.submission import NO_EXERCISE, content_hash, unpack
from course_lib.grading.task import Task

NO_ID = "It names no student: give your ID (open {}), submit again."


@dataclass(frozen=True)
class Standing:
    """The state of a task: an outcome for lists, and the rest of a warning behind its name."""

    outcome: str
    text: str = ""


class HandIn:
    """A notebook that is about to be handed in, held against what is known of its last checks.

    Args:
        path: The notebook's file.
        notebook: What it holds.
        tasks: The tasks of its exercise.
        state: Of the student's folder.
        own: The ID that the folder knows.
    """

    def __init__(
        self, path: Path, notebook: Notebook, tasks: Sequence[Task], state: State, own: str | None
    ) -> None:
        self._path, self._notebook, self._tasks, self._own = path, notebook, tasks, own
        pairs = zip(notebook.cells, notebook.ran, strict=True)
        self._cells = [CodeCell(number, text, ran) for number, (text, ran) in enumerate(pairs, 1)]
        found = ((task.id, last_check(state, task.id)) for task in tasks)
        self._checked: dict[str, LastCheck] = {name: last for name, last in found if last}
        self._handed_out = _handed_out(notebook.exercise or "")

    @cached_property
    def tasks(self) -> dict[str, Standing]:
        """The state of each task, by its short name."""
        return {task.id.split(".")[1]: self._stands(task) for task in self._tasks}

    def warnings(self) -> list[str]:
        """List what should be looked at, a sentence each."""
        found = [cell.syntax_error for cell in self._cells if cell.syntax_error]
        if self._tasks and not self._checked:
            found.append(f"it was never checked here: type course check {self._path.name} first")
        silent = {"passed"} if self._checked else {"passed", "unchecked"}
        found += [f"{name} {one.text}" for name, one in self.tasks.items() if one.outcome not in silent]
        return [*found, *self._loose_cells(), *self._saved_early(), *self._id()]

    def _stands(self, task: Task) -> Standing:
        cell, last = self._own_cell(task), self._checked.get(task.id)
        if cell is None:
            return Standing("missing", f"is missing: no cell makes {task.name}")
        as_checked = last is not None and cell.digest in last.cells
        if last is not None and last.passed and as_checked:
            return Standing("passed")
        if cell.digest in self._handed_out:
            return Standing("empty", f"is empty: {cell.name} is as it was handed out")
        if cell.is_stub:
            return Standing("empty", f"is not complete: {cell.name} still raises NotImplementedError")
        if cell.syntax_error:
            return Standing("broken", f"cannot run: {cell.name} is not valid Python")
        if last is None:
            return Standing("unchecked", "was never checked")
        if last.cells and not as_checked:
            text = f"has changed since its last check: run {cell.name} and check it again"
            return Standing("changed since its check", text)
        return Standing("passed") if last.passed else Standing("failed", "failed its last check")

    def _own_cell(self, task: Task) -> CodeCell | None:
        """Return the cell that makes what a task asks for, or the stub in its place."""
        calls = [cell for cell in self._cells if task.id in cell.checks]
        given = calls[-1].checks[task.id] if calls else ast.Name(task.name)
        if not isinstance(given, ast.Name):
            return calls[-1]
        makers = [cell for cell in self._cells if given.id in cell.gives]
        if makers:
            return makers[-1]
        broken = [cell for cell in self._cells if cell.syntax_error and given.id in cell.source]
        before = self._cells[calls[-1].number - 2 : calls[-1].number - 1] if calls else []
        return next((cell for cell in (*broken, *before) if cell.syntax_error or cell.is_stub), None)

    def _loose_cells(self) -> Iterator[str]:
        """Name the cells of no task that no check has seen, up to the last check."""
        seen = frozenset[str]().union(*(last.cells for last in self._checked.values()))
        if not seen and not any(cell.ran for cell in self._cells):
            return  # nothing is known of any cell
        of_tasks = [self._own_cell(task) for task in self._tasks]
        end = max((cell.number for cell in self._cells if cell.checks), default=0)
        for cell in self._cells[:end]:
            if not cell.source.strip() or cell in of_tasks or cell.checks or cell.digest in seen:
                continue
            if not cell.ran:
                yield f"{cell.name} was never run"
            elif seen:
                yield f"{cell.name} has changed since the last check"

    def _saved_early(self) -> Iterator[str]:
        """Warn where the last check was made with something that the saved file may not hold."""
        if not self._checked:
            return
        last, saved = max(one.time for one in self._checked.values()), saved_at(self._path)
        unseen = any(one.outcome not in ("passed", "failed") for one in self.tasks.values())
        known = all(one.cells for one in self._checked.values())
        if saved < last and (unseen or not known):
            yield (
                f"the notebook was saved at {_clock(saved)}, before the last check at {_clock(last)}: if it "
                "has changes that are not saved, press Ctrl+S and submit again"
            )

    def _id(self) -> Iterator[str]:
        named = self._notebook.student
        if named and self._own and named != self._own:
            yield (
                f"{self._path.name} names the student {named}, but your ID is {self._own}: open "
                f"{first_lesson()}, or type set_identity('{self._own}') in a cell, then submit again"
            )


def _clock(time: datetime) -> str:
    return f"{time.astimezone():%H:%M:%S on %d %b}"


def _handed_out(exercise: str) -> frozenset[str]:
    """Return the digests of an exercise's cells as students get it."""
    path = exercises_dir() / f"{exercise}.ipynb"
    try:
        return frozenset(map(cell_digest, parse_notebook(path.read_bytes(), path.name).cells))
    except (OSError, CourseError):
        return frozenset()


def report(warnings: Sequence[str], file: str) -> str:
    """Return the lines for the terminal, or "" where there is nothing to warn of."""
    if not warnings:
        return ""
    lines = "".join(f"\n  - {line}" for line in warnings)
    return (
        f"\nIt is packed, but look at {counted(len(warnings), 'thing')} before you hand it in:{lines}\n"
        f"Then save the notebook and type again: course submit {file}"
    )


@dataclass(frozen=True)
class Receipt:
    """The packed file, the content of its receipt, and warnings before it is handed in."""

    file: Path
    content: Mapping[str, Any]
    warnings: tuple[str, ...] = ()

    def text(self) -> str:
        """Return the lines for the student."""
        rows = "".join(f"\n  {key:11} {value or 'none'}" for key, value in self.content.items())
        no_id = "" if self.content["student"] else f"\n{NO_ID.format(first_lesson())}"
        warned = report(self.warnings, self.content["file"])
        return f"Wrote {self.file}: this is the file to hand in. Its receipt:{rows}{no_id}{warned}"


def submit(path: Path, out: Path | None = None) -> Receipt:
    """Pack an exercise with a receipt into `out`; default: beside it, named after it and the ID.

    Raises:
        CourseError: The notebook can't be read, is not an exercise, or the file can't be written.
    """
    path = find_notebook(path)
    data, _ = unpack(path)
    notebook = parse_notebook(data, path.name)
    if notebook.exercise is None:
        raise CourseError(f"{path} {NO_EXERCISE}")
    student = notebook.student or current_identity()
    files = working_files(path, notebook.cells)
    receipt = {
        "exercise": notebook.exercise,
        "student": student,
        "file": path.name,
        "code cells": len(notebook.cells),
        "files": ", ".join(files),
        "sha256": content_hash(data, files),
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
    }
    out = out or path.with_name(f"{notebook.exercise}_{student or 'no_id'}.zip")
    _write(out, receipt, data, files)
    try:
        warnings = _remember(path, notebook, out, str(receipt["time"]))
    except CourseError as error:  # it is packed: what the folder remembers must not say otherwise
        warnings = [str(error)]
    return Receipt(out, receipt, tuple(warnings))


def _write(out: Path, receipt: Mapping[str, Any], data: bytes, files: Mapping[str, str]) -> None:
    try:
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr(f"{receipt['exercise']}.ipynb", data)
            archive.writestr(RECEIPT, json.dumps(receipt, indent=1))
            for name, text in files.items():
                archive.writestr(WORKING_FOLDER + name, text)
    except OSError as error:
        raise CourseError(f"{out} can't be written: {error.strerror}. Name another: --out FILE") from error


def _remember(path: Path, notebook: Notebook, out: Path, time: str) -> list[str]:
    """Keep what was packed in the student's folder, for `course status`; return the warnings."""
    folder, exercise = find_student_folder(path.parent), notebook.exercise or ""
    state = state_of(folder)
    if folder is not None:
        state.put("packed", exercise, time)
    of_week = shipped_catalog().of_week(exercise.split("_")[0])
    hand_in = HandIn(path, notebook, of_week, state, state.get("identity", "student") or current_identity())
    if folder is not None and path.suffix == ".ipynb":
        tasks = tuple((name, one.outcome) for name, one in hand_in.tasks.items())
        files = str(out.resolve()), str(path.resolve())
        keep_packed(state, exercise, Packed(time, *files, digest_of_cells(path), tasks))
    return hand_in.warnings()
