"""From task scores to a mark: points of checks and persons, bonus, late policy."""

import getpass
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from course_lib.course.course_file import Late
from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.judge import TaskResult
from course_lib.grading.task import Row

DAY = 86_400  # [s]


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
    """The points of one person for a task or for one row of its rubric; the last one counts."""

    task: str
    points: float
    row: str
    comment: str
    by: str
    at: str


def read_marks(path: Path) -> list[HandMark]:
    """Return all marks of a file, the oldest first.

    Raises:
        CourseError: The file is damaged.
    """
    if not path.is_file():
        return []
    try:
        return [HandMark(**entry) for entry in json.loads(path.read_text(encoding="utf-8"))]
    except (OSError, ValueError, TypeError) as error:
        raise CourseError(f"{path} can't be read: {error}. Restore it from a copy, or remove it.") from error


def add_mark(path: Path, task: TaskResult, points: float, row: str, comment: str) -> HandMark:
    """Append a mark to a file of marks, with the user's name and the time.

    Args:
        path: The file of marks.
        task: As it was judged.
        points: For the row, else for the whole task.
        row: Its number from 1, or its first words; "" for the whole task.
        comment: For the student.

    Raises:
        CourseError: There is no such row, or it has fewer points.
    """
    named = _row(task.rubric, row) if row else None
    text, most = (named.text, named.points) if named else ("", task.points)
    if not 0 <= points <= most:
        raise CourseError(f"{points:g} points for {text or task.task}: expected 0 to {most:g}")
    now = datetime.now(UTC).isoformat(timespec="seconds")
    given = HandMark(task.task, points, text, comment, getpass.getuser(), now)
    entries = [asdict(mark) for mark in [*read_marks(path), given]]
    write_whole(path, json.dumps(entries, indent=1, ensure_ascii=False).encode())
    return given


def apply_marks(result: TaskResult, marks: Iterable[HandMark]) -> TaskResult:
    """Return a task with the points of persons: the last for the whole task, or the sum over all rows."""
    mine = [mark for mark in marks if mark.task == result.task]
    if not mine:
        return result
    comments = tuple(f"{mark.row}: {mark.comment}".lstrip(": ") for mark in mine if mark.comment)
    if not mine[-1].row:
        return replace(result, manual=mine[-1].points, comments=comments)
    given = {mark.row: mark.points for mark in mine if mark.row}
    if missing := [row.text for row in result.rubric if row.text not in given]:
        return replace(result, comments=(*comments, f"still to be marked: {', '.join(missing)}"))
    share = sum(given[row.text] for row in result.rubric) / sum(row.points for row in result.rubric)
    return replace(result, manual=round(result.points * share, 2), comments=comments)


def _row(rubric: Sequence[Row], name: str) -> Row:
    for number, row in enumerate(rubric, 1):
        if name == str(number) or row.text.casefold().startswith(name.casefold()):
            return row
    rows = "; ".join(f"{number} {row.text} ({row.points:g})" for number, row in enumerate(rubric, 1))
    raise CourseError(f"--row {name}: the rubric has {rows or 'no rows: leave out --row'}")
