"""Exercise notebooks as JSON: quick to read, and written the way Jupyter writes them."""

import json
from pathlib import Path
from typing import Any

from course_lib.course.whole_file import write_whole
from course_lib.errors import CourseError, did_you_mean

Notebook = dict[str, Any]


def find_notebook(path: Path) -> Path:
    """Return a notebook's path, which may have been typed without .ipynb.

    Raises:
        CourseError: There is no such file, but one of nearly the same name.
    """
    with_suffix = path.with_name(f"{path.name}.ipynb") if path.name else path
    if with_suffix.is_file() and not path.is_file():
        return with_suffix
    if not path.exists():
        folder = path.parent
        near = [str(one) for one in (*folder.glob("*.ipynb"), *folder.glob("*/week*_exercise.ipynb"))]
        begun = [one for one in near if Path(one).name.startswith(f"{path.name}_exercise.")]
        if meant := did_you_mean(begun[0] if begun else str(path), near):
            raise CourseError(f"there is no {path}{meant}")
    return path


def read_notebook(path: Path) -> Notebook:
    """A notebook as plain data.

    Raises:
        CourseError: it is missing, no JSON, or no notebook of format 4.
    """
    try:
        notebook = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CourseError(f"{path} can't be read as a notebook: {error}") from error
    if not isinstance(notebook, dict) or notebook.get("nbformat") != 4 or "cells" not in notebook:
        raise CourseError(f"{path} is no notebook of format 4. Save it again in JupyterLab.")
    return notebook


def notebook_text(notebook: Notebook) -> str:
    """The file's text in Jupyter's own layout: indent 1, keys sorted, non-ASCII as it is."""
    return json.dumps(notebook, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def source(cell: dict[str, Any]) -> str:
    """A cell's text; the file format allows a string or a list of lines."""
    text = cell.get("source", "")
    return text if isinstance(text, str) else "".join(text)


def stamp(notebook: Notebook, student: str) -> bool:
    """Store the student's ID in the notebook's metadata; True if that changed it."""
    course = notebook.setdefault("metadata", {}).setdefault("course", {})
    changed = course.get("student") != student
    course["student"] = student
    return bool(changed)


def stamp_exercises(folder: Path, student: str) -> list[Path]:
    """Store the ID in every exercise of the student's folder; files that are no notebooks are left alone."""
    exercises = sorted(folder.glob("week*_exercise*.ipynb"))
    for path in exercises:
        try:
            notebook = read_notebook(path)
        except CourseError:
            continue  # `course check` names what is wrong with it; an ID can still be given
        if stamp(notebook, student):
            write_whole(path, notebook_text(notebook).encode())
    return exercises
