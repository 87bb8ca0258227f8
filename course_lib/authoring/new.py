"""`course new week09` and `course new course`: files filled from templates."""

import base64
import re
import unicodedata
from collections.abc import Iterator, Mapping
from importlib import metadata
from pathlib import Path

from course_lib.course.course_file import read_course_file
from course_lib.course.exercise import Notebook, exercise_from, notebook_text
from course_lib.course.material import DISTRIBUTION
from course_lib.errors import CourseError
from course_lib.files import draft_folder, write_atomically
from course_lib.grading.store import Course

HERE = Path(__file__).parent / "templates"


def render(kind: str, name: str, values: Mapping[str, object]) -> str:
    """Render a template with these values."""
    from jinja2 import Environment, StrictUndefined

    text = (HERE / kind / f"{name}.jinja").read_text(encoding="utf-8")
    environment = Environment(undefined=StrictUndefined, keep_trailing_newline=True, autoescape=False)
    return environment.from_string(text).render(**values)


WEEK_TEMPLATE = "week"
CELL = re.compile(
    r"^# %%(?: \[(?P<markdown>markdown)\])? (?P<id>[\w-]+)(?: \[(?P<tag>[\w-]+)\])?\n", re.MULTILINE
)
KERNEL = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}
FIT_TITLE = re.compile(r"\w[\w ,.:;()'!?+-]{0,59}")
PICTURE = "picture.png"


def new_week(week: str, title: str, course: Course) -> list[Path]:
    """Write the files of a week, and its entry in course.toml.

    Args:
        week: The name of the week, like "week09".
        title: The title, like "Occupancy maps".
        course: The course that gets the week.

    Returns:
        The files, in the order in which an author should read them.

    Raises:
        CourseError: The week exists already, or its name or title is invalid.
    """
    settings = course.exercises / "course.toml"
    course_file = read_course_file(settings)
    course_file.require_valid(week)
    known_weeks = course_file.weeks
    if not re.fullmatch(r"week\d\d", week):
        raise CourseError(f"{week!r} is not the name of a week: expected one like week09")
    if week in known_weeks:
        raise CourseError(
            f"{week} is already in {settings}: {known_weeks[week].title!r}. Choose another week"
        )
    title = check_title(title)
    new_files = dict(_week_files(week, title, course))
    # Equal files were written by a run that was interrupted before the entry in course.toml.
    there = [
        path
        for path, data in new_files.items()
        if path.exists() and not (path.is_file() and path.read_bytes() == data)
    ]
    if there:
        raise CourseError(f"{there[0]} already exists: move it away, or choose another week")
    for path, data in new_files.items():
        write_atomically(path, data)
    entry = render(WEEK_TEMPLATE, "course.toml", _values(week, title, course))
    write_atomically(settings, (settings.read_text(encoding="utf-8").rstrip() + "\n" + entry).encode())
    return [*new_files, settings]


def check_title(title: str) -> str:
    """Return a title with composed letters, if it is valid in headings, Python and TOML.

    Raises:
        CourseError: The title is invalid. The message lists the permitted characters.
    """
    title = unicodedata.normalize("NFC", title)
    if not FIT_TITLE.fullmatch(title):
        raise CourseError(
            f"the title {title!r}: expected 1 to 60 letters, digits, spaces or , . : ; ( ) ' ! ? + -"
        )
    return title


def unchanged_files(week: str, course: Course) -> list[Path]:
    """Return the files of a week, except notebooks, that are as `new_week` wrote them."""
    try:
        title = read_course_file(course.exercises / "course.toml").weeks[week].title
    # A week may have only a check file.
    except (CourseError, KeyError):
        return []
    template_files = (
        (path, data) for path, data in _week_files(week, title, course) if path.suffix != ".ipynb"
    )
    return [path for path, data in template_files if path.is_file() and path.read_bytes() == data]


