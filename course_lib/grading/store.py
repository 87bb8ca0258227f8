"""The graded course, the folder of records, and the digests of all dependencies of records."""

import hashlib
import json
import os
import platform
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import course_lib
from course_lib.course.material import exercises_dir, solutions_dir
from course_lib.errors import CourseError
from course_lib.grading.task import Catalog, load_catalog

if TYPE_CHECKING:
    from course_lib.grading.jail.filters import Need

LOCK, MARKS_LOCK = ".lock", ".marks.lock"
# Marks are not included: they have their own lock.
STORED_FOLDERS = ("results", "evidence", "reports", "copies", "preflight")
TURN_SECONDS = 10.0  # [s] timeout; writing a file of marks takes milliseconds


@dataclass(frozen=True)
class Course:
    """Folders of tasks and hidden checks, which each judging process reads itself.

    Args:
        exercises: Folder of course.toml, with the public check files in `checks`.
        solutions: Folder of the solutions, with the hidden check files in `checks`.
        sandbox: The weakest isolation that is accepted for running a submission.
        private_folders: The folders of submissions and results, which no submission may read.
    """

    exercises: Path
    solutions: Path
    sandbox: "Need" = "partial"
    private_folders: tuple[Path, ...] = ()

    @property
    def lessons(self) -> Path:
        """The folder of the lessons, next to the exercises."""
        return self.exercises.parent / "notebooks"

    @property
    def forbidden_paths(self) -> tuple[str, ...]:
        """Paths that submissions must not be able to read."""
        return tuple(str(path.resolve()) for path in (self.exercises, self.solutions, *self.private_folders))


def this_course() -> Course:
    """Return the course of this installation.

    Raises:
        CourseError: The installation is a student's copy, without solutions.
    """
    return Course(exercises_dir(), solutions_dir())


@lru_cache(maxsize=4)
def catalog_of(course: Course) -> Catalog:
    """Return the course's catalog, including hidden scenarios."""
    return load_catalog(course.exercises, course.solutions)


@lru_cache(maxsize=64)
def rules_of(course: Course, exercise: str) -> str:
    """Return the digest of the rules for judging evidence: check files, points, and the kit.

    Dates and the late policy are excluded, so that an extension for one student does not cause the
    whole class to be judged again.
    """
    week = exercise.split("_")[0]
    files = (folder / "checks" / f"{week}.py" for folder in (course.exercises, course.solutions))
    checks = [hashlib.sha256(f.read_bytes()).hexdigest() for f in files if f.is_file()]
    settings = catalog_of(course).course.weeks.get(week)
    points = [dict(settings.points), dict(settings.bonus)] if settings else []
    return digest_of([kit_digest(), checks, points])


@cache
def kit_digest() -> str:
    """Return the digest of all Python files and tables of the kit in this process."""
    top = Path(course_lib.__file__).parent
    total = hashlib.sha256()
    for path in sorted(path for kind in ("*.py", "*.toml", "*.txt") for path in top.rglob(kind)):
        total.update(str(path.relative_to(top)).encode() + b"\0" + path.read_bytes())
    return total.hexdigest()


def digest_of(content: Any) -> str:
    """Return the digest of plain data."""
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:32]


def evidence_path(out: Path, key: str) -> Path:
    """Return the path of the evidence with a key."""
    return out / "evidence" / f"{key}.msgpack.gz"


def usage_path(out: Path, key: str) -> Path:
    """Return the path of the resource usage of the run that produced some evidence."""
    return out / "evidence" / f"{key}.usage.json"


def check_times_path(out: Path, key: str) -> Path:
    """Return the path of the times that each check took to judge some evidence."""
    return out / "evidence" / f"{key}.checks.json"


def result_path(out: Path, student: str, exercise: str) -> Path:
    """Return the path of a student's result for an exercise."""
    return out / "results" / student / f"{exercise}.json"


def marks_path(out: Path, student: str, exercise: str) -> Path:
    """Return the path of the points that graders gave a student by hand."""
    return out / "marks" / student / f"{exercise}.json"


def final_path(out: Path) -> Path:
    """Return the path of the list of exercises whose marks are final, one per line."""
    return out / "final.txt"


def final_exercises(out: Path) -> frozenset[str]:
    """Return the exercises whose marks are final; their reports show hidden checks."""
    path = final_path(out)
    return frozenset(path.read_text(encoding="utf-8").split()) if path.is_file() else frozenset()


def report_path(out: Path, student: str, exercise: str) -> Path:
    """Return the path of a student's report page."""
    return out / "reports" / student / f"{exercise}.html"


class RecordsWriteError(CourseError):
    """Raised if the folder of records can't be written.

    Grading stops, and continues with --resume.
    """


@contextmanager
def writing(out: Path) -> Iterator[None]:
    """Turn an error of the file system, such as a full disk, into a `RecordsWriteError`.

    Raises:
        RecordsWriteError: A file of the folder could not be written.
    """
    try:
        yield
    except OSError as error:
        raise RecordsWriteError(
            f"{out} can't be written: {error.strerror or error}. Fix that and run the command "
            "again (grade with --resume: nothing is lost), or use another folder"
        ) from error


@contextmanager
def lock_folder(out: Path, waiting: Callable[[str], None] | None = None) -> Iterator[None]:
    """Lock the folder of records.

    The system releases the lock when the process ends for any reason.

    Args:
        out: The folder.
        waiting: Called with a line of text before waiting for another process; None raises instead
            of waiting.

    Raises:
        RecordsWriteError: The folder can't be written.
        CourseError: Another process holds the lock, and `waiting` is None.
    """
    # Imported late, because Windows lacks this module (and cannot grade).
    import fcntl

    with ExitStack() as stack:
        with writing(out):
            out.mkdir(parents=True, exist_ok=True)
            # Without a buffer, whose second write on closing would replace the error of a full
            # disk.
            file = stack.enter_context((out / LOCK).open("ab+", buffering=0))
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError as error:
                holder = (out / LOCK).read_text() or "another process"
                if waiting is None:
                    raise CourseError(
                        f"{out} is in use by {holder}: wait until it ends, then try again"
                    ) from error
                waiting(
                    f"{out} is in use by {holder}: waiting until it ends. Ctrl+C cancels; nothing "
                    "is stored yet."
                )
                fcntl.flock(file, fcntl.LOCK_EX)
            file.truncate(0)
            file.write(f"process {os.getpid()} on {platform.node()}".encode())
            for draft in (
                path for folder in STORED_FOLDERS for path in (out / folder).rglob(".*") if path.is_file()
            ):
                # A grader that was killed can leave half-written files.
                draft.unlink()
        yield


@contextmanager
def lock_marks(out: Path) -> Iterator[None]:
    """Lock the files of marks. Another process may use the folder of records at the same time.

    Raises:
        RecordsWriteError: The folder can't be written.
        CourseError: Another process holds this lock for more than TURN_SECONDS.
    """
    # Imported late, because Windows lacks this module (and cannot grade).
    import fcntl

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
