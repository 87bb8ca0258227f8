"""The student's state: small JSON files in the folder's .course/.

A student may close the laptop, fill the disk or open two kernels at any moment. Each file is
therefore replaced as a whole by renaming a complete draft, so a reader never sees half of one. What
cannot be written is kept in memory: a full disk must not prevent a student from checking an answer.
"""

import errno
import hashlib
import json
import os
import platform
import sys
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.files import write_atomically
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
            _print_once(f"{path.parent} cannot be written: {error.strerror}. {_IN_MEMORY} {advice}")
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
_IN_MEMORY = "What you enter here is kept only while this kernel lives."
_READ_ONLY = (
    f"{{}} cannot be written, so what you enter here is kept only while this kernel lives. {_OTHER_FOLDER}"
)


def student_state() -> State:
    """Return the state of the student's folder around the working directory, otherwise of this process."""
    return state_of(find_student_folder())


def state_of(folder: Path | None) -> State:
    """Return the state of a student's folder, or of this process if the folder is missing or read-only."""
    if folder is None:
        return _of_this_process
    if os.access(folder / STATE_FOLDER, os.W_OK):
        return State(folder)
    _print_once(_READ_ONLY.format(folder))
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
    """

    time: datetime
    passed: bool
    cells: frozenset[str] = frozenset()
    student: str | None = None


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
    state: State, task_id: str, *, passed: bool, cells: Iterable[str], student: str | None
) -> None:
    """Store the time of a check, the student, and digests of these cells."""
    time = datetime.now(UTC).isoformat(timespec="seconds")
    digests = sorted({cell_digest(cell) for cell in cells})
    check = {"time": time, "passed": passed, "cells": digests, "student": student or ""}
    state.put(CHECKS, task_id, check)


def last_check(state: State, task_id: str) -> LastCheck | None:
    """Return the last check of a task, or None if there is none or its entry is unreadable."""
    match state.get(CHECKS, task_id):
        case {"time": str(time), "passed": bool(passed), "cells": list(cells), **others}:
            # Version 0.3 did not store the student.
            student = None if "student" not in others else str(others["student"])
            try:
                return LastCheck(datetime.fromisoformat(time), passed, frozenset(map(str, cells)), student)
            except ValueError:
                return None
    return None


def save_packed_submission(state: State, exercise: str, packed: PackedSubmission) -> None:
    """Store what `course submit` has packed."""
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


PACKAGE = Path(__file__).resolve().parent.parent
DISTRIBUTION = "course-lib"
REPAIR = "pip install -e ."
# Entry-point group of the packages of courses.
GROUP = "course_lib.course"
CHOICE = "COURSE_PACKAGE"


def course_package() -> Path:
    """Return the folder of the course's package.

    Without an installed course, this is the kit itself. If several courses are installed, the one
    whose project contains the current folder is used, otherwise the one that COURSE_PACKAGE names.

    Raises:
        CourseError: Several courses are installed and none is selected.
    """
    packages = _installed_courses()
    if len(packages) <= 1:
        return next(iter(packages.values()), PACKAGE)
    candidates = [p for p in packages.values() if Path.cwd().is_relative_to(p.parent)]
    candidates += [p for name, p in packages.items() if name == os.environ.get(CHOICE)]
    if not candidates:
        raise CourseError(
            f"several courses are installed: {', '.join(sorted(packages))}. Change to the folder "
            f"of one, or select it: export {CHOICE}={min(packages)}"
        )
    return candidates[0]


@cache
def _installed_courses() -> dict[str, Path]:
    """Return the package folders of installed courses by name, without importing the packages."""
    specs = {e.value: find_spec(e.value) for e in metadata.entry_points(group=GROUP)}
    return {name: Path(spec.origin).resolve().parent for name, spec in specs.items() if spec and spec.origin}


def material_root() -> Path:
    """Return the folder with `notebooks/` and `exercises/`, in an installed wheel or the checkout.

    Raises:
        CourseError: The installation contains neither.
    """
    package = course_package()
    for root in (package / "_course", package.parent):
        if (root / "notebooks").is_dir() and (root / "exercises").is_dir():
            return root
    raise CourseError(
        f"there are no lessons next to {package}: this installation is incomplete. "
        "Install again: pip install -e ."
    )


def lessons_dir() -> Path:
    """Return the folder of the lessons, `weekNN_*.ipynb`."""
    return material_root() / "notebooks"


def lessons() -> list[Path]:
    """Return the lessons of all weeks in order. Reviews are not lessons."""
    return sorted(set(lessons_dir().glob("week*.ipynb")) - set(reviews()))


def reviews() -> list[Path]:
    """Return the reviews, `weekNN_your_review.ipynb`, in order.

    Each belongs to the week in its name.
    """
    return sorted(lessons_dir().glob("week*_your_review.ipynb"))


def first_lesson() -> str:
    """Return the file name of the first lesson, in which students enter their ID."""
    return next((path.name for path in lessons()), "the first lesson")


def extras() -> list[Path]:
    """Return the optional lessons, `extra_*.ipynb`, which belong to no week."""
    return sorted(lessons_dir().glob("extra_*.ipynb"))


def exercises_dir() -> Path:
    """Return the folder of the exercises, `course.toml`, public checks, quizzes and assets."""
    return material_root() / "exercises"


ASSETS = "assets"  # the folder of a course's own files, in exercises/ and in a student's folder


def asset_files(folder: Path) -> list[Path]:
    """Return the files of an assets folder, except caches of Python and backups of editors."""
    files = filter(Path.is_file, folder.rglob("*"))
    return sorted(path for path in files if not _is_left_over(path.relative_to(folder)))


def _is_left_over(path: Path) -> bool:
    return any(part.startswith(".") or part == "__pycache__" for part in path.parts)


def reject_other_course() -> None:
    """Raise a CourseError if the current folder belongs to a course that is not installed.

    Its settings would be ignored, such as the time zone of a collection.
    """
    root = course_package().parent
    for folder in (Path.cwd(), *Path.cwd().parents):
        if (
            folder != root
            and (folder / "exercises" / "course.toml").is_file()
            and (folder / "solutions").is_dir()
        ):
            raise CourseError(
                f"{folder} is a course that is not installed; the installed one is {root}. "
                f"To work on this one, run: pip install -e '{folder}'\n"
                f"To work on the installed one, run: cd '{root}'"
            )


def checkout_root() -> Path:
    """Return the instructors' checkout, the only place with solutions and hidden checks.

    Raises:
        CourseError: The installation is a student's copy or a wheel, or the current folder belongs
            to a course that is not installed.
    """
    root = course_package().parent
    reject_other_course()
    if (root / "solutions").is_dir() and (root / "pyproject.toml").is_file():
        return root
    raise CourseError(
        f"{root} contains no solutions, which only the instructors' checkout has. "
        "Clone the course's repository, then run there: pip install -e ."
    )


def solutions_dir() -> Path:
    """Return the folder of solved exercises and hidden checks, which only instructors have."""
    return checkout_root() / "solutions"


@dataclass(frozen=True)
class VersionCheck:
    """The required and the installed version of a package."""

    name: str
    required: str
    installed: str | None
    is_satisfied: bool

    @property
    def line(self) -> str:
        """The result as a line of text."""
        if self.is_satisfied:
            return f"✔ {self.name} {self.installed}"
        actual = f"version {self.installed} is installed" if self.installed else "not installed"
        return f"✘ {self.name}: {actual}, required: {self.required or 'any version'}. In a terminal: {REPAIR}"


def find_versions() -> Iterator[VersionCheck]:
    """Yield the packages that the kit requires on this platform."""
    from packaging.requirements import Requirement

    for text in metadata.requires(DISTRIBUTION) or []:
        need = Requirement(text)
        if need.marker and not need.marker.evaluate({"extra": ""}):
            # Requirements of other platforms and of extras do not apply.
            continue
        try:
            version = metadata.version(need.name)
        except metadata.PackageNotFoundError:
            yield VersionCheck(need.name, str(need.specifier), None, False)
        else:
            yield VersionCheck(need.name, str(need.specifier), version, need.specifier.contains(version))


def check_versions() -> None:
    """Print Python and each package with ✔ or ✘, and how to fix each ✘."""
    findings = list(find_versions())
    unmet = [finding for finding in findings if not finding.is_satisfied]
    print(f"✔ Python {platform.python_version()} on {platform.system()} ({sys.prefix})")  # noqa: T201  output
    print("\n".join(finding.line for finding in findings))  # noqa: T201  the cell's output
    verdict = f"{len(unmet)} of {len(findings)} need to be fixed" if unmet else "Everything is fine."
    print(verdict)  # noqa: T201  the cell's output
