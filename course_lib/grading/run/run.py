"""The stage `run`: from a job to evidence, stored under the job's digest.

A job is plain data, which may be sent to another process or machine.
"""

import gzip
import hashlib
import json
import os
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import msgpack

from course_lib.course.course_file import Limits
from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.grading.evidence import Evidence
from course_lib.grading.inputs import personal_values
from course_lib.grading.jail.filters import Isolation, Need, Usage
from course_lib.grading.jail.launch import KilledStartError, WorkerError, shared_template
from course_lib.grading.records import Run
from course_lib.grading.run.submission_run import CellLog, SubmissionRun
from course_lib.grading.store import evidence_path, usage_path, writing
from course_lib.grading.task import Catalog, Message, Scenario, Task
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.third_party import read_json

VERSION = 3  # version of the stored evidence's format
# A written task without scenarios still has evidence: the submitted text.
ANSWER = (Scenario("answer"),)


@dataclass(frozen=True)
class Step:
    """One scenario of a task, and whether it is hidden."""

    task: Task
    scenario: Scenario
    is_hidden: bool = False

    def without_checks(self) -> "Step":
        """Return the step without checks and expected messages, which only the judge needs."""
        task = replace(self.task, scenarios=(), ghost=())
        return Step(task, replace(self.scenario, checks=()), self.is_hidden)


@dataclass(frozen=True)
class Job:
    """A submission to run.

    Args:
        cells: The sources of its code cells.
        student: The student ID from which personal values are derived; None is a guest.
        steps: The scenarios in order.
        limits: Its resource limits.
        files: Contents of the submitted files, and of the course's assets, by path.
        need: The weakest isolation that is accepted for running it.
        forbidden_paths: Paths of the course that it must not be able to read.
    """

    cells: tuple[str, ...]
    student: str | None
    steps: tuple[Step, ...]
    limits: Limits
    files: Mapping[str, str | bytes] = field(default_factory=dict)
    need: Need = "any"
    forbidden_paths: tuple[str, ...] = ()

    @property
    def personal(self) -> dict[str, dict[str, Any]]:
        """The student's personal values, by task."""
        return {step.task.id: personal_values(step.task, self.student) for step in self.steps}

    @property
    def key(self) -> str:
        """The digest of everything that the evidence depends on.

        Submissions with equal keys are run once.

        The kit is excluded, so that a corrected check can judge existing evidence.
        """
        steps = [step.without_checks() for step in self.steps]
        content = [VERSION, self.cells, self.personal, sorted(self.files.items()), steps, self.limits]
        return hashlib.sha256(msgpack.packb(content, default=_job_fields)).hexdigest()[:32]


def plan_scenarios(tasks: Sequence[Task], catalog: Catalog, *, with_hidden: bool) -> tuple[Step, ...]:
    """Return all scenarios of all tasks, public ones first."""
    public = [(task, task.scenarios or ANSWER * (task.kind == "written")) for task in tasks]
    steps = [Step(task, scenario) for task, scenarios in public for scenario in scenarios]
    if with_hidden:
        steps += [Step(task, s, is_hidden=True) for task in tasks for s in catalog.hidden.get(task.id, ())]
    return tuple(steps)


def _job_fields(data: Any) -> Any:
    if isinstance(data, Message) and not data.best_effort:
        # Evidence that was stored before the field existed keeps its key.
        return {name: value for name, value in vars(data).items() if name != "best_effort"}
    return vars(data) if hasattr(data, "__dict__") else repr(data)


TRIES = 2
OUT_OF_MEMORY = (
    ". The machine may be out of memory: close other programs, or grade with --jobs 1. "
    "Nothing is lost: the same command with --resume continues"
)
PROCESSOR = 36  # index of the processor in a thread's /proc stat line, counted after its name
LEVEL = 2  # gzip level: a higher one takes longer than the run itself
# A process has one template, and Dask may call from several threads.
_template_lock = threading.Lock()


@dataclass(frozen=True)
class ExerciseRun:
    """The evidence of all scenarios of one submission, and the log of its cells."""

    runs: tuple[Run, ...]
    log: CellLog
    isolation: Isolation
    usage: Usage = field(default_factory=Usage)


@dataclass(frozen=True)
class StoredRun:
    """The bytes of an `ExerciseRun` to store, and its usage, which differs from run to run."""

    evidence: bytes
    usage: Usage


def prepare(need: Need, forbidden_paths: tuple[str, ...]) -> list[str]:
    """Start this process's template and check its isolation.

    Returns:
        Lines for the terminal: reasons for starts that were killed and repeated.

    Raises:
        CourseError: The machine's isolation is too weak.
        WorkerError: No template starts, or each was killed; the message says what to do.
    """
    killed = list[str]()
    while len(killed) < TRIES:
        try:
            shared_template(forbidden_paths).isolation.require(need)
            return [f"Tried again: {why}" for why in killed]
        except KilledStartError as error:
            killed.append(str(error))
    raise WorkerError(f"{killed[-1]}, {TRIES} times{OUT_OF_MEMORY}")


