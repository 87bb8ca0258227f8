"""Copies for students: the student's folder of `course lab`, and `course release`."""

import hashlib
import json
import re
import shutil
import tomllib
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

from course_lib.course.course_file import read_course_file
from course_lib.course.exercise import read_notebook, source, stamp_exercises, write_exercises
from course_lib.course.installation import PACKAGE, checkout_root, course_package, exercises_dir, lessons_dir
from course_lib.course.state import STATE_FOLDER, WRITTEN_FOLDER, State
from course_lib.errors import CourseError

DEFAULT_FOLDER = Path("my_course")
# solutions/, tests/ (they hold right and wrong answers) and everything hidden stay with the instructors.
RELEASED = (  # with the course's package
    "notebooks",
    "exercises",
    ".binder",
    ".devcontainer",
    "docs/images",  # of README.md
    "pyproject.toml",
    "README.md",
    "LICENSE",
    "CHANGELOG.md",
)
# Who got more time concerns nobody else: a table of its own in course.toml, up to the next one.
EXTENSIONS = re.compile(r"^\[weeks\.\w+\.extensions\].*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.pyc", ".*", "_course")
LESSONS = ("week*.ipynb", "extra_*.ipynb", "week*.py")  # else lessons have written it


@dataclass(frozen=True)
class Refresh:
    """The changes of one call of `prepare`, as names relative to the folder."""

    added: tuple[str, ...] = ()
    updated: tuple[str, ...] = ()  # not edited by the student, so the new release took their place
    beside: tuple[str, ...] = ()  # edited: the new release was written beside

    def lines(self) -> list[str]:
        """Return the report, one line per kind of change."""
        return [
            f"{what}: {', '.join(names)}"
            for what, names in (
                ("new", self.added),
                ("updated", self.updated),
                ("you edited these, so the new version lies beside yours", self.beside),
            )
            if names
        ]


def shipped_files() -> dict[str, Path]:
    """Return the kit's file for each name in a student's folder."""
    lessons = [
        path for name in ("week*.ipynb", "week*.py", "extra_*.ipynb") for path in lessons_dir().glob(name)
    ]
    notebooks = [*lessons, *exercises_dir().glob("week*.ipynb")]
    assets = [path for path in (exercises_dir() / "assets").rglob("*") if path.is_file()]
    named = {path.name: path for path in notebooks}
    return dict(
        sorted((named | {path.relative_to(exercises_dir()).as_posix(): path for path in assets}).items())
    )


def content_hash(path: Path) -> str:
    """Return a digest of a notebook's cells without outputs, or of any other file's bytes."""
    content = path.read_bytes()
    if path.suffix == ".ipynb":
        try:
            cells = [(cell.get("cell_type"), source(cell)) for cell in read_notebook(path)["cells"]]
            content = json.dumps(cells).encode()
        except CourseError:
            pass  # broken by hand, hence edited: its bytes differ from anything shipped
    return hashlib.sha256(content).hexdigest()


def prepare(folder: Path) -> Refresh:
    """Copy what is missing into the student's folder, and newer releases into or beside what is there.

    Raises:
        CourseError: the folder is a file, the kit's own checkout, or can't be written.
    """
    folder = folder.expanduser().resolve()
    if folder.exists() and not folder.is_dir():
        raise CourseError(f"{folder} is a file, not a folder. Name another one: course lab my_course")
    if folder in (PACKAGE.parent, course_package().parent):
        raise CourseError(f"{folder} is the kit itself. Name a folder of your own: course lab my_course")
    try:
        for name in (STATE_FOLDER, WRITTEN_FOLDER):
            (folder / name).mkdir(parents=True, exist_ok=True)
        refresh = _refresh(folder)
    except OSError as error:
        raise CourseError(
            f"can't write into {folder} ({error.strerror}). Try: course lab ~/course"
        ) from error
    state = State(folder)
    student = state.get("identity", "student")
    if student:
        stamp_exercises(folder, student)
    return refresh


def _refresh(folder: Path) -> Refresh:
    state = State(folder)
    shipped = state.section("shipped")
    added, updated, beside = [], [], []
    for name, newest in shipped_files().items():
        mine, release = folder / name, content_hash(newest)
        if not mine.exists():
            added.append(name)
            _write(newest, mine)
        elif shipped.get(name) != release and (now := content_hash(mine)) != release:
            if now == shipped.get(name):
                updated.append(name)
                _write(newest, mine)
            else:
                place = _free_name(mine)
                beside.append(place.name)
                _write(newest, place)
        state.put("shipped", name, release)
    return Refresh(tuple(added), tuple(updated), tuple(beside))


def _write(newest: Path, place: Path) -> None:
    place.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(newest, place)


def _free_name(path: Path) -> Path:
    for number in range(1, 1000):
        place = path.with_name(f"{path.stem}_new{number if number > 1 else ''}{path.suffix}")
        if not place.exists():
            return place
    raise CourseError(f"too many newer versions beside {path}: delete the ones you don't need")


def _released() -> tuple[str, ...]:
    return (course_package().name, *RELEASED)


def free_place(out: Path) -> Path:
    """Return the folder that a release goes into.

    Raises:
        CourseError: It holds something, or lies inside what is released.
    """
    root, out = checkout_root(), out.expanduser().resolve()
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise CourseError(f"{out} is not an empty folder. Name a new one, or remove it first.")
    if any(out.is_relative_to(root / name) for name in _released()):
        raise CourseError(f"{out} lies inside what is released. Name a folder elsewhere.")
    return out


def release(out: Path) -> list[Path]:
    """Copy what students get into `out`; returns what was copied, as paths in `out`.

    Raises:
        CourseError: not a checkout; `out` holds something, or can't be written; course.toml is malformed.
    """
    root, out = checkout_root(), free_place(out)
    stale = write_exercises()
    if stale:
        names = ", ".join(path.name for path in stale)
        raise CourseError(
            f"written again from the solutions: {names}. Review and commit them, then release again."
        )
    settings = _without_extensions(root / "exercises" / "course.toml")
    try:
        copies = [_copy(root / name, out / name) for name in _released() if (root / name).exists()]
        (out / "exercises" / "course.toml").write_text(settings, encoding="utf-8")
        return copies
    except OSError as error:
        raise CourseError(
            f"can't write the release to {out}: {error.strerror}. Name another folder."
        ) from error


def _without_extensions(path: Path) -> str:
    """Return course.toml without the students' extensions; refuse a malformed file."""
    read_course_file(path).demand()
    text = EXTENSIONS.sub("", path.read_text(encoding="utf-8"))
    for week, table in tomllib.loads(text)["weeks"].items():
        if "extensions" in table:
            raise CourseError(f"{path}: write {week}'s extensions as a table, [weeks.{week}.extensions]")
    return text


def _strays(folder: str, names: list[str]) -> set[str]:
    """Return the names that `shutil.copytree` leaves out; notebooks/ may hold files that lessons wrote."""
    if Path(folder).name != "notebooks":
        return LEFT_OUT(folder, names)
    return {name for name in names if not any(fnmatch(name, pattern) for pattern in LESSONS)}


def _copy(source: Path, place: Path) -> Path:
    place.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, place, ignore=_strays if source.name == "notebooks" else LEFT_OUT)
    else:
        shutil.copyfile(source, place)
    return place
