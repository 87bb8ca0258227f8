"""A handed-in notebook and its code cells, read without trust in what the file holds."""

import ast
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from course_lib.course.exercise import source
from course_lib.course.identity import normalise
from course_lib.course.state import cell_digest
from course_lib.errors import CourseError
from course_lib.export.statements import bound_names, without_magics
from course_lib.foreign import read_json

MAX_BYTES = 20_000_000  # [B]
LOOKS_LIKE = {b"<": "it looks like a web page", b"%pdf": "it is a PDF", b"pk": "it is a zip archive"}
MAX_HEAD = 40  # characters of a cell's first line


@dataclass(frozen=True)
class Notebook:
    """A handed-in notebook: its code cells, its exercise, the ID that it claims.

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
        content = read_json(data)  # in UTF-8, 16 or 32, as it begins
    except ValueError as error:
        start = data.lstrip()[:4].lower()
        kinds = [text for first, text in LOOKS_LIKE.items() if start.startswith(first)]
        what = kinds[0] if kinds else "it is not JSON" if start else "it is empty"
        raise CourseError(f"{name} is not a notebook: {what}. Save it again in JupyterLab.") from error
    content = _dict(content)
    sheets = content.get("worksheets")  # what format 3 had around the cells
    sheet = _dict(sheets[0]) if isinstance(sheets, list) and sheets else {}
    cells = content.get("cells", sheet.get("cells"))
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise CourseError(
            f"{name} is not a notebook of format 3 or 4: it has no list of cells. Save it again."
        )
    code_cells = [cell for cell in cells if cell.get("cell_type") == "code"]
    code = tuple(source({"source": cell.get("source", cell.get("input", ""))}) for cell in code_cells)
    ran = tuple(bool(cell.get("execution_count", cell.get("prompt_number"))) for cell in code_cells)
    claims = _dict(_dict(content.get("metadata")).get("course"))
    exercise = exercise_named(claims.get("exercise")) or exercise_named(name)
    return Notebook(code, exercise, claimed_id(claims), ran)


def exercise_named(text: Any) -> str | None:
    """Return the exercise that a name begins with, "week01_exercise", or None."""
    named = re.match(r"week\d\d_exercise", text) if isinstance(text, str) else None
    return named and named[0]


def claimed_id(claims: Any) -> str | None:
    """Return the ID that a file claims, normalised, as it may become a folder's name, or None."""
    try:
        claim = _dict(claims).get("student")
        return normalise(claim) if isinstance(claim, str) else None
    except CourseError:
        return None


def _dict(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


@dataclass(frozen=True)
class CodeCell:
    """A code cell: its number among the code cells, its source, whether it was run in the saved notebook."""

    number: int
    source: str
    ran: bool

    @property
    def name(self) -> str:
        """The cell's name in messages."""
        head = next((line.strip() for line in self.source.splitlines() if line.strip()), "")
        return f"code cell {self.number} ({head[:MAX_HEAD]}{'…' * (len(head) > MAX_HEAD)})"

    @property
    def digest(self) -> str:
        """The digest of the source."""
        return cell_digest(self.source)

    @cached_property
    def tree(self) -> ast.Module:
        """Its Python; empty where it cannot be parsed."""
        try:
            return ast.parse(without_magics(self.source))
        except (SyntaxError, ValueError):
            return ast.Module([], [])

    @cached_property
    def syntax_error(self) -> str:
        """Return what is wrong with its Python, or ""."""
        try:
            compile(without_magics(self.source), "cell", "exec", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT, True)
        except (SyntaxError, ValueError) as error:
            line = f", line {error.lineno}" if isinstance(error, SyntaxError) and error.lineno else ""
            return f"{self.name}{line}: {getattr(error, 'msg', error)}"
        return ""

    @cached_property
    def gives(self) -> frozenset[str]:
        """The names that it binds, not counting those inside functions and classes."""
        return frozenset(bound_names(self.tree))

    @cached_property
    def checks(self) -> Mapping[str, ast.expr]:
        """The second argument of each call of `check`, by task."""
        calls = (node for node in ast.walk(self.tree) if isinstance(node, ast.Call) and len(node.args) > 1)
        return {
            str(call.args[0].value): call.args[1]
            for call in calls
            if getattr(call.func, "id", "") == "check" and isinstance(call.args[0], ast.Constant)
        }

    @cached_property
    def is_stub(self) -> bool:
        """True if the cell raises NotImplementedError somewhere."""
        raised = (node.exc for node in ast.walk(self.tree) if isinstance(node, ast.Raise) and node.exc)
        return any(ast.unparse(one).startswith("NotImplementedError") for one in raised)
