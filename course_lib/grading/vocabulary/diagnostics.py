"""Expectations on a robot's health, and on what was found out about a robot."""

from collections.abc import Iterable
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.values import compare
from course_lib.grading.vocabulary.wording import Problem, heard, word
from course_lib.robots.unknown_make import Make

TOPIC, ARRAY = "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"
LEVELS = ("OK", "WARN", "ERROR", "STALE")
SETTLED = 1.005  # [s] after its beginning a part of a run shows in what is reported every second
FACTS = {  # about an unknown robot, and the tool that tells
    "image_rate": "ros2 topic hz",
    "image_width": "ros2 topic echo --once --field width",
    "scan_reliability": "ros2 topic info -v",
    "threshold": "ros2 param get",
    "trigger_service": "ros2 service list -t",
}


@word("{level}, {says}")
def expect_level(evidence: Evidence, level: str, *, says: str, begin: float, end: float) -> Iterable[Problem]:
    """Each status about a second between two times [s] has this level, and its message this word in it."""
    came = heard(evidence, TOPIC, ARRAY)
    arrays = [m for at, m in came if begin + SETTLED <= at <= end + SETTLED - 1]
    statuses = [status for array in arrays for status in array.status]
    when = f"from {begin:g} to {end:g} s"
    if not statuses:
        return [Problem(f"no status came {when}", "a status is missing")]
    for status in statuses:
        reported = LEVELS[min(status.level[0], len(LEVELS) - 1)]
        if reported != level:
            return [Problem(f"the level is {reported} {when}, expected {level}", "a level is wrong")]
        if says not in status.message.lower():
            message = f"the message is {status.message!r} {when}: {says!r} is not in it"
            return [Problem(message, "a message of a status does not say what it should")]
    return []


@word("{name}")
def expect_fact(evidence: Evidence, name: str, *, serial: int) -> Iterable[Problem]:
    """A dict has a fact about the robot of this number, rates within 3 %; the right one is not said."""
    facts: Any = evidence.returns[0] if evidence.returns else None
    if not isinstance(facts, dict) or name not in facts:
        return [Problem(f"there is no {name!r} in what came back", "a fact is missing")]
    make = Make(serial)
    right: Any = {
        "image_rate": make.image_hz,
        "image_width": make.image_width,
        "scan_reliability": "RELIABLE" if make.scans_reliably else "BEST_EFFORT",
        "threshold": make.threshold,
        "trigger_service": "/robot/reset_odometry",
    }[name]
    tolerance = 0.03 * right if isinstance(right, float) else 0.0
    if not list(compare(facts[name], right, tolerance, "", name)):
        return []
    message = f"{name} is {facts[name]!r}, and that is not what your robot has. Look with {FACTS[name]}"
    return [Problem(message, "a fact about the robot is wrong")]
