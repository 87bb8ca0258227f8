"""`course submit`: write one file to submit, with a receipt and with warnings."""

import ast
import io
import json
import os
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any

from course_lib.course.exercise import SET_IDENTITY, current_identity, find_notebook
from course_lib.course.material import exercises_dir, first_lesson
from course_lib.course.state import (
    LastCheck,
    PackedSubmission,
    State,
    cell_digest,
    find_student_folder,
    last_check,
    save_packed_submission,
    state_of,
)
from course_lib.course.student_folder import content_hash as digest_of_cells
from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically
from course_lib.grading.submissions.archives import RECEIPT, WORKING_FOLDER, working_files
from course_lib.grading.submissions.notebook import (
    NOT_SUBMITTED,
    CodeCell,
    Notebook,
    own_modules,
    parse_notebook,
)
from course_lib.grading.submissions.submission import NO_EXERCISE, content_hash, unpack
from course_lib.grading.task import Task, shipped_catalog
from course_lib.third_party import read_bytes

NO_ID = "it has no student ID. Enter your ID (open {}) and run the command again"


@dataclass(frozen=True)
class TaskState:
    """A task's state: an outcome for lists, and a warning after the task's name, or ""."""

    outcome: str
    text: str = ""


class NotebookReview:
    """A notebook that is about to be submitted, compared with the results of its last checks.

    Args:
        path: The notebook's file.
        notebook: The parsed notebook.
        tasks: The tasks of its exercise.
        state: The state stored in the student's folder.
        identity: The ID stored in the student's folder.
    """

    def __init__(
        self,
        path: Path,
        notebook: Notebook,
        tasks: Sequence[Task],
        state: State,
        identity: str | None,
    ) -> None:
        self._path, self._notebook, self._tasks, self._identity = path, notebook, tasks, identity
        pairs = zip(notebook.cells, notebook.was_run, strict=True)
        self._cells = [CodeCell(number, text, was_run) for number, (text, was_run) in enumerate(pairs, 1)]
        checks = ((task.id, last_check(state, task.id)) for task in tasks)
        self._last_checks: dict[str, LastCheck] = {name: last for name, last in checks if last}
        self._released_digests = _released_digests(notebook.exercise or "")

    @cached_property
    def tasks(self) -> dict[str, TaskState]:
        """The state of each task, by its short name."""
        return {task.id.split(".")[1]: self._assess(task) for task in self._tasks}

    @property
    def passed_count(self) -> int:
        """The number of tasks that are as they were when they passed their check."""
        return sum(task.outcome == "passed" for task in self.tasks.values())

    def warnings(self) -> list[str]:
        """Return warnings, one sentence each."""
        problems = [cell.syntax_error for cell in self._cells if cell.syntax_error]
        if self._path.suffix == ".ipynb":
            problems += map(NOT_SUBMITTED.format, own_modules(self._path, self._notebook.cells))
        if self._tasks and not self._last_checks:
            problems.append(f"it was never checked here: run course check {_path_to_type(self._path)} first")
        silent = {"passed"} if self._last_checks else {"passed", "unchecked"}
        states = [(name, task) for name, task in self.tasks.items() if task.outcome not in silent]
        problems += [f"{name} {task.text}" for name, task in states if task.text]
        problems += [*self._unchecked_cells(), *self._unsaved_warning()]
        stored_id = self._notebook.student
        if stored_id and self._identity and stored_id != self._identity:
            problems.append(
                f"{self._path.name} has the student ID {stored_id}, but yours is {self._identity}: "
                f"open {first_lesson()}, or type {SET_IDENTITY.format(self._identity)} in a cell, "
                "then submit again"
            )
        return problems

    def _assess(self, task: Task) -> TaskState:
        cell, last = self._own_cell(task), self._last_checks.get(task.id)
        if cell is None:
            return TaskState("missing", f"is missing: no cell defines {task.name}")
        # The saved file may contain a version that was run before the checked one.
        as_checked = last is not None and cell.digest in last.cells - last.replaced
        student = self._identity or self._notebook.student or ""
        if task.personal and last is not None and last.student not in (None, student):
            whose = f"for the ID {last.student}" if last.student else "without an ID"
            text = f"was last checked {whose}, with other numbers than yours: check it again"
            return TaskState("changed since its check", text)
        # A stub that was run before the right answer is among the checked cells, too.
        if last is not None and last.passed and as_checked and not cell.is_stub:
            return TaskState("passed")
        if cell.digest in self._released_digests:
            # A bonus task may stay empty.
            _, is_bonus = shipped_catalog().points(task)
            return TaskState("empty", "" if is_bonus else f"is empty: {cell.name} is unchanged")
        if cell.is_stub:
            return TaskState("empty", f"is not complete: {cell.name} still raises NotImplementedError")
        if cell.syntax_error:
            return TaskState("broken", f"cannot run: {cell.name} is not valid Python")
        if last is None:
            return TaskState("unchecked", "was never checked")
        if last.cells and not as_checked:
            text = f"has changed since its last check: run {cell.name} and check it again"
            return TaskState("changed since its check", text)
        return TaskState("passed") if last.passed else TaskState("failed", "failed its last check")

    def _own_cell(self, task: Task) -> CodeCell | None:
        """Return the cell that defines a task's object, or the stub in its place."""
        calls = [cell for cell in self._cells if task.id in cell.checks]
        argument = calls[-1].checks[task.id] if calls else ast.Name(task.name)
        if not isinstance(argument, ast.Name):
            return calls[-1]
        makers = [cell for cell in self._cells if argument.id in cell.bindings]
        if makers:
            return makers[-1]
        unparsable = [cell for cell in self._cells if cell.syntax_error and argument.id in cell.source]
        before = self._cells[calls[-1].number - 2 : calls[-1].number - 1] if calls else []
        return next((cell for cell in (*unparsable, *before) if cell.syntax_error or cell.is_stub), None)

    def _unchecked_cells(self) -> Iterator[str]:
        """Yield a warning for each unchecked cell before the last check, if a task depends on it.

        Students measure and try things in other cells, which need no check.
        """
        checked_digests = frozenset[str]().union(*(last.cells for last in self._last_checks.values()))
        if not checked_digests and not any(cell.was_run for cell in self._cells):
            # Nothing is known about any cell.
            return
        of_tasks = [self._own_cell(task) for task in self._tasks]
        end = max((cell.number for cell in self._cells if cell.checks), default=0)
        names = self._names_of_tasks([cell for cell in of_tasks if cell is not None])
        for cell in self._cells[:end]:
            if cell in of_tasks or cell.checks or cell.digest in checked_digests:
                continue
            # A missing task may be in a cell that now defines another name.
            may_be_task = None in of_tasks and cell.bindings
            if names.isdisjoint(cell.changed_names) and not may_be_task:
                continue
            if not cell.was_run:
                yield f"{cell.name} was never run"
            elif checked_digests:
                yield f"{cell.name} has changed since the last check"

    def _names_of_tasks(self, of_tasks: Iterable[CodeCell]) -> frozenset[str]:
        """Return the names that the tasks use, directly or in other cells."""
        names = frozenset[str]().union(*(cell.used_names for cell in of_tasks))
        while True:
            definitions = [cell.used_names for cell in self._cells if names & cell.bindings]
            if (more := names.union(*definitions)) == names:
                return names
            names = more

    def _unsaved_warning(self) -> Iterator[str]:
        """Warn if the last check may have used changes that are not in the saved file."""
        if not self._last_checks:
            return
        last_check = max(value.time for value in self._last_checks.values())
        save_time = datetime.fromtimestamp(self._path.stat().st_mtime, UTC)
        unseen = any(task.outcome not in ("passed", "failed") for task in self.tasks.values())
        has_digests = all(check.cells for check in self._last_checks.values())
        if save_time >= last_check or not (unseen or not has_digests):
            return
        if last_check > datetime.now(UTC):
            # To save again would not help.
            yield (
                f"the last check was at {_format_time(last_check)}, in the future: the clock of "
                f"this computer was changed. Run: course check {_path_to_type(self._path)}"
            )
        else:
            yield (
                f"the notebook was saved at {_format_time(save_time)}, before the last check at "
                f"{_format_time(last_check)}: if it has unsaved changes, press Ctrl+S and submit "
                "again"
            )


