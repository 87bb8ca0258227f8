"""Rigid motions, forward kinematics and inverse kinematics.

Twists have their linear part first: shape (6,), [m/s] and [rad/s]. The kinematics use numpy only,
because Pinocchio cannot be installed everywhere. The joints of a robot are combined into arrays
once per robot (`Motions`), so that the poses of all joints need a few operations of numpy.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate
from math import isfinite, sin, tan
from numbers import Real

import numpy as np
import numpy.typing as npt
from rclpy.duration import Duration
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from transforms3d.quaternions import mat2quat

from course_lib.arrays import Bools, Floats, Matrix
from course_lib.errors import CourseError, did_you_mean
from course_lib.robots.robot import Robot
from course_lib.robots.urdf import MOVING, Joint, Urdf

# Angle [rad] below which series are exact to the last bits, while quotients lose digits.
_SMALL = 1e-3

_CROSSED = np.array(
    [[0, 0, 0, 0, 0, -1, 0, 1, 0], [0, 0, 1, 0, 0, 0, -1, 0, 0], [0, -1, 0, 1, 0, 0, 0, 0, 0.0]]
)


def cross_matrices(vector: Floats) -> Matrix:
    """Return the cross-product matrices, shape (…, 3, 3), of vectors, shape (…, 3)."""
    matrices: Matrix = (vector @ _CROSSED).reshape(*vector.shape, 3)
    return matrices


def inverse(transform: Matrix) -> Matrix:
    """Return the inverse of a rigid transform, shape (4, 4)."""
    inverted = np.eye(4)
    inverted[:3, :3] = transform[:3, :3].T
    inverted[:3, 3] = -transform[:3, :3].T @ transform[:3, 3]
    return inverted


def motion_of(twist: Floats) -> Matrix:
    """Return the exponential of a twist: the rigid motion after one second, shape (4, 4)."""
    about = cross_matrices(twist[3:])
    angle = float(np.linalg.norm(twist[3:]))
    if angle < _SMALL:
        first, second, third = 1 - angle**2 / 6, 0.5 - angle**2 / 24, 1 / 6 - angle**2 / 120
    else:
        first = sin(angle) / angle
        second, third = 2 * sin(angle / 2) ** 2 / angle**2, (1 - first) / angle**2
    motion = np.eye(4)
    motion[:3, :3] += first * about + second * about @ about
    motion[:3, 3] = twist[:3] + second * about @ twist[:3] + third * about @ about @ twist[:3]
    return motion


def twist_of(motion: Matrix) -> Floats:
    """Return the logarithm of a motion, shape (4, 4): the twist of at most half a turn in one second."""
    rotation = motion[:3, :3]
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    sine_axis = np.array([zy - yz, xz - zx, yx - xy]) / 2
    sine, cosine = float(np.linalg.norm(sine_axis)), (xx + yy + zz - 1) / 2
    angle = np.arctan2(sine, cosine)
    # The axis of the rotation times its angle [rad].
    turn: Floats
    if cosine > 0:
        turn = sine_axis * (angle / sine if sine else 1.0)
    else:
        # Near half a turn the axis is computed from the symmetric part: (1 - cosine) axis axisᵀ +
        # cosine I.
        square = (rotation + rotation.T) / 2 - cosine * np.eye(3)
        column = square[:, np.argmax(np.diag(square))]
        turn = column / np.linalg.norm(column) * (angle if column @ sine_axis >= 0 else -angle)
    angle = float(np.linalg.norm(turn))
    if angle < _SMALL:
        along, across = 1 - angle**2 / 12, 1 / 12 + angle**2 / 720
    else:
        along = angle / 2 / tan(angle / 2)
        across = (1 - along) / angle**2
    way = motion[:3, 3]
    return np.concatenate([along * way - cross_matrices(turn) @ way / 2 + across * (turn @ way) * turn, turn])


def twist_jacobian(twist: Floats) -> Matrix:
    """Return the derivative of a motion's twist with respect to a small prior twist, shape (6, 6).

    It is the inverse of the left Jacobian of SE(3), as a polynomial of the twist's adjoint.
    """
    adjoint = np.zeros((6, 6))
    adjoint[:3, :3] = adjoint[3:, 3:] = cross_matrices(twist[3:])
    adjoint[:3, 3:] = cross_matrices(twist[:3])
    square, angle = adjoint @ adjoint, float(np.linalg.norm(twist[3:]))
    # The factors of the adjoint's second and fourth power follow from x / 2 cot(x / 2) and its
    # derivative. Near 0 the quotients lose digits, so the series are used.
    if angle < 0.1:
        second, fourth = 1 / 12 - angle**4 / 30240, -1 / 720 - angle**2 / 15120
    else:
        half = angle / 2
        value = half / tan(half)
        # The derivative with respect to the square of the angle.
        slope = (1 / tan(half) - half / sin(half) ** 2) / (8 * half)
        fourth = float(1 + angle**2 * slope - value) / angle**4
        second = 2 * angle**2 * fourth - float(slope)
    return np.eye(6) - adjoint / 2 + second * square + fourth * square @ square


# Offsets that prefer x, then y, so that rounding does not decide between equal components.
_EARLIER = np.array([2e-12, 1e-12, 0.0])


@dataclass(frozen=True, eq=False)
class Motions:
    """The joints of a tree as arrays, in which parents precede children.

    At position p, a joint's transform from child to parent is `still + sin(p) sines + (1 - cos(p))
    cosines + p slides`. Its quaternion is `cos(p / 2) quaternions[0] + sin(p / 2) quaternions[1]`,
    with p = 0 for joints that do not turn.

    Args:
        joints: The n joints.
        numbers: The index of each joint by its name.
        above: For each joint the index of the joint that moves its parent, or -1; shape (n,).
        still, sines, cosines, slides: Terms of the transforms, shape (n, 4, 4).
        quaternions: (x, y, z, w), shape (2, n, 4).
        turns: Whether each joint turns, shape (n,).
        axes: Axes of rotation or translation in the child; zero for fixed joints; shape (n, 3).
    """

    joints: tuple[Joint, ...]
    numbers: Mapping[str, int]
    above: tuple[int, ...]
    still: Matrix
    sines: Matrix
    cosines: Matrix
    slides: Matrix
    quaternions: Floats
    turns: Bools
    axes: Floats

    def steps(self, positions: Floats) -> Matrix:
        """Return transform_child_to_parent of all joints, shape (n, 4, 4)."""
        p = positions[:, None, None]
        return self.still + np.sin(p) * self.sines + (1 - np.cos(p)) * self.cosines + p * self.slides


@lru_cache(maxsize=32)
def motions_of(tree: Urdf) -> Motions:
    """Return the arrays of a tree's joints."""
    joints = tuple(tree.joints_from_root())
    number = {joint.child: index for index, joint in enumerate(joints)}
    zero_transforms = np.array([joint.transform_joint_to_parent for joint in joints]).reshape(-1, 4, 4)
    turns = np.array([joint.kind in ("revolute", "continuous") for joint in joints], dtype=bool)
    slide = np.array([joint.kind == "prismatic" for joint in joints], dtype=bool)
    # A zero axis is left unchanged.
    units = [np.array(joint.axis) / (np.linalg.norm(joint.axis) or 1.0) for joint in joints]
    axes = np.array(units).reshape(-1, 3) * (turns | slide)[:, None]
    about, along = (
        zero_transforms[:, :3, :3] @ cross_matrices(axes),
        zero_transforms[:, :3, :3] @ axes[:, :, None],
    )
    sines, cosines, slides = np.zeros((3, len(joints), 4, 4))
    sines[turns, :3, :3] = about[turns]
    cosines[turns, :3, :3] = (about @ cross_matrices(axes))[turns]
    slides[slide, :3, 3] = along[slide, :, 0]
    above = tuple(number.get(joint.parent, -1) for joint in joints)
    numbers = {joint.name: index for index, joint in enumerate(joints)}
    at_0 = np.array([np.roll(mat2quat(transform[:3, :3]), -1) for transform in zero_transforms]).reshape(
        -1, 4
    )
    quarter_turns = np.empty_like(at_0)
    quarter_turns[:, :3] = at_0[:, 3:] * axes + np.cross(at_0[:, :3], axes)
    quarter_turns[:, 3] = -np.sum(at_0[:, :3] * axes, axis=1)
    quaternions = np.array([at_0, quarter_turns])
    return Motions(joints, numbers, above, zero_transforms, sines, cosines, slides, quaternions, turns, axes)


def link_poses(robot: Robot, positions: Mapping[str, float] | None = None) -> dict[str, Floats]:
    """Return the poses of all links.

    Args:
        robot: A robot from `load_robot`.
        positions: Joint positions by name, [rad], or [m] for prismatic joints. Other joints are at
            0, and mimic joints follow theirs.

    Returns:
        transform_link_to_root of each link, shape (4, 4). The root is the link without a parent.

    Raises:
        CourseError: A joint does not exist or has more than one degree of freedom, or a position is
            not finite.

    Example:
        >>> from course_lib.robots import load_robot
        >>> positions = {"shoulder_lift_joint": -1.0, "elbow_joint": 1.5}
        >>> poses = link_poses(load_robot("ur10"), positions)
        >>> poses["tool0"][:3, 3].round(2)
        array([0.78, 0.26, 0.27])
    """
    motions = motions_of(robot.tree)
    poses: list[Matrix] = []
    for above, step in zip(motions.above, motions.steps(configuration(robot, positions or {})), strict=True):
        poses.append(step if above < 0 else poses[above] @ step)
    return {robot.tree.root: np.eye(4)} | {
        joint.child: pose for joint, pose in zip(motions.joints, poses, strict=True)
    }


def configuration(robot: Robot, positions: Mapping[str, float]) -> Floats:
    """Return all joint positions, in the order of the robot's `Motions`; see `link_poses`."""
    tree, joints = robot.tree, motions_of(robot.tree).joints
    movable = {joint.name: joint for joint in tree.joints.values() if joint.kind in MOVING}
    for name, position in positions.items():
        if name not in movable:
            suggestion = did_you_mean(str(name), list(movable)) or "."
            raise CourseError(
                f"{robot.name!r} has no movable joint {name!r}{suggestion} "
                f"Movable joints: {', '.join(movable)}."
            )
        if not isinstance(position, Real) or not isfinite(position):
            unit = movable[name].unit
            raise CourseError(
                f"Joint {name!r} got position {position!r}, expected a finite number, [{unit}]."
            )
    values = np.zeros(len(joints))
    for index, joint in enumerate(joints):
        if joint.kind in MOVING:
            follow = tree.resolve_mimic(joint)
            mimicked = positions.get(follow.joint, 0.0) * follow.factor + follow.offset
            values[index] = positions.get(joint.name, mimicked)
    return values


def joint_poses(tree: Urdf, positions: Mapping[str, float]) -> dict[str, Floats]:
    """Return the poses of child links in their parents: x, y, z [m], quaternion (x, y, z, w).

    Args:
        tree: The robot.
        positions: Positions of the requested joints, [rad] or [m]. One that is not finite results
            in NaN.
    """
    motions = motions_of(tree)
    rows = np.array([motions.numbers[name] for name in positions], dtype=np.intp)
    p = np.array([*positions.values()], dtype=float)[:, None]
    p[~np.isfinite(p)] = np.nan
    half = np.where(motions.turns[rows, None], p / 2, 0.0)
    at_0, quarter_turns = motions.quaternions[:, rows]
    poses = np.empty((len(rows), 7))
    poses[:, :3] = motions.still[rows, :3, 3] + p * motions.slides[rows, :3, 3]
    poses[:, 3:] = match_matrix_signs(np.cos(half) * at_0 + np.sin(half) * quarter_turns)
    return dict(zip(positions, poses, strict=True))


def match_matrix_signs(quaternions: Floats) -> Floats:
    """Return quaternions (x, y, z, w), shape (n, 4), with the sign that KDL chooses for matrices.

    Up to a turn of 120°, w is positive. Beyond it, the largest other component is positive; of
    equal ones, the last.
    """
    largest = np.argmax(np.abs(quaternions[:, :3]) - _EARLIER, axis=1)
    leading = np.where(np.abs(quaternions[:, 3]) > 0.5, 3, largest)
    signs = np.copysign(1.0, quaternions[np.arange(len(quaternions)), leading])
    signed: Floats = quaternions * signs[:, None]
    return signed


# Accuracy of a solution, in [m] and [rad].
ACCURACY = 1e-10
# Maximum number of steps, and the longest step [rad].
STEPS, LONGEST_STEP = 200, 0.5
# Number of starts: the given one, then random ones, which are the same in every call.
STARTS = 20
# Time between two points of the trajectory [s].
STEP = 0.1


def joints_for(
    robot: Robot,
    link: str,
    transform_link_to_root: npt.ArrayLike,
    start: Mapping[str, float] | None = None,
) -> dict[str, float]:
    """Return joint positions that bring a link to a pose.

    The solver uses damped least squares within the limits of all joints. It returns a solution near
    `start` or, if it finds none from there, from another start.

    Args:
        robot: A robot from `load_robot`. Joints with more than one degree of freedom do not move.
        link: The link's name.
        transform_link_to_root: The desired pose, shape (4, 4), translation in [m].
        start: Positions by name, as for `link_poses`.

    Raises:
        CourseError: The link does not exist, the pose is not rigid, or no solution was found. The
            message contains the distance of the best result.

    Example:
        >>> from course_lib.robots import load_robot
        >>> robot = load_robot("ur10")
        >>> goal = link_poses(robot, {"shoulder_lift_joint": -1.0, "elbow_joint": 1.5})["tool0"]
        >>> joints = joints_for(robot, "tool0", goal)
        >>> bool(abs(link_poses(robot, joints)["tool0"] - goal).max() < 0.01)
        True
    """
    arm = arm_of(robot, link)
    goal, tries = np.array(transform_link_to_root, float), []
    if goal.shape != (4, 4) or not np.allclose(goal[:3, :3] @ goal[:3, :3].T, np.eye(3), atol=1e-6):
        raise CourseError(f"The pose {goal.tolist()} is not a rigid transform of shape (4, 4), link to root.")
    random, positions = np.random.default_rng(0), arm.with_mimic_joints(configuration(robot, start or {}))
    lower, upper = (
        np.maximum(arm.lower, -np.pi)[arm.driving_joints],
        np.minimum(arm.upper, np.pi)[arm.driving_joints],
    )
    for _ in range(STARTS):
        positions, gap = _iterate(arm, goal, positions)
        if np.abs(gap).max() < ACCURACY:
            named_positions = zip(arm.motions.joints, map(float, positions), strict=True)
            return {joint.name: position for joint, position in named_positions if joint.kind in MOVING}
        tries.append(gap)
        positions[arm.driving_joints] = random.uniform(lower, upper)
        positions = arm.with_mimic_joints(positions)
    smallest_gap = min(tries, key=lambda gap: float(np.linalg.norm(gap)))
    meters, degrees = np.linalg.norm(smallest_gap[:3]), np.degrees(np.linalg.norm(smallest_gap[3:]))
    place = ", ".join(f"{value:.2f}" for value in goal[:3, 3])
    raise CourseError(
        f"{link} cannot reach ({place}) m in {robot.tree.root}, with this rotation: the "
        f"best pose found is {meters:.2f} m and {degrees:.0f}° away. Choose a pose closer to the "
        "arm, or drive there."
    )


@dataclass(frozen=True, eq=False)
class Arm:
    """The joints between the root and a link.

    Args:
        motions: The robot's n joints.
        chain: The indices of the joints between the root and the link, in this order.
        driving_joints: The indices of joints that determine the chain's positions: the joints
            themselves, or the joints that they mimic.
        lower, upper: Limits of all positions, shape (n,), [rad] or [m]. Those of mimic joints are
            not used.
        factors, offsets: The positions of all joints are `factors @ positions + offsets`, where
            columns of mimic joints are 0; shapes (n, n) and (n,).
    """

    motions: Motions
    chain: list[int]
    driving_joints: list[int]
    lower: Floats
    upper: Floats
    factors: Matrix
    offsets: Floats

    def with_mimic_joints(self, positions: Floats) -> Floats:
        """Return the positions with mimic joints set from the joints that they follow."""
        with_mimic_joints: Floats = self.factors @ positions + self.offsets
        return with_mimic_joints

    def poses(self, positions: Floats) -> Matrix:
        """Return the poses of the root and the chain's children in the root, shape (1 + its length, 4, 4)."""
        steps = self.motions.steps(positions)[self.chain]
        return np.array(list(accumulate(steps, np.matmul, initial=np.eye(4))))

    def jacobian(self, poses: Matrix) -> Matrix:
        """Return the Jacobian: the link's twist, in the link's frame, per joint velocity, shape (6, n)."""
        jacobian, turns = np.zeros((6, len(self.motions.joints))), self.motions.turns[self.chain, None]
        axes = (poses[1:, :3, :3] @ self.motions.axes[self.chain, :, None])[:, :, 0]
        arms = poses[-1, :3, 3] - poses[1:, :3, 3]
        ways = np.where(turns, (cross_matrices(axes) @ arms[:, :, None])[:, :, 0], axes)
        jacobian[:3, self.chain] = (ways @ poses[-1, :3, :3]).T
        jacobian[3:, self.chain] = (np.where(turns, axes, 0.0) @ poses[-1, :3, :3]).T
        return jacobian


def arm_of(robot: Robot, link: str) -> Arm:
    """Return the joints between the root and a link, or raise a CourseError for an unknown link."""
    motions = motions_of(robot.tree)
    ends = {joint.child: index for index, joint in enumerate(motions.joints)}
    if link not in ends and link != robot.tree.root:
        raise CourseError(
            f"{robot.name!r} has no link {link!r}. Its links: {', '.join([robot.tree.root, *ends])}."
        )
    chain, at = list[int](), ends.get(link, -1)
    while at >= 0:
        chain.insert(0, at)
        at = motions.above[at]
    limits = np.array(
        [
            (-np.inf, np.inf)
            if joint.kind == "continuous"
            else (joint.limits.get("lower", 0.0), joint.limits.get("upper", 0.0))
            for joint in motions.joints
        ]
    ).reshape(-1, 2)
    # The matrix and the offsets compute mimic joints from the joints that they follow.
    factors, offsets = np.eye(len(motions.joints)), np.zeros(len(motions.joints))
    for number, joint in enumerate(motions.joints):
        follow = robot.tree.resolve_mimic(joint)
        if joint.kind in MOVING and follow.joint != joint.name:
            leads = robot.tree.joints[follow.joint].kind in MOVING
            factors[number, number] = 0.0
            factors[number, motions.numbers[follow.joint]] = follow.factor if leads else 0.0
            offsets[number] = follow.offset
    driven_joints = [int(joint) for number in chain for joint in np.flatnonzero(factors[number])]
    return Arm(
        motions, chain, list(dict.fromkeys(driven_joints)), limits[:, 0], limits[:, 1], factors, offsets
    )


def _iterate(arm: Arm, goal: Matrix, positions: Floats) -> tuple[Floats, Floats]:
    """Iterate from positions towards a goal.

    Returns:
        The last positions and the remaining twist, shape (6,).
    """
    for _ in range(STEPS):
        poses = arm.poses(positions)
        gap = twist_of(inverse(poses[-1]) @ goal)
        if np.abs(gap).max() < ACCURACY:
            break
        jacobian = twist_jacobian(gap) @ arm.jacobian(poses) @ arm.factors
        damping = (0.01 * gap @ gap + 1e-12) * np.eye(6)
        step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping, gap)
        step *= LONGEST_STEP / np.abs(step).max(initial=LONGEST_STEP)
        positions = arm.with_mimic_joints(np.clip(positions + step, arm.lower, arm.upper))
    return positions, gap


def straight_line(
    robot: Robot, link: str, start: Mapping[str, float], goal: npt.ArrayLike, *, seconds: float
) -> JointTrajectory:
    """Return the trajectory that moves a link along a straight line without turning it.

    The link accelerates in the first half and decelerates in the second half, as a cubic.

    Args:
        robot: A robot from `load_robot`. Joints with more than one degree of freedom do not move.
        link: The link's name.
        start: Initial joint positions by name, [rad].
        goal: The final position in the root link, shape (3,), [m].
        seconds: Duration of the motion.

    Raises:
        CourseError: An argument is invalid, a point of the line is out of reach, or a joint would
            be too fast.

    Example:
        >>> from course_lib.robots import load_robot
        >>> robot, start = load_robot("ur10"), {"shoulder_lift_joint": -1.0, "elbow_joint": 1.5}
        >>> goal = link_poses(robot, start)["tool0"][:3, 3] + (0.0, 0.0, 0.1)
        >>> trajectory = straight_line(robot, "tool0", start, goal, seconds=2.0)
        >>> trajectory.points[-1].time_from_start.sec
        2
    """
    poses = link_poses(robot, start)
    if link not in poses or not seconds > 0 or np.shape(goal) != (3,):
        raise CourseError(
            f"{link=}, {goal=}, {seconds=}: expected a link of {robot.name!r}, a point, and a time [s]."
        )
    pose = poses[link]
    begin, way = pose[:3, 3].copy(), np.asarray(goal, float) - pose[:3, 3]
    times = np.linspace(0.0, seconds, max(2, round(seconds / STEP) + 1))
    joints = [dict(start)]
    for portion in times[1:] / seconds:
        pose[:3, 3] = begin + way * portion**2 * (3 - 2 * portion)
        joints.append(joints_for(robot, link, pose, joints[-1]))
    # Controllers accept no commands for mimic joints.
    names = [name for name in joints[-1] if not robot.tree.joints[name].mimic]
    positions = np.array([[values.get(name, 0.0) for name in names] for values in joints])
    velocities = np.gradient(positions, times, axis=0)
    velocities[[0, -1]] = 0.0
    for name, speed in zip(names, np.abs(velocities).max(axis=0), strict=True):
        limit = robot.tree.joints[name].velocity
        if speed > limit:
            raise CourseError(
                f"On this line {name} would move at {speed:.2f} rad/s, but its limit is "
                f"{limit:.2f}. Give it more time, or choose another line."
            )
    points = [
        JointTrajectoryPoint(
            positions=position, velocities=velocity, time_from_start=Duration(seconds=time).to_msg()
        )
        for position, velocity, time in zip(positions, velocities, times.tolist(), strict=True)
    ]
    return JointTrajectory(joint_names=names, points=points)
