from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point32
from sensor_msgs.msg import ChannelFloat32, PointCloud

from course_lib.displays.display import Display
from tests.displays.bench import Bench
from tests.displays.clouds import clouds
from tests.displays.clouds.clouds import cloud, plain, points_of

PLACES = [(0.0, 1.0, 2.0), (1.0, 0.0, 1.0), (3.0, 2.0, 0.0)]


def show_cloud(*channels: ChannelFloat32, places: Any = PLACES, **properties: Any) -> tuple[Bench, Display]:
    bench = Bench()
    display = bench.session.add("rviz_default_plugins/PointCloud", "Old", {"Topic": "/old"}, **properties)
    message = PointCloud(points=[Point32(x=x, y=y, z=z) for x, y, z in places], channels=list(channels))
    message.header.frame_id = "map"
    bench.publish("/old", message)
    bench.update()
    return bench, display


def test_point_cloud_with_lists_is_drawn_like_the_same_cloud_with_fields() -> None:
    bench, display = show_cloud(ChannelFloat32(name="intensity", values=[1.0, 5.0, 9.0]))
    twin = clouds.add(bench)
    bench.publish(clouds.TOPIC, cloud(plain(PLACES, intensity=np.array([1, 5, 9], np.float32))))
    bench.update()
    (old,), (new,) = points_of(bench, display), points_of(bench, twin)
    np.testing.assert_array_equal(old.points, new.points)
    np.testing.assert_array_equal(old.colors, new.colors)
    assert (old.size, old.spot) == (new.size, new.spot)


@pytest.mark.parametrize("wrong", [float("nan"), float("inf")])
def test_invalid_points_are_counted_and_colored_but_not_drawn(wrong: float) -> None:
    places = [*PLACES[:2], (wrong, 0.0, 0.0)]
    bench, display = show_cloud(ChannelFloat32(name="intensity", values=[1.0, 5.0, 9.0]), places=places)
    (drawn,) = points_of(bench, display)
    assert drawn.points.tolist() == [list(place) for place in PLACES[:2]]
    assert len(drawn.colors) == 2
    assert display["Max Intensity"] == 9.0
    assert bench.status(display, "Points") == ("ok", "Showing [3] points from [1] messages")
    display["Color Transformer"] = "AxisColor"
    bench.update()
    assert len(points_of(bench, display)[0].points) == 2


def test_channel_with_a_different_length_is_reported_and_zero_as_in_rviz() -> None:
    bench, display = show_cloud(ChannelFloat32(name="intensity", values=[1.0]))
    assert len(points_of(bench, display)[0].points) == 3
    assert (display["Color Transformer"], display["Max Intensity"]) == ("Intensity", 0.0)
    text = "channel 'intensity' has 1 value for 3 points; RViz draws 0 for each."
    assert bench.hints(display) == [text]
