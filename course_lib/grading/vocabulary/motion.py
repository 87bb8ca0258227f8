"""Expectations on how a marker moves during the scenario."""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.marker_state import ADD, INVISIBLE, each, fits, no_markers, unseen
from course_lib.grading.vocabulary.wording import Problem, close, number, off_by, word

PERIOD_TOLERANCE = 0.05  # fraction
LEAST_TURN = math.pi  # [rad] seen of a circle before it counts as one
LARGEST_STEP = math.pi / 2  # [rad] from message to message: beyond it nobody sees which way round it goes
NOT_MOVING = "a marker does not move as expected"

Path = list[tuple[float, tuple[float, float, float]]]  # ([s], [m])


@word("goes round a circle on {topic}")
def expect_circle(
    evidence: Evidence,
    topic: str,
    *,
    radius: float,
    center: Sequence[float] = (0.0, 0.0),
    height: float | None = None,
    period: float | None = None,
    counter_clockwise: bool | None = None,
    tolerance: float = 0.05,
    type: str | None = None,  # noqa: A002 - the field's name in ROS
    ns: str | None = None,
    id: int | None = None,  # noqa: A002 - the field's name in ROS
) -> Iterable[Problem]:
    """A marker that can be seen goes round a horizontal circle, for most of the scenario.

    Radius, center (x, y), height (default: the first marker's) and the tolerance of radius and height in [m],
    in the marker's frame; the period of one turn in [s]; counter-clockwise as seen from above.
    """
    added = [(s, m) for s, m in each(evidence, topic) if m.action == ADD]
    if not added:
        raise no_markers(evidence, topic)
    meant = [(s, marker) for s, marker in added if fits(marker, type, ns, id)]
    path = [(s, _place(marker)) for s, marker in meant if not unseen(marker)]
    if not meant:
        which = {"type": type, "ns": ns, "id": id}
        asked = ", ".join(f"{name} {value!r}" for name, value in which.items() if value is not None)
        message = f"no marker with {asked} was added on {topic}"
        return [Problem(message, "type, ns or id of a marker is wrong")]
    if not path:
        return [Problem(f"the marker is invisible: {unseen(meant[0][1])}", INVISIBLE)]
    plane = path[0][1][2] if height is None else height  # [m]
    return (
        too_short(path, evidence.seconds)
        or off_circle(path, radius, center, plane, tolerance)
        or turning(path, center, period, counter_clockwise)
    )


def _place(marker: Any) -> tuple[float, float, float]:
    position = marker.pose.position
    return position.x, position.y, position.z


def too_short(path: Path, seconds: float, noun: str = "the marker") -> list[Problem]:
    """What is wrong with a path that was published for less than half of a scenario of `seconds` [s]."""
    seen = path[-1][0] - path[0][0]  # [s]
    message = f"{noun} was seen to move for {number(seen, 's')} of {seconds:g} s"
    return [Problem(message, NOT_MOVING)] if seen < seconds / 2 else []


def off_circle(
    path: Path,
    radius: float,
    center: Sequence[float],
    height: float,
    tolerance: float,
    noun: str = "the marker",
) -> list[Problem]:
    """Where a path first leaves a circle; lengths in [m]."""
    for seconds, (x, y, z) in path:
        distance = math.dist((x, y), center)
        if not close(distance, radius, tolerance):
            gap = off_by(distance, radius, "too far out", "too far in")
            where = f"{number(distance, 'm')} from the centre, expected {number(radius, 'm')}"
            message = f"after {number(seconds, 's')} {noun} is {gap}: {where}"
            return [Problem(message, "the path leaves the circle: wrong radius or centre")]
        if not close(z, height, tolerance):
            gap = off_by(z, height, "too high", "too low")
            message = f"{noun} is {gap}: z = {number(z, 'm')}, expected {number(height, 'm')}"
            return [Problem(message, "the path is at the wrong height")]
    return []


def turning(
    path: Path,
    center: Sequence[float],
    period: float | None,
    counter_clockwise: bool | None,
    noun: str = "the marker",
) -> list[Problem]:
    """What is wrong with the sense or the period [s] of a path round a center."""
    angles = [math.atan2(y - center[1], x - center[0]) for _, (x, y, _) in path]
    steps = [math.remainder(b - a, math.tau) for a, b in pairwise(angles)]
    turned, seconds = sum(steps), path[-1][0] - path[0][0]
    if sum(abs(step) for step in steps) < 1e-3:
        return [Problem(f"{noun} stands still, expected it to go round", NOT_MOVING)]
    if (jump := max(map(abs, steps))) > LARGEST_STEP:
        message = f"{noun} jumps by {math.degrees(jump):.0f}° from one message to the next"
        return [Problem(f"{message}: were degrees taken for radians?", "a path jumps instead of turning")]
    if counter_clockwise is not None and (turned > 0) != counter_clockwise:
        names = ("clockwise", "counter-clockwise")
        message = f"{noun} goes {names[turned > 0]} (from above), expected {names[counter_clockwise]}"
        return [Problem(message, "the direction of turning is wrong")]
    if period is not None:
        came = seconds * math.tau / abs(turned) if turned else math.inf  # [s]
        gap = off_by(came, period, "too slow", "too fast", "s")
        message = f"one turn takes {number(came, 's')}, expected {number(period, 's')}: {gap}"
        right = close(came, period, PERIOD_TOLERANCE * period)
        return [] if right else [Problem(message, "the time of one turn is wrong")]
    message = f"{noun} turned only {math.degrees(abs(turned)):.0f}°"
    return [] if abs(turned) >= LEAST_TURN else [Problem(message, "too little of the circle was driven")]
