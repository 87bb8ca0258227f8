"""Checks on joint states, and on trajectories that are sent to an arm."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.wording import Problem, close, heard, listed, number, numbers, word
from course_lib.robots.trajectory import Waypoint
from course_lib.ros import standin_path
from course_lib.ros.clock import START_NS
from course_lib.ros.messages import type_name

TOPIC = "/joint_states"
STATE = "sensor_msgs/msg/JointState"
PHASE_TOLERANCE = 0.2  # [rad]: time may be counted from the node's start or from its first message
TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
TOLERANCE, TIME_TOLERANCE = 1e-3, 0.05  # [rad], [s]


@word("every joint has a name and a position")
def expect_joint_states(
    evidence: Evidence, names: Sequence[str], *, topic: str = TOPIC, moving: bool = False
) -> Iterable[Problem]:
    """Expect exactly the joints `names` in every message, in any order, each with a finite position.

    With `moving`, some joint must move: positions that are forgotten are no motion.
    """
    for seconds, state in heard(evidence, topic):
        if problems := list(_broken(state, names)):
            when = f"after {number(seconds, 's')} "
            return [Problem(when + problem.message, problem.mistake) for problem in problems]
    poses = [list(state.position) for _, state in heard(evidence, topic)]
    if moving and all(pose == poses[0] for pose in poses):
        return [
            Problem(f"no joint moves: every message has the positions {numbers(poses[0])}", "no joint moves")
        ]
    return []


@word("how {joint} moves")
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
    """Expect a joint at middle + amplitude * sin(2 pi hz t + phase), t [s] from the first message.

    Amplitude, phase, middle and tolerance in [rad] (or [m]); an amplitude of 0 asks for standing still, None
    for a swing by whatever amplitude above the tolerance. It is published for half of the scenario at least.
    """
    states = heard(evidence, topic, STATE)
    found = [(s, m.position[i]) for s, m in states if (i := _index(m, joint)) < len(m.position)]
    if not found:
        named = ", ".join(states[-1][1].name) or "no joint"
        message = f"no position of {joint} came on {topic}; the last message names {named}"
        return [Problem(message, "the position of a joint is missing")]
    times, positions = np.array(found).T
    if (seen := times[-1] - times[0]) < evidence.seconds / 2:
        message = f"{joint} was published for {number(seen, 's')} of {evidence.seconds:g} s"
        return [Problem(message, "a joint is not published all the time")]
    if not np.isfinite(positions).all():
        return [Problem(f"a position of {joint} is not finite", "the position of a joint is not finite")]
    wave = 2 * math.pi * hz * (times - states[0][0])
    return list(_differs_from_swing(joint, wave, positions, (amplitude, hz, phase, middle), tolerance))


@word("the joints that stand still")
def expect_joints_still(
    evidence: Evidence, positions: Mapping[str, float], *, topic: str = TOPIC
) -> Iterable[Problem]:
    """Expect joints that stand still at their `positions`, [rad] or [m], as `expect_joint_swing` has it."""
    for joint, middle in positions.items():
        check = expect_joint_swing(joint, amplitude=0.0, hz=0.0, middle=middle, topic=topic)
        verdict = check.judge(evidence)
        if verdict.score < 1:
            yield Problem(verdict.message, verdict.mistake)


def _index(state: Any, joint: str) -> int:
    return list(state.name).index(joint) if joint in state.name else len(state.position)


def _broken(state: Any, names: Sequence[str]) -> Iterator[Problem]:
    if type_name(state) != STATE:
        yield Problem(f"a {type_name(state)} came, expected {STATE}", "a topic has the wrong type")
        return
    unknown = [name for name in state.name if name not in names]
    missing = [name for name in names if name not in state.name]
    if unknown:
        message = f"the robot has no joint {listed(unknown)}; not named is {listed(missing) or 'none'}"
        yield Problem(message, "the name of a joint is wrong")
    elif missing:
        yield Problem(f"not named is {listed(missing)}", "the name of a joint is missing")
    if len(state.position) != len(state.name):
        message = f"a message has {len(state.name)} names and {len(state.position)} positions"
        yield Problem(message, "names and positions are not equally many")
    if not np.isfinite(state.position).all():
        yield Problem("a position is not finite", "the position of a joint is not finite")


def _differs_from_swing(
    joint: str,
    wave: np.ndarray[Any, Any],
    positions: np.ndarray[Any, Any],
    wanted: tuple[float | None, float, float, float],
    tolerance: float,
) -> Iterator[Problem]:
    """Compare with the swing of the wanted frequency that fits the positions best."""
    amplitude, hz, phase, middle = wanted
    columns = np.array([np.sin(wave), np.cos(wave), np.ones(len(wave))]).T
    columns[:, :2] *= amplitude != 0  # what should stand still has a middle only
    sine, cosine, came_middle = np.linalg.lstsq(columns, positions)[0].round(9)
    came, turned = math.hypot(sine, cosine), math.remainder(math.atan2(cosine, sine) - phase, math.tau)
    rest = float(np.abs(columns @ (sine, cosine, came_middle) - positions).max())
    if rest > tolerance and amplitude == 0:
        message = f"{joint} moves by {number(rest, 'rad')}, expected that it stands still"
        yield Problem(message, "a joint moves that should stand still")
        return
    if rest > max(tolerance, 0.05 * came):
        message = f"{joint} does not swing {number(hz)} times a second as a sine does"
        yield Problem(f"{message}: {number(rest, 'rad')} off", "a joint does not swing as it should")
        return
    if amplitude is None:
        if came <= tolerance:
            yield Problem(f"{joint} stands still, expected that it swings", "a joint stands still")
        return
    if not close(came, amplitude, tolerance):
        message = f"{joint} swings by {_angles(came, amplitude)}"
        yield Problem(message, "the amplitude of a joint's position is wrong")
    elif amplitude and not close(turned, 0.0, PHASE_TOLERANCE):
        message = (
            f"{joint} swings with another phase: by {number(abs(turned), 'rad')}; a half turn is a wrong sign"
        )
        yield Problem(message, "the phase or the sign of a joint's position is wrong")
    if not close(came_middle, middle, tolerance):
        message = f"the middle of {joint} is {_angles(came_middle, middle)}"
        yield Problem(message, "the middle position of a joint is wrong")


def _angles(came: float, expected: float) -> str:
    in_degrees = expected and close(math.radians(came), expected, 0.01 * abs(expected))
    hint = ": degrees, where radians are wanted" if in_degrees else ""
    return f"{number(came, 'rad')}, expected {number(expected, 'rad')}{hint}"


@word("trajectory {index} on {topic}")
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
    """Expect a trajectory that joint_trajectory_controller accepts, and that ends in `goal`.

    Args:
        evidence: With the trajectories.
        topic: Of the trajectories.
        goal: By joint, in any order, [rad]; the arm stands still there.
        index: Of the trajectory, counted from 0.
        at: Time of arrival, [s] after the start.
        seconds: Time of its last point, [s] after that.
        points: Number of its points; any number if it is None.
        of: Number of all trajectories; any number if it is None.
    """
    standin_path.install()  # the judge's process has not imported any ROS name yet
    from rclpy.time import Time

    from course_lib.robots.trajectory import waypoints_of

    when, sent = _trajectory(evidence, topic, index, points, of)
    try:
        *_, last = waypoints_of(sent, list(goal), Time(nanoseconds=START_NS + round(when * 1e9)))
    except (CourseError, ValueError) as refused:  # rclpy raises ValueError for a time before 1970
        return [Problem(f"the controller says: {refused}", "the controller refuses the trajectory")]
    return list(_differs_from_goal(last, goal, when, at, seconds))


def _trajectory(
    evidence: Evidence, topic: str, index: int, points: int | None, of: int | None
) -> tuple[float, Any]:
    """Return ([s] since the start, trajectory); raise the problem if a number is not as expected."""
    came = heard(evidence, topic, TRAJECTORY)
    number = f"{len(came)} trajectories came on {topic}, expected"
    if len(came) <= index:
        raise Problem(f"{number} at least {index + 1}", "a trajectory is missing")
    if len(came) > (of or len(came)):
        raise Problem(f"{number} {of}", "the count of trajectories is wrong")
    sent = came[index][1]
    if len(sent.points) != (points or len(sent.points)):
        message = f"the trajectory has {len(sent.points)} points, expected {points}"
        raise Problem(message, "a trajectory has the wrong number of points")
    return came[index]


def _differs_from_goal(
    last: Waypoint, goal: Mapping[str, Any], when: float, at: float, seconds: float
) -> Iterator[Problem]:
    if not close(when, at, TIME_TOLERANCE):
        message = f"the trajectory came after {number(when, 's')}, expected after {number(at, 's')}"
        yield Problem(message, "a trajectory is sent at the wrong time")
    if not close(last.seconds, seconds, TIME_TOLERANCE):
        message = (
            f"its last point is reached after {number(last.seconds, 's')}, expected {number(seconds, 's')}"
        )
        yield Problem(message, "the time of a trajectory is wrong")
    if len(last.state) < 2:
        message = "its last point has no velocities, so the arm would stop with a jerk"
        yield Problem(message, "a trajectory has no velocities")
    for (joint, expected), position in zip(goal.items(), last.state[0].tolist(), strict=True):
        if not close(position, expected, TOLERANCE):
            message = f"{joint} goes to {number(position, 'rad')}, expected {number(expected, 'rad')}"
            yield Problem(message, "a trajectory leads to the wrong position of a joint")
