"""Inverse kinematics: joints for a pose of a link, and along a straight line."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
import numpy.typing as npt
from rclpy.duration import Duration
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.arrays import Floats, Matrix
from course_lib.errors import CourseError
from course_lib.robots.kinematics import Motions, configuration, link_poses, motions_of
from course_lib.robots.rigid_motions import crossed, inverse, twist_jacobian, twist_of
from course_lib.robots.robot import Robot
from course_lib.robots.urdf import MOVING, Joint, Urdf

ACCURACY = 1e-10  # [m], [rad]
STEPS, LONGEST_STEP = 200, 0.5  # [rad]
STARTS = 20  # the one given, then others by chance, always the same ones
STEP = 0.1  # [s] between two points of the trajectory


def joints_for(
    robot: Robot, link: str, transform_link_to_root: npt.ArrayLike, start: Mapping[str, float] | None = None
) -> dict[str, float]:
    """Return joint positions that bring a link to a pose.

    Damped least squares from `start` on, within the limits of all joints. Of several solutions it is one near
    `start`; if none is found from there, one from elsewhere. Mimic joints stand where their joint puts them.

    Args:
        robot: What `load_robot` returns; joints that one number does not place stand still.
        link: The link's name.
        transform_link_to_root: Where it is to be, shape (4, 4), translation in [m].
        start: Positions by name, as `link_poses` takes them.

    Raises:
        CourseError: If the link does not exist, the pose is not rigid, or no solution was found; the message
            holds the distance of the best one.
    """
    arm = arm_of(robot, link)
    goal, tries = _checked(transform_link_to_root), []
    random, positions = np.random.default_rng(0), arm.settled(configuration(robot, start or {}))
    lower, upper = np.maximum(arm.lower, -np.pi)[arm.driven], np.minimum(arm.upper, np.pi)[arm.driven]
    for _ in range(STARTS):
        positions, gap = _descend(arm, goal, positions)
        if np.abs(gap).max() < ACCURACY:
            found = zip(arm.motions.joints, map(float, positions), strict=True)
            return {joint.name: position for joint, position in found if joint.kind in MOVING}
        tries.append(gap)
        positions[arm.driven] = random.uniform(lower, upper)
        positions = arm.settled(positions)
    near = min(tries, key=lambda gap: float(np.linalg.norm(gap)))
    meters, degrees = np.linalg.norm(near[:3]), np.degrees(np.linalg.norm(near[3:]))
    place = ", ".join(f"{value:.2f}" for value in goal[:3, 3])
    raise CourseError(
        f"{link} cannot be brought to ({place}) m in {robot.tree.root}, turned as asked: the best that was "
        f"found is {meters:.2f} m and {degrees:.0f}° away. Ask for a place nearer to the arm, or drive."
    )


def _checked(transform: npt.ArrayLike) -> Floats:
    pose = np.array(transform, float)
    if pose.shape != (4, 4) or not np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3), atol=1e-6):
        raise CourseError(f"The pose {pose.tolist()} is not a rigid transform of shape (4, 4), link to root.")
    return pose


@dataclass(frozen=True, eq=False)
class Arm:
    """The joints between the root and a link.

    Args:
        motions: Of the robot's n joints.
        chain: The numbers of the joints that carry the link, the last one at the link.
        driven: The numbers of the joints that move these: themselves, or those that they mimic.
        lower, upper: Limits of all positions, shape (n,), [rad] or [m]; those of mimic joints do not count.
        factors, offsets: The positions of all joints are `factors @ positions + offsets`, where columns of
            mimic joints are 0; shapes (n, n) and (n,).
    """

    motions: Motions
    chain: list[int]
    driven: list[int]
    lower: Floats
    upper: Floats
    factors: Matrix
    offsets: Floats

    def settled(self, positions: Floats) -> Floats:
        """Return positions with mimic joints where their joints put them."""
        settled: Floats = self.factors @ positions + self.offsets
        return settled

    def poses(self, positions: Floats) -> Matrix:
        """Return the poses of the root and the chain's children in the root, shape (1 + its length, 4, 4)."""
        steps = self.motions.steps(positions)[self.chain]
        return np.array(list(accumulate(steps, np.matmul, initial=np.eye(4))))

    def jacobian(self, poses: Matrix) -> Matrix:
        """Return the link's twist, in the link, by the joints' speeds; shape (6, n)."""
        found, turns = np.zeros((6, len(self.motions.joints))), self.motions.turns[self.chain, None]
        axes = (poses[1:, :3, :3] @ self.motions.axes[self.chain, :, None])[:, :, 0]
        arms = poses[-1, :3, 3] - poses[1:, :3, 3]
        ways = np.where(turns, (crossed(axes) @ arms[:, :, None])[:, :, 0], axes)
        found[:3, self.chain] = (ways @ poses[-1, :3, :3]).T
        found[3:, self.chain] = (np.where(turns, axes, 0.0) @ poses[-1, :3, :3]).T
        return found


