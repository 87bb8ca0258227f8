"""Checks on motion and place: circles, transforms and paths."""

import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.marker_state import ADD, INVISIBLE, each, fits, no_markers, unseen
from course_lib.grading.vocabulary.markers import DIRECTIONS
from course_lib.grading.vocabulary.wording import (
    Problem,
    close,
    close_angles,
    heard,
    number,
    numbers,
    off_by,
    word,
    yaw_of,
)
from course_lib.ros.clock import START_NS
from course_lib.ros.messages import type_name
from course_lib.ros.tf2_core import BufferCore
from course_lib.ros.tf2_transform import Transform, TransformException

PERIOD_TOLERANCE = 0.05  # fraction
LEAST_TURN = math.pi  # [rad] seen of a circle before it counts as one
LARGEST_STEP = math.pi / 2  # [rad] from message to message: beyond it nobody sees which way round it goes
NOT_MOVING = "a marker does not move as expected"

Path = list[tuple[float, tuple[float, float, float]]]  # ([s], [m])
TF = "tf2_msgs/msg/TFMessage"
FOR_EVER_NS = 2**62  # [ns]: nothing is forgotten
YAW_TOLERANCE = 0.05  # [rad]
PATH = "nav_msgs/msg/Path"


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
    """Expect a visible marker that goes round a horizontal circle, for most of the scenario.

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
    """Return the problem of a path published for less than half of a scenario of `seconds` [s]."""
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
    """Return the problem where a path first leaves a circle; lengths in [m]."""
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
    """Return the problem with the sense or the period [s] of a path round a center."""
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


@word("where {source} is in {target}")
def expect_transform(
    evidence: Evidence,
    target: str,
    source: str,
    *,
    at: float | None = None,
    translation: Sequence[float] | None = None,
    yaw: float | None = None,
    static: bool = False,
    tolerance: float = 0.01,
) -> Iterable[Problem]:
    """Expect the pose of frame `source` in frame `target` in tf2, `at` [s] after the start or at last.

    Translation and its tolerance in [m], yaw about z in [rad]. A static one comes on /tf_static and never on
    /tf.
    """
    if static and any(pose.child == source for _, pose in _published(evidence, "/tf")):
        message = f"{source} is broadcast on /tf again and again, expected once on /tf_static"
        return [Problem(message, "what never moves is not static")]
    try:
        found = evidence.once(tree).lookup(target, source, 0 if at is None else START_NS + round(at * 1e9))
    except TransformException as error:
        return [Problem(f"tf2 says: {error}", "a transform is missing or has wrong stamps")]
    return list(_misplaced(found, translation or found.translation, yaw, tolerance))


@word("{frame} goes round a circle in {target}")
def expect_circling_frame(
    evidence: Evidence,
    target: str,
    frame: str,
    *,
    radius: float | None = None,
    height: float | None = None,
    period: float | None = None,
    counter_clockwise: bool | None = None,
    heading: float | None = None,
    start: float | None = None,
    tolerance: float = 0.05,
) -> Iterable[Problem]:
    """Expect a frame that goes round the origin of the frame `target`, for most of the scenario.

    Radius and height (None: those of the first pose) and tolerance in [m], the period of one turn in [s],
    counter-clockwise as seen from above; heading is the yaw less the direction from the origin, [rad]: 0
    looks outward, pi / 2 ahead; start is the direction from the origin at first, [rad].
    """
    poses = [(seconds, pose) for seconds, pose in _published(evidence, "/tf") if pose.child == frame]
    if not poses:
        return [Problem(f"no transform of {frame!r} came on /tf", "a transform is missing")]
    strange = sorted({pose.parent for _, pose in poses} - {target})
    if strange:
        message = f"the parent of {frame!r} is {strange[0]!r}, expected {target!r}"
        return [Problem(message, "a frame has the wrong parent")]
    path: Path = [(seconds, pose.translation) for seconds, pose in poses]
    first = path[0][1]
    plane = first[2] if height is None else height  # [m]
    distance = math.hypot(*first[:2]) if radius is None else radius  # [m]
    return (
        too_short(path, evidence.seconds, frame)
        or off_circle(path, distance, (0.0, 0.0), plane, tolerance, frame)
        or turning(path, (0.0, 0.0), period, counter_clockwise, frame)
        or [*_headed(poses, heading), *_started(frame, first, start)]
    )


def _started(frame: str, place: Sequence[float], start: float | None) -> Iterator[Problem]:
    angle = math.atan2(place[1], place[0])  # [rad]
    if start is not None and not close_angles(angle, start, YAW_TOLERANCE):
        message = f"{frame} starts at the angle {number(angle, 'rad')}, expected {number(start, 'rad')}"
        yield Problem(message, "a path starts at the wrong place")


def tree(evidence: Evidence) -> BufferCore:
    """Return tf2's buffer with all published transforms; it forgets none."""
    buffer = BufferCore(FOR_EVER_NS)
    for topic in ("/tf", "/tf_static"):
        for _, transform in _published(evidence, topic):
            buffer.set_transform(transform, is_static=topic == "/tf_static")
    return buffer


