"""The stage `run`: from a job to evidence, which is kept in a file."""

import gzip
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

import msgpack

from course_lib.errors import CourseError
from course_lib.grading.catalog import Catalog
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.isolation import Isolation
from course_lib.grading.jail.launch import shared_template
from course_lib.grading.judge import Run, TaskResult, judge_task
from course_lib.grading.run.job import Job, Step, plan
from course_lib.grading.run.outcome import Usage
from course_lib.grading.run.submission_run import CellLog, SubmissionRun
from course_lib.grading.task import Task
from course_lib.ros.graph import Sample
from course_lib.ros.qos import Qos


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
    with closing(SubmissionRun(job.cells, job.personal, job.limits, template, job.files)) as session:
        runs = [Run(s.scenario, session.run(s.task, s.scenario), s.hidden) for s in job.steps]
    return ExerciseRun((), tuple(runs), session.log, session.isolation, usage=session.usage)


def judge_exercise(run: ExerciseRun, tasks: Sequence[Task], catalog: Catalog) -> ExerciseRun:
    """Return the same run with its tasks and their results."""
    results = [
        judge_task(task, *catalog.points(task), [r for r in run.runs if r.evidence.task == task.id])
        for task in tasks
    ]
    return replace(run, tasks=tuple(tasks), results=tuple(results))


VERSION = 2
LEVEL = 2  # of compression: a higher one takes longer than the run did


def pack(run: ExerciseRun) -> bytes:
    """All that came out of a submission: the same bytes for the same evidence."""
    content = {
        "version": VERSION,
        "isolation": run.isolation.layers,
        "log": run.log,
        "evidence": [one.evidence for one in run.runs],
    }
    return gzip.compress(msgpack.packb(content, default=_by_field), LEVEL, mtime=0)


def unpack(data: bytes, steps: Sequence[Step]) -> ExerciseRun:
    """What `pack` made, with the checks of today.

    Raises:
        CourseError: It is something else, or of other scenarios.
    """
    try:
        content = msgpack.unpackb(gzip.decompress(data), strict_map_key=False)
        if content["version"] != VERSION:
            raise ValueError(f"it is of version {content['version']}, expected {VERSION}")
        kept = {(row["task"], row["scenario"]): _evidence(row) for row in content["evidence"]}
        runs = [Run(s.scenario, kept[s.task.id, s.scenario.name], s.hidden) for s in steps]
        log, isolation = CellLog(**content["log"]), Isolation(tuple(content["isolation"]))
    except Exception as error:  # a file may hold anything
        raise CourseError(f"stored evidence can't be read ({error!r}): grade without --rejudge") from error
    return ExerciseRun((), tuple(runs), log, isolation)


def _by_field(data: Any) -> dict[str, Any]:
    """A dataclass as its fields, without what it has worked out from them."""
    return {field.name: getattr(data, field.name) for field in fields(data)}


def _evidence(row: dict[str, Any]) -> Evidence:
    samples = tuple(Sample(**{**sample, "qos": Qos(**sample["qos"])}) for sample in row["samples"])
    texts = {name: tuple(row[name]) for name in ("returns", "errors")}
    return Evidence(**{**row, **texts, "samples": samples})
