"""Joint trajectories: messages, splines through their points, and tolerances at the goal."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain, pairwise

import numpy as np
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from numpy.polynomial.polynomial import polyder, polyval
from rclpy.action.server import ServerGoalHandle
from rclpy.duration import Duration
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.task import Future
from rclpy.time import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.arrays import Floats
from course_lib.errors import CourseError

_FIELDS = ("positions", "velocities", "accelerations")
_SMALLEST_SPEED = float(np.finfo(np.float32).eps)  # as there
Result = FollowJointTrajectory.Result
ERASED = -1.0  # a tolerance of any size; 0 is that of the controller, and this one has none


@dataclass(frozen=True, eq=False)
class Waypoint:
    """Desired joint states at a time [s].

    `state` has the positions of n joints, or those and velocities, or also accelerations: shape (1, n),
    (2, n) or (3, n), in [rad] or [m], per [s] and [s²].
    """

    seconds: float
    state: Floats


def sample(waypoints: Sequence[Waypoint], seconds: float) -> Floats:
    """Return positions, velocities and accelerations at a time, shape (3, n).

    Two waypoints are joined by lines; by cubics, if both have velocities; by quintics, if both also
    have accelerations. Before the first and after the last one the joints keep its state.
    """
    later = next((i for i, waypoint in enumerate(waypoints) if seconds < waypoint.seconds), len(waypoints))
    if later in (0, len(waypoints)):
        state = waypoints[max(later - 1, 0)].state
        return np.vstack([state, np.zeros((3 - len(state), state.shape[1]))])
    start, end = waypoints[later - 1], waypoints[later]
    return np.array([polyval(seconds - start.seconds, powers) for powers in _spline(start, end)])


@lru_cache(maxsize=64)
def _spline(start: Waypoint, end: Waypoint) -> tuple[Floats, ...]:
    """Return the coefficients of the polynomials between two waypoints, and of their two derivatives."""
    given = min(len(start.state), len(end.state))
    ends = np.vstack([start.state[:given], end.state[:given]])
    powers: Floats = _fit(given, end.seconds - start.seconds) @ ends
    return powers, polyder(powers).astype(float), polyder(powers, 2).astype(float)


@lru_cache(maxsize=64)
def _fit(given: int, duration: float) -> Floats:
    """Return the matrix from the derivatives at both ends to the polynomial's coefficients."""
    monomials = np.eye(2 * given)
    ends = [polyval(end, polyder(monomials, order)) for end in (0.0, duration) for order in range(given)]
    return np.linalg.inv(ends)


def waypoints_of(message: JointTrajectory, joints: Sequence[str], now: Time) -> list[Waypoint]:
    """Convert a trajectory to waypoints, with times since its start and states in the order of `joints`.

    Raises:
        CourseError: If joint_trajectory_controller refuses it, with its words.
    """
    for problem in chain(_of_names(message, joints), _of_times(message, now), _of_points(message)):
        raise CourseError(problem)
    order = [list(message.joint_names).index(joint) for joint in joints]
    return [Waypoint(_seconds(point), np.array(_given(point))[:, order]) for point in message.points]


def _seconds(point: JointTrajectoryPoint) -> float:
    return Duration.from_msg(point.time_from_start).nanoseconds / 1e9


def _given(point: JointTrajectoryPoint) -> list[Sequence[float]]:
    """Return positions, velocities and accelerations up to the first empty field."""
    fields = [getattr(point, name) for name in _FIELDS]
    return fields[: next((i for i, field in enumerate(fields) if not len(field)), len(fields))]


def _of_names(message: JointTrajectory, joints: Sequence[str]) -> Iterator[str]:
    if len(set(message.joint_names)) != len(joints):
        yield "Joints on incoming trajectory don't match the controller joints."
    for name in message.joint_names:
        if name not in joints:
            yield f"Incoming joint {name} doesn't match the controller's joints."
    if not message.points:
        yield "Empty trajectory received."


def _of_times(message: JointTrajectory, now: Time) -> Iterator[str]:
    times = [_seconds(point) for point in message.points]  # [s]
    start = Time.from_msg(message.header.stamp).nanoseconds / 1e9
    if start and start + times[-1] < now.nanoseconds / 1e9:
        start_and_end = f"start time ({start:f}) that ends in the past ({start + times[-1]:f})"
        yield f"Received trajectory with non-zero {start_and_end}"
    for number, (before, after) in enumerate(pairwise(times)):
        if after <= before:
            times_are = f"it is {before:f} and {after:f} respectively"
            yield f"Time between points {number} and {number + 1} is not strictly increasing, {times_are}"


