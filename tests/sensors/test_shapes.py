from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.arrays import Floats
from course_lib.errors import CourseError
from course_lib.sensors.world import Shape, box, cylinder, plane, sphere
from tests.sensors.scenes import random_rays

lengths = st.floats(0.05, 5)
seeds = st.integers(0, 2**32)
X, Y, Z = np.eye(3)


def one(shape: Shape, origin: Any, ray: Any) -> float:
    direction = np.array(ray, float) / np.linalg.norm(ray)
    return float(shape.distances(np.array(origin, float), direction[:, None])[0])


@pytest.mark.parametrize(
    ("shape", "origin", "ray", "expected"),
    [
        (box(2, 4, 6), (-5, 0, 0), X, 4),
        (box(2, 4, 6), (0, -5, 0), Y, 3),
        (box(2, 4, 6), (0, 0, 0), Z, 3),  # from inside
        (box(2, 4, 6), (-5, 0, 0), -X, np.inf),
        (box(2, 4, 6), (-5, 2.1, 0), X, np.inf),
        (box(2, 2, 2), (-2, -2, -2), (1, 1, 1), np.sqrt(3)),
        (sphere(1), (-5, 0, 0), X, 4),
        (sphere(1), (-5, 0.6, 0), X, 4.2),
        (sphere(1), (0.5, 0, 0), X, 0.5),
        (sphere(1), (-5, 1.01, 0), X, np.inf),
        (cylinder(1, 2), (-5, 0.6, 0), X, 4.2),
        (cylinder(1, 2), (0.5, 0, 5), -Z, 4),
        (cylinder(1, 2), (1.5, 0, 5), -Z, np.inf),
        (cylinder(1, 2), (0, 0, 0), (1, 0, 2), np.hypot(1, 0.5)),
        (cylinder(1, 2), (-5, 0, 1.1), X, np.inf),
        (plane(), (0, 0, 2), (1, 0, -1), 2 * np.sqrt(2)),
        (plane(), (0, 0, -2), Z, 2),
        (plane(), (0, 0, 2), Z, np.inf),
        (plane(), (0, 0, 2), X, np.inf),
    ],
)
def test_ray_hits_agree_with_geometry(shape: Shape, origin: Any, ray: Any, expected: float) -> None:
    assert one(shape, origin, ray) == pytest.approx(expected, abs=1e-9)


@given(lengths, lengths, lengths, seeds)
def test_ray_hits_lie_on_the_surface(x: float, y: float, z: float, seed: int) -> None:
    chance = np.random.default_rng(seed)
    origin, rays = chance.uniform(-6, 6, 3), random_rays(chance, 200)
    radii: dict[str, tuple[Shape, Any]] = {
        "box": (box(x, y, z), lambda p: (np.abs(p) / (np.array([[x], [y], [z]]) / 2)).max(axis=0)),
        "sphere": (sphere(x), lambda p: np.linalg.norm(p, axis=0) / x),
        "cylinder": (cylinder(x, z), lambda p: np.maximum(np.hypot(p[0], p[1]) / x, np.abs(p[2]) / (z / 2))),
    }
    for shape, level in radii.values():  # level: below 1 inside, 1 on the surface
        length = shape.distances(origin, rays)
        met = np.isfinite(length)
        np.testing.assert_allclose(level(origin[:, None] + length[met] * rays[:, met]), 1, atol=1e-6)
        assert_no_surface_before(level, origin, rays, length)


def assert_no_surface_before(level: Any, origin: Floats, rays: Floats, length: Floats) -> None:
    begins_inside = level(origin[:, None]) < 1
    for share in np.linspace(0.001, 0.999, 50):
        points = origin[:, None] + share * np.minimum(length, 20) * rays
        inside = level(points) < 1 - 1e-9
        assert (inside == begins_inside).all()


@given(seeds)
def test_shapes_lie_within_their_size_and_bounding_radius(seed: int) -> None:
    chance = np.random.default_rng(seed)
    for shape in (box(1, 2, 3), sphere(0.7), cylinder(0.4, 2)):
        rays = random_rays(chance, 100)
        points = shape.distances(np.zeros(3), rays) * rays
        assert (np.abs(points) <= shape.size[:, None] / 2 + 1e-9).all()
        assert (np.linalg.norm(points, axis=0) <= shape.reach + 1e-9).all()


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: box(1, -2, 3), r"y \[m\] of a box is -2; expected a number > 0\."),
        (lambda: sphere(0), r"radius \[m\] of a sphere is 0; expected a number > 0\."),
        (lambda: cylinder(1, float("nan")), r"height \[m\] of a cylinder is nan"),
        (lambda: sphere("big"), "radius .* is 'big'"),  # type: ignore[arg-type]  # a wrong value
    ],
)
def test_invalid_sizes_are_reported(make: Any, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        make()
