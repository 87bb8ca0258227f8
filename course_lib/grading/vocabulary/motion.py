"""Expectations on how a marker moves during the scenario."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.vocabulary.marker_state import ADD, Which, each, no_markers
from course_lib.grading.vocabulary.wording import Problem, check_of, close, number, off_by

PERIOD_TOLERANCE = 0.05  # fraction
LEAST_TURN = math.pi  # [rad] seen of a circle before it counts as one
NOT_MOVING = "a marker does not move as expected"

Path = list[tuple[float, tuple[float, float, float]]]  # ([s], [m])


def expect_moving(
    topic: str,
    *,
    at_least: float = 0.1,
    type: str | None = None,  # noqa: A002 - the field's name in ROS
    ns: str | None = None,
    id: int | None = None,  # noqa: A002 - the field's name in ROS
) -> Check:
    """A marker gets at least so far, [m], from where it was first."""
    expected = {"topic": topic, "at_least": at_least, "selection": {"type": type, "ns": ns, "id": id}}
    return check_of(f"moves on {topic}", expected, _moving)


def expect_circle(
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
) -> Check:
    """A marker goes round a horizontal circle.

    Args:
        topic: Carries Marker or MarkerArray.
        radius: [m].
        center: (x, y) in the marker's frame, [m].
        height: Of the circle's plane, [m].
        period: Of one turn, [s].
        counter_clockwise: As seen from above.
        tolerance: Of radius and height, [m].
        type: Name of the marker's type.
        ns: Its namespace.
        id: Its id.
    """
    shape = {"radius": radius, "center": tuple(center), "height": height, "tolerance": tolerance}
    turning = {"period": period, "counter_clockwise": counter_clockwise}
    expected = {"topic": topic, "shape": shape, "turning": turning}
    expected["selection"] = {"type": type, "ns": ns, "id": id}
    return check_of(f"goes round a circle on {topic}", expected, _circle)


def path_of(evidence: Evidence, topic: str, selection: dict[str, Any]) -> Path:
    """Where the selected markers were placed, in time."""
    which = Which(**selection)
    placed = [(s, m) for s, m in each(evidence, topic) if m.action == ADD and which.fits(m)]
    return [(s, (m.pose.position.x, m.pose.position.y, m.pose.position.z)) for s, m in placed]


def _no_path(evidence: Evidence, topic: str, selection: dict[str, Any]) -> list[Problem]:
    if not any(True for _ in each(evidence, topic)):
        return no_markers(evidence, topic)
    which = ", ".join(f"{name} {value!r}" for name, value in selection.items() if value is not None)
    return [Problem(f"no marker with {which} was added on {topic}", "type, ns or id of a marker is wrong")]


def _moving(evidence: Evidence, topic: str, at_least: float, selection: dict[str, Any]) -> list[Problem]:
    path = path_of(evidence, topic, selection)
    if not path:
        return _no_path(evidence, topic, selection)
    distances = [math.dist(place, path[0][1]) for _, place in path]  # [m]
    far = max(distances) if all(map(math.isfinite, distances)) else math.nan
    if far >= at_least:
        return []
    message = f"the marker moved {number(far, 'm')}, expected at least {number(at_least, 'm')}"
    return [Problem(message, NOT_MOVING)]


def _circle(
    evidence: Evidence,
    topic: str,
    shape: dict[str, Any],
    turning: dict[str, Any],
    selection: dict[str, Any],
) -> list[Problem]:
    path = path_of(evidence, topic, selection)
    if not path:
        return _no_path(evidence, topic, selection)
    return _off_circle(path, **shape) or _turning(path, shape["center"], **turning)


def _off_circle(
    path: Path, radius: float, center: Sequence[float], height: float | None, tolerance: float
) -> list[Problem]:
    for seconds, (x, y, z) in path:
        distance = math.dist((x, y), center)
        if not close(distance, radius, tolerance):
            gap = off_by(distance, radius, "too far out", "too far in")
            where = f"{number(distance, 'm')} from the centre, expected {number(radius, 'm')}"
            message = f"after {number(seconds, 's')} the marker is {gap}: {where}"
            return [Problem(message, "the path leaves the circle: wrong radius or centre")]
        if height is not None and not close(z, height, tolerance):
            gap = off_by(z, height, "too high", "too low")
            message = f"the marker is {gap}: z = {number(z, 'm')}, expected {number(height, 'm')}"
            return [Problem(message, "the path is at the wrong height")]
    return []


def _turning(
    path: Path, center: Sequence[float], period: float | None, counter_clockwise: bool | None
) -> list[Problem]:
    angles = [math.atan2(y - center[1], x - center[0]) for _, (x, y, _) in path]
    steps = [math.remainder(b - a, math.tau) for a, b in pairwise(angles)]
    turned, seconds = sum(steps), path[-1][0] - path[0][0]
    if sum(abs(step) for step in steps) < 1e-3:
        return [Problem("the marker stands still, expected it to go round", NOT_MOVING)]
    if counter_clockwise is not None and (turned > 0) != counter_clockwise:
        names = ("clockwise", "counter-clockwise")
        message = f"the marker goes {names[turned > 0]} (from above), expected {names[counter_clockwise]}"
        return [Problem(message, "the direction of turning is wrong")]
    if period is not None:
        came = seconds * math.tau / abs(turned) if turned else math.inf  # [s]
        if not close(came, period, PERIOD_TOLERANCE * period):
            gap = off_by(came, period, "too slow", "too fast", "s")
            message = f"one turn takes {number(came, 's')}, expected {number(period, 's')}: {gap}"
            return [Problem(message, "the time of one turn is wrong")]
    elif not abs(turned) >= LEAST_TURN:
        degrees = math.degrees(abs(turned))
        return [Problem(f"the marker turned only {degrees:.0f}°", "too little of the circle was driven")]
    return []
