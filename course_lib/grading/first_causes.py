"""Errors of cells without those that only follow from an earlier one."""

import re
from collections.abc import Sequence

from course_lib.errors import counted
from course_lib.grading.handin.notebook import CodeCell
from course_lib.grading.judge import TaskResult

_UNKNOWN_NAME = re.compile(r"NameError: name '(\w+)' is not defined")
_PLACE = re.compile(r"\(cell In\[(\d+)\]")
MANY = 3  # names that no cell makes: a cell is missing, not a letter
NOT_MADE = "is not in the notebook: no cell that ran to its end makes it"  # behind a task's name


class Causes:
    """What kept a notebook's cells from running.

    Args:
        errors: Of the cells, in their order, as `describe` words them.
        cells: The sources of all code cells.
    """

    def __init__(self, errors: Sequence[str], cells: Sequence[str]) -> None:
        self._kept: list[str] = []
        self._followers = 0
        made = [CodeCell(number, text, True).gives for number, text in enumerate(cells, 1)]
        unknown = (_UNKNOWN_NAME.match(error) for error in errors)
        names = dict.fromkeys(found[1] for found in unknown if found)
        self._made = frozenset[str]().union(*made)
        self._nowhere = [name for name in names if name not in self._made]
        self._cell_missing = len(self._nowhere) >= MANY
        lost = set[str]()
        for error in errors:
            found, place = _UNKNOWN_NAME.match(error), _PLACE.search(error)
            number = int(place[1]) if place else 0
            if found and found[1] in lost:
                self._followers += 1
            else:
                self._kept.append(error)
            lost |= made[number - 1] if 0 < number <= len(made) else set()
            if found:
                lost |= set(self._nowhere) if self._cell_missing else {found[1]}

    def lines(self) -> list[str]:
        """Return the first errors, and how many others follow from them."""
        found = list(self._kept)
        if self._cell_missing:
            names = ", ".join(self._nowhere)
            found.append(f"No cell imports or defines {names}: is the cell with the imports missing?")
        if self._followers:
            found.append(f"{counted(self._followers, 'more cell')} cannot run for the same reason.")
        return found

    def explain(self, result: TaskResult) -> bool:
        """Whether a task only failed because of these errors, so that its checks would say them again."""
        return bool(self._kept and result.errors) and all(map(self._follows, result.errors))

    def _follows(self, error: str) -> bool:
        unknown = _UNKNOWN_NAME.match(error)
        if unknown is None:
            return error.endswith(NOT_MADE)
        return unknown[1] in self._nowhere or (self._cell_missing and unknown[1] not in self._made)
