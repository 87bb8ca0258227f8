from math import pi

import numpy as np
import pytest

from course_lib.viewer.drawables import Shape
from course_lib.viewer.renderer import unit_shape


@pytest.mark.parametrize(
    ("shape", "volume"), [("box", 1), ("sphere", pi / 6), ("cylinder", pi / 4), ("cone", pi / 12)]
)
def test_unit_shapes_are_closed_with_outward_faces_and_have_their_volume(shape: Shape, volume: float) -> None:
    a, b, c = np.moveaxis(unit_shape(shape, 128).corners.astype(float), 1, 0)
    assert np.cross(b - a, c - a).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-4)
    assert (a * np.cross(b, c)).sum() / 6 == pytest.approx(volume, rel=4e-3)


@pytest.mark.parametrize("shape", ["box", "sphere", "cylinder", "cone"])
def test_normals_point_in_the_direction_of_the_triangles(shape: Shape) -> None:
    surface = unit_shape(shape, 32)
    a, b, c = np.moveaxis(surface.corners, 1, 0)
    across = np.cross(b - a, c - a)
    real = np.linalg.norm(across, axis=1) > 1e-6  # a ring that has shrunk to a point has empty triangles
    assert ((surface.normals[real].mean(axis=1) * across[real]).sum(axis=1) > 0).all()
