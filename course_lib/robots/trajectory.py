"""Joint trajectories: messages, splines through their points, goals, tolerances, a controller.

The rules, texts and limits are those of ros2_control's joint_trajectory_controller: a trajectory
that a robot's controller would reject is rejected here with the same text.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise, takewhile
from typing import Unpack

import numpy as np
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from numpy.polynomial.polynomial import polyder, polyval
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.duration import Duration
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.node import Node, NodeOptions
from rclpy.task import Future
from rclpy.time import Time
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.arrays import Floats
from course_lib.errors import CourseError
from course_lib.robots.urdf import MOVING, Urdf, parse_urdf


def period_of(rate: float) -> float:
    """Return the period [s] of a rate [Hz]. Raise a CourseError if the rate is not positive."""
    if not 0 < rate < math.inf:
        raise CourseError(f"The rate is {rate!r}, expected a positive number, [Hz].")
    return 1.0 / rate


_FIELDS = ("positions", "velocities", "accelerations")
# joint_trajectory_controller has the same threshold.
_SMALLEST_SPEED = float(np.finfo(np.float32).eps)
Result = FollowJointTrajectory.Result
# A negative tolerance means no limit. 0 selects the controller's default, which has no limit here
# either.
ERASED = -1.0


@dataclass(frozen=True, eq=False)
class Waypoint:
    """Desired joint states at a time [s].

    The rows of `state` are positions, velocities and accelerations of n joints, of which the last
    ones may be missing: shape (1, n), (2, n) or (3, n), in [rad] or [m], and per [s] and [s²].
    """

    seconds: float
    state: Floats


def sample(waypoints: Sequence[Waypoint], seconds: float) -> Floats:
    """Return positions, velocities and accelerations at a time, shape (3, n).

    The interpolation between two waypoints is linear, cubic if both have velocities, and quintic if
    both also have accelerations. Before the first and after the last one its state is kept.
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
    known_count = min(len(start.state), len(end.state))
    ends = np.vstack([start.state[:known_count], end.state[:known_count]])
    powers: Floats = _fit(known_count, end.seconds - start.seconds) @ ends
    return powers, polyder(powers).astype(float), polyder(powers, 2).astype(float)


@lru_cache(maxsize=64)
def _fit(known_count: int, duration: float) -> Floats:
    """Return the matrix from the derivatives at both ends to the polynomial's coefficients."""
    monomials = np.eye(2 * known_count)
    ends = [
        polyval(end, polyder(monomials, order)) for end in (0.0, duration) for order in range(known_count)
    ]
    return np.linalg.inv(ends)


def waypoints_of(message: JointTrajectory, joints: Sequence[str], now: Time) -> list[Waypoint]:
    """Convert a trajectory to waypoints, with times since its start and states in the order of `joints`.

    Raises:
        CourseError: joint_trajectory_controller would reject it. The message is the controller's.
    """
    if len(set(message.joint_names)) != len(joints):
        raise CourseError("Joints on incoming trajectory don't match the controller joints.")
    for name in message.joint_names:
        if name not in joints:
            raise CourseError(f"Incoming joint {name} doesn't match the controller's joints.")
    if not message.points:
        raise CourseError("Empty trajectory received.")
    for problem in _find_problems(message, now):
        raise CourseError(problem)
    order = [list(message.joint_names).index(joint) for joint in joints]
    waypoints = []
    for point in message.points:
        # Only the fields before the first empty one are used.
        fields = list(takewhile(len, (getattr(point, name) for name in _FIELDS)))
        waypoints.append(Waypoint(_seconds(point), np.array(fields)[:, order]))
    return waypoints


def _seconds(point: JointTrajectoryPoint) -> float:
    return Duration.from_msg(point.time_from_start).nanoseconds / 1e9


