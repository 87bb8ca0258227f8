"""`course grade`: a folder of submissions into evidence, results, gradebook and reports."""

import fnmatch
import os
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from pathlib import Path
from typing import Any

from course_lib.course.installation import exercises_dir, solutions_dir
from course_lib.errors import CourseError, counted
from course_lib.grading.executors import executors, flow
from course_lib.grading.grade_one import (
    Course,
    catalog_of,
    demand,
    evidence_path,
    identity,
    judge_one,
    keep_evidence,
    prepared,
    rules_of,
    run_job,
)
from course_lib.grading.handin.copies import compare_class
from course_lib.grading.handin.ids import with_ids
from course_lib.grading.handin.submission import Submission, find_submissions
from course_lib.grading.jail.isolation import Need
from course_lib.grading.marks.mark import read_result, result_path, results_in
from course_lib.grading.out_folder import OutError, sole_use, writing
from course_lib.grading.preflight import try_out
from course_lib.grading.reports.table import Row, broken_lines, counts, say, task_lines, watched
from course_lib.grading.reports.tables import concerns, write_tables
from course_lib.grading.run.job import Job

GRADED = ("graded", "needs_marking", "limit")


@dataclass
class Batch:
    """One student's attempts at one exercise, and what is still missing before they can be judged."""

    attempts: list[Submission]
    missing: set[str] = field(default_factory=set)  # keys of evidence
    fault: str = ""


def grade(
    submissions: Path,
    out: Path,
    *,
    jobs: int | None = None,
    dask: str | None = None,
    only: str = "*",
    resume: bool = False,
    rejudge: bool = False,
    need: Need = "partial",
    course: Course | None = None,
) -> bool:
    """Grade all submissions of a folder.

    Args:
        submissions: One folder per student, or files that `course submit` wrote.
        out: Where results, evidence, reports and gradebook.csv go.
        jobs: Submissions at a time; default: the number of processors.
        dask: Address of a scheduler, on whose workers submissions are run then.
        only: Pattern of STUDENT/EXERCISE, to grade some.
        resume: Leave out what has been graded already.
        rejudge: Judge stored evidence again, run nothing.
        need: The sandbox without which nothing is run.
        course: Where tasks and hidden checks are; default: this checkout.

    Returns:
        Whether every submission could be graded.

    Raises:
        OutError: `out` can't be written.
        CourseError: Too little of a sandbox, no submissions, broken check files, `out` is in use, or
            a solution or a stub does not get its mark here.
    """
    course = course or Course(exercises_dir(), solutions_dir())
    course = replace(course, sandbox=need, handed_in=(submissions, out))
    found = _found(submissions, course)
    batches, work = _plan(_chosen(found, only), course)
    with sole_use(out):
        if resume:
            batches = [batch for batch in batches if not _is_done(batch, out, course)]
        _look_for_evidence(batches, out, wanted=resume or rejudge)
        if rejudge:
            batches = _with_evidence(batches)
        graded = _graded(batches, work, course, out, jobs or os.cpu_count() or 1, dask, may_run=not rejudge)
        try:
            rows = list(watched(graded, len(batches)))
        except KeyboardInterrupt:
            say("Interrupted. Nothing is lost: the same command with --resume goes on.")
            raise
        _finish(rows, batches, found, out, course)
    return all(row["status"] in GRADED for row in rows)


def _found(submissions: Path, course: Course) -> list[Submission]:
    """Return what counts of the submissions, and tell the zone of local times where nobody has chosen it."""
    settings = catalog_of(course).course
    if settings.zone_note:
        say(settings.zone_note)
    return with_ids(find_submissions(submissions, settings.counts, settings.zone), submissions)


def _chosen(found: Sequence[Submission], only: str) -> list[Submission]:
    chosen = [one for one in found if fnmatch.fnmatch(f"{one.student}/{one.exercise}", only)]
    if not chosen:
        one = f"{found[0].student}/{found[0].exercise}"
        raise CourseError(f"--only {only} fits no submission: write a pattern like 'ada/*'; one is {one}")
    return chosen


def _plan(chosen: Sequence[Submission], course: Course) -> tuple[list[Batch], dict[str, Job]]:
    """What to judge, and by the key of its evidence, what to run for it: identical files once."""
    work: dict[str, Job] = {}
    owners = defaultdict[str, set[str]](set)
    attempts = []
    for submission in chosen:
        attempt, job = prepared(submission, course)
        attempts.append(attempt)
        owners[attempt.sha256].add(attempt.student)
        if job is not None:
            work[attempt.key] = job
    batches = []
    for _, group in groupby(attempts, lambda one: (one.student, one.exercise)):
        batches.append(Batch([replace(a, twins=_twins(a, owners[a.sha256])) for a in group]))
    return batches, work


