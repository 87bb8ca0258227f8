"""Expectations on a robot's health, and on what was found out about a robot."""

from collections.abc import Iterable
from typing import Any

from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.facts import TOOLS, is_fact
from course_lib.grading.vocabulary.wording import Problem, heard, word

TOPIC, ARRAY = "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"
LEVELS = ("OK", "WARN", "ERROR", "STALE")
LAST_WEIGHT = 0.3  # of the part that counts alone
SETTLED = 1.005  # [s] after its beginning a part of a run shows in what is reported every second


@word("{level}, {says}")
def expect_level(evidence: Evidence, level: str, *, says: str, begin: float, end: float) -> Iterable[Problem]:
    """Expect one status about each second between two times [s]: of a level, with a word in its message."""
    came = heard(evidence, TOPIC, ARRAY)
    lists = [list(m.status) for at, m in came if begin + SETTLED <= at <= end + SETTLED - 1]
    statuses = [status for together in lists for status in together]
    when = f"from {begin:g} to {end:g} s"
    if not statuses:
        return [Problem(f"no status came {when}", "a status is missing")]
    if most := max(len(together) for together in lists) - 1:
        message = f"a message has {most + 1} statuses {when}, expected one"
        return [Problem(message, "a message has more than one status")]
    for status in statuses:
        reported = LEVELS[min(status.level[0], len(LEVELS) - 1)]
        if reported != level:
            return [Problem(f"the level is {reported} {when}, expected {level}", "a level is wrong")]
        if says not in status.message.lower():
            message = f"the message is {status.message!r} {when}: {says!r} is not in it"
            return [Problem(message, "a message of a status does not say what it should")]
    return []


def expect_levels(*parts: tuple[str, str, str], seconds: float = 3.0) -> tuple[Check, ...]:
    """Return a check of each part of a run: (level, word in its message, title), each of so many seconds.

    The first part requires the last one, and all others the first: one level for all times is worth little.
    """
    first, *others, last = (
        expect_level(level, says=says, begin=seconds * n, end=seconds * (n + 1)).titled(title)
        for n, (level, says, title) in enumerate(parts)
    )
    first = first.requiring(last)
    return (first, *(other.requiring(first) for other in others), last.worth(LAST_WEIGHT))


@word("{name}")
def expect_fact(evidence: Evidence, name: str, *, serial: int) -> Iterable[Problem]:
    """Expect a dict with a fact about the robot of this number, rates within 3 %; no message tells it."""
    facts: Any = evidence.returns[0] if evidence.returns else None
    if not isinstance(facts, dict) or name not in facts:
        return [Problem(f"there is no {name!r} in what came back", "a fact is missing")]
    if is_fact(serial, name, facts[name]):
        return []
    message = f"{name} is {facts[name]!r}, and that is not what your robot has. Look with {TOOLS[name]}"
    return [Problem(message, "a fact about the robot is wrong")]
