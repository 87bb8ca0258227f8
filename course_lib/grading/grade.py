"""`course grade`: a folder of submissions in five stages, hand-in, run, judge, mark and report.

Each stage is one function from records to records, and each record is a file with the digest of
what it depends on. An existing record with the right digest is not computed again.

| stage | function | record |
|---|---|---|
| hand-in | `submissions.submission.plan_attempts` | the submission itself |
| run | `run.run.run` | OUT/evidence/DIGEST.msgpack.gz |
| judge | `judge.judge` | in OUT/results/STUDENT/EXERCISE.json |
| mark | `marks.mark` | OUT/results/STUDENT/EXERCISE.json |
| report | `reports.report.report` | OUT/reports/STUDENT/EXERCISE.html |
"""

import os
import platform
import re
import shutil
import signal
import sys
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import FrameType

import course_lib
from course_lib.course.exercise import exercise_from, notebook_text, read_notebook
from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically
from course_lib.grading import store
from course_lib.grading.executors import call_in_child, executors, submit_in_window
from course_lib.grading.jail.filters import Need
from course_lib.grading.judge import judge, judge_in_child
from course_lib.grading.marks import GradebookRow, MarkedResult, mark, read_marks, stored_result
from course_lib.grading.records import Fault, Judgement, Result, Submission
from course_lib.grading.reports.rendering import join_few, print_line, replace_controls
from course_lib.grading.reports.report import has_page, report
from course_lib.grading.reports.tables import review_reasons, write_check_times, write_tables
from course_lib.grading.run.run import (
    ExerciseRun,
    Job,
    StoredRun,
    plan_scenarios,
    prepare,
    run,
    store_evidence,
    unpack,
)
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.copies import compare_class
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.submissions.submission import (
    Attempts,
    find_submissions,
    missing_file_lines,
    plan_attempts,
    resolve_ids,
    skipped_files,
    store_submission_folders,
    unfinished_lines,
)
from course_lib.grading.task import Catalog, Task

STUDENT = "preflight"  # the student ID that determines the personal values
FOLDER = "preflight"  # subfolder of the results
MOST_SHOWN = 3  # maximum number of differences in a message


@dataclass(frozen=True, eq=False)
class Trial:
    """A solution or a stub, to be graded like a submission.

    Args:
        exercise: "week01_exercise".
        name: "solution" or "stub".
        path: The notebook file.
        job: The job that runs it.
    """

    exercise: str
    name: str
    path: Path
    job: Job

    def key(self, machine: str) -> str:
        """Return the name of the job's evidence.

        Equal inputs on the same machine have equal names.
        """
        return f"{self.job.key}-{store.digest_of([machine, self.job.need])[:16]}"


