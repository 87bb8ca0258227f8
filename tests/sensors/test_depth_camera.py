from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import Image

from course_lib.errors import CourseError
from course_lib.sensors.depth_camera import DepthCameraNode
from course_lib.sensors.motion import placed
from course_lib.sensors.pinhole import Pinhole
from course_lib.sensors.shapes import box
from course_lib.sensors.world import Thing, World
from tests.sensors.scenes import TRANSFORM_OPTICAL_TO_WORLD, published

WALL = World([Thing(box(1, 100, 2), placed(3.5, 0, 0))])


def image(world: World = WALL, **settings: Any) -> Any:
    pinhole = Pinhole(32, 24, 20.0)
    node = lambda: DepthCameraNode(world, TRANSFORM_OPTICAL_TO_WORLD, pinhole=pinhole, **settings)  # noqa: E731  # one use
    return published(node, Image)[0]


def depth(message: Any) -> Any:
    dtype = {"32FC1": "<f4", "16UC1": "<u2"}[message.encoding]
    return np.frombuffer(message.data, dtype).reshape(message.height, message.width)


def test_depth_is_along_z_so_a_wall_is_flat() -> None:
    message = image()
    assert (message.encoding, message.step) == ("32FC1", 128)
    np.testing.assert_allclose(depth(message)[8:16], 3, atol=1e-6)
    assert np.isposinf(depth(message)[0]).all()


def test_millimetres_have_0_for_what_is_not_known() -> None:
    message = image(encoding="16UC1")
    assert (message.encoding, message.step) == ("16UC1", 64)
    assert (depth(message)[8:16] == 3000).all()
    assert (depth(message)[0] == 0).all()


def test_what_16_bits_cannot_say_is_not_known() -> None:
    far = World([Thing(box(1, 1000, 1000), placed(80, 0, 0))])
    assert (depth(image(far, encoding="16UC1", range_max=100.0)) == 0).all()


def test_limits_and_lost_values_are_as_rep_117_and_118_say() -> None:
    assert np.isneginf(depth(image(range_min=4.0))[12]).all()
    assert np.isposinf(depth(image(range_max=2.0))[12]).all()
    assert np.isnan(depth(image(dropout=1.0))).all()
    assert (depth(image(dropout=1.0, encoding="16UC1")) == 0).all()


def test_an_unknown_encoding_is_named() -> None:
    with pytest.raises(CourseError, match="encoding is 'mono8'; give '32FC1'"):
        image(encoding="mono8")
