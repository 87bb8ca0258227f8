"""Expectations on the markers that a topic shows at the end."""

import math
from collections.abc import Callable, Sequence
from typing import Any

from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.vocabulary.marker_state import TYPES, Which, no_markers, noun, shown, type_of
from course_lib.grading.vocabulary.wording import (
    Problem,
    check_of,
    close,
    listed,
    nothing_on,
    number,
    numbers,
    off_by,
)

DRAWN_TYPES = tuple(name for name in TYPES if name not in ("MESH_RESOURCE", "ARROW_STRIP"))
COLOR_TOLERANCE = 0.02  # of 0..1
YAW_TOLERANCE = 0.02  # [rad]
COLORS = {
    "black": (0, 0, 0), "white": (1, 1, 1), "grey": (0.5, 0.5, 0.5), "red": (1, 0, 0), "green": (0, 1, 0),
    "blue": (0, 0, 1), "yellow": (1, 1, 0), "cyan": (0, 1, 1), "magenta": (1, 0, 1), "orange": (1, 0.5, 0),
    "purple": (0.5, 0, 0.5),
}  # fmt: skip


def expect_marker(
    topic: str,
    *,
    type: str | None = None,  # noqa: A002 - the field's name in ROS
    ns: str | None = None,
    id: int | None = None,  # noqa: A002 - the field's name in ROS
    frame: str | None = None,
    position: Sequence[float] | None = None,
    yaw: float | None = None,
    scale: Sequence[float] | None = None,
    color: Sequence[float] | None = None,
    text: str | None = None,
    points: Sequence[Sequence[float]] | None = None,
    tolerance: float = 0.01,
) -> Check:
    """At the end the topic shows a marker with these properties; `ns` and `id` select it, else the best fits.

    Args:
        topic: Carries Marker or MarkerArray.
        type: Name of the type, "CUBE".
        ns: Its namespace.
        id: Its id.
        frame: Its frame.
        position: Of its centre, [m].
        yaw: Turn about z, [rad].
        scale: [m].
        color: RGB or RGBA, 0 to 1.
        text: What it says.
        points: Shape (N, 3), in any order, [m].
        tolerance: Of all lengths, [m].
    """
    given = {
        "type": type, "frame": frame, "position": position, "yaw": yaw, "scale": scale, "color": color,
        "text": text, "points": points,
    }  # fmt: skip
    wanted = {name: value for name, value in given.items() if value is not None}
    title = f"the marker on {topic}: {listed(list(wanted)) or 'is there'}"
    selection = {"ns": ns, "id": id}
    expected = {"topic": topic, "selection": selection, "wanted": wanted, "tolerance": tolerance}
    return check_of(title, expected, _marker)


def expect_marker_count(topic: str, count: int, *, type: str | None = None) -> Check:  # noqa: A002 - as above
    """At the end the topic shows exactly so many markers (of one type)."""
    expected = {"topic": topic, "count": count, "type_name": type}
    return check_of(f"{count} {type or 'marker'}s on {topic}", expected, _count)


def expect_all_marker_types(topic: str, *types: str) -> Check:
    """At the end the topic shows at least one marker of each type; by default of all that need no mesh."""
    expected = {"topic": topic, "types": types or DRAWN_TYPES}
    return check_of(f"every marker type on {topic}", expected, _all_types)


def _marker(
    evidence: Evidence, topic: str, selection: dict[str, Any], wanted: dict[str, Any], tolerance: float
) -> list[Problem]:
    markers = shown(evidence, topic)
    if not markers:
        return no_markers(evidence, topic)
    selected = [marker for marker in markers if Which(**selection).fits(marker)]
    if not selected:
        there = ", ".join(f"{marker.ns!r} {marker.id}" for marker in markers[:5])
        asked = f"ns {selection['ns']!r}, id {selection['id']}"
        return [
            Problem(f"no marker with {asked} on {topic}, there is: {there}", "ns or id of a marker is wrong")
        ]
    found = [
        [p for name, value in wanted.items() for p in PROPERTIES[name](marker, value, tolerance)]
        for marker in selected
    ]
    return min(found, key=lambda problems: (any(p.mistake == WRONG_TYPE for p in problems), len(problems)))


def _count(evidence: Evidence, topic: str, count: int, type_name: str | None) -> list[Problem]:
    if topic not in evidence.topics:
        return [nothing_on(evidence, topic)]
    there = sum(Which(type_name).fits(marker) for marker in shown(evidence, topic))
    if there == count:
        return []
    which = type_name or "marker"
    return [Problem(f"{topic} shows {there} {which}s at the end, expected {count}", "the count is wrong")]


