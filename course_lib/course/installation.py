"""The installation: where the kit keeps what it ships, and whether its packages fit."""

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
GROUP = "course_lib.course"  # of entry points: the package of a course
CHOICE = "COURSE_PACKAGE"


def course_package() -> Path:
    """Return the package folder of the course: an installed one, else the kit with its own course.

    Of several, the one counts whose project holds the current folder, else the one that COURSE_PACKAGE names.

    Raises:
        CourseError: Several are installed, and none is chosen.
    """
    found = _installed()
    if len(found) <= 1:
        return next(iter(found.values()), PACKAGE)
    chosen = [p for p in found.values() if Path.cwd().is_relative_to(p.parent)]
    chosen += [p for name, p in found.items() if name == os.environ.get(CHOICE)]
    if not chosen:
        raise CourseError(
            f"several courses are installed: {', '.join(sorted(found))}. Go into the folder of one, or "
            f"name it: export {CHOICE}={min(found)}"
        )
    return chosen[0]


@cache
def _installed() -> dict[str, Path]:
    """Return the folders of installed courses' packages, by name, without importing them."""
    specs = {e.value: find_spec(e.value) for e in metadata.entry_points(group=GROUP)}
    return {name: Path(spec.origin).resolve().parent for name, spec in specs.items() if spec and spec.origin}


def material_root() -> Path:
    """Return the folder with `notebooks/` and `exercises/`: in an installed wheel, else the checkout.

    Raises:
        CourseError: the installation holds neither.
    """
    package = course_package()
    for root in (package / "_course", package.parent):
        if (root / "notebooks").is_dir() and (root / "exercises").is_dir():
            return root
    raise CourseError(
        f"no lessons beside {package}: this installation is not complete. Install again: pip install -e ."
    )


def lessons_dir() -> Path:
    """Return the folder of the lessons, `weekNN_*.ipynb`."""
    return material_root() / "notebooks"


def lessons() -> list[Path]:
    """Return the lessons of all weeks, in order; a review is not a lesson."""
    return sorted(set(lessons_dir().glob("week*.ipynb")) - set(reviews()))


def reviews() -> list[Path]:
    """Return the reviews, in order, `weekNN_your_review.ipynb`; by its name it follows its week."""
    return sorted(lessons_dir().glob("week*_your_review.ipynb"))


def first_lesson() -> str:
    """Return the file name of the first lesson, in which students give their ID."""
    return next((path.name for path in lessons()), "the first lesson")


def extras() -> list[Path]:
    """Return the optional lessons, which belong to no week, `extra_*.ipynb`."""
    return sorted(lessons_dir().glob("extra_*.ipynb"))


def exercises_dir() -> Path:
    """Return the folder of the exercises, `course.toml`, public checks, quizzes and assets."""
    return material_root() / "exercises"


def checkout_root() -> Path:
    """Return the instructors' checkout, the only place that holds solutions and hidden checks.

    Raises:
        CourseError: this is a student's copy, or an installed wheel, or the current folder is in another
            course, which is not installed.
    """
    root = course_package().parent
    for here in (Path.cwd(), *Path.cwd().parents):
        if here != root and (here / "exercises" / "course.toml").is_file() and (here / "solutions").is_dir():
            raise CourseError(
                f"{here} is a course that is not installed; {root} is. Type here: pip install -e . "
                "Or go there."
            )
    if (root / "solutions").is_dir() and (root / "pyproject.toml").is_file():
        return root
    raise CourseError(
        f"{root} holds no solutions: this needs the instructors' checkout. "
        "Clone the course's repository, then there: pip install -e ."
    )


def solutions_dir() -> Path:
    """Return the folder of the solved exercises and hidden checks; instructors only."""
    return checkout_root() / "solutions"


@dataclass(frozen=True)
class Finding:
    """One package: what is wanted, what is there."""

    name: str
    wanted: str
    installed: str | None
    fits: bool

    @property
    def line(self) -> str:
        """One line for people."""
        if self.fits:
            return f"✔ {self.name} {self.installed}"
        came = f"version {self.installed} is installed" if self.installed else "not installed"
        return f"✘ {self.name}: {came}, wanted {self.wanted or 'any version'}. In a terminal: {REPAIR}"


def find_versions() -> Iterator[Finding]:
    """Yield each package that the kit itself needs on this platform."""
    from packaging.requirements import Requirement

    for text in metadata.requires(DISTRIBUTION) or []:
        need = Requirement(text)
        if need.marker and not need.marker.evaluate({"extra": ""}):
            continue  # of another platform, or of an extra
        try:
            installed = metadata.version(need.name)
        except metadata.PackageNotFoundError:
            yield Finding(need.name, str(need.specifier), None, False)
        else:
            yield Finding(need.name, str(need.specifier), installed, need.specifier.contains(installed))


def check_versions() -> None:
    """Print Python and every package with ✔ or ✘, and what to do about the latter."""
    findings = list(find_versions())
    bad = [finding for finding in findings if not finding.fits]
    print(f"✔ Python {platform.python_version()} on {platform.system()} ({sys.prefix})")  # noqa: T201  output
    print("\n".join(finding.line for finding in findings))  # noqa: T201  the cell's output
    verdict = f"{len(bad)} of {len(findings)} need a hand" if bad else "All of it is fine."
    print(verdict)  # noqa: T201  the cell's output