def run_preflight(
    exercises: Iterable[str],
    course: store.Course,
    out: Path,
    runner: Executor,
    judge_executor: Executor,
    *,
    may_run: bool,
) -> list[str]:
    """Run and judge each exercise's solution and stub like submissions, reusing earlier evidence.

    Args:
        exercises: The exercises to be graded, "week01_exercise", ….
        course: The course, with solutions and hidden checks.
        out: The folder of records, which keeps the evidence.
        runner: The executor that runs submissions.
        judge_executor: The executor that judges them.
        may_run: Whether trials without evidence are run; otherwise they are skipped.

    Returns:
        Lines for the terminal: the tested exercises, and those that were skipped, with the reason.

    Raises:
        CourseError: A solution lacks full marks, a stub has points, or the workers have another
            version of the kit.
    """
    names = sorted(exercises)
    solutions = {name: course.solutions / f"{name.split('_')[0]}_solution.ipynb" for name in names}
    present = {name: path for name, path in solutions.items() if path.is_file()}
    notes = [
        f"Not tested: {name}, because {solutions[name]} does not exist"
        for name in names
        if name not in present
    ]
    trials = [trial for name, path in present.items() for trial in _trials(name, path, course)]
    if may_run and trials:
        evidence_paths = _run(trials, out, runner)
    else:
        earlier = {trial: list((out / FOLDER).glob(f"{trial.job.key}-*.msgpack.gz")) for trial in trials}
        evidence_paths = {
            trial: max(paths, key=lambda path: path.stat().st_mtime)
            for trial, paths in earlier.items()
            if paths
        }
        untested = (f"{trial.name} of {trial.exercise}" for trial in trials if trial not in evidence_paths)
        notes += [f"Not tested: {description}, because --rejudge runs nothing" for description in untested]
    futures = {
        trial: judge_executor.submit(judge_trial, trial, course, path)
        for trial, path in evidence_paths.items()
    }
    wrong = {trial: reason for trial, future in futures.items() if (reason := future.result())}
    for trial in wrong:
        # The machine may have been the cause, so the trial is run again next time.
        evidence_paths[trial].unlink()
    if wrong:
        raise CourseError(_failure_message(wrong, course))
    tried = ", ".join(sorted({trial.exercise for trial in evidence_paths}))
    return [*notes, *[f"Solution and stub of {tried}: full marks and no marks, as required."] * bool(tried)]


def installed_kit() -> tuple[str, str]:
    """Return the path and the hash of this process's kit."""
    return str(Path(course_lib.__file__).parent), store.kit_digest()


def judge_trial(trial: Trial, course: store.Course, evidence_file: Path) -> str:
    """Judge stored evidence with the current checks, and return an error message if the mark is wrong."""
    catalog = store.catalog_of(course)
    tasks = catalog.tasks_of_week(trial.exercise.split("_")[0])
    evidence = unpack(evidence_file.read_bytes(), plan_scenarios(tasks, catalog, with_hidden=True))
    judgement = judge_in_child(evidence, tasks, catalog)
    marked_tasks = [task for task in judgement.tasks if not task.rubric]
    is_solution = trial.name == "solution"
    wrong = [r for r in marked_tasks if (r.score < r.points if is_solution else r.score > 0)]
    if not wrong:
        return ""
    score, max_score = sum(r.score for r in marked_tasks), sum(r.points for r in marked_tasks)
    expected = "all" if is_solution else "none"
    mark = f"the {trial.name} {trial.path} gets {score:g} of {max_score:g} points, expected {expected}"
    summaries = []
    for result in wrong[:MOST_SHOWN]:
        # The task's points, the first check with the wrong verdict, and the first error.
        checks = [c for c in result.checks if c.weight and (c.score < 1 if is_solution else c.score > 0)]
        failures = [f"{c.scenario}, {c.title!r}: {c.broken or c.message}" for c in checks[:1]]
        points = f"{result.task}: {result.score:g} of {result.points:g}"
        summaries.append("; ".join([points, *failures, *result.errors[:1]]))
    return ". ".join([mark, *judgement.cell_errors[:is_solution], *summaries])


def _trials(exercise: str, solution: Path, course: store.Course) -> Iterator[Trial]:
    catalog = store.catalog_of(course)
    week = exercise.split("_")[0]
    tasks = catalog.tasks_of_week(week)
    steps = tuple(step.without_checks() for step in plan_scenarios(tasks, catalog, with_hidden=True))
    stub = course.exercises / f"{exercise}.ipynb"
    texts = {
        "solution": (solution, solution.read_bytes()),
        "stub": (stub, stub.read_bytes())
        if stub.is_file()
        else (solution, notebook_text(exercise_from(read_notebook(solution))).encode()),
    }
    for name, (path, data) in texts.items():
        try:
            cells = parse_notebook(data, path.name).cells
        except CourseError as error:
            command = "python -m course_lib.course.exercise"
            advice = f" It is generated from {solution}: {command}" if path == stub else ""
            raise CourseError(f"nothing is graded: {path.parent}: {error}{advice}") from None
        files = catalog.with_assets(week, working_files(path, cells))
        limits, forbidden_paths = catalog.course.limits, course.forbidden_paths
        job = Job(cells, STUDENT, steps, limits, files, course.sandbox, forbidden_paths)
        yield Trial(exercise, name, path, job)


