"""Running and judging whole notebooks, for the tests of all weeks' checks."""

import linecache
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import exercises_dir, solutions_dir
from course_lib.grading.evidence import Evidence
from course_lib.grading.inputs import personal_values, set_values
from course_lib.grading.judge import judge
from course_lib.grading.records import Judgement, Run
from course_lib.grading.run.run import Job, plan_scenarios, run_scenarios
from course_lib.grading.run.scenario import run_in_this_process
from course_lib.grading.task import Catalog, Scenario, Task, load_catalog

WEEKS = sorted(path.name[:6] for path in solutions_dir().glob("week*_solution.ipynb"))
STUDENT = "s1"
A_WHILE = 100.0  # [s]
IN_PROCESS = ("node", "function")  # kinds of tasks that need only the cells that define something
DEFINITION = r"(class|def|import|from|[A-Z_]+ =|\"\"\"|#)"


@cache
def catalog() -> Catalog:
    """The course's, with limits for a machine that has much else to do."""
    loaded = load_catalog(exercises_dir(), solutions_dir())
    limits = replace(
        loaded.course.limits, cell_seconds=A_WHILE, scenario_seconds=A_WHILE, total_seconds=600.0
    )
    return replace(loaded, course=replace(loaded.course, limits=limits))


def cells_of(path: Path) -> list[str]:
    if path.suffix == ".py":
        return [path.read_text()]
    return [source(cell) for cell in read_notebook(path)["cells"] if cell["cell_type"] == "code"]


def solution(week: str) -> Path:
    return solutions_dir() / f"{week}_solution.ipynb"


class Marked(NamedTuple):
    """The evidence of a notebook, and its judgement."""

    runs: tuple[Run, ...]
    judgement: Judgement


def marked(cells: Sequence[str], tasks: Sequence[Task], *, hidden: bool = True) -> Marked:
    steps = plan_scenarios(tasks, catalog(), with_hidden=hidden)
    evidence = run_scenarios(Job(tuple(cells), STUDENT, steps, catalog().course.limits))
    return Marked(evidence.runs, judge(evidence, tasks, catalog()))


@cache
def run_of(path: Path) -> Marked:
    """Run and judge a file: a solution, an exercise as it is handed out, or an answer."""
    return marked(cells_of(path), catalog().tasks_of_week(path.name[:6]))


def defined(cells: Sequence[str], week: str) -> dict[str, Any]:
    """Return the names that a notebook defines, executed in this process without views and runs."""
    set_values({task.id: personal_values(task, STUDENT) for task in catalog().tasks_of_week(week)})
    namespace: dict[str, Any] = {}
    for number, cell in enumerate(re.sub(r"^%.*\n", "", cell) for cell in cells):
        if re.match(DEFINITION, cell):
            # Hints read the failing line, which IPython offers in the same way.
            name = f"<cell {number}>"
            linecache.cache[name] = (len(cell), None, cell.splitlines(keepends=True), name)
            exec(compile(cell, name, "exec"), namespace)
    return namespace


def evidence_here(
    task: Task, scenario: Scenario, namespace: Mapping[str, Any], wall_limit: float = A_WHILE
) -> Evidence:
    """Return the evidence of a scenario, run in this process."""
    subject, personal = namespace[task.name], personal_values(task, STUDENT)
    return run_in_this_process(task, scenario, subject, personal, wall_limit=wall_limit)


def judged(week: str) -> list[Task]:
    """Return the tasks that are judged by checks, without manually marked ones."""
    return [task for task in catalog().tasks_of_week(week) if not task.rubric]
