"""The installed course: its package, the folders of its material, and the versions that it needs.

A course is installed by an entry point of the group `course_lib.course`. Without one, the kit's own
course is used, from the wheel or from a checkout. Only the instructors' checkout has solutions.
"""

import os
import platform
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from course_lib.errors import CourseError

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
    files = sorted(filter(Path.is_file, folder.rglob("*")))
    parts_of_files = [(path, path.relative_to(folder).parts) for path in files]
    return [
        path
        for path, parts in parts_of_files
        if not any(part.startswith(".") or part == "__pycache__" for part in parts)
    ]


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
    """Return the instructors' checkout, which alone has solutions and hidden checks.

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
