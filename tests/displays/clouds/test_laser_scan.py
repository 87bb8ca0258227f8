from math import pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sensor_msgs.msg import LaserScan

from course_lib.displays.display import Display
from tests.displays.bench import START_NS, Bench, ns
from tests.displays.clouds.clouds import points_of


def scan(ranges: list[float], frame: str = "map", at: float = 0.0, **fields: Any) -> LaserScan:
    message = LaserScan(ranges=ranges, angle_increment=pi / 2, range_min=0.5, range_max=10.0, **fields)
    message.header.frame_id = frame
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(ns(at), 10**9)
    return message


def add(bench: Bench) -> Display:
    return bench.session.add("rviz_default_plugins/LaserScan", "Scan", {"Topic": "/scan"})


def ends(bench: Bench, display: Display) -> np.ndarray:
    return np.round(points_of(bench, display)[0].points, 5)


def test_beam_angles_increase_counterclockwise() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/scan", scan([1.0, 2.0, 3.0]))
    bench.update()
    assert ends(bench, display).tolist() == [[1, 0, 0], [0, 2, 0], [-3, 0, 0]]


@pytest.mark.slow
@settings(deadline=None)  # machines may be busy
@given(st.lists(st.floats(width=32), max_size=8))
def test_only_ranges_within_the_limits_are_shown(ranges: list[float]) -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/scan", scan(ranges))
    bench.update()
    count = sum(0.5 <= distance < 10.0 for distance in ranges)
    assert bench.status(display, "Points") == ("ok", f"Showing [{count}] points from [1] messages")


def test_each_beam_starts_at_the_scanner_pose_at_its_time() -> None:
    bench = Bench()
    display = add(bench)
    for at in (0.0, 1.0):
        bench.transform("map", "laser", (10 * at, 0.0, 0.0), at=at, static=False, yaw=at * pi / 2)
    still = scan([1.0, 1.0, 1.0], "laser", 0.0, time_increment=0.5)
    still.angle_increment = 0.0
    bench.publish("/scan", still, at=1.0)
    bench.update(1.0)
    half = np.sqrt(0.5)
    np.testing.assert_allclose(ends(bench, display), [[1, 0, 0], [5 + half, half, 0], [10, 1, 0]], atol=1e-4)


def test_scan_waits_for_the_transform_of_its_last_beam() -> None:
    bench = Bench()
    display = add(bench)
    bench.transform("map", "laser", at=0.0, static=False)
    long = scan([1.0, 1.0, 1.0], "laser", time_increment=0.5)
    bench.publish("/scan", long)  # determines the duration of scans
    bench.publish("/scan", long)
    bench.update()
    assert not points_of(bench, display)
    bench.transform("map", "laser", at=1.0, static=False)
    bench.update(1.0)
    assert len(points_of(bench, display)) == 1


def test_scan_of_long_duration_causes_a_warning() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/scan", scan([1.0] * 4, time_increment=1.0))
    bench.update()
    assert bench.status(display, "Scan Time") == (
        "warn",
        "Laser scan time, computed from time_increment * len(ranges), is rather large:  3s.\n"
        "The display of any message will be delayed by this amount of time!",
    )


@pytest.mark.parametrize(("intensities", "hints"), [([1.0, 2.0], 0), ([], 0), ([1.0], 1)])
def test_intensities_color_the_points_if_there_is_one_per_range(intensities: list[float], hints: int) -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/scan", scan([1.0, 1.0], intensities=intensities))
    bench.update()
    colours = points_of(bench, display)[0].colors
    assert (len(np.unique(colours, axis=0)) == 2) == (len(intensities) == 2)
    assert len(bench.hints(display)) == hints


def test_empty_frame_is_dropped_with_the_text_of_the_rviz_log() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/scan", scan([1.0], ""))
    bench.update()
    assert bench.hints(display) == [
        f"RViz's log: Message Filter dropping message: frame '' at time {START_NS / 1e9:.3f} "
        "for reason 'the frame id of the message is empty'"
    ]
