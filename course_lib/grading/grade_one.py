"""Runs one submission into stored evidence, and judges it from there: mark, report, result."""

import hashlib
import json
import math
import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from course_lib.course.state import write_whole
from course_lib.grading.catalog import Catalog, load_catalog
from course_lib.grading.handin.submission import Submission
from course_lib.grading.jail.isolation import Need
from course_lib.grading.jail.launch import WorkerError, shared_template
from course_lib.grading.marks.mark import Result, Status, row_of
from course_lib.grading.marks.marks import marks_path, read_marks
from course_lib.grading.out_folder import writing
from course_lib.grading.reports.report import write_report
from course_lib.grading.run.job import Job, plan
from course_lib.grading.run.outcome import Usage, usage_path
from course_lib.grading.run.run import judge_exercise, pack, run_scenarios, unpack

TRIES = 2
_one_at_a_time = threading.Lock()  # a process has one template, and Dask may call from several threads


@dataclass(frozen=True)
class Course:
    """Where tasks and hidden checks are; every judging process reads them for itself."""

    exercises: Path
    solutions: Path
    sandbox: Need = "partial"  # without it nothing is run
    handed_in: tuple[Path, ...] = ()  # the folders of submissions and results

    @property
    def refused(self) -> tuple[str, ...]:
        """What no submission may read."""
        return tuple(str(path.resolve()) for path in (self.exercises, self.solutions, *self.handed_in))


@lru_cache(maxsize=4)
def catalog_of(course: Course) -> Catalog:
    """The tasks with their hidden scenarios."""
    return load_catalog(course.exercises, course.solutions)


@lru_cache(maxsize=64)
def rules_of(course: Course, exercise: str) -> str:
    """A hash of what a result depends on besides the evidence: course.toml and the week's check files."""
    check_file = f"checks/{exercise.split('_')[0]}.py"
    files = (course.exercises / "course.toml", course.exercises / check_file, course.solutions / check_file)
    return hashlib.sha256(b"\0".join(f.read_bytes() for f in files if f.is_file())).hexdigest()[:32]


@dataclass(frozen=True)
class Ran:
    """What came out of a submission, and what it used."""

    evidence: bytes
    usage: Usage


def evidence_path(out: Path, key: str) -> Path:
    """Where evidence is kept."""
    return out / "evidence" / f"{key}.msgpack.gz"


def prepared(submission: Submission, course: Course) -> tuple[Submission, Job | None]:
    """A submission with the key of its evidence, and the job that makes it; none for what can't be graded."""
    catalog = catalog_of(course)
    tasks = catalog.of_week(submission.exercise.split("_")[0])
    notebook, bare = submission.notebook, replace(submission, notebook=None, files={})
    if notebook is None:
        return bare, None
    if not tasks:
        return replace(bare, problem=bare.problem or f"the course has no {bare.exercise}"), None
    steps = tuple(step.unjudged() for step in plan(tasks, catalog, hidden=True))
    limits = catalog.course.limits
    files = dict(submission.files)
    job = Job(notebook.cells, submission.values_of, steps, limits, files, course.sandbox, course.refused)
    return replace(bare, key=job.key), job


def demand(need: Need, refused: tuple[str, ...] = ()) -> None:
    """Refuse to run anything in less than is needed.

    Raises:
        CourseError: Says what is missing here and what to type.
    """
    shared_template(refused).isolation.demand(need)


def run_job(job: Job) -> Ran:
    """Run a submission; what comes out is judged elsewhere.

    Raises:
        CourseError: Too little of a sandbox.
        WorkerError: It can't be run here: the kit's or the machine's fault.
    """
    with _one_at_a_time:
        for _ in range(TRIES):
            demand(job.need, job.refused)
            template = shared_template(job.refused)
            try:
                run = run_scenarios(job)
            except (OSError, WorkerError):  # it may have been killed before
                template.close()
            else:
                if template.is_sound:
                    return Ran(pack(run), run.usage)
                template.close()  # it was killed, and the submission with it: what came out means nothing
    raise WorkerError(f"no worker can be started, or it was killed, {TRIES} times")