def _find_problems(message: JointTrajectory, now: Time) -> Iterator[str]:
    """Yield joint_trajectory_controller's errors for the times and the points of a trajectory."""
    times = [_seconds(point) for point in message.points]
    start = Time.from_msg(message.header.stamp).nanoseconds / 1e9
    if start and start + times[-1] < now.nanoseconds / 1e9:
        start_and_end = f"start time ({start:f}) that ends in the past ({start + times[-1]:f})"
        yield f"Received trajectory with non-zero {start_and_end}"
    for number, (before, after) in enumerate(pairwise(times)):
        if after <= before:
            times_are = f"it is {before:f} and {after:f} respectively"
            yield f"Time between points {number} and {number + 1} is not strictly increasing, {times_are}"
    names = message.joint_names
    for number, point in enumerate(message.points):
        for name in _FIELDS:
            size = len(getattr(point, name))
            if size != len(names) and (size or name == "positions"):
                sizes = f"joint_names size ({len(names)}) and {name} ({size})"
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
class GoalEnd:
    """The end of a goal: its code, the text for the client, and the text for the log."""

    code: int
    text: str
    log_text: str = ""


REACHED = GoalEnd(Result.SUCCESSFUL, "Goal successfully reached!", "Goal reached, success!")
PREEMPTED = GoalEnd(Result.INVALID_GOAL, "Current goal preempted by new incoming action.")
LEFT_PATH = GoalEnd(
    Result.PATH_TOLERANCE_VIOLATED,
    "Aborted due to path tolerance violation",
    "Aborted due to state tolerance violation",
)


class TrajectoryGoal:
    """A goal with its position tolerances, from its start to its end.

    Args:
        handle: The action server's handle of the goal.
        joints: The controller's joints in its order.
        logger: Logs the joints that exceed their tolerances.
    """

    def __init__(
        self,
        handle: ServerGoalHandle,
        joints: Sequence[str],
        logger: RcutilsLogger,
    ) -> None:
        self.handle, self._joints, self._logger = handle, joints, logger
        self.result: Future[Result] = Future()
        request = handle.request
        try:
            self._path = _tolerances("path_tolerance", request.path_tolerance, joints)
            self._goal = _tolerances("goal_tolerance", request.goal_tolerance, joints)
        except CourseError as error:
            logger.error(f"{error} Using default tolerances.")
            self._path = self._goal = np.full(len(joints), np.inf)
        # In seconds.
        self._most_late = Duration.from_msg(request.goal_time_tolerance).nanoseconds / 1e9

    def check_tolerances(self, error: Floats, late: float) -> GoalEnd | None:
        """Return the end of the goal if it has been reached or violated.

        Args:
            error: Desired - actual positions.
            late: Time since the planned end, negative before it, [s].
        """
        tolerances = self._path if late < 0 else self._goal
        failed = np.flatnonzero(np.abs(error) > tolerances)
        if not failed.size:
            return REACHED if late >= 0 else None
        if late >= 0 and not late > self._most_late > 0:
            return None
        for joint in failed:
            self._logger.error(f"State tolerances failed for joint {joint}:")
            self._logger.error(f"Position Error: {error[joint]:f}, Position Tolerance: {tolerances[joint]:f}")
        text = f"Aborted due to goal_time_tolerance exceeding by {late:f} seconds"
        return LEFT_PATH if late < 0 else GoalEnd(Result.GOAL_TOLERANCE_VIOLATED, text, text)

    def end(self, end: GoalEnd) -> None:
        """End the goal with a result."""
        (self.handle.succeed if end is REACHED else self.handle.abort)()
        self.result.set_result(Result(error_code=end.code, error_string=end.text))

    def cancel(self) -> None:
        """End the goal as canceled by the client."""
        self.handle.canceled()
        self.result.set_result(Result())

    def report(self, now: Time, desired: Floats, actual: Floats) -> None:
        """Publish feedback. The rows of `desired` and `actual` are positions and velocities."""
        feedback = FollowJointTrajectory.Feedback(joint_names=list(self._joints))
        feedback.header.stamp = now.to_msg()
        for name, state in (("desired", desired), ("actual", actual), ("error", desired - actual)):
            setattr(feedback, name, JointTrajectoryPoint(positions=state[0], velocities=state[1]))
        self.handle.publish_feedback(feedback)


