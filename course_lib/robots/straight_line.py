"""Straight lines: a trajectory of all joints that takes a link along a line."""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from rclpy.duration import Duration
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.errors import CourseError
from course_lib.robots.inverse_kinematics import joints_for
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import Robot

STEP = 0.1  # [s] between two points of the trajectory


def straight_line(
    robot: Robot, link: str, start: Mapping[str, float], goal: npt.ArrayLike, *, seconds: float
) -> JointTrajectory:
    """Return the trajectory that takes a link along a straight line, and does not turn it.

    It speeds up for the first half and slows down for the second one, as a cubic.

    Args:
        robot: What `load_robot` returns; all of its joints have one number.
        link: The link's name.
        start: Where the joints are, by name, [rad].
        goal: Where the link is to go, a point in the root link, shape (3,), [m].
        seconds: How long that takes.

    Raises:
        CourseError: If an argument is none, a part of the line is out of reach, or a joint would be too fast.
    """
    poses = link_poses(robot, start)
    if link not in poses or not seconds > 0 or np.shape(goal) != (3,):
        raise CourseError(
            f"{link=}, {goal=}, {seconds=}: give a link of {robot.name!r}, a point, and a time [s]."
        )
    pose = poses[link]
    begin, way = pose[:3, 3].copy(), np.asarray(goal, float) - pose[:3, 3]
    times = np.linspace(0.0, seconds, max(2, round(seconds / STEP) + 1))
    joints = [dict(start)]
    for portion in times[1:] / seconds:
        pose[:3, 3] = begin + way * portion**2 * (3 - 2 * portion)
        joints.append(joints_for(robot, link, pose, joints[-1]))
    names = list(joints[-1])
    positions = np.array([[one.get(name, 0.0) for name in names] for one in joints])
    velocities = np.gradient(positions, times, axis=0)
    velocities[[0, -1]] = 0.0
    _check(names, velocities, robot.model.velocityLimit)
    return JointTrajectory(
        joint_names=names,
        points=[
            JointTrajectoryPoint(
                positions=position, velocities=velocity, time_from_start=Duration(seconds=time).to_msg()
            )
            for position, velocity, time in zip(positions, velocities, times.tolist(), strict=True)
        ],
    )


def _check(names: list[str], velocities: npt.NDArray[np.float64], limits: npt.NDArray[np.float64]) -> None:
    fastest = np.abs(velocities).max(axis=0)
    for name, speed, limit in zip(names, fastest, limits, strict=True):
        if speed > limit:
            raise CourseError(
                f"On this line {name} would move at {speed:.2f} rad/s, its limit is {limit:.2f}. Give it "
                "more seconds, or take another line."
            )
