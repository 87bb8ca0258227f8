"""From the scores of checks and the points of graders to results and marks."""

import json
import math
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, fields, replace
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any

from course_lib.course.course_file import POINTS_PER_WEEK, CourseFile
from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.grading.records import (
    MISMATCH,
    Attempt,
    Fault,
    HandMark,
    Judgement,
    Mark,
    Result,
    Status,
    Submission,
    TaskResult,
    from_plain,
    read_stored_result,
    to_plain,
)
from course_lib.grading.store import digest_of, lock_marks, marks_path, result_path
from course_lib.host import user_name
from course_lib.third_party import read_json


@dataclass(frozen=True)
class MarkEntry:
    """Points as entered by a grader.

    Args:
        points: Points for the row, else for the whole task; None for a comment alone.
        row: The row's number from 1 or its first words; "" for the whole task.
        comment: A comment for the student; None keeps the existing one.
        withdraw: Withdraw existing marks; points and comment are ignored.
    """

    points: float | None
    row: str = ""
    comment: str | None = None
    withdraw: bool = False


class MarksConflictError(CourseError):
    """Raised if someone else has marked the same task in the meantime. Nothing is written."""


def read_marks(path: Path) -> list[HandMark]:
    """Return all marks of a file, oldest first.

    Raises:
        CourseError: The file is damaged.
    """
    if not path.is_file():
        return []
    try:
        return from_plain(read_json(path.read_text(encoding="utf-8")), list[HandMark])
    except (OSError, ValueError, TypeError) as error:
        raise CourseError(f"{path} can't be read: {error}. Restore it from a copy, or remove it.") from error


def standing_marks(marks: Iterable[HandMark]) -> list[HandMark]:
    """Return the marks of a file that were not withdrawn.

    Nothing is removed from the file, so that it shows who gave and who withdrew a mark.
    """
    standing: list[HandMark] = []
    for mark in marks:
        if mark.withdrawn:
            standing = [old for old in standing if old.task != mark.task or mark.row not in ("", old.row)]
        else:
            standing.append(mark)
    return standing


def revision_of(marks: Iterable[HandMark], task: str, sha256: str) -> str:
    """Return the revision of a task's marks, which changes with each new mark and with another submission."""
    return f"{sha256[:8]}-{digest_of([asdict(mark) for mark in marks if mark.task == task])[:16]}"


def add_marks(
    path: Path,
    task: TaskResult,
    entries: Sequence[MarkEntry],
    *,
    sha256: str,
    by: str = "",
    revision: str | None = None,
) -> list[HandMark]:
    """Append a grader's marks to a file of marks, all or none, and flush them to the disk.

    Args:
        path: OUT/marks/STUDENT/EXERCISE.json.
        task: The judged task.
        entries: Points for the task, or for rows of its rubric.
        sha256: Digest of the submission.
        by: The grader; default: the user of the machine.
        revision: Revision of the marks that the grader has seen; None skips the comparison.

    Raises:
        MarksConflictError: The task has other marks by now, or there is another submission.
        CourseError: The row does not exist, or has fewer points.
    """
    with lock_marks(path.parents[2]):
        stored_marks = read_marks(path)
        marks_of_task = [mark for mark in stored_marks if mark.task == task.task]
        by = by or user_name()
        new = [replace(_hand_mark(task, entry, marks_of_task, by), sha256=sha256) for entry in entries]
        if revision is not None and revision != revision_of(marks_of_task, task.task, sha256):
            last = marks_of_task[-len(new) :]
            if [replace(mark, at="") for mark in last] == [replace(mark, at="") for mark in new]:
                # The page sent the marks again, because the first answer was lost.
                return last
            cause = f"{marks_of_task[-1].by if marks_of_task else 'somebody'} has marked"
            if not revision.startswith(f"{sha256[:8]}-"):
                cause = "the student has changed"
            raise MarksConflictError(f"{cause} {task.task} in the meantime")
        for draft in path.parent.glob(f".{path.name}.*"):
            # A process that was killed can leave half-written files.
            draft.unlink()
        text = json.dumps([asdict(mark) for mark in [*stored_marks, *new]], indent=1, ensure_ascii=False)
        write_atomically(path, text.encode("utf-8", "replace"))
        # Flush the new directory entries of the file and its folders to the disk.
        for folder in path.parents[:3]:
            handle = os.open(folder, os.O_RDONLY)
            try:
                os.fsync(handle)
            finally:
                os.close(handle)
    return new


