import numpy as np
import pytest
from sensor_msgs.msg import Range

from course_lib.errors import CourseError
from course_lib.sensors.sensor_nodes import RangeNode, cone_rays
from course_lib.sensors.world import Thing, World, placed, sphere
from tests.sensors.scenes import AT_ORIGIN, published


@pytest.mark.parametrize(("y", "expected"), [(0, 1.5), (2.0, np.inf)])
def test_range_is_the_nearest_distance_in_the_cone(y: float, expected: float) -> None:
    world = World([Thing(sphere(0.5), placed(2, y, 0))])
    (message,) = published(lambda: RangeNode(world, AT_ORIGIN), Range)
    assert message.range == pytest.approx(expected, abs=1e-5)
    assert message.field_of_view == pytest.approx(np.pi / 9)
    assert (message.min_range, message.max_range) == pytest.approx((0.02, 4.0))


def test_distance_beyond_the_maximum_range_is_inf() -> None:
    (message,) = published(lambda: RangeNode(World([Thing(sphere(1), placed(9, 0, 0))]), AT_ORIGIN), Range)
    assert message.range == np.inf


def test_rays_fill_exactly_the_cone() -> None:
    rays = cone_rays(np.pi / 6, 200)
    off = np.arccos(np.clip(rays[0], -1, 1))
    assert off[0] == 0
    assert off.max() == pytest.approx(np.pi / 12)
    np.testing.assert_allclose(np.linalg.norm(rays, axis=0), 1)
    assert cone_rays(np.pi / 6, 1)[:, 0].tolist() == [1, 0, 0]


def test_invalid_cone_is_reported() -> None:
    with pytest.raises(CourseError, match=r"field_of_view \[rad\] is 0; expected a number > 0"):
        published(lambda: RangeNode(World([]), AT_ORIGIN, field_of_view=0), Range)
    with pytest.raises(CourseError, match="rays is 0"):
        published(lambda: RangeNode(World([]), AT_ORIGIN, rays=0), Range)
