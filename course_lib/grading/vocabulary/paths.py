"""Expectations on nav_msgs/Path."""

import math
from collections.abc import Iterable, Sequence

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.wording import Problem, close, heard, numbers, word

PATH = "nav_msgs/msg/Path"


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
    """The last path has so many poses, in a frame, from one end to the other.

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
    turn = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    if yaw is not None and not close(math.remainder(turn - yaw, math.tau), 0.0, tolerance):
        message = f"the last pose of {topic} is turned by {turn:.2f} rad about z, expected {yaw:.2f} rad"
        return [Problem(message, "the orientation in a path is wrong")]
    return []