def _run(trials: Iterable[Trial], out: Path, runner: Executor) -> dict[Trial, Path]:
    """Run the trials without evidence from this machine, and return the path of each evidence."""
    # Evidence depends on the machine and the kit, besides the job.
    own_location, digest = installed_kit()
    try:
        runner_location, other = runner.submit(installed_kit).result()
    except (ImportError, AttributeError) as error:
        # The kit on the worker is older than this function.
        runner_location, other = f"another place ({error})", ""
    if other != digest and runner_location == own_location:
        raise CourseError(
            f"nothing is graded: the kit in {own_location} changed while this command ran. "
            "Give the same command again with --resume"
        )
    if other != digest:
        raise CourseError(
            f"nothing is graded: submissions would be run by the kit in {runner_location}, which "
            "is not the version "
            f"in {own_location} that judges them. Install the same version there: pip install -e "
            f"{Path(own_location).parent}"
        )
    system = (platform.node(), platform.platform(), sys.version, sys.prefix)
    machine = repr((digest, system, os.geteuid(), shutil.which("bwrap")))
    evidence_paths = {trial: out / FOLDER / f"{trial.key(machine)}.msgpack.gz" for trial in trials}
    started = [(path, runner.submit(run, t.job)) for t, path in evidence_paths.items() if not path.is_file()]
    for path, future in started:
        evidence = future.result().evidence
        with store.writing(out):
            write_atomically(path, evidence)
    return evidence_paths


def _failure_message(wrong: Mapping[Trial, str], course: store.Course) -> str:
    kit, first = Path(course_lib.__file__).parent, next(iter(wrong)).path
    places = f"The checks are in {course.exercises} and {course.solutions}, the kit is {kit}"
    also = [f"Also: {', '.join(str(trial.path) for trial in wrong if trial.path != first)}"] * (
        len(wrong) > 1
    )
    look = (
        f"Run `course check {first}` to see more, correct the notebook, its checks or the kit, and "
        "grade again. Until then, --only '*/week01*' grades a single exercise"
    )
    return ". ".join([f"nothing is graded: {next(iter(wrong.values()))}", *also, places, look])


GRADED = ("graded", "needs_marking", "limit")
NO_REPORT = "No report could be written"
MEND = "Correct the check and grade with --rejudge, or give the task's points with `course mark`."
Faults = Mapping[str, Fault]  # by the key of the missing evidence
Judge = Callable[[ExerciseRun, Sequence[Task], Catalog], Judgement]


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
    course: store.Course | None = None,
) -> bool:
    """Grade a folder of submissions and return whether each submission could be graded.

    Args:
        submissions: One folder per student, or files that `course submit` wrote.
        out: The folder of records, which also gets gradebook.csv.
        jobs: Number of submissions in parallel; default: the number of processors.
        dask: Address of a Dask scheduler; if given, submissions run on its workers.
        only: Pattern of STUDENT/EXERCISE that selects submissions.
        resume: Reuse all existing records.
        rejudge: Judge the existing evidence again, without running anything.
        need: The weakest isolation that is accepted for running submissions.
        course: The course; default: the one of this checkout.

    Raises:
        RecordsWriteError: `out` can't be written.
        CourseError: Nothing can be graded, or `out` is inside `submissions`.
    """
    if out.resolve().is_relative_to(submissions.resolve()):
        reason = "its results would be submissions of the next grading"
        raise CourseError(f"{out} is inside {submissions}: {reason}. Choose another folder: --out DIR")
    if course is None:
        course, here = store.this_course(), Path("exercises/course.toml")
        if here.is_file() and here.parent.resolve() != course.exercises.resolve():
            # Both have a week 1: all submissions of this one would get no points there.
            print_line(
                f"warning: graded by the course in {course.exercises.parent}, which is installed, "
                f"not by the one in this folder, {Path.cwd()}. If that is wrong, type here: "
                "pip install -e ."
            )
    course = replace(course, sandbox=need, private_folders=(submissions, out))
    found_submissions = _find(submissions, course)
    line = plan_attempts(found_submissions, course, only)
    with store.lock_folder(out):
        with store.writing(out):
            store_submission_folders(out, submissions, found_submissions)
        work = _find_pending(line, course, out, resume=resume, rejudge=rejudge)
        rows = _grade_with_progress(work, jobs or os.cpu_count() or 1, dask)
        _finish(rows, work, found_submissions)
    return all(row.status in GRADED for row in rows)


