from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo

from course_lib.displays.display import Display
from tests.displays.bench import Bench

PATH = "displays/Info/drawn"


def add(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/CameraInfo", "Info", {"Topic": "/info"}, **properties)


def info(fx: float = 100.0, **fields: Any) -> CameraInfo:
    """Return the info of a camera of 400 x 200 pixels, whose axis passes through the middle."""
    message = CameraInfo(width=400, height=200, **fields)
    message.header.frame_id = "map"
    message.p = np.array([fx, 0, 200.0, 0, 0, 100.0, 100.0, 0, 0, 0, 1.0, 0])
    return message


def part(bench: Bench, name: str) -> Any:
    return bench.scene.objects().get(f"{PATH}/{name}")


def corners(bench: Bench) -> list[list[float]]:
    """Return the far ends of the edges that begin at the camera."""
    return np.round(part(bench, "edges").points.reshape(-1, 2, 3)[:4, 1], 6).tolist()  # type: ignore[no-any-return]  # of an array


def test_frustum_edges_pass_through_the_image_corners() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/info", info())
    assert corners(bench) == [[-2, -1, 1], [2, -1, 1], [2, 1, 1], [-2, 1, 1]]
    assert bench.status(display, "Camera Info") == ("ok", "OK")
    display["Far clip"] = 2.0
    assert corners(bench)[2] == [4, 2, 2]
    display["Edge color"], display["Alpha"] = (255, 0, 0), 1.0
    assert part(bench, "edges").colors.tolist() == [1, 0, 0, 1]
    display["Show edges"] = False
    assert part(bench, "edges") is None


def test_binning_and_region_reduce_the_image() -> None:
    bench = Bench()
    add(bench)
    bench.publish("/info", info(binning_x=2, binning_y=4))
    assert corners(bench)[2] == [0, -0.5, 1]
    small = info()
    small.roi.width, small.roi.height = 100, 100
    bench.publish("/info", small)
    assert corners(bench)[2] == [-1, 0, 1]


def test_sides_are_shown_only_if_both_properties_are_enabled() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/info", info())
    assert part(bench, "sides") is None
    display["Not show side polygons"] = False
    assert part(bench, "sides").faces.shape == (4, 3)
    display["Color"] = (0, 0, 255)
    assert part(bench, "sides").colors.tolist() == [0, 0, 1, 0.5]
    display["Show polygons"] = False
    assert part(bench, "sides") is None


@pytest.mark.parametrize("fx", [0.0, np.nan])
def test_camera_without_focal_length_is_an_error(fx: float) -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/info", info())
    bench.publish("/info", info(fx))
    assert bench.status(display, "Camera Info") == ("error", "Invalid intrinsic matrix")
    assert part(bench, "edges") is None
