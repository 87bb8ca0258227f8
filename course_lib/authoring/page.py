"""A notebook as the rules for lessons see it."""

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from course_lib.course.exercise import Notebook, read_notebook, source
from course_lib.errors import CourseError

PARTS = {"id": str, "cell_type": str, "metadata": dict}  # of every cell
QUESTIONS = ("quiz", "predict", "compare")


def parsed(cell: str) -> ast.Module:
    """Return the syntax tree of a cell, in which lines of magics are comments.

    Raises:
        SyntaxError: It is not Python.
    """
    return ast.parse(re.sub(r"^%", "# %", cell, flags=re.MULTILINE))


@dataclass(frozen=True)
class NotebookPage:
    """A notebook of the course.

    Args:
        path: The file.
        exercises: The folder of the exercises, with `quizzes/`.
    """

    path: Path
    exercises: Path

    @cached_property
    def notebook(self) -> Notebook:
        """The notebook as plain data; each cell has what Jupyter writes."""
        notebook = read_notebook(self.path)
        for number, cell in enumerate(notebook["cells"], 1):
            if wrong := [name for name, kind in PARTS.items() if not isinstance(cell.get(name), kind)]:
                raise CourseError(f"cell {number} has no {wrong[0]!r}: write it again in JupyterLab")
        return notebook

    @property
    def cells(self) -> Sequence[dict[str, object]]:
        """All cells."""
        cells: list[dict[str, object]] = self.notebook["cells"]
        return cells

    @cached_property
    def markdown(self) -> str:
        """All text."""
        return "\n\n".join(source(c) for c in self.cells if c["cell_type"] == "markdown")

    @cached_property
    def code_cells(self) -> list[str]:
        """The code, cell by cell."""
        return [source(c) for c in self.cells if c["cell_type"] == "code"]

    @cached_property
    def code(self) -> str:
        """All code."""
        return "\n".join(self.code_cells)

    @cached_property
    def questions(self) -> list[tuple[str, str]]:
        """The questions of the code, in order: ("predict", "week01.top"), ("quiz", "week01")."""
        return [question for cell in self.code_cells for question in _questions(cell)]

    @cached_property
    def headings(self) -> list[tuple[int, str]]:
        """The headings with their levels."""
        return [(len(m[1]), m[2]) for m in re.finditer(r"^(#+) (.+)$", self.markdown, re.MULTILINE)]

    @property
    def week(self) -> str:
        """The first word of its name, "week01"."""
        return self.path.stem.split("_")[0]


def _questions(cell: str) -> Iterator[tuple[str, str]]:
    try:
        tree = parsed(cell)
    except SyntaxError:  # a rule names it
        return
    calls = (node for node in ast.walk(tree) if isinstance(node, ast.Call))
    for call in sorted(calls, key=lambda node: (node.lineno, node.col_offset)):
        match call:
            case ast.Call(ast.Name(name), [ast.Constant(str(asked)), *_]) if name in QUESTIONS:
                yield name, asked
