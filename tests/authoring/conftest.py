"""A course with one week, as `course new` makes it."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from course_lib.authoring.new import new_week
from course_lib.grading.store import Course

Break = Callable[[str, str, str], None]


def empty_course(top: Path) -> Course:
    """A course without weeks."""
    course = Course(top / "exercises", top / "solutions")
    for folder in (course.exercises, course.solutions, course.lessons):
        folder.mkdir()
    (course.exercises / "course.toml").write_text('title = "Maps"\ntime_zone = "UTC"\n\n[weeks]\n')
    return course


def write(course: Course, name: str, old: str, new: str) -> None:
    """Replace a string in a file of the course."""
    path = course.exercises.parent / name
    text = path.read_text("utf-8")
    assert old in text, f"{name} has no {old!r}"
    path.write_text(text.replace(old, new), "utf-8")


@pytest.fixture
def course(tmp_path: Path) -> Course:
    """A course with a week 9 on occupancy maps."""
    course = empty_course(tmp_path)
    new_week("week09", "Occupancy maps", course)
    return course


@pytest.fixture
def change(course: Course) -> Break:
    """Replaces a string in a file of the course."""
    return partial(write, course)