def judge_one(attempts: Sequence[Submission], course: Course, out: Path, fault: str = "") -> dict[str, Any]:
    """Judge stored evidence, write report and result.

    Args:
        attempts: Of one student at one exercise: the one with the best mark counts.
        course: Where the checks are.
        out: The folder of results.
        fault: Why there is no evidence, if that is our fault.

    Returns:
        Its line of the gradebook.

    Raises:
        OutError: The result can't be written.
    """
    results = [_result(attempt, course, out, fault) for attempt in attempts]
    best = max(results, key=_rank)
    rules = rules_of(course, best.submission.exercise)
    return _stored(replace(best, attempts=tuple(map(_attempt, results)), rules=rules), course, out)


def identity(submission: Submission) -> dict[str, str]:
    """Return what identifies a submission: its content, when it came, and whether its ID is right."""
    received = json.dumps(submission.received.as_plain())
    return {"key": submission.key, "received": received, "id_flag": submission.id_flag}


def _attempt(result: Result) -> dict[str, Any]:
    return {**identity(result.submission), "final": result.mark.final if result.mark else None}


def _rank(result: Result) -> float:
    """The mark; a fault of ours goes before, as the mark may be there, and what has no mark comes last."""
    if result.status == "grader_error":
        return math.inf
    return result.mark.final if result.mark else -1.0


def _result(submission: Submission, course: Course, out: Path, fault: str) -> Result:
    """A submission's result; any fault of the kit becomes `grader_error`, and the class goes on."""
    if fault:
        kind, _, text = fault.partition(": ")
        return Result(submission, "grader_error", kind, text)
    if not submission.key:
        reason = submission.reason or ("wrong exercise" if submission.sha256 else "unreadable")
        return Result(submission, "rejected", reason, submission.problem)
    try:
        return _judged(submission, course, out)
    except Exception as error:  # whatever it is, it is no fault of the student
        return Result(submission, "grader_error", type(error).__name__, str(error))


def _judged(submission: Submission, course: Course, out: Path) -> Result:
    catalog = catalog_of(course)
    week, late = submission.exercise.split("_")[0], catalog.course.late
    tasks = catalog.of_week(week)
    stored = evidence_path(out, submission.key).read_bytes()
    run = judge_exercise(unpack(stored, plan(tasks, catalog, hidden=True)), tasks, catalog)
    deadline, received = catalog.course.deadline(week, submission.student), submission.received
    days, remark = received.days_late(deadline, late), received.remark(deadline, late)
    notes = tuple(received.contradictions(deadline, late))
    reason = next((task.stopped for task in run.results if task.stopped), run.log.limit)  # which limit
    status: Status = "limit" if reason else "graded"
    return Result(submission, status, reason, "", run, days, late.percent_per_day, notes=notes, remark=remark)


def _stored(result: Result, course: Course, out: Path) -> dict[str, Any]:
    submission = result.submission
    marks = read_marks(marks_path(out, submission.student, submission.exercise))
    with writing(out):
        try:
            write_report(result.with_marks(marks), out, catalog_of(course).course)
        except OSError:
            raise
        except Exception as error:  # the marks are right without a report, and must not be lost with it
            problem = f"no report: {type(error).__name__}: {error}"
            result = replace(result, notes=(*result.notes, problem))
        result.write(out)
    return row_of(result.content(), marks)


def renew_report(submission: Submission, course: Course, out: Path) -> None:
    """Write the report again, from stored evidence, with what persons gave since."""
    marks = read_marks(marks_path(out, submission.student, submission.exercise))
    result = _result(submission, course, out, "")
    if result.run is not None:  # else the old one says more
        write_report(result.with_marks(marks), out, catalog_of(course).course)


def keep_evidence(out: Path, key: str, ran: Ran) -> None:
    """Write evidence, whole or not at all, and beside it what the run used.

    Raises:
        OutError: It can't be written.
    """
    with writing(out):
        write_whole(usage_path(out, key), ran.usage.as_json().encode())
        write_whole(evidence_path(out, key), ran.evidence)
