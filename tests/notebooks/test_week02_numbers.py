"""Week 2's checks and views agree with the dimensions of the UR10."""

import runpy
from math import pi, tan

import numpy as np
import pytest

from course_lib import Viewer
from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import exercises_dir, lessons_dir, solutions_dir
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


def test_upright_arm_is_inside_the_view_next_to_the_sliders() -> None:
    viewer = Viewer(fixed_frame="base_link")
    for cell in read_notebook(lessons_dir() / "week02_joint_states.ipynb")["cells"]:
        lines = source(cell).splitlines() if cell["cell_type"] == "code" else []
        for line in lines:
            if line.startswith("viewer.view["):
                exec(line, {"viewer": viewer})
        if cell["id"] == "sliders-view":
            break
    viewer.refresh()
    upright = link_poses(load_robot("ur10"), {"shoulder_lift_joint": -pi / 2, "wrist_1_joint": -pi / 2})
    camera = viewer.scene.camera
    for link in ("base_link", "tool0"):
        x, y, minus_depth, _ = camera.view_matrix() @ upright[link][:, 3]
        # The image is at least as high as it is wide. A margin is left for the size of the links.
        assert max(abs(x), abs(y)) < -minus_depth * tan(camera.vertical_fov / 2) - 0.1, link
