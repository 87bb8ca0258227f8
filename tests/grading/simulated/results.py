"""A simulated class over a term: records as `course grade` leaves them, without running code."""

import random
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, timedelta
from pathlib import Path

from course_lib.course.course_file import CourseFile
from course_lib.grading.marks import MarkEntry, add_marks, mark
from course_lib.grading.records import (
    CheckResult,
    Fault,
    Judgement,
    ReceiptTime,
    Result,
    Submission,
    TaskResult,
)
from course_lib.grading.store import marks_path

STATES = ("graded",) * 14 + ("missing",) * 3 + ("rejected", "grader_error", "by hand")


def write_results(out: Path, students: list[str], course: CourseFile, seed: int = 0) -> int:
    """Write results of all students and weeks with points; returns their number."""
    chance, count = random.Random(seed), 0
    for student in students:
        for week in (week for week, settings in course.weeks.items() if settings.points):
            state = chance.choice(STATES)
            if state == "missing":
                continue
            result = _result(student, week, state, course, chance)
            result.write(out)
            if state == "by hand":
                task = result.judgement.tasks[0]  # type: ignore[union-attr]
                path = marks_path(out, student, f"{week}_exercise")
                add_marks(
                    path, task, [MarkEntry(round(chance.uniform(0, task.points), 1), "", "Read.")], sha256=""
                )
            count += 1
    return count


def _result(student: str, week: str, state: str, course: CourseFile, chance: random.Random) -> Result:
    deadline = course.deadline(week, student)
    assert deadline is not None
    hours = chance.choice((-48, -1, -0.1, 0.2, 5, 30, 80, 500))
    time = deadline.astimezone(UTC) + timedelta(hours=hours)
    received = ReceiptTime(None if chance.random() < 0.05 else time, "received.csv")
    one = Submission(student, f"{week}_exercise", Path(student, f"{week}_exercise.ipynb"), received)
    if state == "rejected":
        return mark([replace(one, problem="not JSON")], [None], course, "d")
    if state == "grader_error":
        return mark([one], [Fault("OSError", "disk full")], course, "d")
    tasks = tuple(_tasks(week, course, chance))
    return mark([one], [Judgement(tasks, "full sandbox", (), "", {})], course, "d")


def _tasks(week: str, course: CourseFile, chance: random.Random) -> Iterator[TaskResult]:
    settings = course.weeks[week]
    for name, most in {**settings.points, **settings.bonus}.items():
        checks = tuple(
            CheckResult(
                f"check {number}",
                "public" if number < 3 else "other",
                number >= 3,
                chance.choice((0.5, 1.0, 2.0)),
                chance.choice((0.0, 0.25, 1.0, 1.0, 1.0)),
                "why",
                "a kind of mistake",
            )
            for number in range(5)
        )
        yield TaskResult(f"{week}.{name}", name, most, name in settings.bonus, checks)
