"""A notebook as the rules for lessons see it."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from course_lib.course.exercise import Notebook, read_notebook, source


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
        """The notebook as plain data."""
        return read_notebook(self.path)

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
    def headings(self) -> list[tuple[int, str]]:
        """The headings with their levels."""
        return [(len(m[1]), m[2]) for m in re.finditer(r"^(#+) (.+)$", self.markdown, re.MULTILINE)]

    @property
    def week(self) -> str:
        """The first word of its name, "week01"."""
        return self.path.stem.split("_")[0]