# Letters of Latin alphabets that are more than a letter of ASCII with an accent.
_LATIN = str.maketrans(
    {"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "æ": "ae", "œ": "oe", "ø": "o", "ł": "l", "đ": "d"}
)


def slug(title: str) -> str:
    """Convert a title to a part of a file name, like "occupancy_maps".

    Latin letters become letters of ASCII, "Feldrobotik Übung" gives "feldrobotik_uebung". A title in
    another alphabet keeps its letters.
    """
    text = title.lower()
    plain = unicodedata.normalize("NFKD", text.translate(_LATIN))
    plain = "".join(letter for letter in plain if not unicodedata.combining(letter))
    return re.sub(r"\W+", "_", plain if plain.isascii() else text).strip("_")


def _values(week: str, title: str, course: Course) -> dict[str, object]:
    earlier = [path.name for path in sorted(course.lessons.glob("week*.ipynb")) if path.name[:6] < week]
    before = f"do `{earlier[-1]}`." if earlier else "you should know Python classes."
    names = {"week": week, "number": int(week[4:]), "title": title, "before": before}
    return {**names, "lesson": f"{week}_{slug(title)}.ipynb"}


def _week_files(week: str, title: str, course: Course) -> Iterator[tuple[Path, bytes]]:
    values = _values(week, title, course)
    number = values["number"]
    about = {"learn": "REPLACE: what students can do then, in a few words", "minutes": 32, "week": number}
    yield course.lessons / str(values["lesson"]), lesson(WEEK_TEMPLATE, values, about)
    about = {"exercise": f"{week}_exercise", "minutes": 15, "week": number}
    solution = parse_notebook(render(WEEK_TEMPLATE, "solved.py", values), about)
    yield course.solutions / f"{week}_solution.ipynb", notebook_text(solution).encode()
    exercise = notebook_text(exercise_from(solution))
    yield course.exercises / f"{week}_exercise.ipynb", exercise.encode()
    for name, path in (
        ("checks.py", course.exercises / "checks" / f"{week}.py"),
        ("hidden.py", course.solutions / "checks" / f"{week}.py"),
        ("quiz.toml", course.exercises / "quizzes" / f"{week}.toml"),
        ("recall.toml", course.exercises / "quizzes" / f"{week}_recall.toml"),
        ("mistakes.toml", course.exercises / "mistakes" / f"{week}.toml"),
        ("answers.toml", course.solutions / "answers" / f"{week}.toml"),
    ):
        yield path, render(WEEK_TEMPLATE, name, values).encode()


def lesson(kind: str, values: Mapping[str, object], about: Mapping[str, object]) -> bytes:
    """Return a lesson rendered from a template, with a picture in its first cell."""
    notebook = parse_notebook(render(kind, "lesson.py", values), about)
    notebook["cells"][0]["attachments"] = {PICTURE: {"image/png": template_picture()}}
    return notebook_text(notebook).encode()


def template_picture() -> str:
    """Return the picture of a new lesson, base64-encoded as in a notebook."""
    return base64.b64encode((HERE / WEEK_TEMPLATE / PICTURE).read_bytes()).decode()


def parse_notebook(text: str, about: Mapping[str, object]) -> Notebook:
    """Convert text to a notebook. Cells begin with `# %% id [tag]` or `# %% [markdown] id`.

    Args:
        text: The text of the cells.
        about: The entry "course" of the notebook's metadata.
    """
    marks = list(CELL.finditer(text))
    ends = [*(mark.start() for mark in marks[1:]), len(text)]
    cells = []
    for mark, end in zip(marks, ends, strict=True):
        lines = text[mark.end() : end].strip("\n").splitlines(keepends=True)
        cell = {"id": mark["id"], "metadata": {"tags": [mark["tag"]]} if mark["tag"] else {}, "source": lines}
        if mark["markdown"]:
            cell |= {"cell_type": "markdown"}
        else:
            cell |= {"cell_type": "code", "execution_count": None, "outputs": []}
        cells.append(cell)
    metadata = {"course": dict(about), "kernelspec": KERNEL, "language_info": {"name": "python"}}
    return {"cells": cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}


COURSE_TEMPLATE = "course"
FIRST_WEEK = ("week01", "First steps")


def new_course(title: str, inside: Path) -> Path:
    """Write a course with a welcome lesson and a first week.

    Args:
        title: The title, like "Robotics 101".
        inside: The folder in which the course's folder is created.

    Returns:
        The course's folder, like "robotics_101".

    Raises:
        CourseError: The title is invalid, or the folder exists already.
        OSError: The course cannot be written. Nothing of it is left then.
    """
    title = check_title(title)
    if not re.fullmatch(r"[a-z0-9_]+", slug(title)):
        raise CourseError(
            f"the title {title!r}: expected Latin letters or digits, because the name of the course's "
            "package is made from it, and pip accepts no others. Use such a title, and then write "
            "the other one as title into exercises/course.toml"
        )
    root = inside / slug(title)
    if root.exists():
        raise CourseError(f"{root} already exists: move it away, or choose another title")
    with draft_folder(root) as draft:
        course = Course(draft / root.name / "exercises", draft / root.name / "solutions")
        for folder in (course.exercises, course.solutions, course.lessons):
            folder.mkdir(parents=True)
        for path, data in _course_files(draft / root.name, title).items():
            write_atomically(path, data)
        new_week(*FIRST_WEEK, course)
        (draft / root.name).rename(root)
    return root


def _course_files(root: Path, title: str) -> dict[Path, bytes]:
    # The prefix avoids clashes with existing packages.
    package = f"course_{slug(title)}"
    version = metadata.version(DISTRIBUTION)
    values = {
        "title": title,
        "package": package,
        "distribution": slug(title).replace("_", "-"),
        "version": version,
    }
    about = {"learn": "REPLACE: what students can do then, in a few words", "minutes": 15, "week": 0}
    contents = {root / "notebooks" / "week00_start.ipynb": lesson(COURSE_TEMPLATE, values, about)}
    for name, place in (
        ("pyproject.toml", "pyproject.toml"),
        ("README.md", "README.md"),
        ("gitignore", ".gitignore"),
        ("init.py", f"{package}/__init__.py"),
        ("test_course.py", "tests/test_course.py"),
        ("course.toml", "exercises/course.toml"),
        ("quiz.toml", "exercises/quizzes/week00.toml"),
    ):
        contents[root / place] = render(COURSE_TEMPLATE, name, values).encode()
    return contents
