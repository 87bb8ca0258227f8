"""From task scores to a mark: points, bonus, late policy."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from course_lib.course.course_file import Late
from course_lib.grading.judge import TaskResult

DAY = 86_400  # [s]


@dataclass(frozen=True)
class Mark:
    """The arithmetic of one submission, in points; the penalty is what is taken off."""

    score: float
    max_score: float
    days_late: int
    penalty: float
    final: float


def mark(tasks: Sequence[TaskResult], days_late: int, late: Late) -> Mark:
    """Add up the tasks, bonus on top, and take off the late penalty, at most all."""
    score = round(sum(task.score for task in tasks), 2)
    max_score = sum(task.points for task in tasks if not task.bonus)
    penalty = round(min(score, score * late.percent_per_day / 100 * days_late), 2)
    return Mark(score, max_score, days_late, penalty, round(score - penalty, 2))


def count_days_late(received: datetime, deadline: datetime | None, late: Late) -> int:
    """Started days after the deadline and the minutes of grace.

    A day lasts until the next day's same local time, also when the clocks change.
    """
    if deadline is None:
        return 0
    received = received.astimezone(UTC)  # times of one zone are subtracted as if clocks never changed
    days = max(math.floor((received - deadline).total_seconds() / DAY) - 1, 0)
    while received - (deadline + timedelta(days=days)) > timedelta(minutes=late.grace_minutes):
        days += 1
    return days
