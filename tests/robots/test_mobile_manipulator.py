import re

import numpy as np
import pytest

from course_lib.robots.kinematics import link_poses
from course_lib.robots.mobile_manipulator import MOUNT, START, mobile_manipulator, simple_painter
from course_lib.robots.robot import load_robot

DOWN, UP = (
    [0.0, 1.5, 0.5, 0.0, 0.0, 0.0],
    [0.0, -0.25, 0.5, 0.0, 0.0, 0.0],
)  # [rad], the commands of seeds/002
JOINTS = [
    f"ur10{name}_joint"
    for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
]


def test_joint_and_link_names_agree_with_the_documents() -> None:
    robot = mobile_manipulator()
    assert list(robot.model.names)[1:] == JOINTS
    assert robot.tree.root == "base_link"
    assert {"ur10base_link", "ur10wrist_3_link", "ur10tool0"} <= set(link_poses(robot))


def test_arm_is_a_ur10_at_its_mount() -> None:
    random, ur10 = np.random.default_rng(0), load_robot("ur10")
    for _ in range(5):
        angles = dict(zip(JOINTS, random.uniform(-3, 3, 6).tolist(), strict=True))
        expected = link_poses(ur10, {name.removeprefix("ur10"): angle for name, angle in angles.items()})[
            "tool0"
        ]
        expected[:3, 3] += MOUNT
        np.testing.assert_allclose(link_poses(mobile_manipulator(), angles)["ur10tool0"], expected, atol=1e-9)


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", ["visual", "collision"])
def test_all_links_have_shapes(kind: str) -> None:
    robot = mobile_manipulator()
    shapes = robot.visual_model if kind == "visual" else robot.collision_model
    names = {shape.name.rpartition("_")[0] for shape in shapes.geometryObjects}
    assert {"base_link", "ur10base_link", "ur10forearm_link", "ur10wrist_3_link"} <= names


def test_arm_does_not_touch_the_base_in_both_sweeps() -> None:
    import pinocchio as pin

    robot = mobile_manipulator()
    shapes = robot.collision_model.copy()
    own = [i for i, shape in enumerate(shapes.geometryObjects) if shape.name.startswith("base_link")]
    moving = [i for i, shape in enumerate(shapes.geometryObjects) if shape.parentJoint > 1]
    for first in own:
        for second in moving:
            shapes.addCollisionPair(pin.CollisionPair(first, second))
    assert own
    assert moving
    data, shape_data = robot.model.createData(), shapes.createData()
    start = [START.get(name, 0.0) for name in JOINTS]
    for begin, end in ((start, DOWN), (DOWN, UP)):
        for positions in np.linspace(begin, end, 40):
            assert not pin.computeCollisions(robot.model, data, shapes, shape_data, positions, True)


def test_wrist_stays_above_the_ground_in_both_sweeps() -> None:
    lifts = np.linspace(-1.2, 1.5, 40)
    heights = [
        link_poses(mobile_manipulator(), {**START, "ur10shoulder_lift_joint": lift})["ur10wrist_3_link"][2, 3]
        for lift in lifts
    ]
    assert min(heights) > 0.2  # [m]


def test_simple_painter_is_light_and_has_the_wrist_of_the_painter_at_rest() -> None:
    painter = simple_painter()
    assert not re.search("mesh", painter.urdf)
    assert painter.urdf.count("<visual>") < 20
    wrist = link_poses(mobile_manipulator(), START)["ur10wrist_1_link"][:3, 3]
    # Its arm has no offset to the side.
    assert np.linalg.norm(wrist[[0, 2]] - [1.559, 2.266]) < 0.02  # [m]
