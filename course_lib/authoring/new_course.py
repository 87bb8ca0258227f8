"""`course new course "Robotics 101"`: a project for a course of one's own, which depends on the kit."""

from importlib import metadata
from pathlib import Path

from course_lib.authoring.new_week import check_title, lesson, new_week, slug
from course_lib.authoring.templates import filled
from course_lib.course.installation import DISTRIBUTION
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.records import Course

TEMPLATE = "course"
FIRST_WEEK = ("week01", "First steps")


def new_course(title: str, inside: Path) -> Path:
    """Write a course with a welcome and a first week.

    Args:
        title: "Robotics 101".
        inside: Where its folder goes.

    Returns:
        The folder, "robotics_101".

    Raises:
        CourseError: The title does not fit, or the folder is there already.
    """
    check_title(title)
    root = inside / slug(title)
    if root.exists():
        raise CourseError(f"{root} is there already: move it away, or name the course otherwise")
    course = Course(root / "exercises", root / "solutions")
    for folder in (course.exercises, course.solutions, course.lessons):
        folder.mkdir(parents=True)
    for path, data in _files(root, title).items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, data)
    new_week(*FIRST_WEEK, course)
    return root


def _files(root: Path, title: str) -> dict[Path, bytes]:
    package = f"course_{slug(title)}"  # of no package that there is
    version = metadata.version(DISTRIBUTION)
    values = {
        "title": title,
        "package": package,
        "distribution": slug(title).replace("_", "-"),
        "version": version,
    }
    about = {"learn": "REPLACE: what students can do then, in a few words", "minutes": 15, "week": 0}
    made = {root / "notebooks" / "week00_start.ipynb": lesson(TEMPLATE, values, about)}
    for name, place in (
        ("pyproject.toml", "pyproject.toml"),
        ("README.md", "README.md"),
        ("gitignore", ".gitignore"),
        ("init.py", f"{package}/__init__.py"),
        ("test_course.py", "tests/test_course.py"),
        ("course.toml", "exercises/course.toml"),
        ("quiz.toml", "exercises/quizzes/week00.toml"),
    ):
        made[root / place] = filled(TEMPLATE, name, values).encode()
    return made
