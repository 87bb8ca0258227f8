"""A handed-in notebook, read with json alone: nbformat would take longer than running it."""

import json
import re
from dataclasses import dataclass
from typing import Any

from course_lib.course.identity import normalise
from course_lib.errors import CourseError

MAX_BYTES = 20_000_000  # [B]
LOOKS_LIKE = {b"<": "it looks like a web page", b"%pdf": "it is a PDF", b"pk": "it is a zip archive"}


@dataclass(frozen=True)
class Notebook:
    """What grading needs of a notebook: its code cells, the exercise that it is, the ID that it claims.

    `ran` has for each code cell whether the file says that it was run.
    """

    cells: tuple[str, ...]
    exercise: str | None = None
    student: str | None = None
    ran: tuple[bool, ...] = ()


def parse_notebook(data: bytes, name: str) -> Notebook:
    """Read a notebook's bytes, in which anything may be; `name` is the file's.

    Raises:
        CourseError: It is too large, no JSON, or no notebook of format 3 or 4.
    """
    if len(data) > MAX_BYTES:
        raise CourseError(f"{name} has more than {MAX_BYTES} bytes. Clear its outputs and save it.")
    try:
        content = json.loads(data)  # in UTF-8, 16 or 32, as it begins
    except (ValueError, RecursionError) as error:
        start = data.lstrip()[:4].lower()
        kinds = [text for first, text in LOOKS_LIKE.items() if start.startswith(first)]
        what = kinds[0] if kinds else "it is not JSON" if start else "it is empty"
        raise CourseError(f"{name} is no notebook: {what}. Save it again in JupyterLab.") from error
    content = _dict(content)
    sheets = content.get("worksheets")  # what format 3 had around the cells
    sheet = _dict(sheets[0]) if isinstance(sheets, list) and sheets else {}
    cells = content.get("cells", sheet.get("cells"))
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise CourseError(
            f"{name} is no notebook of format 3 or 4: it has no list of cells. Save it again in JupyterLab."
        )
    code_cells = [cell for cell in cells if cell.get("cell_type") == "code"]
    code = tuple(_source(cell) for cell in code_cells)
    ran = tuple(bool(cell.get("execution_count", cell.get("prompt_number"))) for cell in code_cells)
    claims = _dict(_dict(content.get("metadata")).get("course"))
    exercise = exercise_named(claims.get("exercise")) or exercise_named(name)
    return Notebook(code, exercise, claimed_id(claims), ran)


def exercise_named(text: Any) -> str | None:
    """The exercise that a name begins with, "week01_exercise"."""
    named = re.match(r"week\d\d_exercise", text) if isinstance(text, str) else None
    return named and named[0]


def claimed_id(claims: Any) -> str | None:
    """The ID that a file claims, normalised, if it is one: it may become a folder's name."""
    try:
        claim = _dict(claims).get("student")
        return normalise(claim) if isinstance(claim, str) else None
    except CourseError:
        return None


def _source(cell: dict[str, Any]) -> str:
    """A cell's text, which the format allows to be a text or a list of lines."""
    source = cell.get("source", cell.get("input", ""))
    lines = source if isinstance(source, list) else [source]
    return "".join(line for line in lines if isinstance(line, str)).encode("utf-8", "replace").decode()


def _dict(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}
