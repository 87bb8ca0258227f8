"""Checks of motion and position: circles, transforms, paths, joint states and trajectories."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from course_lib.errors import CourseError, format_count, join_words
from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.check_function import (
    Problem,
    are_angles_close,
    check_function,
    describe_offset,
    format_angle,
    format_number,
    format_numbers,
    is_close,
    received_messages,
    yaw_of,
)
from course_lib.grading.vocabulary.markers import (
    ADD,
    CIRCLE,
    DIRECTIONS,
    FINDERS,
    INVISIBLE,
    Arguments,
    invisibility_reason,
    iter_markers,
    judge_marker,
    matches,
    no_markers_problem,
)
from course_lib.grading.vocabulary.topics import find_silence
from course_lib.ros.graph.graph import START_NS
from course_lib.ros.messages import type_name
from course_lib.ros.programs import import_path
from course_lib.ros.tf2 import BufferCore, Transform, TransformException

# As a fraction of the period. With 3 instead of pi, the period is 4.7 % too long.
PERIOD_TOLERANCE = 0.02
LEAST_TURN = math.pi  # [rad] minimum angle for a path to count as a circle
# [rad] With larger steps between messages, the direction of rotation is ambiguous.
LARGEST_STEP = math.pi / 2
STILL = 1e-6  # [rad] a smaller step between two messages counts as no motion
NAMING = ("type", "ns", "id")
NOT_MOVING = "a marker does not move as expected"
# Kinds of mistakes by the exception of tf2.
FAILED_LOOKUPS = {
    "ConnectivityException": "the tree of frames is in two parts",
    "ExtrapolationException": "a transform has wrong stamps",
}

Path = list[tuple[float, tuple[float, float, float]]]  # ([s], [m])
TF = "tf2_msgs/msg/TFMessage"
FOR_EVER_NS = 2**62  # [ns] cache time of the buffer, practically infinite
YAW_TOLERANCE = 0.05  # [rad]
MOVING_AMPLITUDE = 1e-3  # [rad] amplitude of a joint that moves, if only a little
MAX_NAMED = 3  # limit on the frames that a message lists
PATH = "nav_msgs/msg/Path"


@check_function("goes round a circle on {topic}")
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
    allow_others: bool = False,
) -> Iterable[Problem]:
    """Expect a visible marker that moves along a horizontal circle for most of the scenario.

    Radius, center (x, y), height (default: that of the first marker) and tolerance are in [m], in
    the marker's frame; the period is in [s]; counter-clockwise is as seen from above.
    `allow_others` permits further markers, as in `expect_marker`.
    """
    arguments = {name: value for name, value in locals().items() if name != "evidence"}
    return judge_marker(evidence, CIRCLE, arguments)


def _circle_problems(evidence: Evidence, arguments: Arguments, marker: Any) -> list[Problem]:
    """Return the problems of a marker's motion, or of the best-fitting marker if None is given.

    A marker's path consists of all messages with its ns and id. All markers of the topic together
    are tried as well, because a node may give each position a new id and delete the previous one.
    """
    topic = arguments["topic"]
    paths = evidence.compute_once(_marker_paths).get(topic, {})
    if not paths:
        raise no_markers_problem(evidence, topic)
    if marker is not None and not matches(marker, *(arguments[name] for name in NAMING)):
        return [_unknown_marker_problem(arguments)]
    together = _check_path([row for path in paths.values() for row in path], evidence, arguments)
    if not together:
        return []
    keys = list(paths) if marker is None else [(marker.ns, marker.id)]
    problems_by_path = [_check_path(paths[key], evidence, arguments) for key in keys if len(paths[key]) > 1]
    return min(problems_by_path, key=len) if problems_by_path else together


FINDERS[CIRCLE] = _circle_problems


def _marker_paths(evidence: Evidence) -> dict[str, dict[tuple[str, int], list[tuple[float, Any]]]]:
    """Return (time since the start [s], marker) of all added markers, by topic and by (ns, id)."""
    paths_by_topic: dict[str, dict[tuple[str, int], list[tuple[float, Any]]]] = {}
    for topic in evidence.topics:
        for seconds, marker in iter_markers(evidence, topic):
            if marker.action == ADD:
                path = paths_by_topic.setdefault(topic, {}).setdefault((marker.ns, marker.id), [])
                path.append((seconds, marker))
    return paths_by_topic


def _check_path(
    added_markers: Sequence[tuple[float, Any]], evidence: Evidence, arguments: Arguments
) -> list[Problem]:
    identity = [arguments[name] for name in NAMING]
    matching = [(s, marker) for s, marker in added_markers if matches(marker, *identity)]
    if not matching:
        return [_unknown_marker_problem(arguments)]
    visible = [(s, marker.pose.position) for s, marker in matching if not invisibility_reason(marker)]
    path = sorted((s, (position.x, position.y, position.z)) for s, position in visible)
    if not path:
        return [Problem(f"the marker is invisible: {invisibility_reason(matching[0][1])}", INVISIBLE)]
    plane = path[0][1][2] if arguments["height"] is None else arguments["height"]  # [m]
    center = arguments["center"]
    heights = [z for _, (_, _, z) in path]
    level: list[Problem] = []
    if arguments["height"] is None and not max(heights) - min(heights) <= 2 * arguments["tolerance"]:
        span = f"{format_number(min(heights), 'm')} to {format_number(max(heights), 'm')}"
        message = f"the marker moves up and down, from z = {span}, expected one height"
        level = [Problem(message, "the path is at the wrong height")]
    return (
        check_duration(path, evidence.seconds)
        or level
        or check_circle(path, arguments["radius"], center, plane, arguments["tolerance"])
        or check_turn(path, center, arguments["period"], arguments["counter_clockwise"])
        or list(find_silence(evidence, arguments["topic"], [seconds for seconds, _ in path], "the marker"))
    )


def _unknown_marker_problem(arguments: Arguments) -> Problem:
    identity = ", ".join(f"{name} {arguments[name]!r}" for name in NAMING if arguments[name] is not None)
    message = f"no marker with {identity} was added on {arguments['topic']}"
    return Problem(message, "type, ns or id of a marker is wrong")


def check_duration(path: Path, seconds: float, noun: str = "the marker") -> list[Problem]:
    """Return a problem if a path covers less than half of a scenario of `seconds` [s]."""
    duration = path[-1][0] - path[0][0]  # [s]
    message = f"{noun} moves for only {format_number(duration, 's')} of {seconds:g} s"
    return [Problem(message, NOT_MOVING)] if duration < seconds / 2 else []


def check_circle(
    path: Path,
    radius: float,
    center: Sequence[float],
    height: float,
    tolerance: float,
    noun: str = "the marker",
) -> list[Problem]:
    """Return a problem for the first position of a path that is off the circle; lengths in [m]."""
    for seconds, (x, y, z) in path:
        distance = math.dist((x, y), center)
        if not is_close(distance, radius, tolerance):
            gap = describe_offset(distance, radius, "too far out", "too far in")
            where = f"{format_number(distance, 'm')} from the centre, expected {format_number(radius, 'm')}"
            message = f"after {format_number(seconds, 's')} {noun} is {gap}: {where}"
            return [Problem(message, "the path leaves the circle: wrong radius or centre")]
        if not is_close(z, height, tolerance):
            gap = describe_offset(z, height, "too high", "too low")
            message = f"{noun} is {gap}: z = {format_number(z, 'm')}, expected {format_number(height, 'm')}"
            return [Problem(message, "the path is at the wrong height")]
    return []


def check_turn(
    path: Path,
    center: Sequence[float],
    period: float | None,
    counter_clockwise: bool | None,
    noun: str = "the marker",
) -> list[Problem]:
    """Return a problem if a path turns around the center in the wrong direction or period [s]."""
    angles = [math.atan2(y - center[1], x - center[0]) for _, (x, y, _) in path]
    steps = [math.remainder(b - a, math.tau) for a, b in pairwise(angles)]
    total_angle, seconds = sum(steps), path[-1][0] - path[0][0]
    if sum(abs(step) for step in steps) < 1e-3:
        return [Problem(f"{noun} stands still, expected it to move along a circle", NOT_MOVING)]
    if problem := _find_jump(path, steps, noun):
        return [problem]
    if counter_clockwise is not None and (total_angle > 0) != counter_clockwise:
        names = ("clockwise", "counter-clockwise")
        message = f"{noun} goes {names[total_angle > 0]} (from above), expected {names[counter_clockwise]}"
        return [Problem(message, "the direction of turning is wrong")]
    if period is not None:
        still = sum(abs(step) < STILL for step in steps)
        if still > len(steps) / 2:
            jump = math.degrees(max(map(abs, steps)))
            message = f"{noun} does not move in {still} of {len(steps)} messages, and jumps by {jump:.0f}°"
            message += " in others, expected an even motion"
            return [Problem(message, "a position is repeated from message to message")]
        actual = seconds * math.tau / abs(total_angle) if total_angle else math.inf  # [s]
        gap = describe_offset(actual, period, "too slow", "too fast", "s")
        message = f"one turn takes {format_number(actual, 's')}, expected {format_number(period, 's')}: {gap}"
        if is_close(math.degrees(actual), period, PERIOD_TOLERANCE * period):
            message += ": are degrees used instead of radians?"
        right = is_close(actual, period, PERIOD_TOLERANCE * period)
        return [] if right else [Problem(message, "the time of one turn is wrong")]
    message = f"{noun} turns by only {math.degrees(abs(total_angle)):.0f}°"
    return [] if abs(total_angle) >= LEAST_TURN else [Problem(message, "too little of the circle was driven")]


def _find_jump(path: Path, steps: Sequence[float], noun: str) -> Problem | None:
    """Return the problem of an angle that jumps: in each message, or only now and then."""
    jump = max(steps, key=abs)
    if abs(jump) <= LARGEST_STEP:
        return None
    message = f"{noun} jumps by {math.degrees(abs(jump)):.0f}° from one message to the next"
    # Equal steps of exactly a quarter turn differ in their last digits.
    if np.median(np.abs(steps)) > LARGEST_STEP - STILL:
        message = f"{message}: are degrees used instead of radians?"
        return Problem(message, "an angle jumps from message to message")
    seconds = path[steps.index(jump) + 1][0]
    message = f"{message}, after {format_number(seconds, 's')}: is the angle set to another value there?"
    return Problem(message, "an angle is set back")


@check_function("where {source} is in {target}")
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
    """Expect the pose of frame `source` in frame `target` in tf2, `at` [s] after the start or at the end.

    Translation and tolerance are in [m], yaw about z in [rad]. A static transform is published on
    /tf_static, with `target` as the parent, and never on /tf. Two different poses of `source` for
    one time are an error, because it is undefined which one applies.
    """
    if ambiguous := list(_check_unambiguous(evidence, source)):
        return ambiguous
    if static and any(pose.child == source for _, pose in _iter_transforms(evidence, "/tf")):
        message = f"{source} is broadcast repeatedly on /tf, expected once on /tf_static"
        return [Problem(message, "a transform that never moves is not static")]
    fixed = [pose for _, pose in _iter_transforms(evidence, "/tf_static") if pose.child == source]
    if static and fixed and target not in [pose.parent for pose in fixed]:
        message = f"the parent of {source!r} is {fixed[0].parent!r}, expected {target!r}"
        return [Problem(message, "a frame has the wrong parent")]
    try:
        transform = evidence.compute_once(transform_buffer).lookup(
            target, source, 0 if at is None else START_NS + round(at * 1e9)
        )
    except TransformException as error:
        mistake = FAILED_LOOKUPS.get(type(error).__name__, "a transform is missing")
        return [Problem(f"tf2 reports: {error}", mistake)]
    problems = []
    for (axis, directions), actual, expected in zip(
        DIRECTIONS.items(), transform.translation, translation or transform.translation, strict=True
    ):
        if not is_close(actual, expected, tolerance):
            gap = describe_offset(actual, expected, *directions)
            where = f"{axis} = {format_number(actual, 'm')}, expected {format_number(expected, 'm')}"
            message = f"{transform.child} is {gap} in {transform.parent}: {where}"
            problems.append(Problem(message, "the position of a frame is wrong"))
    turn = yaw_of(*transform.rotation)
    if yaw is not None and not are_angles_close(turn, yaw, YAW_TOLERANCE):
        message = f"{transform.child} is turned by {format_angle(turn)} about z, expected {format_angle(yaw)}"
        problems.append(Problem(message, "the orientation of a frame is wrong"))
    return problems


@check_function("{frame} goes round a circle in {target}")
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
    """Expect a frame that moves around the origin of `target` for most of the scenario.

    Radius and height (None: those of the first pose) and tolerance are in [m], the period is in
    [s], counter-clockwise is as seen from above. `heading` [rad] is the yaw minus the direction
    from the origin: 0 faces outward, pi / 2 forward. `start` [rad] is the initial direction from
    the origin.
    """
    if ambiguous := list(_check_unambiguous(evidence, frame)):
        return ambiguous
    poses = [(seconds, pose) for seconds, pose in _iter_transforms(evidence, "/tf") if pose.child == frame]
    if len(poses) > 1 and not any(pose.stamp_ns for _, pose in poses):
        # Such a frame can be looked up at the latest time only, but displays request the stamps of
        # messages.
        message = f"every transform of {frame!r} has the stamp 0: tf2 has no data at any other time"
        return [Problem(message, "a transform has wrong stamps")]
    if not poses:
        others = [pose for _, pose in _iter_transforms(evidence, "/tf")]
        if any((pose.parent, pose.child) == (frame, target) for pose in others):
            message = f"{frame!r} is the parent of {target!r} on /tf, expected the other way round"
            return [Problem(message, "a frame has the wrong parent")]
        other_frames = sorted({pose.child for pose in others})
        only = f", only of {', '.join(map(repr, other_frames[:MAX_NAMED]))}" if other_frames else ""
        if any(frame.startswith("/") for frame in other_frames):
            only += ": a frame of tf2 has no / in front"
        return [Problem(f"no transform of {frame!r} was published on /tf{only}", "a transform is missing")]
    strange = sorted({pose.parent for _, pose in poses} - {target})
    if strange:
        message = f"the parent of {frame!r} is {strange[0]!r}, expected {target!r}"
        return [Problem(message, "a frame has the wrong parent")]
    path: Path = [(seconds, pose.translation) for seconds, pose in poses]
    first = path[0][1]
    plane = first[2] if height is None else height  # [m]
    distance = math.hypot(*first[:2]) if radius is None else radius  # [m]
    return (
        check_duration(path, evidence.seconds, frame)
        or check_circle(path, distance, (0.0, 0.0), plane, tolerance, frame)
        or check_turn(path, (0.0, 0.0), period, counter_clockwise, frame)
        or list(find_silence(evidence, "/tf", [seconds for seconds, _ in path], frame))
        or list(_check_directions(poses, heading, start))
    )


def _check_unambiguous(evidence: Evidence, frame: str) -> Iterator[Problem]:
    """Yield a problem if a frame is broadcast with different poses for one time."""
    if frame in (conflicts := evidence.compute_once(_find_conflicts)):
        when, first, other = conflicts[frame]
        places = [f"{format_numbers(pose.translation)} m in {pose.parent!r}" for pose in (first, other)]
        message = f"{frame} is broadcast {when} at {places[0]} and at {places[1]}"
        yield Problem(
            f"{message}: it is undefined which one applies", "a frame has several poses at one time"
        )


def _find_conflicts(evidence: Evidence) -> dict[str, tuple[str, Transform, Transform]]:
    """Return for each ambiguous frame a description of the time and two contradicting poses."""
    first: dict[tuple[str, int | None], Transform] = {}
    conflicts: dict[str, tuple[str, Transform, Transform]] = {}
    for topic, stamped in (("/tf_static", False), ("/tf", True)):
        for _, pose in _iter_transforms(evidence, topic):
            # A moving frame without a stamp is another mistake, which tf2 reports.
            if stamped and not pose.stamp_ns:
                continue
            fixed = first.get((pose.child, None))
            earlier = fixed or first.setdefault((pose.child, pose.stamp_ns if stamped else None), pose)
            # The representations are compared, because NaN is not equal to itself.
            if repr((earlier.parent, earlier.pose)) != repr((pose.parent, pose.pose)):
                when = ("on /tf_static and on /tf" if fixed else "for one time") if stamped else "as static"
                conflicts.setdefault(pose.child, (when, earlier, pose))
    return conflicts


def transform_buffer(evidence: Evidence) -> BufferCore:
    """Return a tf2 buffer that contains all published transforms and never drops any."""
    buffer = BufferCore(FOR_EVER_NS)
    for topic in ("/tf", "/tf_static"):
        for _, transform in _iter_transforms(evidence, topic):
            buffer.set_transform(transform, is_static=topic == "/tf_static")
    return buffer


def _iter_transforms(evidence: Evidence, topic: str) -> Iterator[tuple[float, Transform]]:
    """Yield (time since the start [s], transform) for each transform published on a topic."""
    for seconds, message in evidence.messages(topic):
        for transform in message.transforms if type_name(message) == TF else ():
            yield seconds, Transform.from_message(transform)


def _check_directions(
    poses: Sequence[tuple[float, Transform]], heading: float | None, start: float | None
) -> Iterator[Problem]:
    """Yield a problem for the first pose with another heading, and for another initial direction [rad]."""
    for seconds, pose in poses if heading is not None else ():
        (x, y, _), turn = pose.translation, yaw_of(*pose.rotation)
        if heading is not None and not are_angles_close(turn - math.atan2(y, x), heading, YAW_TOLERANCE):
            expected = format_angle(math.remainder(math.atan2(y, x) + heading, math.tau))
            expected_text = f"{expected}: the direction from the origin plus {format_angle(heading)}"
            message = f"after {format_number(seconds, 's')} {pose.child} is turned by {format_angle(turn)}"
            yield Problem(f"{message}, expected {expected_text}", "the orientation of a frame is wrong")
            break
    first = poses[0][1]
    angle = math.atan2(first.translation[1], first.translation[0])
    if start is not None and not are_angles_close(angle, start, YAW_TOLERANCE):
        message = f"{first.child} starts at the angle {format_angle(angle)}, expected {format_angle(start)}"
        yield Problem(message, "a path starts at the wrong position")


@check_function("the last path on {topic}")
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
    """Expect `count` poses in the last path, and its frame and two ends.

    The ends, shape (2, 3), and the tolerance are in [m]; the yaw of the last pose about z in [rad].
    """
    _, path = received_messages(evidence, topic, PATH)[-1]
    if path.header.frame_id != frame:
        message = f"the path on {topic} is in frame {path.header.frame_id!r}, expected {frame!r}"
        return [Problem(message, "the frame of a path is wrong")]
    if len(path.poses) != count:
        message = f"the last path on {topic} has {format_count(len(path.poses), 'pose')}, expected {count}"
        if abs(len(path.poses) - count) == 1:
            return [Problem(message, "a path has one pose too many or too few")]
        if len(path.poses) < count:
            return [Problem(message, "a path has too few poses")]
        return [Problem(message, "a path has the wrong number of poses")]
    for which, end, expected in zip(("first", "last"), (path.poses[0], path.poses[-1]), ends, strict=True):
        place = end.pose.position
        position = (place.x, place.y, place.z)
        if not is_close(math.dist(position, expected), 0.0, tolerance):
            actual, expected_text = format_numbers(position), format_numbers(expected)
            message = f"the {which} pose of {topic} is at {actual} m, expected {expected_text} m"
            for cause, other in (
                ("x and y are exchanged", (place.y, place.x, place.z)),
                ("each sign is reversed", (-place.x, -place.y, -place.z)),
            ):
                if is_close(math.dist(other, expected), 0.0, tolerance):
                    message = f"{message}: {cause}"
            if is_close(math.dist(map(abs, position), map(abs, expected)), 0.0, tolerance):
                return [Problem(message, "a pose of a path is mirrored")]
            return [Problem(message, "a pose of a path is at the wrong position")]
    own_frames = {pose.header.frame_id for pose in path.poses} - {frame}
    if own_frames:
        message = f"a pose of the path on {topic} has the frame {min(own_frames)!r} in its own header"
        return [Problem(f"{message}, expected {frame!r}", "the frame of a pose in a path is wrong")]
    q = path.poses[-1].pose.orientation
    length = math.hypot(q.x, q.y, q.z, q.w)
    turn = yaw_of(q.x, q.y, q.z, q.w)
    if yaw is not None and not are_angles_close(turn, yaw, tolerance):
        message = f"the last pose of {topic} is turned by {format_angle(turn)} about z"
        message += f", expected {format_angle(yaw)}"
        if not is_close(length, 1.0, UNIT_TOLERANCE):
            message += f": its quaternion has the length {length:.2f}, expected 1"
        return [Problem(message, "the orientation in a path is wrong")]
    return []


TOPIC = "/joint_states"
STATE = "sensor_msgs/msg/JointState"
# [rad] A node may count the time from its start or from its first message.
PHASE_TOLERANCE = 0.2
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
NOT_ALL_THE_TIME = "a joint is not published all the time"
TOLERANCE, TIME_TOLERANCE = 1e-3, 0.05  # [rad], [s]
UNIT_TOLERANCE = 0.01  # tolerance of a quaternion's length
# Actual divided by expected frequency: twice or half, 2 pi left out, a period for a frequency.
OTHER_FREQUENCIES = (
    *(0.5, 2.0, 0.25, 4.0, 1 / math.tau, math.tau, 1 / math.pi, math.pi),
    *(1 / 3, 3.0, 1.5, 2 / 3, 8.0, 16.0, 0.125, 1 / 16, 2.5, 0.4, math.degrees(1.0)),
)


@check_function("every joint has a name and a position")
def expect_joint_states(
    evidence: Evidence, names: Sequence[str], *, topic: str = TOPIC, moving: bool = False
) -> Iterable[Problem]:
    """Expect exactly the joints `names` in every message, in any order, with finite positions.

    With `moving`, some joint must move. Omitted positions do not count as motion.
    """
    for seconds, state in received_messages(evidence, topic):
        if problems := list(_check_state(state, names)):
            when = f"after {format_number(seconds, 's')} "
            return [Problem(when + problem.message, problem.mistake) for problem in problems]
    poses = [list(state.position) for _, state in received_messages(evidence, topic)]
    if moving and all(pose == poses[0] for pose in poses):
        return [
            Problem(
                f"no joint moves: every message has the positions {format_numbers(poses[0])}",
                "no joint moves",
            )
        ]
    return []


@check_function("how {joint} moves")
def expect_joint_swing(
    evidence: Evidence,
    joint: str,
    *,
    amplitude: float | None,
    hz: float,
    phase: float = 0.0,
    middle: float = 0.0,
    topic: str = TOPIC,
    tolerance: float = 0.02,
) -> Iterable[Problem]:
    """Expect a joint at middle + amplitude * sin(2 pi hz t + phase), with t [s] from the first message.

    Amplitude, phase, middle and tolerance are in [rad] (or [m]). An amplitude of 0 means that the
    joint stands still; None means any amplitude above the tolerance. The joint must be published
    without gaps, see `find_silence`.
    """
    states = received_messages(evidence, topic, STATE)
    # A message may have fewer positions than names.
    swing = [
        (seconds, position)
        for seconds, state in states
        for name, position in zip(state.name, state.position, strict=False)
        if name == joint
    ]
    if not swing:
        last = states[-1][1]
        content = ", ".join(last.name) or "no joint"
        if joint in last.name:
            content = f"{len(last.name)} names and {format_count(len(last.position), 'position')}"
        message = f"no position of {joint} was published on {topic}; the last message has {content}"
        return [Problem(message, "the position of a joint is missing")]
    if any(list(m.name).count(joint) > 1 for _, m in states):
        message = (
            f"a message on {topic} contains {joint} more than once: it is undefined which position applies"
        )
        return [Problem(message, "a joint is named more than once")]
    times, positions = np.array(swing).T
    if (duration := times[-1] - times[0]) < evidence.seconds / 2:
        message = f"{joint} was published for {format_number(duration, 's')} of {evidence.seconds:g} s"
        return [Problem(message, NOT_ALL_THE_TIME)]
    for gap in find_silence(evidence, topic, times.tolist(), joint):
        return [Problem(gap.message, NOT_ALL_THE_TIME)]
    if not np.isfinite(positions).all():
        return [Problem(f"a position of {joint} is not finite", "the position of a joint is not finite")]
    wave = 2 * math.pi * hz * (times - states[0][0])
    return list(_compare_swing(joint, wave, positions, (amplitude, hz, phase, middle), tolerance))


@check_function("the joints that stand still")
def expect_joints_still(
    evidence: Evidence, positions: Mapping[str, float], *, topic: str = TOPIC
) -> Iterable[Problem]:
    """Expect joints to remain at `positions` [rad] or [m], as in `expect_joint_swing`."""
    for joint, middle in positions.items():
        check = expect_joint_swing(joint, amplitude=0.0, hz=0.0, middle=middle, topic=topic)
        verdict = check.judge(evidence)
        if verdict.score < 1:
            yield Problem(verdict.message, verdict.mistake)


def _check_state(state: Any, names: Sequence[str]) -> Iterator[Problem]:
    if type_name(state) != STATE:
        yield Problem(f"a {type_name(state)} was published, expected {STATE}", "a topic has the wrong type")
        return
    unknown = [name for name in state.name if name not in names]
    missing = [name for name in names if name not in state.name]
    if unknown:
        message = f"the robot has no joint {join_words(unknown)}"
        if missing:
            message += f"; missing: {join_words(missing)}"
        if any(f"{first}{second}" in unknown for first, second in pairwise(names)):
            message += " (is a comma missing between two strings?)"
        yield Problem(message, "the name of a joint is wrong")
    elif missing:
        yield Problem(f"a message lacks {join_words(missing)}", "the name of a joint is missing")
    elif twice := [name for name in names if list(state.name).count(name) > 1]:
        yield Problem(
            f"a message contains {join_words(twice)} more than once", "a joint is named more than once"
        )
    if len(state.position) != len(state.name):
        counts = format_count(len(state.name), "name"), format_count(len(state.position), "position")
        message = f"a message has {counts[0]} and {counts[1]}"
        yield Problem(message, "the numbers of names and positions differ")
    if not np.isfinite(state.position).all():
        yield Problem("a position is not finite", "the position of a joint is not finite")


def _compare_swing(
    joint: str,
    wave: np.ndarray[Any, Any],
    positions: np.ndarray[Any, Any],
    expected: tuple[float | None, float, float, float],
    tolerance: float,
) -> Iterator[Problem]:
    """Compare the positions with the best-fitting swing of the expected frequency."""
    amplitude, hz, phase, middle = expected
    columns = np.array([np.sin(wave), np.cos(wave), np.ones(len(wave))]).T
    # A joint that should not move has only a middle position.
    columns[:, :2] *= amplitude != 0
    sine, cosine, came_middle = np.linalg.lstsq(columns, positions)[0].round(9)
    actual, phase_error = math.hypot(sine, cosine), math.remainder(math.atan2(cosine, sine) - phase, math.tau)
    max_residual = float(np.abs(columns @ (sine, cosine, came_middle) - positions).max())
    if max_residual > tolerance and amplitude == 0:
        message = f"{joint} moves by {format_number(max_residual, 'rad')}, expected it to stand still"
        yield Problem(message, "a joint moves that should stand still")
        return
    if max_residual > max(tolerance, 0.05 * actual):
        if amplitude is None or (other := _frequency_of(wave, positions, hz, tolerance / 20)) is None:
            message = f"{joint} does not follow a sine at {format_number(hz)} Hz"
            yield Problem(
                f"{message}: it is up to {format_number(max_residual, 'rad')} off",
                "a joint does not swing as expected",
            )
        else:
            message = f"{joint} swings {format_number(other)} times a second, expected {format_number(hz)}"
            yield Problem(message, "the frequency of a joint's position is wrong")
        return
    if amplitude is None:
        if actual <= tolerance:
            yield Problem(f"{joint} stands still, expected it to swing", "a joint stands still")
        return
    if amplitude and is_close(actual, 0.0, tolerance):
        little = (
            f"swings by only {format_number(actual, 'rad')}" if actual > MOVING_AMPLITUDE else "stands still"
        )
        message = f"{joint} {little}, expected it to swing by {format_number(amplitude, 'rad')}"
        yield Problem(message, "a joint stands still")
    elif not is_close(actual, amplitude, tolerance):
        message = f"{joint} swings by {_format_angles(actual, amplitude)}"
        yield Problem(message, "the amplitude of a joint's position is wrong")
    elif amplitude and not is_close(phase_error, 0.0, PHASE_TOLERANCE):
        message = (
            f"{joint} swings with a phase error of {format_number(abs(phase_error), 'rad')}; "
            "half a turn means a wrong sign"
        )
        yield Problem(message, "the phase or the sign of a joint's position is wrong")
    if not is_close(came_middle, middle, tolerance):
        angles = _format_angles(came_middle, middle)
        if amplitude == 0:
            yield Problem(f"{joint} stands at {angles}", "a joint stands at the wrong position")
        else:
            yield Problem(f"the middle of {joint} is {angles}", "the middle position of a joint is wrong")


def _frequency_of(
    wave: np.ndarray[Any, Any], positions: np.ndarray[Any, Any], hz: float, tolerance: float
) -> float | None:
    """Return the frequency [Hz] of another sine that the positions follow, or None.

    Args:
        wave: The angle of the expected sine at each position [rad].
        positions: The positions [rad].
        hz: The expected frequency.
        tolerance: The largest difference from a sine [rad]. Slow sines differ little from each
            other, so that it has to be small.
    """
    for ratio in OTHER_FREQUENCIES:
        columns = np.array([np.sin(ratio * wave), np.cos(ratio * wave), np.ones(len(wave))]).T
        fit = np.linalg.lstsq(columns, positions)[0]
        if np.abs(columns @ fit - positions).max() <= tolerance:
            return ratio * hz
    return None


def _format_angles(actual: float, expected: float) -> str:
    hints = {
        math.radians(actual): ": is it in degrees instead of radians?",
        math.radians(math.radians(actual)): ": was an angle in degrees converted to degrees?",
    }
    matching = (hint for angle, hint in hints.items() if is_close(angle, expected, 0.01 * abs(expected)))
    hint = next(matching, "") if expected else ""
    return f"{format_number(actual, 'rad')}, expected {format_number(expected, 'rad')}{hint}"


@check_function("trajectory {index} on {topic}")
def expect_trajectory(
    evidence: Evidence,
    topic: str,
    goal: Mapping[str, float],
    *,
    index: int = 0,
    at: float,
    seconds: float,
    points: int | None = None,
    of: int | None = None,
) -> Iterable[Problem]:
    """Expect a trajectory that joint_trajectory_controller accepts and that ends in `goal`.

    Args:
        evidence: The evidence with the trajectories.
        topic: The topic of the trajectories.
        goal: Final positions by joint, in any order [rad]; the arm must stand still there.
        index: Index of the trajectory, counted from 0.
        at: Time [s] of its publication after the start.
        seconds: Time [s] of its last point after that.
        points: Number of its points, or None for any number.
        of: Number of all trajectories, or None for any number.
    """
    # The judge's process has not made ROS names importable yet.
    import_path.install()
    from rclpy.time import Time

    from course_lib.robots.trajectory import waypoints_of

    when, trajectory = _find_trajectory(evidence, topic, index, points, of)
    sent = [sample for sample in evidence.samples if sample.topic == topic]
    if any(sample.qos.reliability == "best_effort" for sample in sent):
        message = (
            f"{topic} is published with Best Effort; the controller requests Reliable and receives nothing"
        )
        raise Problem(message, "a command is published with Best Effort")
    try:
        *_, last = waypoints_of(trajectory, list(goal), Time(nanoseconds=START_NS + round(when * 1e9)))
    # A time before 1970 raises a ValueError.
    except (CourseError, ValueError) as rejection:
        yield Problem(f"the controller rejects it: {rejection}", "the controller rejects the trajectory")
        return
    if not is_close(when, at, TIME_TOLERANCE):
        message = (
            f"the trajectory was published after {format_number(when, 's')}, "
            f"expected after {format_number(at, 's')}"
        )
        yield Problem(message, "a trajectory is sent at the wrong time")
    if not is_close(last.seconds, seconds, TIME_TOLERANCE):
        message = (
            f"its last point is reached after {format_number(last.seconds, 's')}, "
            f"expected {format_number(seconds, 's')}"
        )
        yield Problem(message, "the time of a trajectory is wrong")
    if len(last.state) < 2:
        message = "its last point has no velocities, so the arm would stop with a jerk"
        yield Problem(message, "a trajectory has no velocities")
    for (joint, expected), position in zip(goal.items(), last.state[0].tolist(), strict=True):
        if not is_close(position, expected, TOLERANCE):
            message = (
                f"{joint} goes to {format_number(position, 'rad')}, expected {format_number(expected, 'rad')}"
            )
            if abs(expected) > TOLERANCE and math.isclose(math.radians(position), expected, rel_tol=1e-3):
                message += ": is it in degrees instead of radians?"
            yield Problem(message, "a trajectory leads to the wrong position of a joint")


def _find_trajectory(
    evidence: Evidence, topic: str, index: int, points: int | None, of: int | None
) -> tuple[float, Any]:
    """Return (time since the start [s], trajectory), or raise a Problem if a count is wrong."""
    actual = received_messages(evidence, topic, TRAJECTORY)
    were = "trajectory was" if len(actual) == 1 else "trajectories were"
    counts = f"{len(actual)} {were} published on {topic}, expected"
    if len(actual) <= index:
        raise Problem(f"{counts} at least {index + 1}", "a trajectory is missing")
    if len(actual) > (of or len(actual)):
        raise Problem(f"{counts} {of}", "the count of trajectories is wrong")
    trajectory = actual[index][1]
    if len(trajectory.points) != (points or len(trajectory.points)):
        message = f"the trajectory has {format_count(len(trajectory.points), 'point')}, expected {points}"
        raise Problem(message, "a trajectory has the wrong number of points")
    return actual[index]
