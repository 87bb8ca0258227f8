"""How checks compare and how they say it: what came in, what was expected, in which direction."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from course_lib.grading.evidence import Check, Evidence, Verdict, passed
from course_lib.grading.task import resolve

MOST_SHOWN = 3  # problems in one message


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong: with values for public checks, and the kind of mistake for hidden ones."""

    message: str
    mistake: str


def check_of(title: str, expected: dict[str, Any], find: Callable[..., list[Problem]]) -> Check:
    """A check that passes when `find(evidence, **expected)` finds no problem; `my(...)` is resolved."""

    def judge(evidence: Evidence) -> Verdict:
        problems = find(evidence, **resolve(expected, evidence.personal))
        if not problems:
            return passed("as expected")
        message = "; ".join(problem.message for problem in problems[:MOST_SHOWN])
        if len(problems) > MOST_SHOWN:
            message += f"; and {len(problems) - MOST_SHOWN} more"
        return Verdict(0.0, message, "; ".join(dict.fromkeys(problem.mistake for problem in problems)))

    return Check(title, judge)


def close(value: float, expected: float, tolerance: float) -> bool:
    """Whether two numbers agree; never for NaN."""
    return abs(value - expected) <= tolerance


def number(value: float, unit: str = "") -> str:
    """A number for people: at least two decimals, and as many as a small value needs."""
    decimals = 2 if value == 0 or abs(value) >= 0.1 or not math.isfinite(value) else 4
    return f"{value:.{decimals}f}{unit and ' ' + unit}"


def numbers(values: Iterable[float]) -> str:
    """A few numbers in brackets."""
    return f"({', '.join(number(value) for value in values)})"


def off_by(value: float, expected: float, more: str, less: str, unit: str = "m") -> str:
    """The difference with its direction, "0.30 m too low"; also for what is no number."""
    if not math.isfinite(value):
        return "not at a place" if math.isnan(value) else "infinitely far off"
    return f"{number(abs(value - expected), unit)} {more if value > expected else less}"


def nothing_on(evidence: Evidence, topic: str) -> Problem:
    """Nothing came on a topic; names those on which something did."""
    others = f"only on {', '.join(sorted(evidence.topics))}" if evidence.topics else "nor on any other topic"
    return Problem(
        f"nothing was published on {topic} in {evidence.seconds:g} s, {others}",
        "nothing was published on an expected topic",
    )


def listed(items: Sequence[str]) -> str:
    """A few words as English has them: "a, b and c"."""
    return " and ".join(filter(None, [", ".join(items[:-1]), *items[-1:]]))
