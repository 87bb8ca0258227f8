"""The stage `run`: from a job to evidence, stored under the job's digest."""

import gzip
import json
import os
import threading
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import msgpack

from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.evidence import Evidence
from course_lib.grading.jail.isolation import Isolation, Need
from course_lib.grading.jail.launch import KilledStartError, TemplateProcess, WorkerError, shared_template
from course_lib.grading.records import evidence_path, usage_path, writing
from course_lib.grading.run.job import VERSION, Job, Run, Step
from course_lib.grading.run.outcome import Usage
from course_lib.grading.run.submission_run import CellLog, SubmissionRun
from course_lib.ros.graph import Sample
from course_lib.ros.qos import Qos

TRIES = 2
OUT_OF_MEMORY = (
    ". The machine may be out of memory: close other programs, or grade with --jobs 1. "
    "Nothing is lost: the same command with --resume goes on"
)
PROCESSOR = 36  # place in what /proc tells of a thread, counted behind its name
LEVEL = 2  # of compression: a higher one takes longer than the run did
_one_at_a_time = threading.Lock()  # a process has one template, and Dask may call from several threads


@dataclass(frozen=True)
class ExerciseRun:
    """The evidence of all scenarios of one submission, and the log of its cells."""

    runs: tuple[Run, ...]
    log: CellLog
    isolation: Isolation
    usage: Usage = field(default_factory=Usage)


@dataclass(frozen=True)
class Ran:
    """An `ExerciseRun` as it is stored, and the usage, which differs from run to run."""

    evidence: bytes
    usage: Usage


def demand(need: Need, refused: tuple[str, ...] = ()) -> None:
    """Check that this machine isolates submissions as well as is needed.

    Raises:
        CourseError: It does not; names what is missing and what to type.
    """
    shared_template(refused).isolation.demand(need)


def make_ready(need: Need, refused: tuple[str, ...]) -> list[str]:
    """Start this process's template, and demand what is needed of it.

    Returns:
        Lines for the terminal: a start that was killed, after which another one came up.

    Raises:
        CourseError: The machine's isolation is less than is needed.
        WorkerError: No template comes up, or each was killed; says what to do.
    """
    killed = list[str]()
    while len(killed) < TRIES:
        try:
            demand(need, refused)
            return [f"Tried again: {why}" for why in killed]
        except KilledStartError as error:
            killed.append(str(error))
    raise WorkerError(f"{killed[-1]}, {TRIES} times{OUT_OF_MEMORY}")


def run(job: Job) -> Ran:
    """Run a submission in the jail of this machine.

    Raises:
        CourseError: The machine's isolation is less than the job needs.
        WorkerError: No worker lives long enough: a fault of the kit or of the machine.
    """
    why: Exception | None = None
    with _one_at_a_time:
        for _ in range(TRIES):
            try:
                demand(job.need, job.refused)
                return _run_in(shared_template(job.refused), job)
            except (OSError, WorkerError) as error:  # it may have been killed before, or while it started
                why = error
    raise WorkerError(f"no worker can be started, or it was killed, {TRIES} times: {why}") from why


def _run_in(template: TemplateProcess, job: Job) -> Ran:
    """Run a job; a template that was killed is closed, as the evidence means nothing then."""
    try:
        made = run_scenarios(job)
        if not template.is_sound:
            raise WorkerError("the template was killed")
    except (OSError, WorkerError):
        template.close()
        raise
    return Ran(pack(made), made.usage)


def run_scenarios(job: Job) -> ExerciseRun:
    """Run all scenarios of a job."""
    template = shared_template(job.refused)
    submission = SubmissionRun(job.cells, job.personal, job.limits, template, job.files)
    with _on_one_processor(), closing(submission):
        runs = [Run(s.scenario, submission.run(s.task, s.scenario), s.hidden) for s in job.steps]
    return ExerciseRun(tuple(runs), submission.log, submission.isolation, submission.usage)


@contextmanager
def _on_one_processor() -> Iterator[None]:
    """Keep this thread on the processor that runs it now, and with it the workers that it starts.

    Grader and worker take turns, and waking a process on another processor takes several times longer.
    """
    try:
        allowed = os.sched_getaffinity(0)
        status = Path("/proc/thread-self/stat").read_text(encoding="utf-8")
        os.sched_setaffinity(0, {int(status.rpartition(")")[2].split()[PROCESSOR])})
    except (AttributeError, OSError):  # not Linux, or it may not: only slower
        yield
        return
    try:
        yield
    finally:
        os.sched_setaffinity(0, allowed)


def keep(out: Path, key: str, ran: Ran) -> None:
    """Write evidence and usage, each whole or not at all.

    Raises:
        OutError: They can't be written.
    """
    with writing(out):
        write_whole(usage_path(out, key), json.dumps(asdict(ran.usage)).encode())
        write_whole(evidence_path(out, key), ran.evidence)


def read_usage(out: Path, key: str) -> Usage | None:
    """Return what a run used, or None if that is not known."""
    with suppress(OSError, ValueError, TypeError, AttributeError):
        content = read_json(usage_path(out, key).read_text(encoding="utf-8"))
        scenarios = {name: float(seconds) for name, seconds in content.pop("scenarios", {}).items()}
        return Usage(**{name: float(value) for name, value in content.items()}, scenarios=scenarios)
    return None


def pack(made: ExerciseRun) -> bytes:
    """Return the bytes to store: the same ones for the same evidence."""
    content = {
        "version": VERSION,
        "isolation": made.isolation.layers,
        "log": made.log,
        "evidence": [one.evidence for one in made.runs],
    }
    return gzip.compress(msgpack.packb(content, default=_by_field), LEVEL, mtime=0)


def unpack(data: bytes, steps: Sequence[Step]) -> ExerciseRun:
    """Return what `pack` stored, with the checks of today.

    Raises:
        CourseError: The bytes are damaged, or of other scenarios.
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
    return ExerciseRun(tuple(runs), log, isolation)


def _by_field(data: Any) -> dict[str, Any]:
    """Return the fields of a dataclass, without cached properties."""
    return {field.name: getattr(data, field.name) for field in fields(data)}


def _evidence(row: dict[str, Any]) -> Evidence:
    samples = tuple(Sample(**{**sample, "qos": Qos(**sample["qos"])}) for sample in row["samples"])
    texts = {name: tuple(row[name]) for name in ("returns", "errors")}
    return Evidence(**{**row, **texts, "samples": samples})