@dataclass(frozen=True)
class Pending:
    """The students and exercises whose records are missing.

    Args:
        line: The attempts of each student and exercise.
        missing: The jobs to run, by the key of their evidence.
        course: The tasks and hidden checks.
        out: The folder of records.
        resume: Reuse existing results.
        rejudge: Run nothing.
    """

    line: Sequence[Attempts]
    missing: Mapping[str, Job]
    course: store.Course
    out: Path
    resume: bool
    rejudge: bool


def _find(submissions: Path, course: store.Course) -> list[Submission]:
    """Find all submissions; print a note about the time zone if the course does not set one."""
    settings = store.catalog_of(course).course
    if settings.zone_note:
        print_line(settings.zone_note)

    def is_accepted(submission: Submission) -> bool:
        week = submission.exercise.split("_")[0]
        deadline = settings.deadline(week, submission.student) if week in settings.weeks else None
        return settings.late.is_accepted(submission.received.days_late(deadline, settings.late))

    all_submissions = find_submissions(
        submissions, settings.counts, settings.zone, with_rejected=True, is_accepted=is_accepted
    )
    resolved = resolve_ids(all_submissions, submissions)
    for line in (*skipped_files(submissions), *unfinished_lines(submissions)):
        print_line(line)
    # Extensions may name an unknown student, such as a misspelled group.
    students = {submission.student for submission in resolved}
    weeks = {submission.exercise.split("_")[0] for submission in resolved} & settings.weeks.keys()
    for week in sorted(weeks):
        if unknown := settings.unknown_extensions(week, students):
            print_line(
                f"note: the extensions of {week} in course.toml contain {join_few(unknown)}: "
                "there is no such group, and no such student has submitted anything."
            )
    # Paths in results are relative to the folder of submissions, so that both can be moved.
    return [replace(s, path=s.path.relative_to(submissions)) for s in resolved]


def _find_pending(
    line: Sequence[Attempts], course: store.Course, out: Path, *, resume: bool, rejudge: bool
) -> Pending:
    """Find the missing records, and print the submissions that --rejudge cannot judge."""
    if resume:
        line = [attempts for attempts in line if not _is_done(attempts, out)]
    jobs = {key: job for attempts in line for key, job in attempts.jobs.items()}
    missing = dict(jobs)
    if resume or rejudge:
        missing = {k: job for k, job in jobs.items() if not store.evidence_path(out, k).is_file()}
    if rejudge:
        for lost in (attempts for attempts in line if attempts.jobs.keys() & missing.keys()):
            print_line(
                f"{lost.student}  {lost.exercise}  no evidence for these inputs: grade it without --rejudge"
            )
        line = [attempts for attempts in line if not attempts.jobs.keys() & missing.keys()]
        missing = {}
    return Pending(line, missing, course, out, resume, rejudge)


def _is_done(attempts: Attempts, out: Path) -> bool:
    """Return whether result and report exist for these files, checks and points."""
    result = _read_stored_result(attempts, out)
    if result is None or result.judgement is None or result.digest != attempts.digest:
        return False
    return has_page(result, out)


