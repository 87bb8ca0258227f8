"""Runs and judges all tasks of one notebook: `course check` and `course grade` alike."""

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, replace
from typing import Any

from course_lib.grading.catalog import Catalog
from course_lib.grading.jail.isolation import Isolation
from course_lib.grading.judge import Run, TaskResult, judge_task
from course_lib.grading.personal import personal_values
from course_lib.grading.runner import CellLog, Session
from course_lib.grading.task import Task


@dataclass(frozen=True)
class ExerciseRun:
    """What came out of a notebook, and what the checks say."""

    tasks: tuple[Task, ...]
    runs: tuple[Run, ...]
    log: CellLog
    isolation: Isolation
    results: tuple[TaskResult, ...] = ()

    @property
    def cell_errors(self) -> list[str]:
        """What went wrong while the cells were run, once, before the scenarios."""
        return [*self.log.stopped.values(), *self.log.errors]

    def as_plain(self) -> dict[str, Any]:
        """What a result file says of it."""
        digests = {f"{r.evidence.task}/{r.scenario.name}": r.evidence.recording.digest() for r in self.runs}
        return {
            "tasks": [{**asdict(task), "score": task.score} for task in self.results],
            "cell_errors": self.cell_errors,
            "output": self.log.output,
            "digests": digests,
        }


def run_exercise(
    cells: Sequence[str],
    tasks: Sequence[Task],
    catalog: Catalog,
    student: str | None,
    *,
    hidden: bool,
    files: Mapping[str, str] | None = None,
) -> ExerciseRun:
    """Run every scenario of every task, public first, and judge what came out."""
    return judge_exercise(run_scenarios(cells, tasks, catalog, student, hidden=hidden, files=files), catalog)


def run_scenarios(
    cells: Sequence[str],
    tasks: Sequence[Task],
    catalog: Catalog,
    student: str | None,
    *,
    hidden: bool,
    files: Mapping[str, str] | None = None,
) -> ExerciseRun:
    """Run every scenario of every task, public first; nothing is judged yet."""
    plan = [(task, scenario, False) for task in tasks for scenario in task.scenarios]
    if hidden:
        plan += [(task, scenario, True) for task in tasks for scenario in catalog.hidden.get(task.id, ())]
    personal = {task.id: personal_values(task, student) for task in tasks}
    with closing(Session(cells, personal, catalog.course.limits, files=files)) as session:
        runs = [Run(scenario, session.run(task, scenario), is_hidden) for task, scenario, is_hidden in plan]
    return ExerciseRun(tuple(tasks), tuple(runs), session.log, session.isolation)


def judge_exercise(run: ExerciseRun, catalog: Catalog) -> ExerciseRun:
    """The same run with the results of its tasks.

    Raises:
        BrokenCheckError: A check raised an exception.
    """
    results = [
        judge_task(task, *catalog.points(task), [r for r in run.runs if r.evidence.task == task.id])
        for task in run.tasks
    ]
    return replace(run, results=tuple(results))
