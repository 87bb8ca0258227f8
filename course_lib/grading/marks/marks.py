"""From task scores to a mark: points of checks and persons, bonus, late policy."""

import getpass
import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, TypeVar

from course_lib.course.course_file import Late
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.judge import TaskResult
from course_lib.grading.records import digest_of, marks_turn
from course_lib.grading.task import Row

DAY = 86_400  # [s]
T = TypeVar("T")


@dataclass(frozen=True)
class Mark:
    """The arithmetic of one submission, in points; the penalty is what is taken off."""

    score: float
    max_score: float
    days_late: int
    penalty: float
    final: float


def add_up(tasks: Sequence[TaskResult], days_late: int, late: Late) -> Mark:
    """Add up the points of tasks, bonus on top, and take off the late penalty, at most all of them."""
    score = round(sum(task.score for task in tasks), 2)
    max_score = sum(task.points for task in tasks if not task.bonus)
    penalty = round(min(score, score * late.percent_per_day / 100 * days_late), 2)
    return Mark(score, max_score, days_late, penalty, round(score - penalty, 2))


def count_days_late(received: datetime, deadline: datetime | None, late: Late) -> int:
    """Return the started days after the deadline and the minutes of grace.

    A day lasts until the next day's same local time, also when the clocks change.
    """
    if deadline is None:
        return 0
    received = received.astimezone(UTC)  # times of one zone are subtracted as if clocks never changed
    days = max(math.floor((received - deadline).total_seconds() / DAY) - 1, 0)
    while received - (deadline + timedelta(days=days)) > timedelta(minutes=late.grace_minutes):
        days += 1
    return days


@dataclass(frozen=True)
class HandMark:
    """The points of one person for a task or for one row of its rubric; the last one counts.

    Args:
        task: Its id.
        points: None is a comment alone.
        row: The text of the rubric's row; "" is the whole task.
        comment: For the student; the last one of each row counts.
        by: The person.
        at: When, in ISO format.
        sha256: Of the hand-in that the person has seen; "" is not known.
    """

    task: str
    points: float | None
    row: str
    comment: str
    by: str
    at: str
    sha256: str = ""

    def is_of(self, sha256: str) -> bool:
        """Return whether it may be of a hand-in."""
        return self.sha256 in ("", sha256)


@dataclass(frozen=True)
class Given:
    """Points as a person types them.

    Args:
        points: For the row, else for the whole task; None is a comment alone.
        row: Its number from 1, or its first words; "" for the whole task.
        comment: For the student; None keeps the one that is there.
    """

    points: float | None
    row: str = ""
    comment: str | None = None


class MarksConflictError(CourseError):
    """Somebody else has marked the same task meanwhile; nothing was written."""


def read_marks(path: Path) -> list[HandMark]:
    """Return all marks of a file, the oldest first; raises a CourseError where it is damaged."""
    return read_entries(path, HandMark)


def read_entries(path: Path, kind: type[T]) -> list[T]:
    """Return the records of a file, the oldest first; none where there is no file.

    Raises:
        CourseError: The file is damaged.
    """
    if not path.is_file():
        return []
    try:
        return [kind(**entry) for entry in read_json(path.read_text(encoding="utf-8"))]
    except (OSError, ValueError, TypeError) as error:
        raise CourseError(f"{path} can't be read: {error}. Restore it from a copy, or remove it.") from error


def revision_of(marks: Iterable[HandMark], task: str, sha256: str) -> str:
    """Return the revision of a task; each mark that is added changes it, and another hand-in."""
    return f"{sha256[:8]}-{digest_of([asdict(mark) for mark in marks if mark.task == task])[:16]}"


