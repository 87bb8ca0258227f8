"""The stage `hand-in`: from a folder of submissions to each student's attempts, with the jobs to run."""

import fnmatch
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby

from course_lib.errors import CourseError
from course_lib.grading.handin.submission import Submission
from course_lib.grading.marks.mark import identity
from course_lib.grading.records import Course, catalog_of, digest_of, kit_digest, rules_of
from course_lib.grading.run.job import Job, plan


@dataclass(frozen=True)
class Attempts:
    """One student's submissions of one exercise, the last one alone unless the best counts.

    Args:
        student: The folder's name, or the ID in the files.
        exercise: "week01_exercise".
        submissions: The oldest first.
        jobs: By the key of the evidence that each brings; none for a submission that is rejected.
        digest: Of all that the result depends on.
    """

    student: str
    exercise: str
    submissions: tuple[Submission, ...]
    jobs: Mapping[str, Job]
    digest: str


def hand_in(found: Sequence[Submission], course: Course, only: str) -> list[Attempts]:
    """Plan the jobs of the submissions that a pattern chooses.

    Args:
        found: All submissions.
        course: The tasks and hidden checks.
        only: A pattern of STUDENT/EXERCISE.

    Raises:
        CourseError: The pattern fits no submission.
    """
    chosen = [one for one in found if fnmatch.fnmatch(f"{one.student}/{one.exercise}", only)]
    if not chosen:
        one = f"{found[0].student}/{found[0].exercise}"
        raise CourseError(f"--only {only} fits no submission: write a pattern like 'ada/*'; one is {one}")
    _refuse_faulty(chosen, course)
    owners = defaultdict[str, set[str]](set)
    for submission in chosen:
        owners[submission.sha256].add(submission.student)
    groups = groupby(chosen, lambda one: (one.student, one.exercise))
    return [_attempts(list(group), owners, course) for _, group in groups]


def _refuse_faulty(chosen: Sequence[Submission], course: Course) -> None:
    """Refuse submissions of a week whose checks can't be read; the other weeks can be graded."""
    faults = catalog_of(course).faults
    weeks = {one.exercise.split("_")[0] for one in chosen}
    for week in sorted(weeks & faults.keys()):
        sound = min(weeks - faults.keys(), default="week01")
        raise CourseError(f"nothing is graded: {faults[week]}. Meanwhile --only '*/{sound}*' grades one week")


def _attempts(group: Sequence[Submission], owners: Mapping[str, set[str]], course: Course) -> Attempts:
    planned = [_planned(submission, course) for submission in group]
    submissions = tuple(
        replace(one, twins=tuple(sorted(owners[one.sha256] - {one.student})) if one.sha256 else ())
        for one, _ in planned
    )
    student, exercise = group[-1].student, group[-1].exercise
    digest = digest_of([kit_digest(), rules_of(course, exercise), [identity(one) for one in submissions]])
    return Attempts(student, exercise, submissions, {job.key: job for _, job in planned if job}, digest)


def _planned(submission: Submission, course: Course) -> tuple[Submission, Job | None]:
    """Return a submission without its code, but with the key of its evidence, and the job that brings it."""
    catalog = catalog_of(course)
    tasks = catalog.of_week(submission.exercise.split("_")[0])
    notebook, bare = submission.notebook, replace(submission, notebook=None, files={})
    if notebook is None:
        return bare, None
    if not tasks:
        return replace(bare, problem=bare.problem or f"the course has no {bare.exercise}"), None
    steps = tuple(step.unjudged() for step in plan(tasks, catalog, hidden=True))
    limits, files = catalog.course.limits, dict(submission.files)
    job = Job(notebook.cells, submission.values_of, steps, limits, files, course.sandbox, course.refused)
    return replace(bare, key=job.key), job
