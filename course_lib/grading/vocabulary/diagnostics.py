"""Checks on diagnostics, and on facts about the unknown robots of week 6."""

import hashlib
import math
from collections.abc import Iterable
from typing import Any

from course_lib.errors import CourseError
from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.vocabulary.wording import Problem, heard, word

RATE_TOLERANCE = 0.03  # of a rate that was measured
TOOLS = {  # by fact: what tells it
    "image_rate": "ros2 topic hz",
    "image_width": "ros2 topic echo --once --field width",
    "scan_reliability": "ros2 topic info -v",
    "threshold": "ros2 param get",
    "trigger_service": "ros2 service list -t",
}
DIGESTS = {  # by serial number, in the order of TOOLS
    11: ("f06190ebd5c4", "9685b57aa459", "407dd88dea80", "92c3b72a2be4", "e62db038f7e6"),
    17: ("96e66dd4419d", "c3cbf854c757", "c42f5e198a68", "b19a75f4fbf7", "a386aa2832f3"),
    23: ("6a99899b5c54", "3d4562ebb768", "27cc6c8afd0e", "25ac2c164041", "014cec068eab"),
    26: ("a90f44d11172", "82a418f15101", "d90a3a9b6be0", "ab0a72b4df3f", "3d28b5a38f66"),
    32: ("1e85461cc1a2", "c6cab8684d01", "dd73fc64bbeb", "105650a70ebc", "fe78d6922466"),
    38: ("c29bba8bbc84", "deee80423aad", "6346e7c05574", "2949d3e91ab8", "6dd554a6d64a"),
    44: ("c8b1526c913b", "b3b5959e8bd0", "81ea1b441ba2", "d5d1b6e602ec", "9f896fd162b3"),
    47: ("8c65af9efb72", "83949fab6212", "8a02c35cd34b", "ee53d0678098", "ca9f6406ddf5"),
    53: ("e973230868bd", "1426e0d4c653", "975b03510946", "4b3f95d3a84d", "2b3f04d8aa52"),
    59: ("3358af9e9a60", "d4cfbbc409ca", "1fbf0ce9661a", "02ef1861f62f", "2c5396c5aad4"),
    62: ("87cc069c09bd", "11a4d249d92e", "cc535e4b09e1", "8cf723a14c7a", "cf094cc2705e"),
    68: ("0cda77411ec5", "4d83f6a06f88", "c7789e1e13f5", "6e6a18d4859b", "4683c9ee2c60"),
}
TOPIC, ARRAY = "/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"
LEVELS = ("OK", "WARN", "ERROR", "STALE")
LAST_WEIGHT = 0.3  # of the part that counts alone
SETTLED = 1.005  # [s] after its beginning a part of a run shows in what is reported every second


def digest(serial: int, name: str, value: float | str) -> str:
    """Return what stands for a fact in the table."""
    text = repr(value) if isinstance(value, str) else f"{value:.6g}"
    return hashlib.blake2b(f"{serial} {name} {text}".encode(), digest_size=6).hexdigest()


def is_fact(serial: int, name: str, value: Any) -> bool:
    """Return whether a robot has this value, a rate within RATE_TOLERANCE.

    Raises:
        CourseError: The table has no robot of this number.
    """
    if serial not in DIGESTS:
        raise CourseError(f"no facts are known of robot {serial}, only of {', '.join(map(str, DIGESTS))}")
    expected = DIGESTS[serial][list(TOOLS).index(name)]
    return any(digest(serial, name, meant) == expected for meant in _meant(name, value))


def _meant(name: str, value: Any) -> list[float | str]:
    """Return the facts that a value may stand for; rates are whole numbers."""
    if isinstance(value, str):
        return [value.strip()]
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0 <= value <= 1e6:
        return []
    if name != "image_rate":
        return [value]
    low, high = value / (1 + RATE_TOLERANCE), value / (1 - RATE_TOLERANCE)
    return list(range(math.ceil(low), math.floor(min(high, low + 100)) + 1))


def _is_number_as_text(value: Any) -> bool:
    return isinstance(value, str) and value.strip().replace(".", "", 1).isdecimal()


@word("{level}, {says}")
def expect_level(evidence: Evidence, level: str, *, says: str, begin: float, end: float) -> Iterable[Problem]:
    """Expect one status about each second from begin to end, [s]: of a level, with the word `says`."""
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
    """Return a check of each of the parts (level, word in its message, title), each of `seconds` [s].

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
    """Expect a dict with the fact `name` about the robot `serial`, rates within 3 %; no message tells it."""
    facts: Any = evidence.returns[0] if evidence.returns else None
    if not isinstance(facts, dict) or name not in facts:
        return [Problem(f"there is no {name!r} in what came back", "a fact is missing")]
    if is_fact(serial, name, facts[name]):
        return []
    if _is_number_as_text(facts[name]):
        message = f"{name} is {facts[name]!r}, a text; expected a number: write it without quotes"
        return [Problem(message, "a value is of the wrong kind")]
    message = f"{name} is {facts[name]!r}, and that is not what your robot has. Look with {TOOLS[name]}"
    return [Problem(message, "a fact about the robot is wrong")]