def _hand_mark(task: TaskResult, entry: MarkEntry, before: Sequence[HandMark], by: str) -> HandMark:
    text, max_points = "", task.points
    if entry.row:
        rows = {str(number): row for number, row in enumerate(task.rubric, 1)}
        matching = (row for row in task.rubric if row.text.casefold().startswith(entry.row.casefold()))
        row = rows.get(entry.row) or next(matching, None)
        if row is None:
            known = "; ".join(f"{number} {row.text} ({row.points:g})" for number, row in rows.items())
            raise CourseError(f"--row {entry.row}: the rubric has {known or 'no rows: leave out --row'}")
        text, max_points = row.text, row.points
    before, at = standing_marks(before), datetime.now(UTC).isoformat(timespec="seconds")
    if entry.withdraw:
        if not any(text in ("", mark.row) for mark in before):
            raise CourseError(
                f"{text or task.task or task.title} has no mark by hand, so none can be withdrawn"
            )
        return HandMark(task.task, None, text, "", by, at, withdrawn=True)
    if entry.points is not None and not 0 <= entry.points <= max_points:
        raise CourseError(
            f"{entry.points:g} points for {text or task.task or task.title}: expected 0 to {max_points:g}"
        )
    last = next((mark.comment for mark in reversed(before) if mark.row == text), "")
    comment = last if entry.comment is None else entry.comment
    return HandMark(task.task, entry.points, text, comment, by, at)


def apply_marks(result: TaskResult, marks: Iterable[HandMark], sha256: str) -> TaskResult:
    """Return a task with graders' points: the last ones for the task, or the sum of all rows."""
    marks_of_task = [mark for mark in standing_marks(marks) if mark.task == result.task]
    by_row = {mark.row: mark.comment for mark in marks_of_task}
    comments = tuple(f"{row}: {comment}".lstrip(": ") for row, comment in by_row.items() if comment)
    points_by_row = {mark.row: mark.points for mark in marks_of_task if mark.points is not None}
    if not points_by_row:
        return replace(result, comments=comments)
    of_this = {mark.row: mark.is_of(sha256) for mark in marks_of_task if mark.points is not None}
    if has_task_mark(marks_of_task):
        return replace(result, manual=points_by_row[""], comments=comments, is_current=of_this[""])
    if missing := [row.text for row in result.rubric if row.text not in points_by_row]:
        return replace(result, comments=(*comments, f"still to be marked: {', '.join(missing)}"))
    share = sum(points_by_row[row.text] for row in result.rubric) / sum(row.points for row in result.rubric)
    result = replace(result, is_current=all(of_this[row.text] for row in result.rubric))
    return replace(result, manual=round(result.points * share, 2), comments=comments)


def task_mark(marks: Iterable[HandMark]) -> HandMark | None:
    """Return the last mark that a grader entered for an exercise without a submission, or None."""
    standing = reversed(standing_marks(marks))
    return next((mark for mark in standing if not mark.task and mark.points is not None), None)


def has_task_mark(marks: Sequence[HandMark]) -> bool:
    """Return whether the last points of a task are for the whole task, not for a row of its rubric."""
    return next((not mark.row for mark in reversed(marks) if mark.points is not None), False)


MARK_COLUMNS = tuple(field.name for field in fields(Mark))
COLUMNS = ("student", "exercise", *MARK_COLUMNS, "status", "reason", "message")


def mark(
    attempts: Sequence[Submission],
    judgements: Sequence[Judgement | Fault | None],
    course: CourseFile,
    digest: str,
    rules: str = "",
) -> Result:
    """Mark one student's attempts at an exercise, and return the best one.

    Args:
        attempts: The submissions, oldest first.
        judgements: The judgement of each, a fault if it has none, or None if it is rejected.
        course: Deadlines and late policy.
        digest: Digest of everything that the result depends on.
        rules: Digest of the rules by which they are judged.
    """
    results = [_make_result(s, judgement, course) for s, judgement in zip(attempts, judgements, strict=True)]
    best = max(results, key=_rank)
    finals = [result.mark.final if result.mark else None for result in results]
    tried = tuple(
        replace(attempt_of(r.submission), final=final) for r, final in zip(results, finals, strict=True)
    )
    return replace(best, attempts=tried, rules=rules, digest=digest if best.judgement else "")


def dates_of(course: CourseFile, student: str, exercise: str) -> list[Any]:
    """Return the dates and the late policy for a student's mark and report, as plain data."""
    week = exercise.split("_")[0]
    deadline = course.deadline(week, student) if week in course.weeks else None
    return [deadline and deadline.isoformat(), course.zone.key, to_plain(course.late)]


def attempt_of(submission: Submission) -> Attempt:
    """Return an attempt's key: its evidence, time of receipt, and whether its ID is correct."""
    return Attempt(submission.key, submission.received, submission.id_flag)


def _rank(result: Result) -> float:
    """Return a sort key: the mark, infinity for a fault (the attempt may be the best), -1 if rejected."""
    if result.status == "grader_error":
        return math.inf
    return result.mark.final if result.mark else -1.0


def _make_result(
    submission: Submission,
    judgement: Judgement | Fault | None,
    course: CourseFile,
) -> Result:
    notes = tuple(submission.notes)
    if judgement is None:
        reason = submission.reason or ("wrong exercise" if submission.sha256 else "unreadable")
        return Result(submission, "rejected", reason, submission.problem, notes=notes)
    if isinstance(judgement, Fault):
        return Result(submission, "grader_error", judgement.kind, judgement.text, notes=notes)
    late, received = course.late, submission.received
    deadline = course.deadline(submission.exercise.split("_")[0], submission.student)
    broken_checks = [f"a check raised an error: {check}" for check in judgement.broken]
    return Result(
        submission,
        "limit" if judgement.limit else "graded",
        judgement.limit,
        judgement=judgement,
        days_late=received.days_late(deadline, late),
        late=late,
        notes=(*notes, *received.contradictions(deadline, late), *broken_checks),
        remark=received.remark(deadline, late),
    )


