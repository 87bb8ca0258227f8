"""Right and wrong answers of a week, from `solutions/answers/weekNN.toml` and the files beside it."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError, place_of

RIGHT = "other_right"  # the end of the name of a whole file with right answers to all tasks


@dataclass(frozen=True)
class Variant:
    """The solution of a task with changes: a row of the week's file.

    Args:
        task: The task's id.
        change: Pairs of what is replaced in the cell of the solution, and by what.
        miss: The requirement that is missed, in words.
        says: What a public check says of it, a regular expression.
        raises: The exception that the code raises then.
        way: How a right solution differs.
        hint: The kind of mistake whose hint, one of the task's own, is shown first.
    """

    task: str
    change: tuple[tuple[str, str], ...]
    miss: str = ""
    says: str = ""
    raises: str = ""
    way: str = ""
    hint: str = ""

    def __post_init__(self) -> None:
        if bool(self.miss) == bool(self.way):
            raise CourseError("expected miss (a wrong answer) or way (a right one)")
        if self.miss and not (self.says or self.raises):
            raise CourseError(f"{self.miss!r}: expected says, what a public check says of it")
        try:
            re.compile(self.says)
        except re.error as error:
            raise CourseError(f"says: {self.says!r} is not a regular expression: {error}") from error
        if not self.change or not all(len(pair) == 2 for pair in self.change):
            raise CourseError("change: expected pairs of old and new text, [[old, new]]")


@dataclass(frozen=True)
class Answers:
    """All answers of one week.

    Args:
        path: The week's file.
        variants: Its rows.
        files: By the name of a whole file beside it, what is said of each task, by the task's id.
        same: By the task's id, operators that change nothing that its requirements name.
    """

    path: Path
    variants: tuple[Variant, ...] = ()
    files: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    same: Mapping[str, Sequence[str]] = field(default_factory=dict)

    @property
    def other_right(self) -> Path | None:
        """The whole file of other right answers, if there is one."""
        path = self.file(RIGHT)
        return path if path.is_file() else None

    def file(self, name: str) -> Path:
        """Return the path of a whole file."""
        return self.path.with_name(f"{self.path.stem}_{name}.py")

    def wrong_answers_to(self, task: str) -> int:
        """Return how many wrong answers to a task are there."""
        return sum(v.task == task and bool(v.miss) for v in self.variants) + sum(
            task in says for says in self.files.values()
        )


def read_answers(solutions: Path, week: str) -> Answers:
    """Read a week's answers; without a file there are none.

    Raises:
        CourseError: It is malformed; names the file, and the line where that is known.
    """
    path = solutions / "answers" / f"{week}.toml"
    if not path.is_file():
        return Answers(path)
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise CourseError(f"{path}: {error}") from error
    files = {name: _by_id(week, says) for name, says in tables.pop("files", {}).items()}
    same = _by_id(week, tables.pop("same", {}))
    rows = [(f"{week}.{name}", row) for name, table in tables.items() for row in table]
    return Answers(path, tuple(_variant(path, task, row) for task, row in rows), files, same)


def _by_id(week: str, table: Mapping[str, Any]) -> dict[str, Any]:
    return {f"{week}.{name}": value for name, value in table.items()}


def _variant(path: Path, task: str, row: Any) -> Variant:
    try:
        pairs = tuple(tuple(pair) for pair in row.get("change", ()))
        return Variant(task, **{**row, "change": pairs})
    except (AttributeError, TypeError, CourseError) as error:
        named = next(iter(row.values()), task) if isinstance(row, dict) else task
        raise CourseError(f"{place_of(path, str(named))}: {task}: {error}") from error


def changed(variant: Variant, name: str, cells: Sequence[str]) -> dict[int, str]:
    """Return the cells of the solution that a variant changes, by their places.

    Args:
        variant: With its changes.
        name: The name of the task's object.
        cells: Of the solution.

    Raises:
        CourseError: A text that is to be replaced is not in exactly one place of one cell with that name.
    """
    made: dict[int, str] = {}
    for old, new in variant.change:
        if old == new:
            raise CourseError(f"{old!r} is replaced by itself")
        now = [made.get(place, cell) for place, cell in enumerate(cells)]
        there = [i for i, cell in enumerate(now) if old in cell and re.search(rf"\b{name}\b", cell)]
        if len(there) != 1:
            raise CourseError(f"{old!r} is in {len(there)} cells of the solution with {name}, expected 1")
        if (count := now[there[0]].count(old)) != 1:
            more = "take more of its line into the pair"
            raise CourseError(f"{old!r} is {count} times in the cell with {name}, expected once: {more}")
        made[there[0]] = now[there[0]].replace(old, new)
    return made
