"""The markers that a topic shows, of Marker and MarkerArray."""

from collections.abc import Iterator
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.wording import Problem, nothing_on, number
from course_lib.ros.messages import type_name

TYPES = (  # by the number in Marker.type
    "ARROW", "CUBE", "SPHERE", "CYLINDER", "LINE_STRIP", "LINE_LIST", "CUBE_LIST", "SPHERE_LIST",
    "POINTS", "TEXT_VIEW_FACING", "MESH_RESOURCE", "TRIANGLE_LIST", "ARROW_STRIP",
)  # fmt: skip
MARKER_MESSAGES = ("visualization_msgs/msg/Marker", "visualization_msgs/msg/MarkerArray")
ADD, DELETE, DELETE_ALL = 0, 2, 3
EACH_COLORED = ("LINE_STRIP", "LINE_LIST", "CUBE_LIST", "SPHERE_LIST", "POINTS", "TRIANGLE_LIST")
NEEDED_SCALES = {
    "LINE_STRIP": "x",
    "LINE_LIST": "x",
    "POINTS": "xy",
    "TEXT_VIEW_FACING": "z",
}  # else all three
INVISIBLE = "a marker is invisible"


def type_of(marker: Any) -> str:
    """Return the name of a marker's type, "CUBE"."""
    return TYPES[marker.type] if 0 <= marker.type < len(TYPES) else f"unknown type {marker.type}"


def fits(marker: Any, *wanted: Any) -> bool:
    """Return whether a marker has this type's name, namespace and id; None means any."""
    came = (type_of(marker), marker.ns, marker.id)
    return all(value in (None, own) for value, own in zip(wanted, came, strict=True))


def each(evidence: Evidence, topic: str) -> Iterator[tuple[float, Any]]:
    """Yield (seconds since the start, marker) of every marker published."""
    for seconds, message in evidence.messages(topic):
        if type_name(message) in MARKER_MESSAGES:
            for marker in getattr(message, "markers", [message]):
                yield seconds, marker


def shown(evidence: Evidence, topic: str, at: float | None = None) -> list[Any]:
    """Return the markers shown `at` [s] or at the end, each as last added, unless its lifetime is over."""
    now = evidence.seconds if at is None else at  # [s]
    markers: dict[tuple[str, int], Any] = {}
    for seconds, marker in each(evidence, topic):
        if seconds > now:
            break
        if marker.action == ADD:
            markers[marker.ns, marker.id] = marker
            if 0 < lifetime(marker) < now - seconds - 1e-6:
                del markers[marker.ns, marker.id]  # nothing that came later has kept it
        elif marker.action == DELETE:
            markers.pop((marker.ns, marker.id), None)
        elif marker.action == DELETE_ALL:
            markers.clear()
    return list(markers.values())


def lifetime(marker: Any) -> float:
    """Return a marker's lifetime, [s]; 0 is for ever."""
    return float(marker.lifetime.sec + marker.lifetime.nanosec / 1e9)


def moment(at: float | None) -> str:
    """Return `at` [s] in words, "after 1.00 s"; None is the end."""
    return "at the end" if at is None else f"after {number(at, 's')}"


def no_markers(evidence: Evidence, topic: str, at: float | None = None) -> Problem:
    """Return the problem of a topic that shows no marker at all `at` [s], or at the end."""
    if topic not in evidence.topics:
        return nothing_on(evidence, topic)
    if evidence.topics[topic] not in MARKER_MESSAGES:
        message = f"{topic} carries {evidence.topics[topic]}, expected {' or '.join(MARKER_MESSAGES)}"
        return Problem(message, "a topic has the wrong message type")
    why = "all were deleted, or their lifetime is over"
    if at is not None and not any(seconds <= at for seconds, _ in each(evidence, topic)):
        why = "the first one comes later"
    mistake = "no marker is left at the end" if at is None else "no marker is there in between"
    return Problem(f"{topic} shows no marker {moment(at)}: {why}", mistake)


def unseen(marker: Any) -> str:
    """Return why nobody can see a marker, or "" where RViz draws it."""
    kind = type_of(marker)
    own = marker.mesh_use_embedded_materials and kind == "MESH_RESOURCE"
    alphas = [color.a for color in marker.colors if kind in EACH_COLORED] or [marker.color.a]
    if not own and not max(alphas) > 0:
        return "color.a is 0"
    needed = "xy" if kind == "ARROW" and marker.points else NEEDED_SCALES.get(kind, "xyz")
    if none := [axis for axis in needed if not abs(getattr(marker.scale, axis)) > 0]:
        return f"scale.{none[0]} is 0"
    if kind == "TEXT_VIEW_FACING" and not marker.text.strip():
        return "its text is empty"
    return "it has no points" if kind in EACH_COLORED and not len(marker.points) else ""