def _tolerances(field: str, given: Iterable[JointTolerance], joints: Sequence[str]) -> Floats:
    """Return the tolerances of all joints, [rad] or [m]; infinite if none is given."""
    tolerances: Floats = np.full(len(joints), np.inf)
    for tolerance in given:
        if tolerance.name not in joints:
            raise CourseError(f"joint '{tolerance.name}' specified in goal.{field} does not exist.")
        if tolerance.position < 0 and tolerance.position != ERASED:
            raise CourseError(
                f"joint '{tolerance.name}' specified in goal.{field} has a invalid position tolerance."
            )
        if tolerance.position > 0:
            tolerances[list(joints).index(tolerance.name)] = tolerance.position
    return tolerances


class SimulatedJoints:
    """Joints that reach a command within one period if the limits in the URDF allow it.

    Args:
        tree: The robot. Joints that mimic others are ignored.
        start: Initial positions by name, [rad] or [m]; other joints start at 0.

    Raises:
        CourseError: A joint does not exist, or its initial position exceeds its limits.
    """

    def __init__(self, tree: Urdf, start: Mapping[str, float]) -> None:
        joints = [j for j in tree.joints.values() if j.kind in MOVING and not j.mimic]
        self.names = [joint.name for joint in joints]
        self.lower = np.array([joint.limits.get("lower", -np.inf) for joint in joints])
        self.upper = np.array([joint.limits.get("upper", np.inf) for joint in joints])
        self.speed = np.array([joint.velocity for joint in joints])
        for name, position in start.items():
            if name not in self.names:
                raise CourseError(f"start: there is no joint {name!r}, only {', '.join(self.names)}.")
            i = self.names.index(name)
            if not self.lower[i] <= position <= self.upper[i]:
                limits = f"{self.lower[i]:.3f} … {self.upper[i]:.3f}"
                raise CourseError(f"{name} cannot start at {position!r}; its limits are {limits}.")
        self.positions: Floats = np.array([start.get(name, 0.0) for name in self.names])
        self.velocities: Floats = np.zeros(len(joints))

    def follow(self, command: Floats, period: float) -> list[str]:
        """Move to positions within a period [s], and return ROS's warnings about limits."""
        inside = np.clip(command, self.lower, self.upper)
        reach = self.speed * period
        reached = np.clip(inside, self.positions - reach, self.positions + reach)
        limited = {"position": inside != command, "velocity": np.abs(reached - inside) > 1e-9}
        self.velocities, self.positions = (reached - self.positions) / period, reached
        names = {kind: " ".join(np.array(self.names)[which]) for kind, which in limited.items()}
        return [f"Joint(s) [{n}] would exceed {kind} limits, limiting" for kind, n in names.items() if n]