@dataclass(frozen=True)
class GradebookRow:
    """The line of the gradebook for one student and exercise.

    Without a mark its numbers are empty.
    """

    student: str
    exercise: str
    mark: Mark | None
    status: Status
    reason: str
    message: str

    @property
    def cells(self) -> dict[str, str | float]:
        """The values of the gradebook's columns, by the names in `COLUMNS`."""
        numbers = asdict(self.mark) if self.mark else dict.fromkeys(MARK_COLUMNS, "")
        texts = {name: getattr(self, name) for name in COLUMNS if name not in MARK_COLUMNS}
        return {name: {**numbers, **texts}[name] for name in COLUMNS}


@dataclass(frozen=True)
class MarkedResult:
    """A result with graders' points, as gradebook, reports, exports and the marking page show it.

    Args:
        result: The result of the checks.
        marks: The points and comments of graders, oldest first.
    """

    result: Result
    marks: tuple[HandMark, ...] = ()

    @property
    def student(self) -> str:
        """The student's name in the gradebook."""
        return self.result.submission.student

    @property
    def exercise(self) -> str:
        """For example "week01_exercise"."""
        return self.result.submission.exercise

    @cached_property
    def tasks(self) -> tuple[TaskResult, ...]:
        """The tasks with graders' points."""
        return tuple(
            apply_marks(task, self.marks, self.result.submission.sha256) for task in self.result.tasks
        )

    @cached_property
    def displayed_result(self) -> Result:
        """The result with graders' points, for the report."""
        result = replace(self.result, status=self.row.status, message=self.row.message)
        if result.judgement is None:
            return result
        return replace(result, judgement=replace(result.judgement, tasks=self.tasks))

    @cached_property
    def row(self) -> GradebookRow:
        """The line of the gradebook."""
        result, submission, exercise_mark = self.result, self.result.submission, task_mark(self.marks)
        row = GradebookRow(self.student, self.exercise, None, result.status, result.reason, result.message)
        if not self.tasks:
            if exercise_mark is None:
                return row
            points = exercise_mark.points or 0.0
            message = ": ".join(
                filter(None, ("marked by a grader without a gradable file", exercise_mark.comment))
            )
            return replace(
                row,
                mark=Mark(points, float(POINTS_PER_WEEK), 0, 0.0, points),
                status="graded",
                message=message,
            )
        full = sum(task.score >= task.points for task in self.tasks)
        message = f"{full} of {len(self.tasks)} tasks have full marks"
        if outdated := ", ".join(task.task for task in self.tasks if not task.is_current):
            message += f"; {outdated}: marked in another submission: mark it again"
        message = "; ".join(filter(None, (message, result.remark, result.rejection_reason)))
        if exercise_mark:
            message += (
                f"; {exercise_mark.points or 0:g} points were given without a file before: "
                "withdraw them with "
                "--without-file --withdraw, or remove the file and its result"
            )
        is_waiting = exercise_mark is not None or any(task.needs_hand_mark for task in self.tasks)
        reason = row.reason
        if submission.id_flag == MISMATCH:
            reason = ", ".join(filter(None, (reason, MISMATCH)))
            message = f"{submission.id_note}; {message}"
            # The grader who entered points for this file has seen the note.
            is_waiting |= not any(mark.is_of(submission.sha256) for mark in standing_marks(self.marks))
        total = Mark.compute(self.tasks, result.days_late, result.late)
        status: Status = "needs_marking" if is_waiting else row.status
        return replace(row, mark=total, status=status, reason=reason, message=message)


def read_result(path: Path) -> MarkedResult:
    """Read a result with the points of graders.

    Raises:
        CourseError: The file, or the file of marks, can't be read.
    """
    student, exercise = path.parent.name, path.stem
    marks = read_marks(marks_path(path.parents[2], student, exercise))
    try:
        result = read_stored_result(path)
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise CourseError(f"{path} can't be read: {error}. Remove it and grade again.") from error
    # The path is authoritative: a file name may contain bytes that JSON cannot represent.
    submission = replace(result.submission, student=student, exercise=exercise)
    return MarkedResult(replace(result, submission=submission), tuple(marks))


def results_in(out: Path) -> Iterator[MarkedResult]:
    """Yield all results by student and exercise, one at a time, as together they may be large."""
    return map(read_result, sorted((out / "results").glob("*/*.json")))


def stored_result(out: Path, student: str, exercise: str) -> MarkedResult:
    """Read the result of a student's exercise. The exceptions are the same as in `read_result`."""
    return read_result(result_path(out, student, exercise))


def require_results(out: Path) -> None:
    """Raise an error if a folder was not written by `course grade`.

    Raises:
        CourseError: It has no results.
    """
    if not any((out / "results").glob("*/*.json")):
        raise CourseError(f"{out} has no results. Type: course grade SUBMISSIONS --out {out}")
