"""`course grade`: a folder of submissions into results, gradebook and reports."""

import fnmatch
import multiprocessing
import os
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from pathlib import Path
from typing import Any

from course_lib.course.files import exercises_dir, solutions_dir
from course_lib.course.whole_file import write_whole
from course_lib.errors import CourseError
from course_lib.grading.grade_one import Course, catalog_of, grade_one, our_fault, stored
from course_lib.grading.gradebook import write_gradebook
from course_lib.grading.jail.isolation import Need
from course_lib.grading.jail.launch import shared_template
from course_lib.grading.report_index import write_index
from course_lib.grading.result import read_result, result_path
from course_lib.grading.submission import Submission, find_submissions
from course_lib.grading.table import printable

Row = dict[str, Any]  # of the gradebook
GRADED = ("graded", "needs_marking", "limit")


def grade(
    submissions: Path,
    out: Path,
    *,
    jobs: int | None = None,
    only: str = "*",
    resume: bool = False,
    need: Need = "partial",
    course: Course | None = None,
) -> bool:
    """Grade all submissions of a folder.

    Args:
        submissions: One folder per student, or files that `course submit` wrote.
        out: Where results, evidence, reports and gradebook.csv go.
        jobs: Submissions at a time; default: the number of processors.
        only: Pattern of STUDENT/EXERCISE, to grade some.
        resume: Leave out what has been graded already.
        need: The sandbox without which nothing is run.
        course: Where tasks and hidden checks are; default: this checkout.

    Returns:
        Whether every submission could be graded.

    Raises:
        CourseError: Too little of a sandbox, no submissions, broken check files, or `out` can't be written.
    """
    course = replace(course or Course(exercises_dir(), solutions_dir()), sandbox=need)
    catalog_of(course)  # a broken check file is named before the first submission
    isolation = shared_template().isolation
    isolation.demand(course.sandbox)
    found = find_submissions(submissions)
    chosen = [s for s in found if fnmatch.fnmatch(f"{s.student}/{s.exercise}", only)]
    if not chosen:
        raise CourseError(f"--only {only} fits no submission; one is {found[0].student}/{found[0].exercise}")
    _check_writable(out)
    todo = [s for s in chosen if not (resume and _is_done(s, out))]
    rows = _grade_all(todo, course, out, jobs or os.cpu_count() or 1)
    for submission in todo:
        for note in submission.notes:
            _say(f"{submission.student}  {submission.exercise}  note: {note}")
    _say_summary(rows)
    _say(f"Isolation: {isolation}.")
    index = write_index(out, catalog_of(course).course.time_zone)
    _say(f"Wrote {write_gradebook(out)} and {index}")
    return all(row["status"] in GRADED for row in rows)


def _check_writable(out: Path) -> None:
    try:
        write_whole(out / "results" / ".writable", b"")
        (out / "results" / ".writable").unlink()
    except OSError as error:
        raise CourseError(f"{out} can't be written: {error.strerror}. Name another: --out DIR") from error


def _is_done(submission: Submission, out: Path) -> bool:
    try:
        kept = read_result(result_path(out, submission))
    except CourseError:  # not there, or written by something else
        return False
    same = (kept.get("sha256"), kept.get("received")) == (
        submission.sha256,
        submission.received.time.isoformat(),
    )
    return same and kept["row"]["status"] in GRADED


def _grade_all(chosen: Sequence[Submission], course: Course, out: Path, jobs: int) -> list[Row]:
    from rich.progress import track

    if min(jobs, len(chosen)) <= 1:
        graded: Iterator[Row] = (grade_one(submission, course, out) for submission in chosen)
    else:
        graded = _in_parallel(chosen, course, out, min(jobs, len(chosen)))
    return list(track(graded, "Grading", total=len(chosen)))


def _in_parallel(chosen: Sequence[Submission], course: Course, out: Path, jobs: int) -> Iterator[Row]:
    context = multiprocessing.get_context("spawn")  # no threads and no locks of this process in it
    with ProcessPoolExecutor(jobs, mp_context=context) as pool:
        futures = {pool.submit(grade_one, submission, course, out): submission for submission in chosen}
        for future in as_completed(futures):
            try:
                yield future.result()
            except Exception as error:  # the grading process itself died: that submission's is our fault
                yield stored(our_fault(futures[future], error), course, out)


def _say_summary(rows: Sequence[Row]) -> None:
    for row in sorted(rows, key=lambda row: (row["student"], row["exercise"])):
        if row["status"] != "graded":
            _say("  ".join(str(row[name]) for name in ("student", "exercise", "status", "reason", "message")))
    counts = ", ".join(f"{n} {status}" for status, n in sorted(Counter(r["status"] for r in rows).items()))
    _say(f"{len(rows)} submissions: {counts or 'nothing to do'}.")


def _say(line: str) -> None:
    print(printable(line))  # noqa: T201  the terminal is its page
