from typing import Any

import numpy as np
import pytest

from course_lib.robots.kinematics import link_poses
from course_lib.robots.models import MODELS, rest_of
from course_lib.robots.robot import load_robot
from tests.robots import by_pinocchio

known: Any = pytest.importorskip("example_robot_data")


def test_the_table_is_that_of_example_robot_data() -> None:
    for name, loader in known.ROBOTS.items():
        if loader.urdf_filename:
            description = f"{loader.path}/{loader.urdf_subpath}/{loader.urdf_filename}"
            assert MODELS[name].urdf == description, name
    assert known.ROBOTS.keys() - MODELS.keys() == {"cassie"}  # which is no URDF


@pytest.mark.parametrize("name", ["ur10", "talos", "go2", "kinova"])
def test_a_robot_rests_as_pinocchios_loader_has_it(name: str) -> None:
    robot = load_robot(name)
    at_rest = by_pinocchio.configuration(robot.model, robot.rest.positions)
    if "root_joint" in robot.model.names:
        at_rest[:7] = by_pinocchio.pin.SE3ToXYZQUAT(by_pinocchio.pin.SE3(robot.rest.transform_root_to_ground))
    np.testing.assert_allclose(at_rest, robot.q0, atol=1e-9)


def test_every_robot_has_a_posture() -> None:
    for name, model in MODELS.items():
        joints = load_robot(name).tree.joints
        assert rest_of(model, joints).positions.keys() <= joints.keys(), name


def test_a_posture_that_names_fixed_joints_can_be_shown() -> None:
    robot = load_robot("borinot")  # its file has a position of the fixed joint at its hand
    assert link_poses(robot, robot.rest.positions).keys() == {robot.tree.root} | {
        joint.child for joint in robot.tree.joints.values()
    }
