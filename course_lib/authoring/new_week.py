"""`course new week09 "Occupancy maps"`: the files of a week, from templates that already run."""

import base64
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from course_lib.authoring.templates import filled, template
from course_lib.course.course_file import read_course_file
from course_lib.course.exercise import Notebook, exercise_from, notebook_text
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.records import Course

TEMPLATE = "week"
CELL = re.compile(
    r"^# %%(?: \[(?P<markdown>markdown)\])? (?P<id>[\w-]+)(?: \[(?P<tag>[\w-]+)\])?\n", re.MULTILINE
)
KERNEL = {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"}
FIT_TITLE = re.compile(r"\w[\w ,.:;()'!?+-]{0,59}")
PICTURE = "picture.png"


def new_week(week: str, title: str, course: Course) -> list[Path]:
    """Write the files of a week, and its entry in course.toml.

    Args:
        week: "week09".
        title: "Occupancy maps".
        course: Where they go.

    Returns:
        The files, in the order in which an author reads them.

    Raises:
        CourseError: The week is there already, or its name or title do not fit.
    """
    settings = course.exercises / "course.toml"
    written = read_course_file(settings)
    written.demand(week)
    known = written.weeks
    if not re.fullmatch(r"week\d\d", week):
        raise CourseError(f"{week!r} is not the name of a week: expected one like week09")
    if week in known:
        raise CourseError(f"{week} is in {settings} already: {known[week].title!r}. Name another week")
    check_title(title)
    made = dict(_files(week, title, course))
    there = [path for path in made if path.exists()]
    if there:
        raise CourseError(f"{there[0]} is there already: move it away, or name another week")
    for path, data in made.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, data)
    entry = filled(TEMPLATE, "course.toml", _values(week, title, course))
    write_whole(settings, (settings.read_text(encoding="utf-8").rstrip() + "\n" + entry).encode())
    return [*made, settings]


def check_title(title: str) -> None:
    """Refuse a title that cannot stand in a heading, in Python and in TOML alike.

    Raises:
        CourseError: Names what a title may be.
    """
    if not FIT_TITLE.fullmatch(title):
        raise CourseError(
            f"the title {title!r}: expected 1 to 60 letters, digits, spaces or , . : ; ( ) ' ! ? + -"
        )


def unchanged_files(week: str, course: Course) -> list[Path]:
    """Return the files of a week that are still what `new_week` wrote, other than notebooks."""
    try:
        title = read_course_file(course.exercises / "course.toml").weeks[week].title
    except (CourseError, KeyError):  # there may be check files only
        return []
    made = ((path, data) for path, data in _files(week, title, course) if path.suffix != ".ipynb")
    return [path for path, data in made if path.is_file() and path.read_bytes() == data]


def slug(title: str) -> str:
    """Return a title as a part of a file's name: "occupancy_maps"."""
    return re.sub(r"\W+", "_", title.lower()).strip("_")


def _values(week: str, title: str, course: Course) -> dict[str, object]:
    earlier = [path.name for path in sorted(course.lessons.glob("week*.ipynb")) if path.name[:6] < week]
    before = f"do `{earlier[-1]}`." if earlier else "you should know Python classes."
    names = {"week": week, "number": int(week[4:]), "title": title, "before": before}
    return {**names, "lesson": f"{week}_{slug(title)}.ipynb"}


def _files(week: str, title: str, course: Course) -> Iterator[tuple[Path, bytes]]:
    values = _values(week, title, course)
    number = values["number"]
    about = {"learn": "REPLACE: what students can do then, in a few words", "minutes": 32, "week": number}
    yield course.lessons / str(values["lesson"]), lesson(TEMPLATE, values, about)
    about = {"exercise": f"{week}_exercise", "minutes": 15, "week": number}
    solution = notebook_of(filled(TEMPLATE, "solved.py", values), about)
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
        yield path, filled(TEMPLATE, name, values).encode()


def lesson(kind: str, values: Mapping[str, object], about: Mapping[str, object]) -> bytes:
    """Return the lesson of a template, with the picture of its first cell."""
    notebook = notebook_of(filled(kind, "lesson.py", values), about)
    notebook["cells"][0]["attachments"] = {PICTURE: {"image/png": template_picture()}}
    return notebook_text(notebook).encode()


def template_picture() -> str:
    """Return the picture of a new lesson, as notebooks hold it."""
    return base64.b64encode(template(TEMPLATE, PICTURE).read_bytes()).decode()


def notebook_of(text: str, about: Mapping[str, object]) -> Notebook:
    """Return the notebook of a text with cells that begin with `# %% id [tag]` or `# %% [markdown] id`.

    Args:
        text: The cells.
        about: The notebook's metadata, under "course".
    """
    marks = list(CELL.finditer(text))
    ends = [*(mark.start() for mark in marks[1:]), len(text)]
    cells = [_cell(mark, text[mark.end() : end].strip("\n")) for mark, end in zip(marks, ends, strict=True)]
    metadata = {"course": dict(about), "kernelspec": KERNEL, "language_info": {"name": "python"}}
    return {"cells": cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}


def _cell(mark: re.Match[str], text: str) -> dict[str, Any]:
    tags = {"tags": [mark["tag"]]} if mark["tag"] else {}
    cell = {"id": mark["id"], "metadata": tags, "source": text.splitlines(keepends=True)}
    if mark["markdown"]:
        return {**cell, "cell_type": "markdown"}
    return {**cell, "cell_type": "code", "execution_count": None, "outputs": []}
