"""Forward kinematics: poses of links."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import isfinite
from numbers import Real

import numpy as np
from transforms3d.quaternions import mat2quat

from course_lib.arrays import Bools, Floats, Matrix
from course_lib.errors import CourseError, did_you_mean
from course_lib.robots.rigid_motions import crossed
from course_lib.robots.robot import Robot
from course_lib.robots.urdf import MOVING, Joint, Urdf

_EARLIER = np.array([2e-12, 1e-12, 0.0])  # how much smaller x and y count, so that rounding decides nothing


@dataclass(frozen=True, eq=False)
class Motions:
    """The joints of a tree in arrays, each joint after those above it.

    A joint at position p puts its child at `still + sin(p) sines + (1 - cos(p)) cosines + p slides` of its
    parent. The quaternion of that is `cos(p / 2) quaternions[0] + sin(p / 2) quaternions[1]`, with p = 0 for
    joints that do not turn.

    Args:
        joints: The joints; n is their number.
        numbers: Where a joint is among them, by its name.
        above: The number of the joint that moves the parent, -1 below the root, shape (n,).
        still, sines, cosines, slides: Shape (n, 4, 4).
        quaternions: (x, y, z, w), shape (2, n, 4).
        turns: Whether a joint turns, shape (n,).
        axes: Of turns and slides in the child, zero where a joint does neither, shape (n, 3).
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

    def chained(self, positions: Floats) -> list[Matrix]:
        """Return transform_child_to_root of all joints."""
        poses: list[Matrix] = []
        for above, step in zip(self.above, self.steps(positions), strict=True):
            poses.append(step if above < 0 else poses[above] @ step)
        return poses


@lru_cache(maxsize=32)
def motions_of(tree: Urdf) -> Motions:
    """Return the arrays of a tree's joints."""
    joints = tuple(tree.downward())
    number = {joint.child: index for index, joint in enumerate(joints)}
    still = np.array([joint.transform_joint_to_parent for joint in joints]).reshape(-1, 4, 4)
    turns, slide = (_are(joints, *kinds) for kinds in (("revolute", "continuous"), ("prismatic",)))
    axes = np.array([_unit(joint.axis) for joint in joints]).reshape(-1, 3) * (turns | slide)[:, None]
    about, along = still[:, :3, :3] @ crossed(axes), still[:, :3, :3] @ axes[:, :, None]
    sines, cosines, slides = np.zeros((3, len(joints), 4, 4))
    sines[turns, :3, :3] = about[turns]
    cosines[turns, :3, :3] = (about @ crossed(axes))[turns]
    slides[slide, :3, 3] = along[slide, :, 0]
    above = tuple(number.get(joint.parent, -1) for joint in joints)
    numbers = {joint.name: index for index, joint in enumerate(joints)}
    quaternions = _quaternions(still, axes)
    return Motions(joints, numbers, above, still, sines, cosines, slides, quaternions, turns, axes)


def _are(joints: Sequence[Joint], *kinds: str) -> Bools:
    return np.array([joint.kind in kinds for joint in joints], dtype=bool)


def _unit(axis: Sequence[float]) -> Floats:
    """Return an axis with length 1; one of length 0 as it is."""
    return np.array(axis) / (np.linalg.norm(axis) or 1.0)


def _quaternions(still: Matrix, axes: Floats) -> Floats:
    """Return the rotations of joints at 0, and these times half a turn about the axis."""
    at_0 = np.array([np.roll(mat2quat(transform[:3, :3]), -1) for transform in still]).reshape(-1, 4)
    turned = np.empty_like(at_0)
    turned[:, :3] = at_0[:, 3:] * axes + np.cross(at_0[:, :3], axes)
    turned[:, 3] = -np.sum(at_0[:, :3] * axes, axis=1)
    return np.array([at_0, turned])


def link_poses(robot: Robot, positions: Mapping[str, float] | None = None) -> dict[str, Floats]:
    """Return the poses of all links.

    Args:
        robot: What `load_robot` returns.
        positions: Joint positions by name, [rad], of prismatic joints [m]. Joints without one stand at 0,
            mimic joints where their joint puts them.

    Returns:
        For each link transform_link_to_root, shape (4, 4); root is the link that all others hang on.

    Raises:
        CourseError: If a joint does not exist or one number does not place it, or a position is not finite.
    """
    motions = motions_of(robot.tree)
    poses = motions.chained(configuration(robot, positions or {}))
    return {robot.tree.root: np.eye(4)} | {
        joint.child: pose for joint, pose in zip(motions.joints, poses, strict=True)
    }


def configuration(robot: Robot, positions: Mapping[str, float]) -> Floats:
    """Return the positions of all joints, see `link_poses`, in the order of the robot's `Motions`."""
    tree, joints = robot.tree, motions_of(robot.tree).joints
    movable = {joint.name: joint for joint in tree.joints.values() if joint.kind in MOVING}
    for name, position in positions.items():
        _check(robot.name, movable, name, position)
    values = np.zeros(len(joints))
    for index, joint in enumerate(joints):
        if joint.kind in MOVING:
            follow = tree.followed(joint)
            mimicked = positions.get(follow.joint, 0.0) * follow.factor + follow.offset
            values[index] = positions.get(joint.name, mimicked)
    return values


def joint_poses(tree: Urdf, positions: Mapping[str, float]) -> dict[str, Floats]:
    """Return the poses of child links in their parents: x, y, z [m], quaternion (x, y, z, w).

    Args:
        tree: The robot.
        positions: Of each joint that is asked for, [rad] or [m]; what is not finite gives NaN.
    """
    motions = motions_of(tree)
    rows = np.array([motions.numbers[name] for name in positions], dtype=np.intp)
    p = np.array([*positions.values()], dtype=float)[:, None]
    p[~np.isfinite(p)] = np.nan
    half = np.where(motions.turns[rows, None], p / 2, 0.0)
    at_0, turned = motions.quaternions[:, rows]
    poses = np.empty((len(rows), 7))
    poses[:, :3] = motions.still[rows, :3, 3] + p * motions.slides[rows, :3, 3]
    poses[:, 3:] = as_of_matrices(np.cos(half) * at_0 + np.sin(half) * turned)
    return dict(zip(positions, poses, strict=True))


def as_of_matrices(quaternions: Floats) -> Floats:
    """Return quaternions (x, y, z, w), shape (n, 4), with the sign that KDL gives those of matrices.

    There w is positive up to a turn of 120°, beyond it the largest of the others; of equal ones the last.
    """
    largest = np.argmax(np.abs(quaternions[:, :3]) - _EARLIER, axis=1)
    leading = np.where(np.abs(quaternions[:, 3]) > 0.5, 3, largest)
    signs = np.copysign(1.0, quaternions[np.arange(len(quaternions)), leading])
    signed: Floats = quaternions * signs[:, None]
    return signed


def _check(robot: str, movable: Mapping[str, Joint], name: str, position: object) -> None:
    if name not in movable:
        meant = did_you_mean(str(name), list(movable)) or "."
        raise CourseError(
            f"{robot!r} has no joint {name!r} that moves{meant} Those that do: {', '.join(movable)}."
        )
    if not isinstance(position, Real) or not isfinite(position):
        unit = movable[name].unit
        raise CourseError(f"Joint {name!r} got position {position!r}, expected a finite number, [{unit}].")