def _twins(attempt: Submission, owners: set[str]) -> tuple[str, ...]:
    return tuple(sorted(owners - {attempt.student})) if attempt.sha256 else ()


def _is_done(batch: Batch, out: Path, course: Course) -> bool:
    """Whether there is a result of these files, by the checks of today."""
    last = batch.attempts[-1]
    try:
        kept = read_result(result_path(out, last.student, last.exercise))
    except CourseError:  # not there, or written by something else
        return False
    known = [{name: attempt.get(name) for name in identity(last)} for attempt in kept["attempts"]]
    is_same = known == [identity(attempt) for attempt in batch.attempts]
    is_current = kept.get("rules") == rules_of(course, last.exercise)
    return is_same and is_current and kept["row"]["status"] in GRADED


def _look_for_evidence(batches: Iterable[Batch], out: Path, *, wanted: bool) -> None:
    for batch in batches:
        keys = {attempt.key for attempt in batch.attempts if attempt.key}
        batch.missing = {key for key in keys if not (wanted and evidence_path(out, key).is_file())}


def _with_evidence(batches: Iterable[Batch]) -> list[Batch]:
    """Those that can be judged again; the others keep the result that they have."""
    complete = []
    for batch in batches:
        if batch.missing:
            last = batch.attempts[-1]
            say(f"{last.student}  {last.exercise}  no evidence of today's inputs: grade it without --rejudge")
        else:
            complete.append(batch)
    return complete


def _graded(
    batches: Sequence[Batch],
    work: dict[str, Job],
    course: Course,
    out: Path,
    jobs: int,
    dask: str | None,
    *,
    may_run: bool,
) -> Iterator[Row]:
    """Run what has to be run, judge as soon as the evidence is there; yields lines of the gradebook."""
    needed = {key: work[key] for batch in batches for key in sorted(batch.missing)}
    if not needed:
        dask = None
    jobs = min(jobs, max(len(batches), 1))
    with executors(jobs, dask) as (run, judge, window):
        if needed:
            run.submit(demand, course.sandbox, course.refused).result()
        exercises = {attempt.exercise for batch in batches for attempt in batch.attempts if attempt.key}
        for note in try_out(exercises, course, out, run, judge, may_run=may_run):
            say(note)
        ready = _ready(batches, flow(run, run_job, ((k, [job]) for k, job in needed.items()), window), out)
        calls = ((batch, (batch.attempts, course, out, batch.fault)) for batch in ready)
        for batch, future in flow(judge, judge_one, calls, window):
            try:
                yield future.result()
            except OutError:
                raise
            except Exception as error:  # the judging process died of it
                yield judge_one(batch.attempts, course, out, f"{type(error).__name__}: {error}")


def _ready(batches: Sequence[Batch], runs: Iterable[tuple[str, Any]], out: Path) -> Iterator[Batch]:
    """Batches as soon as all their evidence is stored."""
    waiting = defaultdict[str, list[Batch]](list)
    for batch in batches:
        for key in batch.missing:
            waiting[key].append(batch)
    yield from [batch for batch in batches if not batch.missing]
    for key, future in runs:
        fault = ""
        try:
            keep_evidence(out, key, future.result())
        except OutError:
            raise
        except Exception as error:  # it could not be run: our fault, and the class goes on
            fault = f"{type(error).__name__}: {error}"
        for batch in waiting[key]:
            batch.missing.remove(key)
            batch.fault = batch.fault or fault
            if not batch.missing:
                yield batch


def _finish(
    rows: Sequence[Row],
    batches: Sequence[Batch],
    found: Sequence[Submission],
    out: Path,
    course: Course,
) -> None:
    """Compare the class, write what is derived from all results, and tell what was done."""
    zone = catalog_of(course).course.zone
    with writing(out):
        compare_class(found, out, course.exercises, zone)
    for last in (batch.attempts[-1] for batch in batches):
        for note in last.notes:
            say(f"{last.student}  {last.exercise}  note: {note}")
    with writing(out):
        files = map(str, write_tables(out, zone))
    for line in (*task_lines(results_in(out)), *broken_lines(results_in(out))):
        say(line)
    isolations = Counter(result["isolation"] for result in results_in(out))
    say(f"{counted(len(rows), 'submission')}: {counts(rows) or 'nothing to do'}.")
    for isolation, number in isolations.most_common():
        say(f"Isolation of {number}: {isolation}.")
    for concern in concerns(results_in(out), out):
        say(f"Look at: {concern.line(out)}")
    say(f"Wrote {' and '.join(files)}")
