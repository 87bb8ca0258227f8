import numpy as np
import pytest

from course_lib.errors import CourseError
from course_lib.viewer.drawables import Camera


def test_camera_target_is_straight_ahead() -> None:
    camera = Camera(eye=(3, 2, 1), target=(0, 0, 0.5))
    target_in_camera = camera.view_matrix() @ [0, 0, 0.5, 1]
    assert target_in_camera[:2] == pytest.approx([0, 0], abs=1e-12)
    assert target_in_camera[2] == pytest.approx(-np.linalg.norm([3, 2, 0.5]))


@pytest.mark.parametrize("eye", [(5, 0, 0), (0, 0, 5), (0, 0, -5), (1, 2, 3)])
def test_view_matrix_never_mirrors_or_scales(eye: tuple[float, float, float]) -> None:
    rotation = Camera(eye=eye).view_matrix()[:3, :3]
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1)


def test_camera_without_a_viewing_direction_is_rejected() -> None:
    with pytest.raises(CourseError, match="no viewing direction"):
        Camera(eye=(1, 1, 1), target=(1, 1, 1))
