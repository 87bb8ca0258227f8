from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import LaserScan

from course_lib.errors import CourseError
from course_lib.sensors.sensor_nodes import LaserScanNode
from course_lib.sensors.world import Thing, World, placed, sphere
from tests.sensors.scenes import AT_ORIGIN, published

AROUND = World([Thing(sphere(5), AT_ORIGIN)])


def scans(seconds: float = 0.5, **settings: Any) -> list[Any]:
    return published(lambda: LaserScanNode(AROUND, AT_ORIGIN, **settings), LaserScan, seconds)


def test_sensor_publishes_at_its_rate_with_stamp_and_frame() -> None:
    found = scans(1.0, rate=20.0, frame_id="front_laser")
    assert len(found) == 20
    assert found[0].header.frame_id == "front_laser"
    assert (found[0].header.stamp.sec, found[0].header.stamp.nanosec) == (1_700_000_000, 50_000_000)


def test_equal_seeds_give_equal_data_and_other_seeds_or_sensors_differ() -> None:
    first, again = scans(noise=0.02, dropout=0.1, seed=3), scans(noise=0.02, dropout=0.1, seed=3)
    assert [np.array(s.ranges).tobytes() for s in first] == [np.array(s.ranges).tobytes() for s in again]
    for other in (
        scans(noise=0.02, dropout=0.1, seed=4),
        scans(noise=0.02, dropout=0.1, seed=3, name="rear"),
    ):
        assert list(other[0].ranges) != list(first[0].ranges)
    assert list(first[1].ranges) != list(first[0].ranges)


def test_noise_and_dropouts_have_the_requested_strength() -> None:
    ranges = np.concatenate([scan.ranges for scan in scans(1.0, beams=2000, noise=0.05, dropout=0.2)])
    assert np.isnan(ranges).mean() == pytest.approx(0.2, abs=0.02)
    assert np.nanmean(ranges) == pytest.approx(5, abs=0.005)
    assert np.nanstd(ranges) == pytest.approx(0.05, rel=0.05)


def test_moving_sensor_measures_from_its_current_pose() -> None:
    node = lambda: LaserScanNode(AROUND, lambda t: placed(t, 0, 0), beams=2, angle_min=0, angle_max=3.0)  # noqa: E731  # as in a lesson
    assert [scan.ranges[0] for scan in published(node, LaserScan, 0.3)] == pytest.approx([4.9, 4.8, 4.7])


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"rate": 0}, r"rate \[Hz\] is 0; expected a number > 0"),
        ({"noise": -1}, "noise is -1; expected a number >= 0"),
        ({"dropout": 1.5}, "dropout is 1.5; expected a number >= 0 and <= 1"),
        ({"seed": -1}, "seed is -1; expected a number >= 0"),
        ({"beams": 0}, "beams is 0; expected a whole number"),
    ],
)
def test_invalid_settings_are_reported(settings: Any, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        scans(**settings)


def test_invalid_sensor_pose_is_reported() -> None:
    with pytest.raises(CourseError, match=r"pose of lidar has shape \(3,\)"):
        published(lambda: LaserScanNode(AROUND, (1, 2, 3)), LaserScan)
