"""`course check FILE`: run the public checks of a whole notebook in a separate process, as in grading."""

import re
from collections.abc import Sequence
from pathlib import Path

from course_lib.course.exercise import SET_IDENTITY, current_identity, find_notebook
from course_lib.errors import CourseError, format_count
from course_lib.grading.advice import Advice
from course_lib.grading.check import save_progress, table_of
from course_lib.grading.judge import judge
from course_lib.grading.own_source import source_in_cells
from course_lib.grading.records import TaskResult
from course_lib.grading.run.outcome import NOT_DEFINED
from course_lib.grading.run.run import Job, plan_scenarios, run_scenarios
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.notebook import NOT_SUBMITTED, CodeCell, own_modules, parse_notebook
from course_lib.grading.submissions.submission import NO_EXERCISE, unpack
from course_lib.grading.task import shipped_catalog

WEEK = re.compile(r"week\d\d")
NOT_CHECKED = "{0.id} ({0.title}): not checked, because {0.name} cannot run; the reason is above."


def check_file(path: Path) -> bool:
    """Run a notebook, print a table per task, and return whether everything passed.

    Raises:
        CourseError: The file can't be read, or is not an exercise of the course.
    """
    path = find_notebook(path)
    notebook, catalog = parse_notebook(unpack(path)[0], path.name), shipped_catalog()
    week = (notebook.exercise or "").split("_")[0]
    tasks = catalog.tasks_of_week(week)
    if not tasks:
        weeks = catalog.course.weeks
        if not WEEK.fullmatch(week) or week in weeks:
            raise CourseError(f"{path} {NO_EXERCISE}")
        raise CourseError(
            f"{path} belongs to {week}, but course.toml has no [weeks.{week}]; it has {', '.join(weeks)}"
        )
    identity = current_identity()
    student = notebook.student or identity
    steps = plan_scenarios(tasks, catalog, with_hidden=False)
    files = catalog.with_assets(week, working_files(path, notebook.cells))
    exercise_run = run_scenarios(Job(notebook.cells, student, steps, catalog.course.limits, files))
    judgement = judge(exercise_run, tasks, catalog)
    causes = RootCauses(judgement.cell_errors, notebook.cells)
    parts: list[object] = [*causes.lines()]
    parts += map(NOT_SUBMITTED.format, own_modules(path, notebook.cells))
    advice = Advice()
    cells = [CodeCell(number, text, True) for number, text in enumerate(notebook.cells, 1)]
    for task, result in zip(tasks, judgement.tasks, strict=True):
        save_progress(task, result, notebook.cells, student)
        evidence = [run.evidence for run in exercise_run.runs if run.evidence.task == task.id]
        follows = causes.is_only_cause(result)
        # The object that `check` receives may have another name than the task.
        arguments = [cell.checks[task.id] for cell in cells if task.id in cell.checks]
        name = getattr(arguments[-1], "id", "") if arguments else task.name
        own_source = source_in_cells(name, notebook.cells, task.week)
        table = table_of(task, result, evidence, student, advice, own_source)
        parts.append(NOT_CHECKED.format(task) if follows else table)
    if identity and student != identity:
        parts.append(
            f"{path.name} has the student ID {student}, but yours is {identity}. Run in a cell: "
            f"{SET_IDENTITY.format(identity)}"
        )
    print(*parts, sep="\n\n")  # noqa: T201
    return all(result.passed for result in judgement.tasks)


_UNKNOWN_NAME = re.compile(r"NameError: name '(\w+)' is not defined")
_PLACE = re.compile(r"\(cell In\[(\d+)\]")
# So many undefined names are more likely a missing cell than misspelled letters.
MANY = 3


class RootCauses:
    """The errors of a notebook's cells, without errors that only follow from an earlier one.

    Args:
        errors: The cells' error texts from `describe`, in cell order.
        cells: The sources of all code cells.
    """

    def __init__(self, errors: Sequence[str], cells: Sequence[str]) -> None:
        self._kept: list[str] = []
        self._followers = 0
        bindings_by_cell = [CodeCell(number, text, True).bindings for number, text in enumerate(cells, 1)]
        unknown = (_UNKNOWN_NAME.match(error) for error in errors)
        names = dict.fromkeys(found[1] for found in unknown if found)
        self._defined = frozenset[str]().union(*bindings_by_cell)
        self._undefined = [name for name in names if name not in self._defined]
        self._cell_missing = len(self._undefined) >= MANY
        lost_names = set[str]()
        for error in errors:
            found, place = _UNKNOWN_NAME.match(error), _PLACE.search(error)
            number = int(place[1]) if place else 0
            if found and found[1] in lost_names:
                self._followers += 1
            else:
                self._kept.append(error)
            lost_names |= bindings_by_cell[number - 1] if 0 < number <= len(bindings_by_cell) else set()
            if found:
                lost_names |= set(self._undefined) if self._cell_missing else {found[1]}

    def lines(self) -> list[str]:
        """Return the first errors, and the number of errors that follow from them."""
        causes = list(self._kept)
        if self._cell_missing:
            names = ", ".join(self._undefined)
            causes.append(f"No cell imports or defines {names}: is the cell with the imports missing?")
        if self._followers:
            causes.append(f"{format_count(self._followers, 'more cell')} cannot run for the same reason.")
        return causes

    def is_only_cause(self, result: TaskResult) -> bool:
        """Return whether these errors are the only reason why the task failed."""
        for error in result.errors:
            unknown = _UNKNOWN_NAME.match(error)
            if unknown is None:
                follows = error.endswith(NOT_DEFINED)
            else:
                is_lost = self._cell_missing and unknown[1] not in self._defined
                follows = is_lost or unknown[1] in self._undefined
            if not follows:
                return False
        return bool(self._kept and result.errors)
