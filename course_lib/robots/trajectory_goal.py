"""A goal of joint_trajectory_controller's action: what it tolerates, and how it ends."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from rclpy.action.server import ServerGoalHandle
from rclpy.duration import Duration
from rclpy.impl.rcutils_logger import RcutilsLogger
from rclpy.task import Future
from rclpy.time import Time
from trajectory_msgs.msg import JointTrajectoryPoint

from course_lib.errors import CourseError
from course_lib.robots.spline import Floats

Result = FollowJointTrajectory.Result
ERASED = -1.0  # a tolerance of any size; 0 is that of the controller, and this one has none


@dataclass(frozen=True)
class End:
    """How a goal ends: its code, what the client is told, what is logged."""

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
    """One goal, from its start to its end; tolerances are those of positions.

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
        """Say how it ends now, if it does: error is desired - actual, late [s] is since the planned end."""
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
        """Come to an end, and let the client know."""
        (self.handle.succeed if end is REACHED else self.handle.abort)()
        self.result.set_result(Result(error_code=end.code, error_string=end.says))

    def cancel(self) -> None:
        """Come to the end that the client asked for."""
        self.handle.canceled()
        self.result.set_result(Result())

    def report(self, now: Time, desired: Floats, actual: Floats) -> None:
        """Tell the client how far it is; desired and actual have positions, then velocities."""
        feedback = FollowJointTrajectory.Feedback(joint_names=list(self._joints))
        feedback.header.stamp = now.to_msg()
        for name, state in (("desired", desired), ("actual", actual), ("error", desired - actual)):
            setattr(feedback, name, JointTrajectoryPoint(positions=state[0], velocities=state[1]))
        self.handle.publish_feedback(feedback)


def _tolerances(field: str, given: Iterable[JointTolerance], joints: Sequence[str]) -> Floats:
    """The tolerances of all joints, [rad] or [m], infinite if there is none."""
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