def _published(evidence: Evidence, topic: str) -> Iterator[tuple[float, Transform]]:
    """Yield ([s] since the start, transform) of every transform published on a topic."""
    for seconds, message in evidence.messages(topic):
        for transform in message.transforms if type_name(message) == TF else ():
            yield seconds, Transform.from_message(transform)


def _misplaced(
    found: Transform, translation: Sequence[float], yaw: float | None, tolerance: float
) -> Iterator[Problem]:
    for (axis, directions), came, expected in zip(
        DIRECTIONS.items(), found.translation, translation, strict=True
    ):
        if not close(came, expected, tolerance):
            gap = off_by(came, expected, *directions)
            where = f"{axis} = {number(came, 'm')}, expected {number(expected, 'm')}"
            message = f"{found.child} is {gap} in {found.parent}: {where}"
            yield Problem(message, "the place of a frame is wrong")
    if yaw is not None and not close_angles(turn := yaw_of(*found.rotation), yaw, YAW_TOLERANCE):
        came_yaw = f"{number(turn, 'rad')} about z, expected {number(yaw, 'rad')}"
        yield Problem(f"{found.child} is turned by {came_yaw}", "the orientation of a frame is wrong")


def _headed(poses: Sequence[tuple[float, Transform]], heading: float | None) -> Iterator[Problem]:
    for seconds, pose in poses if heading is not None else ():
        (x, y, _), turn = pose.translation, yaw_of(*pose.rotation)
        if heading is not None and not close_angles(turn - math.atan2(y, x), heading, YAW_TOLERANCE):
            asked = f"the direction from the origin plus {number(heading, 'rad')}"
            message = f"after {number(seconds, 's')} {pose.child} is turned by {number(turn, 'rad')}"
            yield Problem(f"{message}, expected {asked}", "the orientation of a frame is wrong")
            return


@word("the last path on {topic}")
def expect_path(
    evidence: Evidence,
    topic: str,
    *,
    count: int,
    frame: str,
    ends: Sequence[Sequence[float]],
    yaw: float | None = None,
    tolerance: float = 0.05,
) -> Iterable[Problem]:
    """Expect a count of poses in the last path, in a frame, from one of the ends to the other.

    Ends of shape (2, 3) and tolerance in [m]; yaw of the last pose about z in [rad].
    """
    _, path = heard(evidence, topic, PATH)[-1]
    if path.header.frame_id != frame:
        message = f"the path on {topic} is in frame {path.header.frame_id!r}, expected {frame!r}"
        return [Problem(message, "the frame of a path is wrong")]
    if len(path.poses) != count:
        message = f"the last path on {topic} has {len(path.poses)} poses, expected {count}"
        return [Problem(message, "a path has the wrong number of poses")]
    for which, one, expected in zip(("first", "last"), (path.poses[0], path.poses[-1]), ends, strict=True):
        place = one.pose.position
        found = (place.x, place.y, place.z)
        if not close(math.dist(found, expected), 0.0, tolerance):
            message = f"the {which} pose of {topic} is at {numbers(found)} m, expected {numbers(expected)} m"
            return [Problem(message, "a pose of a path is at the wrong place")]
    q = path.poses[-1].pose.orientation
    turn = yaw_of(q.x, q.y, q.z, q.w)
    if yaw is not None and not close_angles(turn, yaw, tolerance):
        message = f"the last pose of {topic} is turned by {turn:.2f} rad about z, expected {yaw:.2f} rad"
        return [Problem(message, "the orientation in a path is wrong")]
    return []