def _read_stored_result(attempts: Attempts, out: Path) -> Result | None:
    """Return the stored result regardless of its digest, or None if it is missing or damaged."""
    try:
        return stored_result(out, attempts.student, attempts.exercise).result
    except CourseError:
        return None


@contextmanager
def second_interrupt_ends_process() -> Iterator[None]:
    """Let a second Ctrl+C terminate this process through the default action of the signal.

    After the first one, grading needs a moment to stop. An exception during that time, or while
    Python waits for threads at exit, would print a traceback. No file is left incomplete, because
    files are replaced as a whole.
    """

    def on_interrupt(number: int, frame: FrameType | None) -> None:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        signal.default_int_handler(number, frame)

    before = signal.signal(signal.SIGINT, on_interrupt)
    try:
        yield
    finally:
        if signal.getsignal(signal.SIGINT) is on_interrupt:
            signal.signal(signal.SIGINT, before)


def _grade_with_progress(work: Pending, jobs: int, dask: str | None) -> list[GradebookRow]:
    """Grade with a progress bar, and return the lines of the gradebook.

    Each problem is a line above the bar.
    """
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    total = len(work.line)
    rate, columns = TextColumn("{task.fields[rate]}"), (BarColumn(), MofNCompleteColumn())
    rows = []
    try:
        with Progress(TextColumn("Grading"), *columns, rate, TimeRemainingColumn()) as progress:
            bar = progress.add_task("", total=total, rate="")
            for row in _grade_all(work, min(jobs, max(total, 1)), dask):
                if row.status != "graded":
                    cells = (row.student, row.exercise, row.status, row.reason, row.message)
                    line = replace_controls("  ".join(cells))
                    progress.console.print(line, markup=False, highlight=False, soft_wrap=True)
                progress.advance(bar)
                progress.update(bar, rate=f"{progress.tasks[bar].speed or 0:.1f}/s")
                rows.append(row)
    except KeyboardInterrupt:
        print_line("Interrupted. Nothing is lost: the same command with --resume continues.")
        raise
    return rows


def _grade_all(work: Pending, jobs: int, dask: str | None) -> Iterator[GradebookRow]:
    """Run the missing jobs.

    Judge, mark and report each student as soon as their evidence is stored.
    """
    course, out = work.course, work.out
    with executors(jobs, dask if work.missing else None) as (runner, judge_executor, window):
        if work.missing:
            for note in runner.submit(prepare, course.sandbox, course.forbidden_paths).result():
                print_line(note)
        exercises = {attempts.exercise for attempts in work.line if attempts.jobs}
        for note in run_preflight(exercises, course, out, runner, judge_executor, may_run=not work.rejudge):
            print_line(note)
        ran = submit_in_window(runner, run, ((key, [job]) for key, job in work.missing.items()), window)
        ready = _await_evidence(work, ran)
        calls = ((pair, (*pair, course, out, work.resume)) for pair in ready)
        for (attempts, faults), future in submit_in_window(judge_executor, judge_mark_report, calls, window):
            try:
                yield future.result()
            except store.RecordsWriteError:
                raise
            except Exception as error:
                yield _grade_in_child(attempts, faults, course, out, error)


def _grade_in_child(
    attempts: Attempts, faults: Faults, course: store.Course, out: Path, error: Exception
) -> GradebookRow:
    """Judge, mark and report one student whose judging process died.

    The check that ended it is named. If the forked process dies, too, the records are written
    here, with the error.
    """
    try:
        grade_again = partial(judge_mark_report, attempts, faults, course, out)
        return call_in_child(partial(grade_again, judge=judge_in_child))
    except CourseError:
        missing = dict.fromkeys((s.key for s in attempts.submissions), Fault.from_error(error))
        return judge_mark_report(attempts, missing, course, out)


