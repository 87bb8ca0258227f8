"""Errors of cells without those that only follow from an earlier one."""

import re
from collections.abc import Sequence

from course_lib.errors import counted
from course_lib.grading.code_cell import CodeCell
from course_lib.grading.judge import TaskResult

_UNKNOWN_NAME = re.compile(r"NameError: name '(\w+)' is not defined")
_PLACE = re.compile(r"\(cell In\[(\d+)\]")
NOT_MADE = "is not in the notebook: no cell that ran to its end makes it"  # behind a task's name


def first_causes(errors: Sequence[str], cells: Sequence[str]) -> list[str]:
    """Return the errors of a notebook's cells, those that follow from an earlier one only counted.

    Args:
        errors: In the order of the cells, as `describe` words them.
        cells: The sources of all code cells.
    """
    kept, lost, followers = list[str](), set[str](), 0
    for error in errors:
        unknown, place = _UNKNOWN_NAME.match(error), _PLACE.search(error)
        number = int(place[1]) if place else 0
        gives = CodeCell(number, cells[number - 1], True).gives if 0 < number <= len(cells) else frozenset()
        if unknown and unknown[1] in lost:
            followers += 1
        else:
            kept.append(error)
        lost |= gives | ({unknown[1]} if unknown else set())
    if followers:
        kept.append(f"{counted(followers, 'more cell')} cannot run for the same reason.")
    return kept


def is_not_made(result: TaskResult) -> bool:
    """Whether a task's object is missing, so that each of its checks would only say this again."""
    return bool(result.errors) and all(error.endswith(NOT_MADE) for error in result.errors)
