from typing import Any

import numpy as np
from geometry_msgs.msg import PointStamped

from course_lib.displays.display import INVALID, Display
from course_lib.viewer.drawables import Solids
from tests.displays.bench import Bench

PATH = "displays/Point/drawn/points"


def add(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/PointStamped", "Point", {"Topic": "/point"}, **properties)


def point(x: float, frame: str = "map") -> PointStamped:
    message = PointStamped()
    message.header.frame_id = frame
    message.point.x = x
    return message


def balls(bench: Bench) -> Solids:
    drawable = bench.scene.objects()[PATH]
    assert isinstance(drawable, Solids)
    return drawable


def test_point_is_a_ball_of_the_given_radius() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/point", point(2.0))
    np.testing.assert_allclose(np.diag(balls(bench).placements[0]), [0.2, 0.2, 0.2, 1])
    assert balls(bench).placements[0, :3, 3].tolist() == [2, 0, 0]
    display["Radius"], display["Color"], display["Alpha"] = 1.0, (0, 0, 255), 0.5
    assert balls(bench).placements[0, 0, 0] == 1
    assert balls(bench).colors.tolist() == [0, 0, 1, 0.5]


def test_history_keeps_the_newest_points_in_the_frame_of_the_last() -> None:
    bench = Bench()
    bench.transform("map", "base", (0.0, 3.0, 0.0))
    display = add(bench, history_length=3)
    for x in range(5):
        bench.publish("/point", point(float(x)))
    bench.publish("/point", point(5.0, "base"))
    assert balls(bench).placements[:, 0, 3].tolist() == [3, 4, 5]
    assert bench.scene.world_transform(PATH)[:3, 3].tolist() == [0, 3, 0]
    display["History Length"] = 2
    assert balls(bench).placements[:, 0, 3].tolist() == [4, 5]


def test_non_finite_point_is_an_error() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/point", point(np.nan))
    assert bench.status(display, "Topic") == ("error", INVALID)
    assert PATH not in bench.scene.objects()
