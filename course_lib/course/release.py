"""`course release OUT`: the students' copy, an installable project without answers."""

import re
import shutil
import tomllib
from fnmatch import fnmatch
from pathlib import Path

from course_lib.course.course_file import read_course_file
from course_lib.course.exercise import write_exercises
from course_lib.course.files import checkout_root
from course_lib.errors import CourseError

# solutions/, tests/ (they hold right and wrong answers) and everything hidden stay with the instructors.
RELEASED = (
    "course_lib",
    "notebooks",
    "exercises",
    "pyproject.toml",
    "README.md",
    "LICENSE",
    "CHANGELOG.md",
)
# Who got more time concerns nobody else: a table of its own in course.toml, up to the next one.
EXTENSIONS = re.compile(r"^\[weeks\.\w+\.extensions\].*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.pyc", ".*", "_course")
LESSONS = ("week*.ipynb", "images", "coverage.toml")  # else lessons have written it


def release(out: Path) -> list[Path]:
    """Copy what students get into `out`; returns what was copied, as paths in `out`.

    Raises:
        CourseError: not a checkout; `out` holds something, or can't be written; course.toml is malformed.
    """
    root, out = checkout_root(), out.expanduser().resolve()
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise CourseError(f"{out} is not an empty folder. Name a new one, or remove it first.")
    if out.is_relative_to(root / "course_lib") or out.is_relative_to(root / "exercises"):
        raise CourseError(f"{out} lies inside what is released. Name a folder elsewhere.")
    stale = write_exercises()
    if stale:
        names = ", ".join(path.name for path in stale)
        raise CourseError(
            f"made anew from the solutions, please look and commit, then release again: {names}"
        )
    settings = _without_extensions(root / "exercises" / "course.toml")
    try:
        copies = [_copy(root / name, out / name) for name in RELEASED if (root / name).exists()]
        (out / "exercises" / "course.toml").write_text(settings, encoding="utf-8")
        return copies
    except OSError as error:
        raise CourseError(
            f"can't write the release to {out}: {error.strerror}. Name another folder."
        ) from error


def _without_extensions(path: Path) -> str:
    """The course file as students get it; a malformed one is refused."""
    read_course_file(path)
    text = EXTENSIONS.sub("", path.read_text(encoding="utf-8"))
    for week, table in tomllib.loads(text)["weeks"].items():
        if "extensions" in table:
            raise CourseError(f"{path}: write {week}'s extensions as a table, [weeks.{week}.extensions]")
    return text


def _strays(folder: str, names: list[str]) -> set[str]:
    """What is in notebooks/ and does not belong there."""
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
