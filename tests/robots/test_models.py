from typing import Any

import numpy as np
import pytest

from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import MODELS, load_robot, rest_posture
from tests.robots import by_pinocchio

known: Any = pytest.importorskip("example_robot_data")


def test_table_agrees_with_example_robot_data() -> None:
    for name, loader in known.ROBOTS.items():
        if loader.urdf_filename:
            description = f"{loader.path}/{loader.urdf_subpath}/{loader.urdf_filename}"
            assert MODELS[name].urdf == description, name
    assert known.ROBOTS.keys() - MODELS.keys() == {"cassie"}  # which is no URDF


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["ur10", "talos", "go2", "kinova"])
def test_rest_posture_agrees_with_the_pinocchio_loader(name: str) -> None:
    robot = load_robot(name)
    at_rest = by_pinocchio.configuration(robot.model, robot.rest.positions)
    if "root_joint" in robot.model.names:
        at_rest[:7] = by_pinocchio.pin.SE3ToXYZQUAT(by_pinocchio.pin.SE3(robot.rest.transform_root_to_ground))
    np.testing.assert_allclose(at_rest, robot.q0, atol=1e-9)


@pytest.mark.slow
def test_every_robot_has_a_rest_posture() -> None:
    for name, model in MODELS.items():
        joints = load_robot(name).tree.joints
        assert rest_posture(model, joints).positions.keys() <= joints.keys(), name


def test_posture_with_fixed_joints_can_be_shown() -> None:
    robot = load_robot("borinot")  # its file has a position of the fixed joint at its hand
    assert link_poses(robot, robot.rest.positions).keys() == {robot.tree.root} | {
        joint.child for joint in robot.tree.joints.values()
    }
