"""Where the kit keeps what it hands out, in a checkout and in an installed wheel."""

from pathlib import Path

from course_lib.errors import CourseError

PACKAGE = Path(__file__).resolve().parent.parent


def material_root() -> Path:
    """The folder with `notebooks/` and `exercises/`: inside an installed wheel, else the checkout.

    Raises:
        CourseError: the installation holds neither.
    """
    for root in (PACKAGE / "_course", PACKAGE.parent):
        if (root / "notebooks").is_dir() and (root / "exercises").is_dir():
            return root
    raise CourseError(
        f"no lessons beside {PACKAGE}: this installation is not complete. Install again: pip install -e ."
    )


def lessons_dir() -> Path:
    """The lessons, `weekNN_*.ipynb`."""
    return material_root() / "notebooks"


def exercises_dir() -> Path:
    """The exercises as handed out, `course.toml`, public checks, quizzes and assets."""
    return material_root() / "exercises"


def checkout_root() -> Path:
    """The instructors' checkout, the only place that holds solutions and hidden checks.

    Raises:
        CourseError: this is a student's copy, or an installed wheel.
    """
    root = PACKAGE.parent
    if (root / "solutions").is_dir() and (root / "pyproject.toml").is_file():
        return root
    raise CourseError(
        f"{root} holds no solutions: this needs the instructors' checkout. "
        "Clone the course's repository, then there: pip install -e ."
    )


def solutions_dir() -> Path:
    """The solved exercises and hidden checks; instructors only."""
    return checkout_root() / "solutions"
