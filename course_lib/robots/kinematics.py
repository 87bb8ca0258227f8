"""Forward kinematics by Pinocchio: poses of links."""

from collections.abc import Mapping
from functools import lru_cache
from math import cos, isfinite, nan, sin
from numbers import Real
from typing import TYPE_CHECKING

from course_lib.arrays import Floats
from course_lib.errors import CourseError, did_you_mean
from course_lib.robots.robot import Robot
from course_lib.robots.urdf import MOVING, Urdf

if TYPE_CHECKING:
    import pinocchio as pin


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
    import pinocchio as pin

    model = robot.tree.model  # has all links, also those of which robot.model is rid
    data = model.createData()
    pin.framesForwardKinematics(model, data, configuration(robot, positions or {}, model))
    return {
        frame.name: transform_link_to_root.homogeneous
        for frame, transform_link_to_root in zip(model.frames, data.oMf, strict=True)
        if frame.type == pin.FrameType.BODY
    }


def configuration(robot: Robot, positions: Mapping[str, float], model: "pin.Model | None" = None) -> Floats:
    """Return joint positions, see `link_poses`, as a configuration of a model, shape (nq,)."""
    import pinocchio as pin

    tree, model = robot.tree, model or robot.model
    movable = {j.name: j for j in tree.joints.values() if j.kind in MOVING and model.existJointName(j.name)}
    for name, position in positions.items():
        _check(robot, list(movable), name, position)
    values: Floats = pin.neutral(model)
    for name, joint in movable.items():
        follow = tree.followed(joint)
        mimicked = positions.get(follow.joint, 0.0) * follow.factor + follow.offset
        _place(model, values, name, positions.get(name, mimicked))
    return values


def joint_poses(tree: Urdf, positions: Mapping[str, float]) -> dict[str, Floats]:
    """Return the poses of child links in their parents: x, y, z [m], quaternion (x, y, z, w).

    Args:
        tree: The robot.
        positions: Of each joint that is asked for, [rad] or [m]; what is not finite gives NaN.
    """
    import pinocchio as pin

    model, data, ends = tree.model, _data(tree), _ends(tree)
    values = pin.neutral(model)
    for name, position in positions.items():
        if tree.joints[name].kind in MOVING:
            _place(model, values, name, position if isfinite(position) else nan)
    pin.forwardKinematics(model, data, values)
    poses = {}
    for name in positions:
        number, joint_in_parent, child_in_joint = ends[name]
        motion = pin.SE3.Identity() if number is None else data.liMi[number]
        poses[name] = pin.SE3ToXYZQUAT(joint_in_parent * motion * child_in_joint)
    return poses


@lru_cache(maxsize=32)
def _data(tree: Urdf) -> "pin.Data":
    """Return the model's working memory, which each use overwrites."""
    return tree.model.createData()


@lru_cache(maxsize=32)
def _ends(tree: Urdf) -> "dict[str, tuple[int | None, pin.SE3, pin.SE3]]":
    """Return for each joint the number of the one that moves it, if any, and the placements of its ends."""
    import pinocchio as pin

    model, found = tree.model, {}
    for name, joint in tree.joints.items():
        parent, child = (
            model.frames[model.getFrameId(link, pin.FrameType.BODY)] for link in (joint.parent, joint.child)
        )
        moved_by = None if parent.parentJoint == child.parentJoint else child.parentJoint
        found[name] = moved_by, parent.placement.inverse(), pin.SE3(child.placement)
    return found


def _place(model: "pin.Model", values: Floats, name: str, position: float) -> None:
    """Write the position of a joint into a configuration."""
    joint = model.joints[model.getJointId(name)]
    # A joint without limits is a point on the unit circle.
    coordinates = (position,) if joint.nq == 1 else (cos(position), sin(position))
    values[joint.idx_q : joint.idx_q + joint.nq] = coordinates


def _check(robot: Robot, movable: list[str], name: str, position: object) -> None:
    if name not in movable:
        meant = did_you_mean(str(name), movable) or "."
        raise CourseError(
            f"{robot.name!r} has no joint {name!r} that moves{meant} Those that do: {', '.join(movable)}."
        )
    if not isinstance(position, Real) or not isfinite(position):
        unit = robot.tree.joints[name].unit
        raise CourseError(f"Joint {name!r} got position {position!r}, expected a finite number, [{unit}].")