def add_marks(
    path: Path,
    task: TaskResult,
    given: Sequence[Given],
    *,
    sha256: str,
    by: str = "",
    revision: str | None = None,
) -> list[HandMark]:
    """Append the marks of one person to a file of marks, all or none; they are on the disk afterwards.

    Args:
        path: OUT/marks/STUDENT/EXERCISE.json.
        task: As it was judged.
        given: For the task, or for rows of its rubric.
        sha256: Of the hand-in.
        by: The person; default: the user of the machine.
        revision: Of the task's marks that the person has seen; None does not ask.

    Raises:
        MarksConflictError: The task has other marks by now, or there is another hand-in.
        CourseError: There is no such row, or it has fewer points.
    """
    with marks_turn(path.parents[2]):
        kept = read_marks(path)
        mine = [mark for mark in kept if mark.task == task.task]
        by = by or getpass.getuser()
        new = [replace(_hand_mark(task, one, mine, by), sha256=sha256) for one in given]
        if revision is not None and revision != revision_of(mine, task.task, sha256):
            if list(map(_content, mine[-len(new) :])) == list(map(_content, new)):
                return mine[-len(new) :]  # sent twice, as the first answer was lost
            who = f"{mine[-1].by if mine else 'somebody'} has marked"
            if not revision.startswith(f"{sha256[:8]}-"):
                who = "the student has changed"
            raise MarksConflictError(f"{who} {task.task} meanwhile")
        _write(path, [*kept, *new])
    return new


def _write(path: Path, marks: Sequence[HandMark]) -> None:
    """Write a file of marks; the new names are on the disk, too, of the file and of folders made for it."""
    for draft in path.parent.glob(f".{path.name}.*"):
        draft.unlink()  # half a file of a person whose process was killed
    text = json.dumps([asdict(mark) for mark in marks], indent=1, ensure_ascii=False)
    write_whole(path, text.encode("utf-8", "replace"))
    for folder in path.parents[:3]:
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _hand_mark(task: TaskResult, given: Given, before: Sequence[HandMark], by: str) -> HandMark:
    row = _row(task.rubric, given.row) if given.row else None
    text, most = (row.text, row.points) if row else ("", task.points)
    if given.points is not None and not 0 <= given.points <= most:
        raise CourseError(f"{given.points:g} points for {text or task.task}: expected 0 to {most:g}")
    last = next((mark.comment for mark in reversed(before) if mark.row == text), "")
    comment = last if given.comment is None else given.comment
    return HandMark(
        task.task, given.points, text, comment, by, datetime.now(UTC).isoformat(timespec="seconds")
    )


def _content(mark: HandMark) -> HandMark:
    return replace(mark, at="")


def marked_tasks(content: Mapping[str, Any], marks: Sequence[HandMark]) -> list[TaskResult]:
    """Return the tasks of a result file with the points of persons."""
    tasks = map(TaskResult.from_plain, content.get("tasks", ()))
    return [apply_marks(task, marks, content["sha256"]) for task in tasks]


def apply_marks(result: TaskResult, marks: Iterable[HandMark], sha256: str) -> TaskResult:
    """Return a task with the points of persons: the last for the whole task, or the sum over all rows."""
    mine = [mark for mark in marks if mark.task == result.task]
    said = {mark.row: mark.comment for mark in mine}
    comments = tuple(f"{row}: {comment}".lstrip(": ") for row, comment in said.items() if comment)
    given = {mark.row: mark.points for mark in mine if mark.points is not None}
    if not given:
        return replace(result, comments=comments)
    of_this = {mark.row: mark.is_of(sha256) for mark in mine if mark.points is not None}
    if whole_task_counts(mine):
        return replace(result, manual=given[""], comments=comments, is_current=of_this[""])
    if missing := [row.text for row in result.rubric if row.text not in given]:
        return replace(result, comments=(*comments, f"still to be marked: {', '.join(missing)}"))
    share = sum(given[row.text] for row in result.rubric) / sum(row.points for row in result.rubric)
    result = replace(result, is_current=all(of_this[row.text] for row in result.rubric))
    return replace(result, manual=round(result.points * share, 2), comments=comments)


def whole_task_counts(marks: Sequence[HandMark]) -> bool:
    """Return whether the last points of a task are for all of it, not for a row of its rubric."""
    return next((not mark.row for mark in reversed(marks) if mark.points is not None), False)


def _row(rubric: Sequence[Row], name: str) -> Row:
    numbers = {str(number): row for number, row in enumerate(rubric, 1)}
    named = (row for row in rubric if row.text.casefold().startswith(name.casefold()))
    if row := numbers.get(name) or next(named, None):
        return row
    rows = "; ".join(f"{number} {row.text} ({row.points:g})" for number, row in enumerate(rubric, 1))
    raise CourseError(f"--row {name}: the rubric has {rows or 'no rows: leave out --row'}")
