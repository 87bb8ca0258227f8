from math import cos, nan, pi, sin
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from course_lib.errors import CourseError
from course_lib.robots.kinematics import joint_poses, link_poses, match_matrix_signs
from course_lib.robots.robot import MODELS, from_text, load_robot
from course_lib.robots.urdf import MOVING, Urdf, parse_urdf
from tests.robots import by_pinocchio
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


def test_planar_2r_arm_agrees_with_the_sum_of_its_angles() -> None:
    first, second = 0.7, -0.3  # [rad]
    poses = link_poses(load_robot(ARM_2R), {"shoulder": first, "elbow": second})
    both = first + second
    expected = np.eye(4)
    expected[:2, :2] = [[cos(both), -sin(both)], [sin(both), cos(both)]]
    expected[:2, 3] = cos(first) + 0.5 * cos(both), sin(first) + 0.5 * sin(both)
    np.testing.assert_allclose(poses["tip"], expected, atol=1e-12)
    np.testing.assert_array_equal(poses["base"], np.eye(4))


def test_joints_without_a_position_are_at_0() -> None:
    tip = link_poses(load_robot(ARM_2R))["tip"]
    np.testing.assert_allclose(tip[:3, 3], [1.5, 0, 0], atol=1e-12)


def every_description() -> list[str]:
    """Return the different descriptions of the kit's robots."""
    return list(dict.fromkeys(load_robot(name).urdf for name in MODELS))


def random_positions(tree: Urdf, random: np.random.Generator) -> dict[str, float]:
    return {j.name: float(random.uniform(-pi, pi)) for j in tree.joints.values() if j.kind in MOVING}


@pytest.mark.slow
def test_link_poses_of_every_robot_agree_with_pinocchio_at_random_configurations() -> None:
    random, compared = np.random.default_rng(0), 0
    for text in every_description():
        robot = from_text(text)
        for _ in range(3):
            positions = random_positions(robot.tree, random)
            poses = link_poses(robot, positions)
            expected = by_pinocchio.link_poses(by_pinocchio.model_of(text), positions)
            assert poses.keys() == expected.keys()
            for link, pose in expected.items():
                np.testing.assert_allclose(poses[link], pose.homogeneous, rtol=0, atol=1e-9, err_msg=link)
            compared += len(poses)
    assert compared > 6000


@pytest.mark.slow
def test_joint_poses_of_every_robot_agree_with_pinocchio_at_random_configurations() -> None:
    random = np.random.default_rng(1)
    for text in every_description():
        tree = parse_urdf(text)
        positions = random_positions(tree, random)
        at = by_pinocchio.link_poses(by_pinocchio.model_of(text), positions)
        for name, pose in joint_poses(tree, positions).items():
            expected = at[tree.joints[name].parent].actInv(at[tree.joints[name].child]).homogeneous
            np.testing.assert_allclose(matrix(pose), expected, rtol=0, atol=1e-9, err_msg=name)


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["ur10", "panda", "solo12", "tiago", "human", "talos_legs"])
def test_link_poses_agree_with_the_model_of_the_pinocchio_loader(name: str) -> None:
    robot, random = load_robot(name), np.random.default_rng(0)
    known = {
        joint: p for joint, p in random_positions(robot.tree, random).items() if joint in robot.model.names
    }
    expected = by_pinocchio.link_poses(robot.model, known)
    poses, root = link_poses(robot, known), expected[robot.tree.root]
    for link, pose in expected.items():
        np.testing.assert_allclose(poses[link], root.actInv(pose).homogeneous, atol=1e-9)


def test_quaternions_have_the_sign_of_the_kdl_conversion() -> None:
    random = np.random.default_rng(0)
    for quaternion in random.normal(size=(500, 4)):
        unit = quaternion / np.linalg.norm(quaternion)
        expected = by_pinocchio.pin.Quaternion(by_pinocchio.pin.Quaternion(unit).matrix()).coeffs()
        np.testing.assert_allclose(match_matrix_signs(unit[None])[0], expected, atol=1e-9)


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


def test_continuous_joint_accepts_any_angle() -> None:
    robot = load_robot(ALL_KINDS)
    wheel = link_poses(robot, {"drive": 0.5 + 4 * pi})["wheel"]
    np.testing.assert_allclose(wheel, link_poses(robot, {"drive": 0.5})["wheel"], atol=1e-9)


def test_mimic_joints_follow_unless_set_explicitly() -> None:
    robot = load_robot(ALL_KINDS)
    followed = link_poses(robot, {"lift": 0.25})
    given = link_poses(
        robot, {"lift": 0.25, "finger": 1.0, "thumb": -1.0}
    )  # 2 · 0.25 + 0.5, and its negative
    for link in followed:
        np.testing.assert_allclose(followed[link], given[link], atol=1e-12)


def test_unknown_joint_error_suggests_a_joint_and_lists_the_movable_joints() -> None:
    with pytest.raises(CourseError, match=r"'ur10' has no movable joint 'elbow'\. Did you mean elbow_joint"):
        link_poses(load_robot("ur10"), {"elbow": 1.0})
    with pytest.raises(CourseError, match=r"Movable joints: shoulder, elbow\."):
        link_poses(load_robot(ARM_2R), {"wrist_of_nothing": 1.0})


def test_fixed_or_floating_joint_cannot_be_set() -> None:
    for name in ("hang", "fly", "slide"):
        with pytest.raises(CourseError, match=f"no movable joint '{name}'"):
            link_poses(load_robot(ALL_KINDS), {name: 1.0})


@pytest.mark.parametrize("position", [nan, float("inf"), "1.0", None, [1.0]])
def test_non_finite_position_is_rejected(position: Any) -> None:
    with pytest.raises(CourseError, match=r"Joint 'lift' got position .*, expected a finite number, \[m\]"):
        link_poses(load_robot(ALL_KINDS), {"lift": position})


def test_nan_position_affects_only_its_own_link() -> None:
    tree = load_robot(ARM_2R).tree
    poses = joint_poses(tree, {"shoulder": nan, "elbow": 0.5, "tip_joint": 0.0})
    assert np.isnan(poses["shoulder"]).any()
    assert np.isfinite([poses["elbow"], poses["tip_joint"]]).all()