class JointTrajectoryController(Node):
    """Moves a robot's joints along trajectories, and publishes /joint_states.

    Trajectories are received on the topic ~/joint_trajectory and as goals of the action
    ~/follow_joint_trajectory. A new trajectory replaces the current one and continues from the
    current positions and velocities; a new goal also aborts the old one. Invalid trajectories are
    logged with the controller's texts.

    Args:
        robot_description: The text of a URDF, like `mobile_manipulator().urdf`.
        start: Initial positions by name, [rad] or [m]; other joints start at 0.
        rate: Control rate, [Hz].
        options: Options of any node.

    Raises:
        CourseError: The description is invalid, `start` does not fit its joints, or the rate is not
            positive.
    """

    def __init__(
        self,
        robot_description: str,
        *,
        start: Mapping[str, float] | None = None,
        rate: float = 20.0,
        **options: Unpack[NodeOptions],
    ) -> None:
        self._period = period_of(rate)
        self._joints = SimulatedJoints(parse_urdf(robot_description), start or {})
        super().__init__("arm_controller", **options)
        # Starts with the next update.
        self._next_trajectory: tuple[Time, Sequence[Waypoint]] | None = None
        self._start_ns = self.get_clock().now().nanoseconds
        self._goal: TrajectoryGoal | None = None
        self._hold()
        self._states = self.create_publisher(JointState, "joint_states", 10)
        self.create_subscription(JointTrajectory, "~/joint_trajectory", self._on_trajectory, 10)
        ActionServer(
            self,
            FollowJointTrajectory,
            "~/follow_joint_trajectory",
            self._follow,
            goal_callback=self._on_goal,
            cancel_callback=self._on_cancel,
        )
        self.create_timer(self._period, self._update)

    def _on_trajectory(self, message: JointTrajectory) -> bool:
        """Accept a trajectory and return True, or log its error and return False."""
        try:
            waypoints = waypoints_of(message, self._joints.names, self.get_clock().now())
        except CourseError as problem:
            self.get_logger().error(str(problem))
            return False
        self._next_trajectory = Time.from_msg(message.header.stamp), waypoints
        return True

    def _on_goal(self, goal: FollowJointTrajectory.Goal) -> GoalResponse:
        self.get_logger().info("Received new action goal")
        if not self._on_trajectory(goal.trajectory):
            return GoalResponse.REJECT
        self.get_logger().info("Accepted new action goal")
        return GoalResponse.ACCEPT

    def _on_cancel(self, _: ServerGoalHandle) -> CancelResponse:
        self.get_logger().info("Got request to cancel goal")
        return CancelResponse.ACCEPT

    async def _follow(self, handle: ServerGoalHandle) -> FollowJointTrajectory.Result | None:
        if self._goal:
            self._goal.end(PREEMPTED)
        self._goal = TrajectoryGoal(handle, self._joints.names, self.get_logger())
        return await self._goal.result

    def _update(self) -> None:
        now = self.get_clock().now()
        state = JointState(name=self._joints.names)
        state.position, state.velocity = self._joints.positions, self._joints.velocities
        state.header.stamp = now.to_msg()
        self._states.publish(state)
        if self._next_trajectory:
            # Follow the waypoints from the current state. A start of 0 means now.
            start, waypoints = self._next_trajectory
            self._start_ns, self._next_trajectory = start.nanoseconds or now.nanoseconds, None
            zero_velocity: Floats = np.zeros_like(self._joints.positions)
            begun = (now.nanoseconds - self._start_ns) / 1e9
            start_point = Waypoint(begun, np.vstack([self._state(), zero_velocity]))
            self._waypoints = [start_point, *waypoints]
        seconds = (now.nanoseconds - self._start_ns) / 1e9
        if goal := self._goal:
            desired, actual = sample(self._waypoints, seconds)[:2], self._state()
            goal.report(now, desired, actual)
            end = goal.check_tolerances((desired - actual)[0], seconds - self._waypoints[-1].seconds)
            is_canceled = goal.handle.is_cancel_requested
            if is_canceled:
                self.get_logger().info("Canceling active action goal because cancel callback received.")
                goal.cancel()
            elif end:
                (self.get_logger().info if end is REACHED else self.get_logger().warning)(end.log_text)
                goal.end(end)
            if is_canceled or end:
                self._goal = None
                if end is not REACHED:
                    self._hold()
        command = sample(self._waypoints, seconds + self._period)[0]
        for warning in self._joints.follow(command, self._period):
            self.get_logger().warning(warning, throttle_duration_sec=1.0)

    def _state(self) -> Floats:
        return np.array([self._joints.positions, self._joints.velocities])

    def _hold(self) -> None:
        """Hold the current positions."""
        self._waypoints = [Waypoint(0.0, self._joints.positions[np.newaxis])]
