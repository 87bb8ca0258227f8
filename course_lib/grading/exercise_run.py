"""Runs and judges all tasks of one notebook: `course check` and `course grade` alike."""

from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from course_lib.grading.catalog import Catalog
from course_lib.grading.jail.isolation import Isolation
from course_lib.grading.jail.launch import shared_template
from course_lib.grading.job import Job, plan
from course_lib.grading.judge import Run, TaskResult, judge_task
from course_lib.grading.runner import CellLog, Session
from course_lib.grading.task import Task
from course_lib.grading.usage import Usage


@dataclass(frozen=True)
class ExerciseRun:
    """What came out of a notebook, and what the checks say."""

    tasks: tuple[Task, ...]
    runs: tuple[Run, ...]
    log: CellLog
    isolation: Isolation
    results: tuple[TaskResult, ...] = ()
    usage: Usage = field(default_factory=Usage)

    @property
    def cell_errors(self) -> list[str]:
        """What went wrong while the cells were run, once, before the scenarios."""
        return [*self.log.stopped.values(), *self.log.errors]

    @property
    def broken(self) -> list[str]:
        """Each check that raised an exception, with task and scenario; for staff."""
        rows = [(task.task, check) for task in self.results for check in task.checks if check.broken]
        return [f"{task}, {check.scenario}, {check.title!r}: {check.broken}" for task, check in rows]

    def as_plain(self) -> dict[str, Any]:
        """What a result file says of it."""
        digests = {f"{r.evidence.task}/{r.scenario.name}": r.evidence.recording.digest() for r in self.runs}
        return {
            "tasks": [
                {**asdict(result), "score": result.score, "rubric": [asdict(row) for row in task.rubric]}
                for task, result in zip(self.tasks, self.results, strict=True)
            ],
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
    steps = plan(tasks, catalog, hidden=hidden)
    job = Job(tuple(cells), student, steps, catalog.course.limits, files or {})
    return judge_exercise(run_scenarios(job), tasks, catalog)


def run_scenarios(job: Job) -> ExerciseRun:
    """Run all scenarios; nothing is judged yet."""
    template = shared_template(job.refused)
    with closing(Session(job.cells, job.personal, job.limits, template, job.files)) as session:
        runs = [Run(s.scenario, session.run(s.task, s.scenario), s.hidden) for s in job.steps]
    return ExerciseRun((), tuple(runs), session.log, session.isolation, usage=session.usage)


def judge_exercise(run: ExerciseRun, tasks: Sequence[Task], catalog: Catalog) -> ExerciseRun:
    """Return the same run with its tasks and their results."""
    results = [
        judge_task(task, *catalog.points(task), [r for r in run.runs if r.evidence.task == task.id])
        for task in tasks
    ]
    return replace(run, tasks=tuple(tasks), results=tuple(results))
