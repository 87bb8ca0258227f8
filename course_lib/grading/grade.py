"""`course grade`: a folder of submissions through five stages, hand-in, run, judge, mark and report.

Each stage is one function from records to records, and each record is a file with the digest of what it
depends on. A record that is there already is not made again.

| stage | function | record |
|---|---|---|
| hand-in | `handin.hand_in.hand_in` | the submission itself |
| run | `run.run.run` | OUT/evidence/DIGEST.msgpack.gz |
| judge | `judge.judge` | in OUT/results/STUDENT/EXERCISE.json |
| mark | `marks.mark.mark` | OUT/results/STUDENT/EXERCISE.json |
| report | `reports.report.report` | OUT/reports/STUDENT/EXERCISE.html |
"""

import os
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, replace
from pathlib import Path

from course_lib.errors import CourseError, counted
from course_lib.grading.executors import executors, flow
from course_lib.grading.handin.copies import compare_class
from course_lib.grading.handin.hand_in import Attempts, hand_in
from course_lib.grading.handin.ids import with_ids
from course_lib.grading.handin.submission import Submission, find_submissions
from course_lib.grading.jail.isolation import Need
from course_lib.grading.judge import Judgement, judge
from course_lib.grading.marks.mark import Fault, Result, mark, read_result, row_of
from course_lib.grading.marks.marks import read_marks
from course_lib.grading.preflight import try_out
from course_lib.grading.records import (
    Course,
    OutError,
    catalog_of,
    evidence_path,
    marks_path,
    result_path,
    sole_use,
    this_course,
    writing,
)
from course_lib.grading.reports.items import keep_check_times
from course_lib.grading.reports.report import has_page, report
from course_lib.grading.reports.table import (
    NO_REPORT,
    Line,
    broken_lines,
    counts,
    gone_lines,
    lost_report_lines,
    say,
    task_lines,
    watched,
)
from course_lib.grading.reports.tables import concerns, write_tables
from course_lib.grading.run.job import Job, plan
from course_lib.grading.run.run import Ran, keep, make_ready, run, unpack

GRADED = ("graded", "needs_marking", "limit")
Faults = Mapping[str, Fault]  # by the key of the evidence that is missing


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
    """Grade a folder of submissions, and return whether every one could be graded.

    Args:
        submissions: One folder per student, or files that `course submit` wrote.
        out: The folder of records, which also gets gradebook.csv.
        jobs: Submissions at a time; default: the number of processors.
        dask: Address of a scheduler, on whose workers submissions are run then.
        only: Pattern of STUDENT/EXERCISE, to grade some.
        resume: Use all records that are there.
        rejudge: Use the evidence that is there, and run nothing.
        need: The least isolation in which submissions are run.
        course: Default: the one of this checkout.

    Raises:
        OutError: `out` can't be written.
        CourseError: Nothing can be graded.
    """
    course = course or this_course()
    course = replace(course, sandbox=need, handed_in=(submissions, out))
    found = _found(submissions, course)
    line = hand_in(found, course, only)
    with sole_use(out):
        work = _pending(line, course, out, resume=resume, rejudge=rejudge)
        rows = _watched(work, jobs or os.cpu_count() or 1, dask)
        _finish(rows, work, found)
    return all(row["status"] in GRADED for row in rows)


@dataclass(frozen=True)
class Pending:
    """The students and exercises whose records are missing.

    Args:
        line: The attempts of each student and exercise.
        missing: By the key of its evidence, each job that must be run.
        course: The tasks and hidden checks.
        out: The folder of records.
        resume: Use results that are there.
        rejudge: Run nothing.
    """

    line: Sequence[Attempts]
    missing: Mapping[str, Job]
    course: Course
    out: Path
    resume: bool
    rejudge: bool


def _found(submissions: Path, course: Course) -> list[Submission]:
    """Find all submissions; print the zone of local times if nobody has chosen one."""
    settings = catalog_of(course).course
    if settings.zone_note:
        say(settings.zone_note)
    return with_ids(find_submissions(submissions, settings.counts, settings.zone), submissions)


def _pending(line: Sequence[Attempts], course: Course, out: Path, *, resume: bool, rejudge: bool) -> Pending:
    """Find the missing records, and print which submissions --rejudge cannot judge."""
    if resume:
        line = [one for one in line if not _is_done(one, out)]
    jobs = {key: job for one in line for key, job in one.jobs.items()}
    reuse = resume or rejudge
    missing = {key: job for key, job in jobs.items() if not (reuse and evidence_path(out, key).is_file())}
    if rejudge:
        for one in (one for one in line if one.jobs.keys() & missing.keys()):
            say(f"{one.student}  {one.exercise}  no evidence of today's inputs: grade it without --rejudge")
        line = [one for one in line if not one.jobs.keys() & missing.keys()]
        missing = {}
    return Pending(line, missing, course, out, resume, rejudge)


def _is_done(attempts: Attempts, out: Path) -> bool:
    """Return whether result and report are there, of these files, these checks and these points."""
    result = _kept(attempts, out)
    return result is not None and result.judgement is not None and has_page(result, out)


def _kept(attempts: Attempts, out: Path) -> Result | None:
    try:
        content = read_result(result_path(out, attempts.student, attempts.exercise))
    except CourseError:  # it is missing, or damaged
        return None
    return Result.from_plain(content) if content.get("digest") == attempts.digest else None