def _await_evidence(
    work: Pending, ran: Iterable[tuple[str, Future[StoredRun]]]
) -> Iterator[tuple[Attempts, Faults]]:
    """Store evidence as jobs end, and yield each student's attempts once all their evidence is stored."""
    waiting = defaultdict[str, list[Attempts]](list)
    absent = {id(attempts): attempts.jobs.keys() & work.missing.keys() for attempts in work.line}
    faults: dict[str, Fault] = {}
    for attempts in work.line:
        for key in absent[id(attempts)]:
            waiting[key].append(attempts)
        if not absent[id(attempts)]:
            yield replace(attempts, jobs={}), {}
    for key, future in ran:
        try:
            store_evidence(work.out, key, future.result())
        except store.RecordsWriteError:
            raise
        except Exception as error:
            # An error of the kit in one submission must not stop the class.
            faults[key] = Fault.from_error(error)
        for attempts in waiting.pop(key):
            absent[id(attempts)] -= {key}
            if not absent[id(attempts)]:
                yield replace(attempts, jobs={}), {key: faults[key] for key in attempts.jobs if key in faults}


def judge_mark_report(
    attempts: Attempts,
    faults: Faults,
    course: store.Course,
    out: Path,
    resume: bool = False,
    judge: Judge = judge,
) -> GradebookRow:
    """Judge, mark and report one student's attempts, whose evidence is stored.

    Args:
        attempts: The attempts, without jobs.
        faults: The reason for each missing evidence, by its key.
        course: The tasks and hidden checks.
        out: The folder of records.
        resume: Reuse the stored result if its digest matches the attempts; otherwise reuse its
            judgement if the checks are the same.
        judge: Judges the evidence of one attempt.

    Raises:
        RecordsWriteError: The folder can't be written.
    """
    stored, catalog = _read_stored_result(attempts, out) if resume else None, store.catalog_of(course)
    previous = stored if stored and stored.digest == attempts.digest else None
    fresh: dict[str, Judgement | Fault | None] = {}
    result = previous
    if result is None:
        # Changed dates affect the mark only, so a judgement by the same checks is reused.
        known_judgements = (
            {stored.submission.key: stored.judgement} if stored and stored.rules == attempts.rules else {}
        )
        fresh = {
            submission.key: _judge_one(submission, faults, course, out, judge)
            for submission in attempts.submissions
            if not known_judgements.get(submission.key)
        }
        judgements = [
            fresh[submission.key] if submission.key in fresh else known_judgements[submission.key]
            for submission in attempts.submissions
        ]
        result = mark(attempts.submissions, judgements, catalog.course, attempts.digest, attempts.rules)
    marks = read_marks(store.marks_path(out, attempts.student, attempts.exercise))
    with store.writing(out):
        for key, judgement in fresh.items():
            if isinstance(judgement, Judgement):
                write_check_times(out, key, judgement)
        try:
            report(result, out, catalog)
        except OSError:
            raise
        except Exception as error:
            # The marks are valid without a report, and must not be lost with it.
            problem = f"{NO_REPORT}: {type(error).__name__}: {error}"
            result = replace(result, notes=(*result.notes, problem))
        if result is not previous:
            result.write(out)
    return MarkedResult(result, tuple(marks)).row


def _judge_one(
    submission: Submission,
    faults: Faults,
    course: store.Course,
    out: Path,
    judge: Judge,
) -> Judgement | Fault | None:
    """Judge stored evidence.

    An error of the kit becomes a `Fault`, which costs the student nothing.
    """
    if submission.key in faults or not submission.key:
        return faults.get(submission.key)
    try:
        catalog = store.catalog_of(course)
        tasks = catalog.tasks_of_week(submission.exercise.split("_")[0])
        packed_evidence = store.evidence_path(out, submission.key).read_bytes()
        steps = plan_scenarios(tasks, catalog, with_hidden=True)
        return judge(unpack(packed_evidence, steps), tasks, catalog)
    except Exception as error:
        # Checks do not raise here, so this is an error of the kit, not of the student.
        return Fault.from_error(error)


