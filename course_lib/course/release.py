"""`course release`: the students' copy of the project, without answers and hidden checks."""

import json
import os
import re
import shutil
import tomllib
from collections.abc import Iterable, Sequence
from datetime import UTC, datetime
from fnmatch import fnmatch
from pathlib import Path

from course_lib.course.course_file import read_course_file, shipped_course_file
from course_lib.course.exercise import BEGIN, END, read_notebook, source, write_exercises
from course_lib.course.material import PACKAGE, checkout_root, course_package, solutions_dir
from course_lib.course.student_folder import LESSONS, SOLUTIONS
from course_lib.errors import CourseError
from course_lib.files import draft_folder
from course_lib.third_party import read_text

README, README_STUDENTS = "README.md", "README_students.md"
FOR_STUDENTS = """# {title}

You need Python 3.11 or newer, and `course_lib`, which your instructor tells you how to install. Type in this
folder, in a new virtual environment:

```console
pip install -e . && course lab
```

JupyterLab opens in your browser and shows your own folder `my_course`, with the lessons and exercises.

```console
course status                    # your progress and the next step
course check week01_exercise     # the public checks of an exercise
course submit week01_exercise    # one file to hand in; warns of what is unfinished
```
"""
# Files that are released in addition to the course's package. solutions/, tests/ (with right and
# wrong answers) and hidden checks are only for instructors.
RELEASED = (
    "notebooks",
    "exercises",
    ".binder",
    ".devcontainer",
    # Pictures of the kit's README.md.
    "docs/images",
    "pyproject.toml",
    "LICENSE",
    "CHANGELOG.md",
)
# Extensions and groups are private, so these tables are removed for students.
EXTENSIONS = re.compile(r"^\[(?:weeks\.\w+\.extensions|groups)\].*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.pyc", ".*", "_course")


def _released_names() -> tuple[str, ...]:
    return (course_package().name, *RELEASED)


def free_folder(out: Path) -> Path:
    """Return the folder for a release.

    Raises:
        CourseError: It is not empty, is inside a folder that is released, or cannot be written.
    """
    root, out = checkout_root(), out.expanduser().resolve()
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        # The draft is hidden, so the folder may look empty, or like a complete release.
        is_draft_left = out.is_dir() and any(out.glob(".release.*.draft"))
        killed = ": a release into it was killed and is not complete" if is_draft_left else ""
        raise CourseError(
            f"{out} is not an empty folder{killed}. Choose a folder that does not exist yet, or "
            "remove this one."
        )
    if any(out.is_relative_to(root / name) for name in _released_names()):
        raise CourseError(f"{out} is inside the released files. Choose a folder elsewhere.")
    nearest = next(folder for folder in (out, *out.parents) if folder.exists())
    if not os.access(nearest, os.W_OK | os.X_OK):
        raise CourseError(f"Cannot write to {nearest}. Choose a folder in which you may write.")
    return out


def require_closed_weeks(weeks: Iterable[str]) -> None:
    """Raise a CourseError if points can still be earned, so the solution must stay hidden."""
    course = shipped_course_file()
    for week in weeks:
        closing = course.closing_time(week)
        if datetime.now(UTC) < closing:
            local = closing.astimezone(course.zone)
            raise CourseError(
                f"{week} can be handed in for points until {local:%Y-%m-%d %H:%M}, with extensions "
                "and late days: release its solution after that"
            )
        if not _solution(week).is_file():
            raise CourseError(f"{week} has no solution to release: {_solution(week)} does not exist")


def _solution(week: str) -> Path:
    return solutions_dir() / f"{week}_solution.ipynb"


def release(out: Path, solved: Sequence[str] = ()) -> list[Path]:
    """Copy the files for students into `out` and return their paths.

    Args:
        out: An empty or new folder.
        solved: The weeks whose solution is released, too, like "week01".

    Raises:
        CourseError: This is not a checkout, `out` is not empty or cannot be written, or course.toml
            is malformed. A week in `solved` can still be handed in for points.
    """
    root, out = checkout_root(), free_folder(out)
    require_closed_weeks(solved)
    renew_exercises()
    settings = _without_extensions(root / "exercises" / "course.toml")
    try:
        # The draft lies inside of `out`, which may be a file system of its own. A release that is
        # interrupted leaves no folder that looks complete.
        with draft_folder(out / "release") as draft:
            names = [name for name in _released_names() if (root / name).exists()]
            copies = [_copy(root / name, draft / name) for name in names]
            (draft / "exercises" / "course.toml").write_text(settings, encoding="utf-8")
            copies += [_copy_solution(week, draft / "exercises" / SOLUTIONS) for week in solved]
            (draft / "README.md").write_text(_readme(root), encoding="utf-8")
            for path in list(draft.iterdir()):
                path.replace(out / path.name)
            return [out / path.relative_to(draft) for path in [*copies, draft / "README.md"]]
    except OSError as error:
        raise CourseError(
            f"can't write the release to {out}: {error.strerror}. Choose another folder."
        ) from error


def _copy_solution(week: str, folder: Path) -> Path:
    """Write a week's solution without the comments that mark the answers, and return its path."""
    notebook = read_notebook(_solution(week))
    for cell in notebook["cells"]:
        lines = source(cell).splitlines(keepends=True)
        cell["source"] = [line for line in lines if not BEGIN.match(line.rstrip()) and line.strip() != END]
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / f"{week}_solution.ipynb"
    place.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return place


def renew_exercises() -> None:
    """Write the exercises from the solutions. Unlike verification, this takes no noticeable time.

    Raises:
        CourseError: An exercise has changed and must be reviewed, or a solution has a
        wrong marker.
    """
    if stale := write_exercises():
        names = ", ".join(path.name for path in stale)
        raise CourseError(f"updated from the solutions: {names}. Review and commit them, then release again.")


def _readme(root: Path) -> str:
    """Return the README of the students' copy: README_students.md, or a short introduction.

    The README of a course's checkout is for authors. The README of the kit is also for students.
    """
    readme = root / (README if course_package() == PACKAGE else README_STUDENTS)
    if readme.is_file():
        return read_text(readme)
    title = read_course_file(root / "exercises" / "course.toml").title
    return FOR_STUDENTS.format(title=title or "Your course")


def _without_extensions(path: Path) -> str:
    """Return course.toml without extensions and groups. Raise a CourseError if it is malformed."""
    read_course_file(path).require_valid()
    text = EXTENSIONS.sub("", read_text(path))
    content = tomllib.loads(text)
    if "groups" in content:
        raise CourseError(f"{path}: write the students' groups as a table, [groups]")
    for week, table in content["weeks"].items():
        if "extensions" in table:
            raise CourseError(f"{path}: write {week}'s extensions as a table, [weeks.{week}.extensions]")
    return text


def _ignored_names(folder: str, names: list[str]) -> set[str]:
    """Return the names for `shutil.copytree` to ignore. notebooks/ may contain files written by lessons."""
    if Path(folder).name != "notebooks":
        return LEFT_OUT(folder, names)
    return {name for name in names if not any(fnmatch(name, pattern) for pattern in LESSONS)}


def _copy(source: Path, place: Path) -> Path:
    place.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, place, ignore=_ignored_names if source.name == "notebooks" else LEFT_OUT)
    else:
        shutil.copyfile(source, place)
    return place
