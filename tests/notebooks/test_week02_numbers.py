"""Week 2's checks agree with the dimensions of the UR10."""

import runpy
from math import pi

import numpy as np
import pytest

from course_lib.course.material import exercises_dir, solutions_dir
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import load_robot

PUBLIC = runpy.run_path(str(exercises_dir() / "checks" / "week02.py"))
HIDDEN = runpy.run_path(str(solutions_dir() / "checks" / "week02.py"))
SIDE, FORWARD, UP = PUBLIC["SIDE"], PUBLIC["FORWARD"], PUBLIC["UP"]


@pytest.mark.parametrize(
    ("pan", "lift", "elbow", "wrist"),
    [
        (0.0, 0.0, 0.0, [FORWARD, SIDE, UP]),
        (pi / 2, 0.0, 0.0, [-SIDE, FORWARD, UP]),
        (0.0, -pi / 2, 0.0, [0.0, SIDE, UP + FORWARD]),
        (HIDDEN["PAN"], HIDDEN["LIFT"] - pi / 2, HIDDEN["ELBOW"], HIDDEN["wrist"]()),
    ],
)
def test_expected_wrist_positions_match_pinocchio(
    pan: float, lift: float, elbow: float, wrist: list[float]
) -> None:
    positions = {"shoulder_pan_joint": pan, "shoulder_lift_joint": lift, "elbow_joint": elbow}
    position = link_poses(load_robot("ur10"), positions)["wrist_1_link"][:3, 3]
    assert np.allclose(position, wrist, atol=1e-6)


def test_joint_checks_list_the_joints_of_the_ur10() -> None:
    joints = load_robot("ur10").tree.joints.values()
    moving = [joint.name for joint in joints if joint.kind != "fixed"]
    assert list(PUBLIC["NAMES"]) == list(HIDDEN["NAMES"]) == moving