def run(job: Job) -> StoredRun:
    """Run a submission in the jail of this machine.

    Raises:
        CourseError: The machine's isolation is weaker than the job requires.
        WorkerError: No worker survives, because of an error of the kit or the machine.
    """
    why: Exception | None = None
    with _template_lock:
        for _ in range(TRIES):
            try:
                shared_template(job.forbidden_paths).isolation.require(job.need)
                # A template that was killed is closed: its evidence is meaningless.
                template = shared_template(job.forbidden_paths)
                try:
                    result = run_scenarios(job)
                    if not template.is_sound:
                        raise WorkerError("the template was killed")
                except (OSError, WorkerError):
                    template.close()
                    raise
                return StoredRun(pack(result), result.usage)
            except (OSError, WorkerError) as error:
                # The template may have been killed before or during its start.
                why = error
    raise WorkerError(f"a worker did not start, or was killed, in {TRIES} attempts: {why}") from why


def run_scenarios(job: Job) -> ExerciseRun:
    """Run all scenarios of a job."""
    template = shared_template(job.forbidden_paths)
    submission = SubmissionRun(job.cells, job.personal, job.limits, template, job.files)
    with _pin_processor(), closing(submission):
        runs = [Run(s.scenario, submission.run(s.task, s.scenario), s.is_hidden) for s in job.steps]
    return ExerciseRun(tuple(runs), submission.log, submission.isolation, submission.usage)


@contextmanager
def _pin_processor() -> Iterator[None]:
    """Pin this thread and the workers that it starts to the current processor.

    Grader and worker take turns, and waking up a process on another processor takes several times
    longer.
    """
    try:
        processors = os.sched_getaffinity(0)
        status = Path("/proc/thread-self/stat").read_text(encoding="utf-8")
        os.sched_setaffinity(0, {int(status.rpartition(")")[2].split()[PROCESSOR])})
    except (AttributeError, OSError):
        # Without Linux, or without permission, the run is only slower.
        yield
        return
    try:
        yield
    finally:
        os.sched_setaffinity(0, processors)


def store_evidence(out: Path, key: str, ran: StoredRun) -> None:
    """Write evidence and usage, each file completely or not at all.

    Raises:
        RecordsWriteError: They can't be written.
    """
    with writing(out):
        write_atomically(usage_path(out, key), json.dumps(asdict(ran.usage)).encode())
        write_atomically(evidence_path(out, key), ran.evidence)


def read_usage(out: Path, key: str) -> Usage | None:
    """Return the usage of a run, or None if it is unknown."""
    with suppress(OSError, ValueError, TypeError, AttributeError):
        content = read_json(usage_path(out, key).read_text(encoding="utf-8"))
        scenarios = {name: float(seconds) for name, seconds in content.pop("scenarios", {}).items()}
        return Usage(**{name: float(value) for name, value in content.items()}, scenarios=scenarios)
    return None


def pack(result: ExerciseRun) -> bytes:
    """Return the bytes to store, which are equal for equal evidence."""
    content = {
        "version": VERSION,
        "isolation": result.isolation.layers,
        "log": result.log,
        "evidence": [run.evidence for run in result.runs],
    }
    return gzip.compress(msgpack.packb(content, default=_fields_of), LEVEL, mtime=0)


def unpack(data: bytes, steps: Sequence[Step]) -> ExerciseRun:
    """Decode the bytes from `pack`, and combine the evidence with the current checks.

    Raises:
        CourseError: The bytes are damaged, or belong to other scenarios.
    """
    try:
        content = msgpack.unpackb(gzip.decompress(data), strict_map_key=False)
        if content["version"] != VERSION:
            raise ValueError(f"it is of version {content['version']}, expected {VERSION}")
        evidence_by_scenario = {}
        for row in content["evidence"]:
            samples = tuple(Sample(**{**sample, "qos": Qos(**sample["qos"])}) for sample in row["samples"])
            lists = {name: tuple(row[name]) for name in ("returns", "errors")}
            key = (row["task"], row["scenario"])
            evidence_by_scenario[key] = Evidence(**{**row, **lists, "samples": samples})
        runs = [Run(s.scenario, evidence_by_scenario[s.task.id, s.scenario.name], s.is_hidden) for s in steps]
        log, isolation = CellLog(**content["log"]), Isolation(tuple(content["isolation"]))
    except Exception as error:
        # A damaged file can cause any exception.
        raise CourseError(f"stored evidence can't be read ({error!r}): grade without --rejudge") from error
    return ExerciseRun(tuple(runs), log, isolation)


def _fields_of(data: Any) -> dict[str, Any]:
    """Return the fields of a dataclass, without computed ones and cached properties."""
    return {field.name: getattr(data, field.name) for field in fields(data) if field.init}
