from math import cos, sin
from typing import Any

import numpy as np
import pytest
from nav_msgs.msg import Odometry

from course_lib.displays.display import INVALID, DrawnDisplay
from tests.displays.bench import Bench
from tests.displays.poses.test_poses import add, drawables_of, extent


def message(x: float = 0.0, yaw: float = 0.0) -> Odometry:
    message = Odometry()
    message.header.frame_id = "map"
    message.pose.pose.position.x = x
    message.pose.pose.orientation.z, message.pose.pose.orientation.w = sin(yaw / 2), cos(yaw / 2)
    message.pose.covariance = np.eye(6).ravel()
    return message


def steps(bench: Bench) -> int:
    return len(drawables_of(bench)["shaft"].placements)


def test_pose_is_shown_if_it_exceeds_the_tolerances() -> None:
    bench = Bench()
    display = add(bench, "Odometry", position_tolerance=1.0, angle_tolerance=0.5)
    for x, yaw in ((0.0, 0.0), (0.9, 0.4), (1.1, 0.0), (1.1, 0.6), (1.2, 0.6 + 2 * np.pi)):
        bench.publish("/pose", message(x, yaw))
    assert steps(bench) == 3
    display["Angle Tolerance"] = display["Position Tolerance"] = 0.0
    bench.publish("/pose", message(1.1, 0.6))
    assert steps(bench) == 4


def test_newest_poses_are_kept_and_0_keeps_all() -> None:
    bench = Bench()
    display = add(bench, "Odometry", keep=3)
    for x in range(5):
        bench.publish("/pose", message(float(x)))
    assert steps(bench) == 3
    assert extent(bench, "shaft", 0)[0].tolist() == [2, 0, 0]
    display["Keep"] = 0
    for x in range(10, 20):
        bench.publish("/pose", message(float(x)))
    assert steps(bench) == 13
    display["Keep"] = 1
    assert extent(bench, "shaft", 0)[0].tolist() == [19, 0, 0]


def test_shape_properties_are_nested_below_the_shape() -> None:
    bench = Bench()
    config = {"Topic": "/pose", "Shape": {"Value": "Axes", "Axes Length": 2, "Color": "0; 0; 255"}}
    display = bench.session.add("rviz_default_plugins/Odometry", "Shown", {**config, "Covariance": False})
    bench.publish("/pose", message())
    assert sorted(drawables_of(bench)) == ["axes"]
    np.testing.assert_allclose(extent(bench, "axes")[1], [2, 0, 0], atol=1e-6)
    display["Shape"] = "Arrow"
    display["Shape/Alpha"] = 0.5
    assert drawables_of(bench)["head"].colors.tolist() == [0, 0, 1, 0.5]


def test_layout_can_set_only_nested_properties() -> None:
    bench = Bench()
    config = {"Topic": {"Depth": 7}, "Covariance": {"Position": {"Scale": 2}}}
    display = bench.session.add("rviz_default_plugins/Odometry", "Shown", config)
    assert (display["Topic/Depth"], display["Covariance/Position/Scale"]) == (7, 2)
    assert display["Covariance/Position"]
    assert not bench.hints(display)


def test_covariances_are_shown_at_each_pose() -> None:
    bench = Bench()
    display = add(bench, "Odometry")
    for x in range(3):
        bench.publish("/pose", message(float(x)))
    assert [len(drawables_of(bench)[name].placements) for name in ("place", "discs")] == [3, 9]
    display["Covariance"] = False
    assert sorted(drawables_of(bench)) == ["head", "shaft"]


@pytest.mark.parametrize(
    ("field", "value", "status"),
    [
        ("position", np.nan, INVALID),
        ("orientation", 3.0, "Message contained unnormalized quaternion (squares of values don't add to 1)"),
    ],
)
def test_invalid_odometry_is_an_error(field: str, value: float, status: str) -> None:
    bench = Bench()
    display: Any = add(bench, "Odometry")
    wrong = message()
    getattr(wrong.pose.pose, field).z = value
    bench.publish("/pose", wrong)
    assert bench.status(display, "Topic") == ("error", status)
    assert not drawables_of(bench)


def test_long_history_is_drawn_once_per_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Bench()
    display = add(bench, "Odometry", keep=0)
    assert isinstance(display, DrawnDisplay)
    draw = type(display).draw
    numbers: list[int] = []

    def count(display: DrawnDisplay) -> None:
        numbers.append(len(display.history))
        draw(display)

    monkeypatch.setattr(type(display), "draw", count)
    for x in range(100):
        bench.publish("/pose", message(float(x)))
    bench.update()
    assert len(numbers) < 30
    assert steps(bench) == 100