def _path_to_type(path: Path) -> str:
    """Return a path as it is typed in a terminal in the current folder."""
    absolute = path.resolve()
    inner = absolute.relative_to(Path.cwd()) if absolute.is_relative_to(Path.cwd()) else path
    return f'"{inner}"' if " " in str(inner) else str(inner)


def _format_time(time: datetime) -> str:
    return f"{time.astimezone():%H:%M:%S on %d %b %Y}"


def _released_digests(exercise: str) -> frozenset[str]:
    """Return the digests of the cells in the unchanged exercise."""
    path = exercises_dir() / f"{exercise}.ipynb"
    try:
        return frozenset(map(cell_digest, parse_notebook(read_bytes(path), path.name).cells))
    except (OSError, CourseError):
        return frozenset()


def report(warnings: Sequence[str], file: str) -> str:
    """Return the warnings as lines for the terminal, or ""."""
    if not warnings:
        return ""
    lines = "".join(f"\n  - {line}" for line in warnings)
    return (
        f"\nIt is packed, but check {format_count(len(warnings), 'thing')} before you submit it:{lines}\n"
        f"Then save the notebook and run again: course submit {file}"
    )


@dataclass(frozen=True)
class Receipt:
    """The packed file, the content of its receipt, and warnings about the notebook."""

    file: Path
    notebook: Path
    content: Mapping[str, Any]
    warnings: tuple[str, ...] = ()

    def text(self) -> str:
        """Return the lines for the student."""
        rows = "".join(f"\n  {key:11} {value or 'none'}" for key, value in self.content.items())
        warned = report(self.warnings, _path_to_type(self.notebook))
        missing_id = NO_ID.format(first_lesson())
        what = "this is the file to submit" if self.content["student"] else missing_id
        return f"Wrote {self.file.resolve()}: {what}. Its receipt:{rows}{warned}"


