"""A handed-in notebook, read with json alone: nbformat would take longer than running it."""

import json
from dataclasses import dataclass
from typing import Any

from course_lib.errors import CourseError

MAX_BYTES = 20_000_000  # [B]


@dataclass(frozen=True)
class Notebook:
    """What grading needs of a notebook: the code cells, and what its metadata claims."""

    cells: tuple[str, ...]
    exercise: str | None = None
    student: str | None = None


def parse_notebook(data: bytes, name: str) -> Notebook:
    """Read a notebook's bytes.

    Args:
        data: As handed in; anything may be in it.
        name: What the message calls it.

    Raises:
        CourseError: It is too large, no JSON, or no notebook of format 4.
    """
    if len(data) > MAX_BYTES:
        raise CourseError(
            f"{name} has {len(data)} bytes, at most {MAX_BYTES} are read. Clear its outputs and save it."
        )
    try:
        content = json.loads(data.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise CourseError(
            f"{name} is no notebook: {_looks_like(data)}. Save it again in JupyterLab."
        ) from error
    cells = content.get("cells") if isinstance(content, dict) else None
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise CourseError(f"{name} is no notebook of format 4: it has no list of cells.")
    course = content.get("metadata", {})
    course = course.get("course", {}) if isinstance(course, dict) else {}
    claims = course if isinstance(course, dict) else {}
    code = [cell for cell in cells if cell.get("cell_type") == "code"]
    return Notebook(tuple(map(_source, code)), _text(claims, "exercise"), _text(claims, "student"))


def _source(cell: dict[str, Any]) -> str:
    """A cell's text, which the format allows to be a text or a list of lines."""
    source = cell.get("source", "")
    lines = source if isinstance(source, list) else [source]
    return "".join(line for line in lines if isinstance(line, str)).encode("utf-8", "replace").decode()


def _text(claims: dict[str, Any], key: str) -> str | None:
    value = claims.get(key)
    return value if isinstance(value, str) and value else None


def _looks_like(data: bytes) -> str:
    start = data.lstrip()[:15].lower()
    kinds = {b"<": "it looks like a web page", b"%pdf": "it is a PDF", b"pk": "it is a zip archive"}
    named = [text for first, text in kinds.items() if start.startswith(first)]
    return named[0] if named else "it is empty" if not start else "it is not JSON"