def _of_points(message: JointTrajectory) -> Iterator[str]:
    names = message.joint_names
    for number, point in enumerate(message.points):
        for name in _FIELDS:
            came = len(getattr(point, name))
            if came != len(names) and (came or name == "positions"):
                sizes = f"joint_names size ({len(names)}) and {name} ({came})"
                yield f"Mismatch between {sizes} at point #{number}."
            if not np.isfinite(getattr(point, name)).all():
                yield f"The {name} at point #{number} are not all finite."
        if len(point.effort):
            kind = "controllers using the 'effort' command interface"
            yield f"Trajectories with effort fields are only supported for {kind}."
    for name, speed in zip(names, message.points[-1].velocities, strict=False):
        if abs(speed) > _SMALLEST_SPEED:
            yield f"Velocity of last trajectory point of joint {name} is not zero: {speed:.15f}"


@dataclass(frozen=True)
class End:
    """The end of a goal: its code, the text for the client, the text for the log."""

    code: int
    says: str
    logs: str = ""


REACHED = End(Result.SUCCESSFUL, "Goal successfully reached!", "Goal reached, success!")
PREEMPTED = End(Result.INVALID_GOAL, "Current goal preempted by new incoming action.")
LEFT_PATH = End(
    Result.PATH_TOLERANCE_VIOLATED,
    "Aborted due to path tolerance violation",
    "Aborted due to state tolerance violation",
)


class TrajectoryGoal:
    """A goal with its tolerances of positions, from its start to its end.

    Args:
        handle: What the action server made of it.
        joints: The controller's, in its order.
        logger: Is told which joint left its tolerance.
    """

    def __init__(self, handle: ServerGoalHandle, joints: Sequence[str], logger: RcutilsLogger) -> None:
        self.handle, self._joints, self._logger = handle, joints, logger
        self.result: Future[Result] = Future()
        request = handle.request
        try:
            self._path = _tolerances("path_tolerance", request.path_tolerance, joints)
            self._goal = _tolerances("goal_tolerance", request.goal_tolerance, joints)
        except CourseError as error:
            logger.error(f"{error} Using default tolerances.")
            self._path = self._goal = np.full(len(joints), np.inf)
        self._most_late = Duration.from_msg(request.goal_time_tolerance).nanoseconds / 1e9  # [s]

    def judge(self, error: Floats, late: float) -> End | None:
        """Return the goal's end if due; error is desired - actual, late [s] is since the planned end."""
        tolerances = self._path if late < 0 else self._goal
        failed = np.flatnonzero(np.abs(error) > tolerances)
        if not failed.size:
            return REACHED if late >= 0 else None
        if late >= 0 and not late > self._most_late > 0:
            return None
        for joint in failed:
            self._logger.error(f"State tolerances failed for joint {joint}:")
            self._logger.error(f"Position Error: {error[joint]:f}, Position Tolerance: {tolerances[joint]:f}")
        says = f"Aborted due to goal_time_tolerance exceeding by {late:f} seconds"
        return LEFT_PATH if late < 0 else End(Result.GOAL_TOLERANCE_VIOLATED, says, says)

    def end(self, end: End) -> None:
        """End the goal with a result."""
        (self.handle.succeed if end is REACHED else self.handle.abort)()
        self.result.set_result(Result(error_code=end.code, error_string=end.says))

    def cancel(self) -> None:
        """End the goal on the client's request."""
        self.handle.canceled()
        self.result.set_result(Result())

    def report(self, now: Time, desired: Floats, actual: Floats) -> None:
        """Publish feedback; desired and actual hold positions, then velocities."""
        feedback = FollowJointTrajectory.Feedback(joint_names=list(self._joints))
        feedback.header.stamp = now.to_msg()
        for name, state in (("desired", desired), ("actual", actual), ("error", desired - actual)):
            setattr(feedback, name, JointTrajectoryPoint(positions=state[0], velocities=state[1]))
        self.handle.publish_feedback(feedback)


def _tolerances(field: str, given: Iterable[JointTolerance], joints: Sequence[str]) -> Floats:
    """Return the tolerances of all joints, [rad] or [m]; infinite where none is given."""
    tolerances: Floats = np.full(len(joints), np.inf)
    for one in given:
        if one.name not in joints:
            raise CourseError(f"joint '{one.name}' specified in goal.{field} does not exist.")
        if one.position < 0 and one.position != ERASED:
            raise CourseError(
                f"joint '{one.name}' specified in goal.{field} has a invalid position tolerance."
            )
        if one.position > 0:
            tolerances[list(joints).index(one.name)] = one.position
    return tolerances
