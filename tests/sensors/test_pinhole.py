from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from std_msgs.msg import Header

from course_lib.errors import CourseError
from course_lib.sensors.sensor_nodes import Pinhole


@given(st.integers(1, 40), st.integers(1, 30), st.floats(1, 1000))
def test_rays_are_projected_back_to_their_pixels(width: int, height: int, focal: float) -> None:
    camera = Pinhole(width, height, focal)
    info = camera.info(Header())
    projected = np.array(info.p).reshape(3, 4)[:, :3] @ camera.rays
    v, u = np.indices((height, width)).reshape(2, -1)
    np.testing.assert_allclose(projected[:2] / projected[2], [u, v], atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(camera.rays, axis=0), 1)


def test_camera_info_is_self_consistent() -> None:
    info = Pinhole(320, 240, 277.0).info(Header(frame_id="eye"))
    assert (info.width, info.height, info.header.frame_id) == (320, 240, "eye")
    assert np.array(info.p).reshape(3, 4)[:, :3].tolist() == np.array(info.k).reshape(3, 3).tolist()
    assert np.array(info.r).reshape(3, 3).tolist() == np.eye(3).tolist()
    assert info.distortion_model == "plumb_bob"
    assert list(info.d) == [0] * 5


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"focal": 0}, r"focal \[px\] is 0; expected a number > 0"),
        ({"focal": float("nan")}, r"focal \[px\] is nan"),
        ({"width": 0}, r"width \[px\] is 0; expected a whole number"),
        ({"height": -2}, r"height \[px\] is -2"),
    ],
)
def test_invalid_cameras_are_reported(settings: Any, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        Pinhole(**settings)
