"""Expectations on the markers that a topic shows at the end."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.marker_state import (
    INVISIBLE,
    each,
    fits,
    moment,
    no_markers,
    shown,
    type_of,
    unseen,
)
from course_lib.grading.vocabulary.marker_state import lifetime as marker_lifetime
from course_lib.grading.vocabulary.wording import (
    Problem,
    close,
    close_angles,
    nothing_on,
    number,
    numbers,
    off_by,
    word,
    yaw_of,
)

COLOR_TOLERANCE = 0.02  # of 0..1
YAW_TOLERANCE = 0.02  # [rad]
LIFETIME_TOLERANCE = 0.01  # [s]
DIRECTIONS = {
    "x": ("too far towards +x", "too far towards -x"),
    "y": ("too far towards +y", "too far towards -y"),
    "z": ("too high", "too low"),
}
COLORS = {
    "black": (0, 0, 0), "white": (1, 1, 1), "grey": (0.5, 0.5, 0.5), "red": (1, 0, 0), "green": (0, 1, 0),
    "blue": (0, 0, 1), "yellow": (1, 1, 0), "cyan": (0, 1, 1), "magenta": (1, 0, 1), "orange": (1, 0.5, 0),
    "purple": (0.5, 0, 0.5),
}  # fmt: skip
Points = Sequence[Sequence[float]]


@word("the marker on {topic}: {given}")
def expect_marker(
    evidence: Evidence,
    topic: str,
    *,
    type: str | None = None,  # noqa: A002 - the field's name in ROS
    ns: str | None = None,
    id: int | None = None,  # noqa: A002 - the field's name in ROS
    frame: str | None = None,
    position: Sequence[float] | None = None,
    yaw: float | None = None,
    scale: Sequence[float | None] | None = None,
    color: Sequence[float] | None = None,
    text: str | None = None,
    points: Points | None = None,
    loop: Points | None = None,
    lifetime: float | None = None,
    at: float | None = None,
    tolerance: float = 0.01,
) -> Iterable[Problem]:
    """Expect such a visible marker on the topic (Marker or MarkerArray), `at` [s] or at the end.

    `ns` and `id` select it, else the one that fits best is meant. Position of the centre, scale (None is any
    length), points (shape (N, 3), in any order, but for an arrow) and `tolerance` in [m]; yaw about z in
    [rad]; lifetime in [s]; color RGB or RGBA from 0 to 1; text and frame are compared exactly. A line strip
    joins the corners of `loop` in order, from any of them and in either direction, and ends at the first.
    """
    wanted: dict[str, Any] = {"type": type, "frame": frame, "position": position, "yaw": yaw, "scale": scale}
    wanted |= {"color": color, "text": text, "points": points, "loop": loop, "lifetime": lifetime}
    selected = _selected(evidence, topic, at, ns, id)
    found = [list(_misfits(marker, wanted, tolerance)) for marker in selected]
    return min(found, key=lambda problems: (WRONG_TYPE in [p.mistake for p in problems], len(problems)))


def _selected(
    evidence: Evidence, topic: str, at: float | None, ns: str | None, number: int | None
) -> list[Any]:
    """Return the markers of a namespace and an id; raise the problem if there is none."""
    markers = shown(evidence, topic, at)
    if not markers:
        raise no_markers(evidence, topic, at)
    selected = [marker for marker in markers if fits(marker, None, ns, number)]
    if not selected:
        there = ", ".join(f"{marker.ns!r} {marker.id}" for marker in markers[:5])
        sought = [f"ns {ns!r}"] * (ns is not None) + [f"id {number}"] * (number is not None)
        message = f"no marker with {' and '.join(sought)} on {topic}, there is: {there}"
        raise Problem(message, "ns or id of a marker is wrong")
    return selected


@word("the number of markers on {topic}")
def expect_marker_count(
    evidence: Evidence,
    topic: str,
    count: int,
    *,
    type: str | None = None,  # noqa: A002 - the field's name in ROS
    at: float | None = None,
) -> Iterable[Problem]:
    """Expect a count of visible markers (of one type) on the topic, `at` [s] or at the end."""
    if topic not in evidence.topics:
        return [nothing_on(evidence, topic)]
    reasons = [unseen(marker) for marker in shown(evidence, topic, at) if fits(marker, type, None, None)]
    there, hidden = reasons.count(""), sorted(filter(None, reasons))
    of_type = f" of type {type}" if type else ""
    message = f"{topic} shows {there} marker{'s' * (there != 1)}{of_type} {moment(at)}, expected {count}"
    why = f"; nobody can see {len(hidden)} more: {hidden[0]}" if hidden else ""
    return [] if there == count else [Problem(message + why, "the count is wrong")]


@word("the markers on {topic} are gone")
def expect_gone(evidence: Evidence, topic: str) -> Iterable[Problem]:
    """Expect markers during the scenario, but none that is shown at its end."""
    if not any(True for _ in each(evidence, topic)):
        raise nothing_on(evidence, topic)
    left = len(shown(evidence, topic))
    message = f"{topic} still shows {left} marker{'s' * (left != 1)} at the end, expected none"
    return [Problem(message, "the count is wrong")] if left else []


def _misfits(marker: Any, wanted: dict[str, Any], tolerance: float) -> Iterator[Problem]:
    noun = f"the {type_of(marker).lower().replace('_', ' ')}"
    if why := unseen(marker):
        yield Problem(f"{noun} is invisible: {why}", INVISIBLE)
    for name, expected in wanted.items():
        if expected is not None:
            mistake, find = PROPERTIES[name]
            yield from (Problem(f"{noun}{says}", mistake) for says in find(marker, expected, tolerance))


def _type(marker: Any, expected: str, _: float) -> Iterator[str]:
    if type_of(marker) != expected:
        yield f" is of type {type_of(marker)}, expected {expected}"


def _frame(marker: Any, expected: str, _: float) -> Iterator[str]:
    if marker.header.frame_id != expected:
        yield f" is in frame {marker.header.frame_id!r}, expected {expected!r}"


def _position(marker: Any, expected: Sequence[float], tolerance: float) -> Iterator[str]:
    for (axis, directions), target in zip(DIRECTIONS.items(), expected, strict=True):
        value = getattr(marker.pose.position, axis)
        if not close(value, target, tolerance):
            where = f"its centre is at {axis} = {number(value, 'm')}, expected {number(target, 'm')}"
            yield f" is {off_by(value, target, *directions)}: {where}"


def _scale(marker: Any, expected: Sequence[float | None], tolerance: float) -> Iterator[str]:
    for axis, target in zip("xyz", expected, strict=True):
        value = getattr(marker.scale, axis)
        if target is not None and not close(value, target, tolerance):
            yield f": scale.{axis} is {number(value, 'm')}, expected {number(target, 'm')}"


def _yaw(marker: Any, expected: float, _: float) -> Iterator[str]:
    q = marker.pose.orientation
    value = yaw_of(q.x, q.y, q.z, q.w)
    if not close_angles(value, expected, YAW_TOLERANCE):
        yield f" is turned by {number(value, 'rad')} about z, expected {number(expected, 'rad')}"


def _color(marker: Any, expected: Sequence[float], _: float) -> Iterator[str]:
    channels = "rgba"[: len(expected)]
    value = [getattr(marker.color, channel) for channel in channels]
    if not all(close(v, e, COLOR_TOLERANCE) for v, e in zip(value, expected, strict=True)):
        hint = " (with a = 0 nobody can see it)" if marker.color.a == 0 else ""
        hint = " (colors go from 0 to 1, not to 255)" if max(value) > 1 else hint
        yield f"'s color {channels} is {_named(value)}, expected {_named(expected)}{hint}"


def _named(color: Sequence[float]) -> str:
    if not all(map(math.isfinite, color)):
        return numbers(color)
    name = min(COLORS, key=lambda name: math.dist(COLORS[name], color[:3]))
    return f"{numbers(color)} ({name})"


def _text(marker: Any, expected: str, _: float) -> Iterator[str]:
    if marker.text.strip() != expected:
        yield f" says {marker.text!r}, expected {expected!r}"


def _lifetime(marker: Any, expected: float, _: float) -> Iterator[str]:
    if not close(marker_lifetime(marker), expected, LIFETIME_TOLERANCE):
        yield f"'s lifetime is {number(marker_lifetime(marker), 's')}, expected {number(expected, 's')}"


def _points(marker: Any, expected: Points, tolerance: float) -> Iterator[str]:
    came = [(p.x, p.y, p.z) for p in marker.points]
    reversed_arrow = type_of(marker) == "ARROW" and not _same(came, expected, tolerance)
    if len(came) != len(expected):
        yield f" has {len(came)} points, expected {len(expected)}"
    elif lost := _without_partner(expected, came, tolerance):
        yield f" has no point at {numbers(lost[0])} m"
    elif strange := _without_partner(came, expected, tolerance):  # a loop may start at any of its corners
        yield f" has a point at {numbers(strange[0])} m, where none belongs"
    elif reversed_arrow:
        yield " points the other way: from the second point to the first"


def _loop(marker: Any, expected: Points, tolerance: float) -> Iterator[str]:
    came = [(p.x, p.y, p.z) for p in marker.points]
    if not came or not close(math.dist(came[0], came[-1]), 0.0, tolerance):
        yield " does not come back to its first point"
        return
    turns = [[*expected[i:], *expected[: i + 1]] for i in range(len(expected))]
    ways = [way for turn in turns for way in (turn, turn[::-1])]
    if not any(_same(came, way, tolerance) for way in ways):
        yield " does not go round from corner to corner"


def _same(points: Points, others: Points, tolerance: float) -> bool:
    """Return whether both are the same points in the same order."""
    pairs = zip(points, others, strict=False)
    return len(points) == len(others) and all(close(math.dist(a, b), 0.0, tolerance) for a, b in pairs)


def _without_partner(points: Points, others: Points, tolerance: float) -> list[Sequence[float]]:
    return [p for p in points if not any(close(math.dist(p, other), 0.0, tolerance) for other in others)]


WRONG_TYPE = "the type of a marker is wrong"
PROPERTIES: dict[str, tuple[str, Callable[[Any, Any, float], Iterator[str]]]] = {
    "type": (WRONG_TYPE, _type),
    "frame": ("the frame of a marker is wrong", _frame),
    "position": ("the position of a marker is wrong", _position),
    "yaw": ("the orientation of a marker is wrong", _yaw),
    "scale": ("the size of a marker is wrong", _scale),
    "color": ("the color of a marker is wrong", _color),
    "text": ("the text of a marker is wrong", _text),
    "points": ("the points of a marker are wrong", _points),
    "loop": ("a line does not go round from corner to corner, and back", _loop),
    "lifetime": ("the lifetime of a marker is wrong", _lifetime),
}
