"""From the marks of weeks to a student's total: weights, exemptions, the lowest ones, quizzes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from course_lib.course.course_file import Term

Kind = Literal["graded", "missing", "exempt", "open"]
FULL = 100.0  # percent


@dataclass(frozen=True)
class WeekMark:
    """One student's mark of one week.

    Args:
        kind: `missing` is zero; `exempt` does not count; `open` waits for a person, or for the kit.
        percent: Of the week's points, above 100 with a bonus; None where there is no mark.
        by: The member of the group whose hand-in it is, if it is another one.
    """

    kind: Kind
    percent: float | None = None
    by: str = ""


@dataclass(frozen=True)
class Total:
    """A student's total, in percent; None if nothing counts yet.

    Args:
        percent: Of all that counts.
        weeks: The part of the weeks alone.
        quizzes: The mean of the quizzes, if they count.
        dropped: The lowest weeks, which do not count.
    """

    percent: float | None
    weeks: float | None
    quizzes: float | None = None
    dropped: tuple[str, ...] = ()


@dataclass(frozen=True)
class TermLine:
    """One student's line of the term.

    Args:
        student: The ID.
        marks: By week, all that count for the class.
        total: Of these.
    """

    student: str
    marks: Mapping[str, WeekMark] = field(default_factory=dict)
    total: Total = Total(None, None)

    def weeks_of(self, kind: Kind) -> list[str]:
        """Return the weeks whose mark is of one kind."""
        return [week for week, mark in self.marks.items() if mark.kind == kind]


def add_up_term(marks: Mapping[str, WeekMark], quizzes: Mapping[str, float], term: Term) -> Total:
    """Return the total of one student.

    Args:
        marks: By week.
        quizzes: Percent by week, of all weeks with a quiz.
        term: Weights, and what does not count.
    """
    counted = {week: mark.percent for week, mark in marks.items() if mark.percent is not None}
    weights = {week: term.weights.get(week, 1.0) for week in counted}
    counted = {week: percent for week, percent in counted.items() if weights[week] > 0}
    dropped = _lowest(counted, weights, int(term.drop_lowest))
    kept = [week for week in counted if week not in dropped]
    if not kept:
        return Total(None, None)
    whole = sum(weights[week] for week in kept)
    weeks = sum(weights[week] * counted[week] for week in kept) / whole
    held = [week for week in counted if week in quizzes]
    if not term.quiz_percent or not held:
        return Total(round(weeks, 2), round(weeks, 2), dropped=dropped)
    quiz = sum(quizzes[week] for week in held) / len(held)
    share = term.quiz_percent / FULL
    return Total(round((1 - share) * weeks + share * quiz, 2), round(weeks, 2), round(quiz, 2), dropped)


def _lowest(counted: Mapping[str, float], weights: Mapping[str, float], number: int) -> tuple[str, ...]:
    """Return the weeks of the lowest marks, of equal ones the heaviest; one week at least is left."""
    ordered: Sequence[str] = sorted(counted, key=lambda week: (counted[week], -weights[week], week))
    return tuple(sorted(ordered[: max(min(number, len(ordered) - 1), 0)]))
