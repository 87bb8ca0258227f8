"""Rehearsals: notebooks of the author's, run in the jail and judged as submissions are."""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from course_lib.authoring.hollow import HOLLOWINGS, Hollowing
from course_lib.course.course_file import Limits
from course_lib.course.exercise import code_cells, read_notebook, source
from course_lib.grading.catalog import Catalog
from course_lib.grading.handin.archives import working_files
from course_lib.grading.judge import TaskResult, judge, judge_task
from course_lib.grading.records import Course, catalog_of
from course_lib.grading.run.job import Job, Run, plan
from course_lib.grading.run.run import run, unpack
from course_lib.grading.task import Task

STUDENT = "author"
MOST = 100  # combinations of one task's personal options that are tried
PATIENCE = 10.0  # times the course's limits of time: an author's machine has much else to do
DEFINES = re.compile(r'(class|def|import|from|[A-Z_]+ =|"""|#|@|%load_ext)')
CHECKS = re.compile(r"^check\(", re.MULTILINE)
ONLY_DEFINED = ("node", "function")  # kinds of tasks that need no cell but those that define something


@dataclass(frozen=True)
class Rehearsal:
    """A notebook to be run and judged.

    Args:
        week: The week.
        name: "the solution", "the stub".
        cells: Its code.
        tasks: The ids of the tasks that are run.
        hidden: Whether the hidden scenarios are run, too.
        option: The row of the personal options; each task's own number of options comes round.
        hollow: Whether what it published is judged once more, emptied of its content.
    """

    week: str
    name: str
    cells: tuple[str, ...]
    tasks: tuple[str, ...]
    hidden: bool = True
    option: int = 0
    hollow: bool = False


@dataclass(frozen=True)
class Rehearsed:
    """The results of a rehearsal.

    Args:
        results: Of its tasks, in order.
        cell_errors: What its cells raised.
        hollow: By the way of emptying and its remedy, the results of the tasks that it changes.
        types: By task and topic, the type of message that was published.
    """

    results: tuple[TaskResult, ...]
    cell_errors: tuple[str, ...]
    hollow: tuple[tuple[str, str, TaskResult], ...]
    types: tuple[tuple[str, str, str], ...]


def cells_of(path: Path) -> tuple[str, ...]:
    """Return the code cells of a notebook, or a Python file as one cell."""
    if path.suffix == ".py":
        return (path.read_text(encoding="utf-8"),)
    return tuple(source(cell) for _, cell in code_cells(read_notebook(path)))


def rehearse(rehearsal: Rehearsal, course: Course) -> Rehearsed:
    """Run a rehearsal in the jail of this process, and judge it."""
    catalog = patient(course)
    tasks = [with_option(catalog.task(name), rehearsal.option) for name in rehearsal.tasks]
    steps = plan(tasks, catalog, hidden=rehearsal.hidden)
    cells = _needed(rehearsal.cells, tasks)
    files = working_files(course.solutions / f"{rehearsal.week}_solution.ipynb", cells)
    unjudged = tuple(step.unjudged() for step in steps)
    job = Job(cells, STUDENT, unjudged, catalog.course.limits, files, course.sandbox, course.refused)
    made = unpack(run(job).evidence, steps)
    judgement = judge(made, tasks, catalog)
    types = {
        (one.evidence.task, topic, type_name)
        for one in made.runs
        for topic, type_name in one.evidence.topics.items()
    }
    emptied = _hollowed(tasks, made.runs, catalog) if rehearsal.hollow else ()
    hollow = tuple((way.name, way.remedy, result) for way, result in emptied)
    return Rehearsed(judgement.tasks, judgement.cell_errors, hollow, tuple(sorted(types)))


@lru_cache(maxsize=4)
def patient(course: Course) -> Catalog:
    """Return the catalog with limits for a machine that has much else to do."""
    catalog = catalog_of(course)
    limits = catalog.course.limits
    seconds = {name: PATIENCE * value for name, value in vars(limits).items() if name.endswith("_seconds")}
    slow: Limits = replace(limits, **seconds)
    return replace(catalog, course=replace(catalog.course, limits=slow))


def options(tasks: Iterable[Task]) -> int:
    """Return how many combinations of personal options a task has, of several the most, up to MOST."""
    return max((min(_combinations(task), MOST) for task in tasks), default=1)


def with_option(task: Task, row: int) -> Task:
    """Return the task with one option of each personal value, so that every student gets these."""
    rows, own = options([task]), {}
    number = row % rows * _combinations(task) // rows  # all of them, or some from begin to end
    for name, choices in task.personal.items():
        number, index = divmod(number, len(choices))
        own[name] = (choices[index],)
    return replace(task, personal=own)


def _combinations(task: Task) -> int:
    return math.prod(len(choices) for choices in task.personal.values())


def _needed(cells: Sequence[str], tasks: Sequence[Task]) -> tuple[str, ...]:
    """Return the cells that these tasks need: views and live runs are left out where nothing reads them."""
    if any(task.kind not in ONLY_DEFINED for task in tasks):
        return tuple(cells)
    return tuple(cell for cell in cells if DEFINES.match(cell) or CHECKS.search(cell))


def _hollowed(
    tasks: Sequence[Task], runs: Sequence[Run], catalog: Catalog
) -> Iterable[tuple[Hollowing, TaskResult]]:
    for task in (task for task in tasks if task.kind == "node"):
        before = [one for one in runs if one.evidence.task == task.id]
        for hollowing in HOLLOWINGS:
            after = [replace(one, evidence=hollowing.of(one.evidence)) for one in before]
            if after != before:
                yield hollowing, judge_task(task, *catalog.points(task), after)
