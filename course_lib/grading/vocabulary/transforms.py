"""Expectations on the tree of frames that was published on /tf and /tf_static."""

import math
from collections.abc import Iterable, Iterator, Sequence

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.markers import DIRECTIONS
from course_lib.grading.vocabulary.motion import Path, off_circle, too_short, turning
from course_lib.grading.vocabulary.wording import Problem, close, number, off_by, word
from course_lib.ros.clock import START_NS
from course_lib.ros.messages import type_name
from course_lib.ros.tf2_core import BufferCore
from course_lib.ros.tf2_errors import TransformException
from course_lib.ros.tf2_transform import Transform

TF = "tf2_msgs/msg/TFMessage"
FOR_EVER_NS = 2**62  # [ns]: nothing is forgotten
YAW_TOLERANCE = 0.05  # [rad]


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
    """tf2 knows the pose of frame `source` in frame `target`, `at` [s] after the start or at last.

    Translation and its tolerance in [m], yaw about z in [rad]. A static one comes on /tf_static and never on
    /tf.
    """
    if static and any(pose.child == source for _, pose in _published(evidence, "/tf")):
        message = f"{source} is broadcast on /tf again and again, expected once on /tf_static"
        return [Problem(message, "what never moves is not static")]
    try:
        found = tree(evidence).lookup(target, source, 0 if at is None else START_NS + round(at * 1e9))
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
    """A frame goes round the origin of another one, for most of the scenario.

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
    if start is not None and not close(math.remainder(angle - start, math.tau), 0.0, YAW_TOLERANCE):
        message = f"{frame} starts at the angle {number(angle, 'rad')}, expected {number(start, 'rad')}"
        yield Problem(message, "a path starts at the wrong place")


def tree(evidence: Evidence) -> BufferCore:
    """tf2's buffer with all that was published, and nothing forgotten."""
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
    if yaw is not None and not close(math.remainder(yaw_of(found) - yaw, math.tau), 0.0, YAW_TOLERANCE):
        came_yaw = f"{number(yaw_of(found), 'rad')} about z, expected {number(yaw, 'rad')}"
        yield Problem(f"{found.child} is turned by {came_yaw}", "the orientation of a frame is wrong")


def _headed(poses: Sequence[tuple[float, Transform]], heading: float | None) -> Iterator[Problem]:
    for seconds, pose in poses if heading is not None else ():
        x, y, _ = pose.translation
        came = math.remainder(yaw_of(pose) - math.atan2(y, x), math.tau)
        if heading is not None and not close(math.remainder(came - heading, math.tau), 0.0, YAW_TOLERANCE):
            asked = f"the direction from the origin plus {number(heading, 'rad')}"
            message = f"after {number(seconds, 's')} {pose.child} is turned by {number(yaw_of(pose), 'rad')}"
            yield Problem(f"{message}, expected {asked}", "the orientation of a frame is wrong")
            return


def yaw_of(pose: Transform) -> float:
    """The turn about z, [rad]."""
    x, y, z, w = pose.rotation
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
