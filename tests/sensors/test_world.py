from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from course_lib.arrays import Floats
from course_lib.errors import CourseError
from course_lib.sensors.world import Thing, World, box, circle, cylinder, placed, plane, sphere
from tests.sensors.scenes import AT_ORIGIN, random_rays

X = np.array([[1.0], [0], [0]])
SHAPES = (box(1, 2, 0.5), sphere(0.6), cylinder(0.5, 1.5), plane())


def random_transform(chance: np.random.Generator) -> Floats:
    transform = np.eye(4)
    rotation, _ = np.linalg.qr(chance.standard_normal((3, 3)))
    transform[:3, :3] = rotation * np.linalg.det(rotation)
    transform[:3, 3] = chance.uniform(-4, 4, 3)
    return transform


@settings(max_examples=50)
@given(st.integers(0, 2**32), st.sampled_from([np.inf, 3.0]))
def test_culling_rays_far_from_objects_does_not_change_the_result(seed: int, far: float) -> None:
    chance = np.random.default_rng(seed)
    things = [Thing(shape, random_transform(chance)) for shape in SHAPES]
    sensor, rays = random_transform(chance), random_rays(chance, 200)
    hits = World(things).cast(sensor, rays, 0.0, far)
    each = np.array([in_its_frame(drawable, sensor, rays) for drawable in things])
    near = each.min(axis=0) <= far
    np.testing.assert_allclose(hits.distance[near], each.min(axis=0)[near], atol=1e-6)
    met = np.isfinite(hits.distance)
    np.testing.assert_allclose(each[hits.thing[met], np.flatnonzero(met)], hits.distance[met], atol=1e-6)
    assert (hits.thing[~met] == -1).all()


def in_its_frame(thing: Thing, transform_sensor_to_world: Floats, rays: Floats) -> Floats:
    to_thing = np.linalg.inv(thing.transform_at(0.0)) @ transform_sensor_to_world
    return thing.shape.distances(to_thing[:3, 3], to_thing[:3, :3] @ rays)


def test_nearer_object_occludes_the_farther() -> None:
    world = World([Thing(box(1, 1, 1), placed(5, 0, 0)), Thing(sphere(0.5), placed(3, 0, 0))])
    hits = world.cast(AT_ORIGIN, X, 0.0)
    assert (hits.distance[0], hits.thing[0]) == (pytest.approx(2.5), 1)


def test_objects_move_with_robot_time() -> None:
    world = World([Thing(sphere(0.5), circle((5, 0, 0), 1, 8))])
    seen = [world.cast(AT_ORIGIN, X, seconds).distance[0] for seconds in (0, 4, 2)]
    assert seen == pytest.approx([5.5, 3.5, np.inf])


def test_object_velocity_is_the_derivative_of_its_motion() -> None:
    drawable = Thing(sphere(0.5), circle((5, 0, 0), 2, 2 * np.pi))
    np.testing.assert_allclose(drawable.velocity_at(0.0), (0, 2, 0), atol=1e-6)
    assert Thing(sphere(1), AT_ORIGIN).velocity_at(3.0).tolist() == [0, 0, 0]


def test_empty_world_is_sky() -> None:
    world = World([])
    hits = world.cast(AT_ORIGIN, X, 0.0)
    assert hits.distance.tolist() == [np.inf]
    assert world.colors[hits.thing].shape == (1, 3)


@pytest.mark.parametrize(
    ("make", "text"),
    [
        (lambda: Thing("blob", AT_ORIGIN), r"shape is 'blob', which is not a shape; expected box"),  # type: ignore[arg-type]
        (lambda: Thing(sphere(1), np.full((4, 4), np.nan), label="Car"), "pose of Car contains nan"),
        (lambda: Thing(sphere(1), AT_ORIGIN, (255, 0, 0)), r"color is \[255, 0, 0\]; .* from 0 to 1"),
        (lambda: Thing(plane(), AT_ORIGIN, label="Floor"), "labelled 'Floor'; planes are infinite"),
        (lambda: World([sphere(1)]), r"Number 0 of the world is Shape.*; expected Thing\(shape, pose\)"),  # type: ignore[list-item]
    ],
)
def test_invalid_objects_of_a_world_are_reported(make: Any, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        make()
