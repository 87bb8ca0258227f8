"""The course that is graded, the folder of records, and the digests of what records depend on."""

import hashlib
import json
import os
import platform
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import course_lib
from course_lib.course.installation import exercises_dir, solutions_dir
from course_lib.errors import CourseError
from course_lib.grading.catalog import Catalog, load_catalog
from course_lib.grading.jail.isolation import Need

LOCK, MARKS_LOCK = ".lock", ".marks.lock"
KEPT = ("results", "evidence", "requests", "reports", "copies", "preflight")  # marks have a lock of their own
TURN_SECONDS = 10.0  # [s] a turn lasts milliseconds


@dataclass(frozen=True)
class Course:
    """Folders of tasks and hidden checks; every judging process reads them itself.

    Args:
        exercises: course.toml, and the public check files in `checks`.
        solutions: The hidden check files in `checks`, and the solutions.
        sandbox: The least isolation in which a submission is run.
        handed_in: The folders of submissions and results, which no submission may read.
    """

    exercises: Path
    solutions: Path
    sandbox: Need = "partial"
    handed_in: tuple[Path, ...] = ()

    @property
    def lessons(self) -> Path:
        """The folder of the lessons, beside the exercises."""
        return self.exercises.parent / "notebooks"

    @property
    def refused(self) -> tuple[str, ...]:
        """Paths that no submission may read."""
        return tuple(str(path.resolve()) for path in (self.exercises, self.solutions, *self.handed_in))


def this_course() -> Course:
    """Return the course of this installation.

    Raises:
        CourseError: It is a student's copy.
    """
    return Course(exercises_dir(), solutions_dir())


@lru_cache(maxsize=4)
def catalog_of(course: Course) -> Catalog:
    """Return the tasks with their hidden scenarios."""
    return load_catalog(course.exercises, course.solutions)


@lru_cache(maxsize=64)
def rules_of(course: Course, exercise: str) -> str:
    """Return the digest of course.toml and the exercise's check files."""
    check_file = f"checks/{exercise.split('_')[0]}.py"
    files = (course.exercises / "course.toml", course.exercises / check_file, course.solutions / check_file)
    return hashlib.sha256(b"\0".join(f.read_bytes() for f in files if f.is_file())).hexdigest()[:32]


@cache
def kit_digest() -> str:
    """Return the digest of this process's kit: of all its Python files and tables."""
    top = Path(course_lib.__file__).parent
    total = hashlib.sha256()
    for path in sorted(path for kind in ("*.py", "*.toml", "*.txt") for path in top.rglob(kind)):
        total.update(str(path.relative_to(top)).encode() + b"\0" + path.read_bytes())
    return total.hexdigest()


def digest_of(content: Any) -> str:
    """Return the digest of plain data."""
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:32]


def evidence_path(out: Path, key: str) -> Path:
    """Return the file of the evidence with a digest."""
    return out / "evidence" / f"{key}.msgpack.gz"


def usage_path(out: Path, key: str) -> Path:
    """Return the file of what bringing that evidence used of the machine."""
    return out / "evidence" / f"{key}.usage.json"


def check_times_path(out: Path, key: str) -> Path:
    """Return the file of the time that judging that evidence took, check by check."""
    return out / "evidence" / f"{key}.checks.json"


def result_path(out: Path, student: str, exercise: str) -> Path:
    """Return the file of a student's result at an exercise."""
    return out / "results" / student / f"{exercise}.json"


def marks_path(out: Path, student: str, exercise: str) -> Path:
    """Return the file of the points that persons gave."""
    return out / "marks" / student / f"{exercise}.json"


def report_path(out: Path, student: str, exercise: str) -> Path:
    """Return the page that the student gets."""
    return out / "reports" / student / f"{exercise}.html"


class OutError(CourseError):
    """The folder of records cannot be written: grading stops, and goes on with --resume."""


@contextmanager
def writing(out: Path) -> Iterator[None]:
    """Turn an error of the file system, such as a full disk, into one line.

    Raises:
        OutError: A file of the folder could not be written.
    """
    try:
        yield
    except OSError as error:
        raise OutError(
            f"{out} can't be written: {error.strerror or error}. Mend that, then type the command again, "
            "grade with --resume (nothing is lost); or name another folder"
        ) from error


@contextmanager
def sole_use(out: Path) -> Iterator[None]:
    """Lock the folder of records; the system releases the lock when the process ends, however it ends.

    Raises:
        OutError: The folder can't be written.
        CourseError: Another process holds the lock.
    """
    import fcntl  # Windows has none, but cannot grade either

    with ExitStack() as stack:
        with writing(out):
            out.mkdir(parents=True, exist_ok=True)
            file = stack.enter_context((out / LOCK).open("a+"))
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                who = (out / LOCK).read_text() or "another process"
                raise CourseError(f"{out} is in use by {who}: wait for its end, then try again") from error
            file.truncate(0)
            file.write(f"process {os.getpid()} on {platform.node()}")
            file.flush()
            for draft in (path for kept in KEPT for path in (out / kept).rglob(".*") if path.is_file()):
                draft.unlink()  # half a file of a grader that was killed
        yield


@contextmanager
def marks_turn(out: Path) -> Iterator[None]:
    """Wait for the turn to write a file of marks, also while the folder is in use; others wait meanwhile.

    Raises:
        OutError: The folder can't be written.
        CourseError: Another process does not end its turn.
    """
    import fcntl  # Windows has none, but cannot grade either

    end = time.monotonic() + TURN_SECONDS
    with ExitStack() as stack:
        with writing(out):
            file = stack.enter_context((out / MARKS_LOCK).open("a"))
        while True:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError as error:
                if time.monotonic() > end:
                    raise CourseError(f"another process writes marks in {out}: try again") from error
                time.sleep(0.01)
        with writing(out):
            yield
