"""Compare kinematics with Pinocchio, from positions by name: `python tests/benchmarks/bench_kinematics.py`.

Processor time of each, the best of some rounds, and the kit's share of Pinocchio's time.
"""

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from course_lib.ros.programs.import_path import install

install()

from course_lib.robots.kinematics import (  # noqa: E402  # needs the stand-in's packages  # noqa: E402  # as above
    ACCURACY,
    LONGEST_STEP,
    joint_poses,
    joints_for,
    link_poses,
)
from course_lib.robots.mobile_manipulator import START, mobile_manipulator  # noqa: E402  # as above
from course_lib.robots.robot import load_robot  # noqa: E402  # as above
from course_lib.robots.urdf import MOVING  # noqa: E402  # as above
from tests.robots import by_pinocchio  # noqa: E402  # as above
from tests.robots.by_pinocchio import pin  # noqa: E402  # as above

ROBOTS = ("ur10", "go2", "talos")
WRIST = "ur10wrist_3_link"


def microseconds(work: Callable[[], object], times: int = 100) -> float:
    """Return the processor time of a call; the best of seven rounds."""
    work()
    rounds = []
    for _ in range(7):
        start = time.process_time()
        for _ in range(times):
            work()
        rounds.append((time.process_time() - start) / times * 1e6)
    return min(rounds)


def pinocchios_joint_poses(model: Any, parents: Mapping[str, str], positions: Mapping[str, float]) -> Any:
    """Return the poses of child links, by name, in their parents."""
    poses = by_pinocchio.link_poses(model, positions)
    return {child: pin.SE3ToXYZQUAT(poses[parent].actInv(poses[child])) for child, parent in parents.items()}


def pinocchios_joints_for(model: Any, goal: Any, positions: Any) -> Any:
    """Take the same steps as `joints_for`."""
    data, frame = model.createData(), model.getFrameId(WRIST)
    while True:
        pin.framesForwardKinematics(model, data, positions)
        missing = data.oMf[frame].actInv(goal)
        gap = pin.log6(missing).vector
        if np.abs(gap).max() < ACCURACY:
            return positions
        jacobian = pin.Jlog6(missing.inverse()) @ pin.computeFrameJacobian(model, data, positions, frame)
        damping = (0.01 * gap @ gap + 1e-12) * np.eye(6)
        step = jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping, gap)
        positions = positions + step * min(1.0, LONGEST_STEP / np.abs(step).max())


def show(what: str, ours: Callable[[], object], theirs: Callable[[], object]) -> None:
    """Print a line of the table."""
    kit, other = microseconds(ours), microseconds(theirs)
    print(f"{what:28}{kit:10.0f}{other:12.0f}{kit / other:10.2f}")


def main() -> None:
    """Print the table."""
    print(f"{'processor time':28}{'kit [µs]':>10}{'pin [µs]':>12}{'ratio':>10}")
    for name in ROBOTS:
        robot = load_robot(name)
        tree, model = robot.tree, by_pinocchio.model_of(robot.urdf)
        positions = {joint.name: 0.3 for joint in tree.joints.values() if joint.kind in MOVING}
        parents = {tree.joints[moved].child: tree.joints[moved].parent for moved in positions}
        show(
            f"{name}: poses of links",
            lambda: link_poses(robot, positions),  # noqa: B023  # called immediately
            lambda: by_pinocchio.link_poses(model, positions),  # noqa: B023  # as above
        )
        show(
            f"{name}: poses of joints",
            lambda: joint_poses(tree, positions),  # noqa: B023  # as above
            lambda: pinocchios_joint_poses(model, parents, positions),  # noqa: B023  # as above
        )
    robot = mobile_manipulator()
    model, goal = by_pinocchio.model_of(robot.urdf), link_poses(robot, START)[WRIST]
    goal[2, 3] += 0.2  # [m]
    show(
        "joints for a pose",
        lambda: joints_for(robot, WRIST, goal, START),
        lambda: pinocchios_joints_for(model, pin.SE3(goal), by_pinocchio.configuration(model, START)),
    )


if __name__ == "__main__":
    main()