def _watched(work: Pending, jobs: int, dask: str | None) -> list[Line]:
    """Grade with a progress bar, and return the lines of the gradebook."""
    try:
        return list(watched(_graded(work, min(jobs, max(len(work.line), 1)), dask), len(work.line)))
    except KeyboardInterrupt:
        say("Interrupted. Nothing is lost: the same command with --resume goes on.")
        raise


def _graded(work: Pending, jobs: int, dask: str | None) -> Iterator[Line]:
    """Run each missing job, then judge, mark and report as soon as a student's evidence is stored."""
    course, out = work.course, work.out
    with executors(jobs, dask if work.missing else None) as (away, here, window):
        if work.missing:
            for note in away.submit(make_ready, course.sandbox, course.refused).result():
                say(note)
        exercises = {one.exercise for one in work.line if one.jobs}
        for note in try_out(exercises, course, out, away, here, may_run=not work.rejudge):
            say(note)
        ran = flow(away, run, ((key, [job]) for key, job in work.missing.items()), window)
        ready = _with_evidence(work, ran)
        calls = ((one, (one, faults, course, out, work.resume)) for one, faults in ready)
        for one, future in flow(here, judge_mark_report, calls, window):
            try:
                yield future.result()
            except OutError:
                raise
            except Exception as error:  # the judging process died of it
                faults = dict.fromkeys((s.key for s in one.submissions), Fault.of(error))
                yield judge_mark_report(one, faults, course, out)


def _with_evidence(
    work: Pending, ran: Iterable[tuple[str, Future[Ran]]]
) -> Iterator[tuple[Attempts, Faults]]:
    """Store evidence as it comes; yield each student's attempts when they have all of theirs."""
    waiting = defaultdict[str, list[Attempts]](list)
    absent = {id(one): one.jobs.keys() & work.missing.keys() for one in work.line}
    faults: dict[str, Fault] = {}
    for one in work.line:
        for key in absent[id(one)]:
            waiting[key].append(one)
        if not absent[id(one)]:
            yield replace(one, jobs={}), {}
    for key, future in ran:
        try:
            keep(work.out, key, future.result())
        except OutError:
            raise
        except Exception as error:  # a fault of ours: the class goes on
            faults[key] = Fault.of(error)
        for one in waiting.pop(key):
            absent[id(one)] -= {key}
            if not absent[id(one)]:
                yield replace(one, jobs={}), {key: faults[key] for key in one.jobs if key in faults}


def judge_mark_report(
    attempts: Attempts, faults: Faults, course: Course, out: Path, resume: bool = False
) -> Line:
    """Apply the last three stages to one student's attempts, whose evidence is stored.

    Args:
        attempts: Without jobs.
        faults: By key, why evidence is missing.
        course: The tasks and hidden checks.
        out: The folder of records.
        resume: Use the result that is there, if its digest is that of the attempts.

    Raises:
        OutError: The folder can't be written.
    """
    kept, catalog = _kept(attempts, out) if resume else None, catalog_of(course)
    judged = [] if kept else [_judged(one, faults, course, out) for one in attempts.submissions]
    result = kept or mark(attempts.submissions, judged, catalog.course, attempts.digest)
    marks = read_marks(marks_path(out, attempts.student, attempts.exercise))
    with writing(out):
        _keep_times(attempts.submissions, judged, out)
        try:
            report(result, out, catalog)
        except OSError:
            raise
        except Exception as error:  # the marks are right without a report, and must not be lost with it
            problem = f"{NO_REPORT}: {type(error).__name__}: {error}"
            result = replace(result, notes=(*result.notes, problem))
        if result is not kept:
            result.write(out)
    return row_of(result.as_plain(), marks)


def _keep_times(
    submissions: Sequence[Submission], judged: Sequence[Judgement | Fault | None], out: Path
) -> None:
    for one, judgement in zip(submissions, judged, strict=False):  # none is judged where a result is kept
        if isinstance(judgement, Judgement):
            keep_check_times(out, one.key, judgement)


def _judged(submission: Submission, faults: Faults, course: Course, out: Path) -> Judgement | Fault | None:
    """Judge stored evidence; a fault of the kit costs the student nothing, and the class goes on."""
    if submission.key in faults or not submission.key:
        return faults.get(submission.key)
    try:
        catalog = catalog_of(course)
        tasks = catalog.of_week(submission.exercise.split("_")[0])
        stored = evidence_path(out, submission.key).read_bytes()
        return judge(unpack(stored, plan(tasks, catalog, hidden=True)), tasks, catalog)
    except Exception as error:  # whatever it is, it is no fault of the student
        return Fault.of(error)


def _finish(rows: Sequence[Line], work: Pending, found: Sequence[Submission]) -> None:
    """Compare the class, write the tables of all results, and print a summary."""
    out, zone = work.out, catalog_of(work.course).course.zone
    with writing(out):
        compare_class(found, out, work.course.exercises, zone)
    for last in (one.submissions[-1] for one in work.line):
        for note in last.notes:
            say(f"{last.student}  {last.exercise}  note: {note}")
    with writing(out):
        results = write_tables(out, zone)
    for lines in (task_lines, broken_lines, lost_report_lines):
        for line in lines(results):
            say(line)
    isolations = Counter(result["isolation"] for result in results)
    say(f"{counted(len(rows), 'submission')}: {counts(rows) or 'nothing to do'}.")
    for isolation, number in isolations.most_common():
        say(f"Isolation of {number}: {isolation}.")
    for concern in concerns(results, out):
        say(f"Look at: {concern.line(out)}")
    for line in gone_lines(results, *work.course.handed_in):
        say(line)
    say(f"Wrote {out / 'gradebook.csv'} and {out / 'reports/index.html'}")
