from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.errors import CourseError
from course_lib.sensors.checked import Floats
from course_lib.sensors.mesh import load_mesh, mesh
from course_lib.sensors.shapes import box
from tests.sensors.scenes import random_rays

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
SIDES = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
CUBE = [face for a, b, c, d in SIDES for face in ((a, b, c), (a, c, d))]
TRIANGLE = ((0, 0, 0), (1, 0, 0), (0, 1, 0))


def by_hand(triangles: Floats, origin: Floats, ray: Floats) -> float:
    """Solve origin + t ray = a + u (b - a) + v (c - a) for each triangle."""
    nearest = np.inf
    for a, b, c in triangles:
        t, u, v = np.linalg.solve(np.array([-ray, b - a, c - a]).T, origin - a)
        if u >= 0 and v >= 0 and u + v <= 1 and t >= 0:
            nearest = min(nearest, t)
    return nearest


@given(st.integers(1, 60), st.integers(0, 2**32))
def test_the_tree_finds_what_trying_every_triangle_finds(count: int, seed: int) -> None:
    chance = np.random.default_rng(seed)
    triangles = chance.uniform(-2, 2, (count, 3, 3))
    origin, rays = chance.uniform(-3, 3, 3), random_rays(chance, 20)
    shape = mesh(triangles.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    expected = [by_hand(triangles, origin, ray) for ray in rays.T]
    np.testing.assert_allclose(shape.distances(origin, rays), expected, atol=1e-6)


@given(st.integers(0, 2**32))
def test_a_cube_of_triangles_is_a_box(seed: int) -> None:
    chance = np.random.default_rng(seed)
    origin, rays = chance.uniform(-3, 3, 3), random_rays(chance, 100)
    shape, solid = mesh(CORNERS, CUBE), box(2, 2, 2)
    np.testing.assert_allclose(shape.distances(origin, rays), solid.distances(origin, rays), atol=1e-6)
    assert shape.size.tolist() == [2, 2, 2]
    assert shape.reach == pytest.approx(np.sqrt(3))


def test_rays_along_the_axes_meet_flat_triangles() -> None:
    shape = mesh(TRIANGLE, [(0, 1, 2)])
    down, aside = np.array([[0.0], [0], [-1]]), np.array([[1.0], [0], [0]])
    assert shape.distances(np.array([0.2, 0.2, 3]), down) == pytest.approx([3])
    assert shape.distances(np.array([0.2, 0.2, 3]), aside) == pytest.approx([np.inf])


def test_many_rays_are_cast_in_parts() -> None:
    rays = random_rays(np.random.default_rng(1), 20_000)
    met = mesh(CORNERS, CUBE).distances(np.zeros(3), rays)
    np.testing.assert_allclose(met, box(2, 2, 2).distances(np.zeros(3), rays), atol=1e-6)


def test_a_mesh_file_is_read(tmp_path: Path) -> None:
    pytest.importorskip("coal")
    file = tmp_path / "cube.obj"
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    file.write_text(vertices + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in CUBE))
    assert load_mesh(file).distances(np.zeros(3), np.array([[1.0], [0], [0]])) == pytest.approx([1])


def test_a_missing_mesh_file_is_named(tmp_path: Path) -> None:
    pytest.importorskip("coal")
    with pytest.raises(CourseError, match=r"nothing\.stl cannot be read as a mesh\. Give an STL, OBJ or DAE"):
        load_mesh(tmp_path / "nothing.stl")


@pytest.mark.parametrize("faces", [[(0, 1, 3)], [(0, 1, -1)], [(0, 1, 0.5)], np.empty((0, 3))])
def test_faces_of_vertices_that_are_not_there_are_named(faces: Any) -> None:
    with pytest.raises(CourseError, match="whole numbers of vertices, from 0 to 2"):
        mesh(TRIANGLE, faces)


def test_vertices_of_another_shape_are_named() -> None:
    with pytest.raises(CourseError, match=r"vertices \[m\] of a mesh has shape \(1, 2\)"):
        mesh([(0, 0)], [(0, 0, 0)])
