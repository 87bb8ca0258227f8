"""Inverse kinematics: joints for a pose of a link, and along a straight line."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from rclpy.duration import Duration
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.arrays import Floats
from course_lib.errors import CourseError
from course_lib.robots.kinematics import configuration, link_poses
from course_lib.robots.robot import Robot

if TYPE_CHECKING:
    import pinocchio as pin


ACCURACY = 1e-10  # [m], [rad]
STEPS, LONGEST_STEP = 200, 0.5  # [rad]
STARTS = 20  # the one given, then others by chance, always the same ones
STEP = 0.1  # [s] between two points of the trajectory


def joints_for(
    robot: Robot, link: str, transform_link_to_root: npt.ArrayLike, start: Mapping[str, float] | None = None
) -> dict[str, float]:
    """Return joint positions that bring a link to a pose.

    Damped least squares from `start` on, within the limits of all joints. Of several solutions it is one near
    `start`; if none is found from there, one from elsewhere.

    Args:
        robot: What `load_robot` returns; all of its joints have one number.
        link: The link's name.
        transform_link_to_root: Where it is to be, shape (4, 4), translation in [m].
        start: Positions by name, as `link_poses` takes them.

    Raises:
        CourseError: If the link does not exist, the pose is not rigid, or no solution was found; the message
            holds the distance of the best one.
    """
    import pinocchio as pin

    model, tries = robot.model, []
    if not model.existBodyName(link) or model.nq != len(model.names) - 1:
        raise CourseError(f"{robot.name!r} has no link {link!r}, or a joint that has more than one number.")
    goal, frame = pin.SE3(_checked(transform_link_to_root)), model.getFrameId(link)
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    random, positions = np.random.default_rng(0), configuration(robot, start or {})
    for _ in range(STARTS):
        positions, gap = _descend(model, frame, goal, positions)
        if np.abs(gap).max() < ACCURACY:
            return dict(zip(model.names[1:], map(float, positions), strict=True))
        tries.append(gap)
        positions = random.uniform(np.maximum(lower, -np.pi), np.minimum(upper, np.pi))
    near = min(tries, key=lambda gap: float(np.linalg.norm(gap)))
    meters, degrees = np.linalg.norm(near[:3]), np.degrees(np.linalg.norm(near[3:]))
    place = ", ".join(f"{value:.2f}" for value in goal.translation)
    raise CourseError(
        f"{link} cannot be brought to ({place}) m in {robot.tree.root}, turned as asked: the best that was "
        f"found is {meters:.2f} m and {degrees:.0f}° away. Ask for a place nearer to the arm, or drive."
    )


def _checked(transform: npt.ArrayLike) -> Floats:
    pose = np.array(transform, float)
    if pose.shape != (4, 4) or not np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-6):
        raise CourseError(f"The pose {pose.tolist()} is not a rigid transform of shape (4, 4), link to root.")
    return pose


def _descend(model: "pin.Model", frame: int, goal: "pin.SE3", positions: Floats) -> tuple[Floats, Floats]:
    """Step towards a goal; return the last positions and the remaining motion, shape (6,)."""
    import pinocchio as pin

    data = model.createData()
    for _ in range(STEPS):
        pin.framesForwardKinematics(model, data, positions)
        missing = data.oMf[frame].actInv(goal)
        gap = pin.log6(missing).vector
        if np.abs(gap).max() < ACCURACY:
            break
        jacobian = pin.Jlog6(missing.inverse()) @ pin.computeFrameJacobian(model, data, positions, frame)
        damping = (0.01 * gap @ gap + 1e-12) * np.eye(6)
        step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping, gap)
        step *= min(1.0, LONGEST_STEP / np.abs(step).max())
        positions = np.clip(positions + step, model.lowerPositionLimit, model.upperPositionLimit)
    return positions, gap


def straight_line(
    robot: Robot, link: str, start: Mapping[str, float], goal: npt.ArrayLike, *, seconds: float
) -> JointTrajectory:
    """Return the trajectory that moves a link along a straight line without a turn.

    It speeds up for the first half and slows down for the second one, as a cubic.

    Args:
        robot: What `load_robot` returns; all of its joints have one number.
        link: The link's name.
        start: Where the joints are, by name, [rad].
        goal: Where the link is to go, a point in the root link, shape (3,), [m].
        seconds: How long that takes.

    Raises:
        CourseError: If an argument is wrong, the line leaves the reach, or a joint would be too fast.
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
    return _trajectory(joints, times, robot.model.velocityLimit)


def _trajectory(joints: Sequence[Mapping[str, float]], times: Floats, limits: Floats) -> JointTrajectory:
    """Return joint positions at times [s] as a trajectory that starts and ends at rest."""
    names = list(joints[-1])
    positions = np.array([[one.get(name, 0.0) for name in names] for one in joints])
    velocities = np.gradient(positions, times, axis=0)
    velocities[[0, -1]] = 0.0
    _check_speed(names, velocities, limits)
    points = [
        JointTrajectoryPoint(
            positions=position, velocities=velocity, time_from_start=Duration(seconds=time).to_msg()
        )
        for position, velocity, time in zip(positions, velocities, times.tolist(), strict=True)
    ]
    return JointTrajectory(joint_names=names, points=points)


def _check_speed(names: list[str], velocities: Floats, limits: Floats) -> None:
    fastest = np.abs(velocities).max(axis=0)
    for name, speed, limit in zip(names, fastest, limits, strict=True):
        if speed > limit:
            raise CourseError(
                f"On this line {name} would move at {speed:.2f} rad/s, its limit is {limit:.2f}. Give it "
                "more seconds, or take another line."
            )