def _finish(
    rows: Sequence[GradebookRow],
    work: Pending,
    found_submissions: Sequence[Submission],
) -> None:
    """Compare the submissions of the class, write the tables of results, and print a summary."""
    out, catalog = work.out, store.catalog_of(work.course)
    zone = catalog.course.zone
    with store.writing(out):
        compare_class(found_submissions, out, work.course.exercises, zone, catalog.tasks.values())
    for line in _note_lines([attempts.submissions[-1] for attempts in work.line]):
        print_line(line)
    with store.writing(out):
        marked_results = write_tables(out, zone)
    results = [result.result for result in marked_results]
    for line in _result_lines(results):
        for folder in (work.course.exercises, work.course.solutions):
            # Results have no paths of this machine, but whoever corrects a check needs one.
            line = line.replace(f" {folder.name}/checks/", f" {folder}/checks/")
        print_line(line)
    statuses = sorted(Counter(row.status for row in rows).items())
    counts = ", ".join(f"{number} {status}" for status, number in statuses)
    print_line(f"{format_count(len(rows), 'submission')}: {counts or 'nothing to do'}.")
    for isolation, number in Counter(result.isolation for result in results).most_common():
        print_line(f"Isolation of {format_count(number, 'submission')}: {isolation}.")
    for concern in review_reasons(marked_results, out):
        print_line(f"Please review: {concern.line(out)}")
    for line in missing_file_lines(results, found_submissions, *work.course.private_folders):
        print_line(line)
    print_line(f"Wrote {out / 'gradebook.csv'} and {out / 'reports/index.html'}")


# Number of submissions that are listed with the same kind of note.
_MOST_NAMED = 5


def _note_lines(submissions: Sequence[Submission]) -> Iterator[str]:
    """Yield the notes on submissions. A kind of note that many have is shown for the first ones only."""
    lines: dict[str, list[str]] = {}
    for submission in submissions:
        for note in submission.notes:
            # Notes of one kind have different endings, like the names of other students.
            kind = re.sub("that of .*", "that of another student", note.split(":")[0])
            line = f"{submission.student}  {submission.exercise}  note: {note}"
            lines.setdefault(kind, []).append(line)
    for kind, lines_of_kind in lines.items():
        yield from lines_of_kind[:_MOST_NAMED]
        if len(lines_of_kind) > _MOST_NAMED:
            count = format_count(len(lines_of_kind) - _MOST_NAMED, "other submission")
            yield f"note of {count}: {kind}. reports/index.html has all notes"


def _result_lines(results: Sequence[Result]) -> Iterator[str]:
    """Yield a line per automatically marked task: results, mean, and results with full marks.

    Then yield a line for each check that raised an exception, and for each reason of lost pages.
    """
    scores: dict[str, list[float]] = {}
    points: dict[str, float] = {}
    for result in results:
        for task in (task for task in result.tasks if not task.rubric):
            scores.setdefault(task.task, []).append(task.score)
            points[task.task] = task.points
    for name, task_scores in sorted(scores.items()):
        yield (
            f"{name:30} {len(task_scores):5} graded  mean {sum(task_scores) / len(task_scores):5.1f} "
            f"of {points[name]:g}  "
            f"{sum(score >= points[name] for score in task_scores)} with full marks"
        )
    broken, lost = defaultdict[str, list[str]](list), defaultdict[str, list[str]](list)
    for result in results:
        for error in result.judgement.broken if result.judgement else ():
            broken[error].append(result.submission.student)
        for note in (note for note in result.notes if note.startswith(NO_REPORT)):
            lost[note].append(result.submission.student)
    for error, students in broken.items():
        yield f"A check could not judge {join_few(students)}: {error}. {MEND}"
    for note, students in lost.items():
        yield f"{note} ({join_few(students)}). The marks are valid."
