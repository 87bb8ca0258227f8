import numpy as np
import pytest

from course_lib.displays.shapes import rotation_to

SPARSE = [(0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.6, 0.0, -0.8)]


@pytest.mark.parametrize("direction", [*SPARSE, (2 / 3, -1 / 3, 2 / 3)])
def test_rotation_maps_z_to_a_direction(direction: tuple[float, float, float]) -> None:
    rotation = rotation_to(np.array(direction))
    np.testing.assert_allclose(rotation[:, 2], direction)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(np.cross(rotation[:, 0], rotation[:, 1]), direction, atol=1e-12)