def arm_of(robot: Robot, link: str) -> Arm:
    """Return what carries a link; raises a CourseError if there is no such link."""
    motions = motions_of(robot.tree)
    ends = {joint.child: index for index, joint in enumerate(motions.joints)}
    if link not in ends and link != robot.tree.root:
        raise CourseError(
            f"{robot.name!r} has no link {link!r}; there is {', '.join([robot.tree.root, *ends])}."
        )
    chain, at = list[int](), ends.get(link, -1)
    while at >= 0:
        chain.insert(0, at)
        at = motions.above[at]
    limits = np.array([_limits(joint) for joint in motions.joints]).reshape(-1, 2)
    factors, offsets = _mimicry(robot.tree, motions)
    driven = [int(one) for number in chain for one in np.flatnonzero(factors[number])]
    return Arm(motions, chain, list(dict.fromkeys(driven)), limits[:, 0], limits[:, 1], factors, offsets)


def _mimicry(tree: Urdf, motions: Motions) -> tuple[Matrix, Floats]:
    """Return the factors and offsets of an arm."""
    factors, offsets = np.eye(len(motions.joints)), np.zeros(len(motions.joints))
    for number, joint in enumerate(motions.joints):
        follow = tree.followed(joint)
        if joint.kind in MOVING and follow.joint != joint.name:
            leads = tree.joints[follow.joint].kind in MOVING
            factors[number, number] = 0.0
            factors[number, motions.numbers[follow.joint]] = follow.factor if leads else 0.0
            offsets[number] = follow.offset
    return factors, offsets


def _limits(joint: Joint) -> tuple[float, float]:
    if joint.kind == "continuous":
        return -np.inf, np.inf
    return joint.limits.get("lower", 0.0), joint.limits.get("upper", 0.0)


def _descend(arm: Arm, goal: Matrix, positions: Floats) -> tuple[Floats, Floats]:
    """Step towards a goal; return the last positions and the remaining twist, shape (6,)."""
    for _ in range(STEPS):
        poses = arm.poses(positions)
        gap = twist_of(inverse(poses[-1]) @ goal)
        if np.abs(gap).max() < ACCURACY:
            break
        jacobian = twist_jacobian(gap) @ arm.jacobian(poses) @ arm.factors
        damping = (0.01 * gap @ gap + 1e-12) * np.eye(6)
        step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping, gap)
        step *= LONGEST_STEP / np.abs(step).max(initial=LONGEST_STEP)
        positions = arm.settled(np.clip(positions + step, arm.lower, arm.upper))
    return positions, gap


def straight_line(
    robot: Robot, link: str, start: Mapping[str, float], goal: npt.ArrayLike, *, seconds: float
) -> JointTrajectory:
    """Return the trajectory that moves a link along a straight line without a turn.

    It speeds up for the first half and slows down for the second one, as a cubic.

    Args:
        robot: What `load_robot` returns; joints that one number does not place stand still.
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
    return _trajectory(robot, joints, times)


def _trajectory(robot: Robot, joints: Sequence[Mapping[str, float]], times: Floats) -> JointTrajectory:
    """Return joint positions at times [s] as a trajectory that starts and ends at rest.

    Controllers take no commands for mimic joints, so it has none.
    """
    names = [name for name in joints[-1] if not robot.tree.joints[name].mimic]
    positions = np.array([[one.get(name, 0.0) for name in names] for one in joints])
    velocities = np.gradient(positions, times, axis=0)
    velocities[[0, -1]] = 0.0
    limits = [robot.tree.joints[name].velocity for name in names]
    _check_speed(names, velocities, limits)
    points = [
        JointTrajectoryPoint(
            positions=position, velocities=velocity, time_from_start=Duration(seconds=time).to_msg()
        )
        for position, velocity, time in zip(positions, velocities, times.tolist(), strict=True)
    ]
    return JointTrajectory(joint_names=names, points=points)


def _check_speed(names: list[str], velocities: Floats, limits: Sequence[float]) -> None:
    fastest = np.abs(velocities).max(axis=0)
    for name, speed, limit in zip(names, fastest, limits, strict=True):
        if speed > limit:
            raise CourseError(
                f"On this line {name} would move at {speed:.2f} rad/s, its limit is {limit:.2f}. Give it "
                "more seconds, or take another line."
            )