def _all_types(evidence: Evidence, topic: str, types: tuple[str, ...]) -> list[Problem]:
    there = {type_of(marker) for marker in shown(evidence, topic)}
    if not there:
        return no_markers(evidence, topic)
    missing = [name for name in types if name not in there]
    if not missing:
        return []
    return [Problem(f"these types are missing at the end: {listed(missing)}", "a marker type is missing")]


WRONG_TYPE = "the type of a marker is wrong"


def _type(marker: Any, expected: str, _: float) -> list[Problem]:
    if type_of(marker) == expected:
        return []
    return [Problem(f"the marker is {type_of(marker)}, expected {expected}", WRONG_TYPE)]


def _frame(marker: Any, expected: str, _: float) -> list[Problem]:
    came = marker.header.frame_id
    if came == expected:
        return []
    message = f"{noun(marker)} is in frame {came!r}, expected {expected!r}"
    return [Problem(message, "the frame of a marker is wrong")]


AXES = (
    ("x", "far towards +x", "far towards -x"),
    ("y", "far towards +y", "far towards -y"),
    ("z", "high", "low"),
)


def _position(marker: Any, expected: Sequence[float], tolerance: float) -> list[Problem]:
    problems = []
    for (axis, more, less), target in zip(AXES, expected, strict=True):
        value = getattr(marker.pose.position, axis)
        if not close(value, target, tolerance):
            where = f"its centre is at {axis} = {number(value, 'm')}, expected {number(target, 'm')}"
            direction = off_by(value, target, f"too {more}", f"too {less}")
            problems.append(
                Problem(f"{noun(marker)} is {direction}: {where}", "the position of a marker is wrong")
            )
    return problems


def _scale(marker: Any, expected: Sequence[float], tolerance: float) -> list[Problem]:
    problems = []
    for axis, target in zip("xyz", expected, strict=True):
        value = getattr(marker.scale, axis)
        if not close(value, target, tolerance):
            message = f"{noun(marker)}: scale.{axis} is {number(value, 'm')}, expected {number(target, 'm')}"
            problems.append(Problem(message, "the size of a marker is wrong"))
    return problems


def _yaw(marker: Any, expected: float, _: float) -> list[Problem]:
    q = marker.pose.orientation
    value = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    if close(math.remainder(value - expected, math.tau), 0.0, YAW_TOLERANCE):
        return []
    message = (
        f"{noun(marker)} is turned by {number(value, 'rad')} about z, expected {number(expected, 'rad')}"
    )
    return [Problem(message, "the orientation of a marker is wrong")]


def _color(marker: Any, expected: Sequence[float], _: float) -> list[Problem]:
    channels = "rgba"[: len(expected)]
    value = [getattr(marker.color, channel) for channel in channels]
    if all(close(v, e, COLOR_TOLERANCE) for v, e in zip(value, expected, strict=True)):
        return []
    message = f"{noun(marker)}'s color {channels} is {_named(value)}, expected {_named(expected)}"
    if marker.color.a == 0:
        message += " (with a = 0 nobody can see it)"
    return [Problem(message, "the color of a marker is wrong")]


def _named(color: Sequence[float]) -> str:
    name = min(COLORS, key=lambda name: math.dist(COLORS[name], color[:3]))
    return f"{numbers(color)} ({name})"


def _text(marker: Any, expected: str, _: float) -> list[Problem]:
    if marker.text.strip() == expected:
        return []
    message = f"{noun(marker)} says {marker.text!r}, expected {expected!r}"
    return [Problem(message, "the text of a marker is wrong")]


def _points(marker: Any, expected: Sequence[Sequence[float]], tolerance: float) -> list[Problem]:
    came = [(p.x, p.y, p.z) for p in marker.points]
    if len(came) != len(expected):
        message = f"{noun(marker)} has {len(came)} points, expected {len(expected)}"
        return [Problem(message, "the number of points of a marker is wrong")]
    lost = [e for e in expected if not any(close(math.dist(e, c), 0.0, tolerance) for c in came)]
    if not lost:
        return []
    return [Problem(f"{noun(marker)} has no point at {numbers(lost[0])} m", "a point of a marker is wrong")]


PROPERTIES: dict[str, Callable[[Any, Any, float], list[Problem]]] = {
    "type": _type, "frame": _frame, "position": _position, "yaw": _yaw, "scale": _scale, "color": _color,
    "text": _text, "points": _points,
}  # fmt: skip
