from math import cos, nan, pi, sin
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from course_lib.errors import CourseError
from course_lib.robots.kinematics import configuration, joint_poses, link_poses
from course_lib.robots.robot import load_robot
from tests.robots.urdfs import ALL_KINDS, ARM_2R


def matrix(pose: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """(4, 4) of x, y, z, and a quaternion (x, y, z, w)."""
    x, y, z, w = pose[3:]
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.vstack([np.column_stack([turn, pose[:3]]), [0, 0, 0, 1]])


def test_a_2r_arm_agrees_with_the_sum_of_its_angles() -> None:
    first, second = 0.7, -0.3  # [rad]
    poses = link_poses(load_robot(ARM_2R), {"shoulder": first, "elbow": second})
    both = first + second
    expected = np.eye(4)
    expected[:2, :2] = [[cos(both), -sin(both)], [sin(both), cos(both)]]
    expected[:2, 3] = cos(first) + 0.5 * cos(both), sin(first) + 0.5 * sin(both)
    np.testing.assert_allclose(poses["tip"], expected, atol=1e-12)
    np.testing.assert_array_equal(poses["base"], np.eye(4))


def test_joints_without_a_position_stand_at_0() -> None:
    tip = link_poses(load_robot(ARM_2R))["tip"]
    np.testing.assert_allclose(tip[:3, 3], [1.5, 0, 0], atol=1e-12)


@pytest.mark.parametrize("name", ["ur10", "panda", "solo12", "tiago", "human", "talos_legs"])
def test_link_poses_agree_with_pinocchio_at_random_configurations(name: str) -> None:
    import pinocchio as pin

    robot, random = load_robot(name), np.random.default_rng(0)
    data = robot.model.createData()
    for _ in range(10):
        joints = [j for j in robot.tree.joints.values() if j.kind != "fixed" and j.name in robot.model.names]
        positions = {j.name: float(random.uniform(-pi, pi)) for j in joints}
        pin.framesForwardKinematics(robot.model, data, configuration(robot, positions))
        root = data.oMf[robot.model.getFrameId(robot.tree.root, pin.FrameType.BODY)]
        poses = link_poses(robot, positions)
        for frame, transform_link_to_model in zip(robot.model.frames, data.oMf, strict=True):
            if frame.type == pin.FrameType.BODY:
                expected = root.actInv(transform_link_to_model).homogeneous
                np.testing.assert_allclose(poses[frame.name], expected, atol=1e-9)


@pytest.mark.parametrize("text", [load_robot(name).urdf for name in ("ur10", "panda", "tiago")] + [ALL_KINDS])
def test_joint_poses_chained_from_the_root_are_link_poses(text: str) -> None:
    robot, random = load_robot(text), np.random.default_rng(0)
    names = [j.name for j in robot.tree.joints.values() if j.kind in ("revolute", "continuous", "prismatic")]
    positions = {name: float(random.uniform(-pi, pi)) for name in names}
    step = joint_poses(robot.tree, dict.fromkeys(robot.tree.joints, 0.0) | positions)
    above = {joint.child: joint for joint in robot.tree.joints.values()}
    for link, transform_link_to_root in link_poses(robot, positions).items():
        chained, at = np.eye(4), link
        while at in above:
            chained, at = matrix(step[above[at].name]) @ chained, above[at].parent
        np.testing.assert_allclose(transform_link_to_root, chained, atol=1e-9)


def test_a_continuous_joint_turns_as_far_as_one_likes() -> None:
    robot = load_robot(ALL_KINDS)
    wheel = link_poses(robot, {"drive": 0.5 + 4 * pi})["wheel"]
    np.testing.assert_allclose(wheel, link_poses(robot, {"drive": 0.5})["wheel"], atol=1e-9)


def test_mimic_joints_follow_unless_they_are_given() -> None:
    robot = load_robot(ALL_KINDS)
    followed = link_poses(robot, {"lift": 0.25})
    given = link_poses(
        robot, {"lift": 0.25, "finger": 1.0, "thumb": -1.0}
    )  # 2 · 0.25 + 0.5, and its negative
    for link in followed:
        np.testing.assert_allclose(followed[link], given[link], atol=1e-12)


def test_an_unknown_joint_is_named_with_a_close_one_and_all_that_move() -> None:
    with pytest.raises(
        CourseError, match=r"'ur10' has no joint 'elbow' that moves\. Did you mean elbow_joint"
    ):
        link_poses(load_robot("ur10"), {"elbow": 1.0})
    with pytest.raises(CourseError, match=r"Those that do: shoulder, elbow\."):
        link_poses(load_robot(ARM_2R), {"wrist_of_nothing": 1.0})


def test_a_fixed_or_floating_joint_cannot_be_placed() -> None:
    for name in ("hang", "fly", "slide"):
        with pytest.raises(CourseError, match=f"no joint '{name}' that moves"):
            link_poses(load_robot(ALL_KINDS), {name: 1.0})


@pytest.mark.parametrize("position", [nan, float("inf"), "1.0", None, [1.0]])
def test_a_position_that_is_no_finite_number_is_refused(position: Any) -> None:
    with pytest.raises(CourseError, match=r"Joint 'lift' got position .*, expected a finite number, \[m\]"):
        link_poses(load_robot(ALL_KINDS), {"lift": position})


def test_a_joint_that_is_nowhere_makes_only_its_own_link_be_nowhere() -> None:
    tree = load_robot(ARM_2R).tree
    poses = joint_poses(tree, {"shoulder": nan, "elbow": 0.5, "tip_joint": 0.0})
    assert np.isnan(poses["shoulder"]).any()
    assert np.isfinite([poses["elbow"], poses["tip_joint"]]).all()