def submit(path: Path, out: Path | None = None) -> Receipt:
    """Pack an exercise with a receipt into `out`; default: next to it, named after it and the ID.

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
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(f"{notebook.exercise}.ipynb", data)
        archive.writestr(RECEIPT, json.dumps(receipt, indent=1))
        for name, text in files.items():
            archive.writestr(WORKING_FOLDER + name, text)
    try:
        write_atomically(Path(os.path.realpath(out)), packed.getvalue())
    except OSError as error:
        raise CourseError(f"{out} can't be written: {error.strerror}. Choose another: --out FILE") from error
    try:
        warnings = _record_submission(path, notebook, out, str(receipt["time"]))
    except (CourseError, OSError) as error:
        # The file is packed already, so an error in the folder's state is only a warning.
        warnings = [str(error)]
    return Receipt(out, path, receipt, tuple(warnings))


def _record_submission(path: Path, notebook: Notebook, out: Path, time: str) -> list[str]:
    """Record the packed file in the student's folder for `course status`; return the warnings."""
    folder, exercise = find_student_folder(path.parent), notebook.exercise or ""
    state = state_of(folder)
    if folder is not None:
        state.put("packed", exercise, time)
    tasks_of_week = shipped_catalog().tasks_of_week(exercise.split("_")[0])
    identity = state.get("identity", "student") or current_identity()
    hand_in = NotebookReview(path, notebook, tasks_of_week, state, identity)
    if folder is not None and path.suffix == ".ipynb":
        tasks = tuple((name, task.outcome) for name, task in hand_in.tasks.items())
        files = str(out.resolve()), str(path.resolve())
        save_packed_submission(state, exercise, PackedSubmission(time, *files, digest_of_cells(path), tasks))
    problems = hand_in.warnings()
    for other in sorted(path.parent.glob("*.ipynb")) if hand_in.passed_count < len(tasks_of_week) else ():
        with suppress(CourseError, OSError):
            copy = parse_notebook(read_bytes(other), other.name)
            review = NotebookReview(other, copy, tasks_of_week, state, identity)
            if copy.exercise == exercise and review.passed_count > hand_in.passed_count:
                problems.append(
                    f"{other.name} has {format_count(review.passed_count, 'task')} that passed, "
                    f"this notebook {hand_in.passed_count}: to submit that one, type course "
                    f"submit {_path_to_type(other)}"
                )
    return problems
