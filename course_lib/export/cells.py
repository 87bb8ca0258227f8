"""The code that is exported: a Python file, or a notebook's cells."""

import json
import re
from dataclasses import dataclass
from pathlib import Path

from course_lib.errors import CourseError

_MARK = re.compile(r"\s*#\s*\|?\s*export\s*$", re.MULTILINE)


@dataclass(frozen=True)
class Cell:
    """A cell's Python: its number, as it is counted in JupyterLab, and whether it is marked for export."""

    number: int
    source: str
    marked: bool


def read_cells(file: Path) -> list[Cell]:
    """Read a .py file, as one cell, or a notebook's code cells; magics are left out.

    Raises:
        CourseError: The file cannot be read, or is no Python.
    """
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no text"
        raise CourseError(f"{file} cannot be read: {reason}. Give a notebook or a Python file.") from error
    if file.suffix != ".ipynb":
        return [Cell(1, text, marked=True)]
    try:
        cells = [(n, c) for n, c in enumerate(json.loads(text)["cells"], 1) if c["cell_type"] == "code"]
        sources = [(number, "".join(cell["source"]), cell.get("metadata", {})) for number, cell in cells]
    except (ValueError, KeyError, TypeError) as error:
        raise CourseError(f"{file} is no notebook of format 4. Save it again in JupyterLab.") from error
    return [
        Cell(number, without_magics(source), bool(_MARK.match(source)) or "export" in meta.get("tags", ()))
        for number, source, meta in sources
    ]


def without_magics(source: str) -> str:
    """Return a cell as Python, its magics as calls and without its mark for export."""
    from IPython.core.inputtransformer2 import TransformerManager

    manager = TransformerManager()  # type: ignore[no-untyped-call]  # IPython annotates little
    return _MARK.sub("", manager.transform_cell(source), count=1)
