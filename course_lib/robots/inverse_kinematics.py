"""Inverse kinematics: the joints that bring a link to a pose, by Pinocchio."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from course_lib.errors import CourseError
from course_lib.robots.kinematics import configuration
from course_lib.robots.robot import Robot

if TYPE_CHECKING:
    import pinocchio as pin

Floats = npt.NDArray[np.float64]

ACCURACY = 1e-10  # [m], [rad]
STEPS, LONGEST_STEP = 200, 0.5  # [rad]
STARTS = 20  # the one given, then others by chance, always the same ones


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
        CourseError: If there is no such link, the pose is none, or no solution was found; it says how near
            one comes.
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
        raise CourseError(f"The pose {pose.tolist()} is no rigid transform of shape (4, 4), link to root.")
    return pose


def _descend(model: "pin.Model", frame: int, goal: "pin.SE3", positions: Floats) -> tuple[Floats, Floats]:
    """Step towards a goal; returns where that ends, and the motion, shape (6,), that is still missing."""
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
