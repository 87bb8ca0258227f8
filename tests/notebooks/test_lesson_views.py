"""The cameras of lessons show what the text describes."""

from math import pi, tan
from pathlib import Path

import numpy as np
import pytest

from course_lib import Viewer
from course_lib.arrays import Reals
from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import exercises_dir, lessons_dir
from course_lib.displays import Orbit
from course_lib.gateway.driving_robot import HALF_ROOM
from course_lib.robots import mobile_manipulator
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import load_robot

# A view next to the notebook opens wider, if it is narrow, until it is as wide as a picture with
# this aspect ratio. It is at least as high as it is wide.
ASPECT = 1.2


def project(notebook: Path, last_cell: str, *points: Reals, name: str = "viewer") -> Reals:
    """Project points to the image of a lesson's view, after the lines up to a cell that set it.

    Returns:
        Positions to the right and up, with 1 at the upper edge of a square image, and depths [m],
        shape (N, 3).
    """
    viewer = Viewer(fixed_frame="map")
    for cell in read_notebook(notebook)["cells"]:
        lines = source(cell).splitlines() if cell["cell_type"] == "code" else []
        for line in lines:
            if line.startswith(f"{name}.view"):
                exec(line, {name: viewer, "Orbit": Orbit})
        if cell["id"] == last_cell:
            break
    else:
        raise AssertionError(f"{notebook.name} has no cell {last_cell!r}")
    viewer.refresh()
    camera = viewer.scene.camera
    in_camera = np.array([(*point[:3], 1.0) for point in points]) @ camera.view_matrix().T
    depths = -in_camera[:, 2:3]
    return np.hstack([in_camera[:, :2] / (depths * tan(camera.vertical_fov / 2)), depths])


def test_upright_arm_is_inside_the_view_next_to_the_sliders() -> None:
    upright = link_poses(load_robot("ur10"), {"shoulder_lift_joint": -pi / 2, "wrist_1_joint": -pi / 2})
    ends = [upright[link][:3, 3] for link in ("base_link", "tool0")]
    image = project(lessons_dir() / "week02_joint_states.ipynb", "sliders-view", *ends)
    # A margin is left for the size of the links.
    assert np.abs(image[:, :2]).max() < 0.95


def test_arm_does_not_cross_the_label_of_the_person() -> None:
    links = [pose[:3, 3] for name, pose in link_poses(mobile_manipulator(), {}).items() if "ur10" in name]
    label = np.array([2.0, 1.0, 2.3])  # [m] in section 3
    image = project(lessons_dir() / "week03_detections.ipynb", "view", label, *links)
    # At the label's depth, [m].
    away = np.abs(image[1:, :2] - image[0, :2]) * image[0, 2] * tan(pi / 8)
    assert len(away) > 6
    # Half the size of a text of 13 characters, 0.3 m high, and the radius of a link [m].
    assert not (away < [1.0 + 0.1, 0.15 + 0.1]).all(axis=1).any()


def test_whole_room_of_the_driving_robot_is_visible() -> None:
    sides = (-HALF_ROOM, HALF_ROOM)
    corners = [np.array([x, y, 0.0]) for x in sides for y in sides]
    image = project(lessons_dir() / "extra_real_robot.ipynb", "see", *corners)
    assert np.abs(image[:, :2]).max() < ASPECT


@pytest.mark.parametrize("height", [0.0, 1.2])  # [m]
def test_frames_of_the_arm_of_week_4_fill_the_view(height: float) -> None:
    notebook = exercises_dir() / "week04_exercise.ipynb"
    image = project(notebook, "broken-look", np.array([0.0, 0.0, height]), name="arm_view")
    assert 0.2 < np.abs(image[:, :2]).max() < 0.9
