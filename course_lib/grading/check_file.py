"""`course check FILE`: the public checks of a whole notebook, in a process of its own, as at grading."""

import re
from collections.abc import Sequence
from pathlib import Path

from course_lib.course.exercise import find_notebook
from course_lib.course.identity import current_identity
from course_lib.errors import CourseError, counted
from course_lib.grading.advice import Advice
from course_lib.grading.catalog import Catalog, shipped_catalog
from course_lib.grading.check import remember, table_of
from course_lib.grading.handin.archives import working_files
from course_lib.grading.handin.notebook import CodeCell, parse_notebook
from course_lib.grading.handin.submission import NO_EXERCISE, unpack
from course_lib.grading.judge import TaskResult, judge
from course_lib.grading.run.job import Job, plan
from course_lib.grading.run.outcome import NOT_MADE
from course_lib.grading.run.run import run_scenarios

WEEK = re.compile(r"week\d\d")
NOT_CHECKED = "{0.id} ({0.title}): not checked, as {0.name} cannot run for a reason above."


def check_file(path: Path) -> bool:
    """Run a notebook, print a table per task, and return whether everything passed.

    Raises:
        CourseError: It can't be read, or is not an exercise of the course.
    """
    path = find_notebook(path)
    notebook, catalog = parse_notebook(unpack(path)[0], path.name), shipped_catalog()
    tasks = catalog.of_week((notebook.exercise or "").split("_")[0])
    if not tasks:
        raise CourseError(f"{path} {_no_tasks((notebook.exercise or '').split('_')[0], catalog)}")
    own = current_identity()
    student = notebook.student or own
    steps, files = plan(tasks, catalog, hidden=False), working_files(path, notebook.cells)
    made = run_scenarios(Job(notebook.cells, student, steps, catalog.course.limits, files))
    judgement = judge(made, tasks, catalog)
    causes = Causes(judgement.cell_errors, notebook.cells)
    said: list[object] = [*causes.lines()]
    advice = Advice()
    for task, result in zip(tasks, judgement.tasks, strict=True):
        remember(task, result, notebook.cells)
        evidence = [one.evidence for one in made.runs if one.evidence.task == task.id]
        follows = causes.explain(result)
        table = table_of(task, result, evidence, student, advice)
        said.append(NOT_CHECKED.format(task) if follows else table)
    if own and student != own:
        said.append(
            f"{path.name} names the student {student}, you are {own}. set_identity('{own}') stamps it."
        )
    print(*said, sep="\n\n")  # noqa: T201  the terminal is its page
    return all(result.passed for result in judgement.tasks)


def _no_tasks(week: str, catalog: Catalog) -> str:
    if not WEEK.fullmatch(week) or week in catalog.course.weeks:
        return NO_EXERCISE
    return f"is of {week}, but course.toml has no [weeks.{week}]; there is {', '.join(catalog.course.weeks)}"


_UNKNOWN_NAME = re.compile(r"NameError: name '(\w+)' is not defined")
_PLACE = re.compile(r"\(cell In\[(\d+)\]")
MANY = 3  # names that no cell makes: a cell is missing, not a letter


class Causes:
    """The errors of a notebook's cells, without those that only follow from an earlier one.

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
        """Return whether these errors are the only reason why a task failed."""
        return bool(self._kept and result.errors) and all(map(self._follows, result.errors))

    def _follows(self, error: str) -> bool:
        unknown = _UNKNOWN_NAME.match(error)
        if unknown is None:
            return error.endswith(NOT_MADE)
        return unknown[1] in self._nowhere or (self._cell_missing and unknown[1] not in self._made)
