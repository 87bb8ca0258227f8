from typing import Any

import numpy as np
from geometry_msgs.msg import Point32, PolygonStamped

from course_lib.displays.display import INVALID, Display
from tests.displays.bench import Bench

PATH = "displays/Polygon/drawn/line"
CORNERS = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 2.0, 0.0)]


def add(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/Polygon", "Polygon", {"Topic": "/polygon"}, **properties)


def polygon(*corners: tuple[float, float, float], frame: str = "map") -> PolygonStamped:
    message = PolygonStamped()
    message.header.frame_id = frame
    message.polygon.points = [Point32(x=x, y=y, z=z) for x, y, z in corners]
    return message


def line(bench: Bench) -> Any:
    return bench.scene.objects().get(PATH)


def test_polygon_is_a_closed_thin_line_in_its_frame() -> None:
    bench = Bench()
    bench.transform("map", "base", (5.0, 0.0, 0.0))
    display = add(bench)
    bench.publish("/polygon", polygon(*CORNERS, frame="base"))
    assert line(bench).points.tolist() == [list(corner) for corner in (*CORNERS, CORNERS[0])]
    assert (line(bench).width, line(bench).strip) == (0.0, True)
    assert bench.scene.world_transform(PATH)[0, 3] == 5.0
    display["Color"], display["Alpha"] = (255, 0, 0), 0.5
    assert line(bench).colors.tolist() == [1, 0, 0, 0.5]


def test_empty_polygon_clears_the_last_one_and_a_non_finite_one_does_not() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/polygon", polygon(*CORNERS))
    bench.publish("/polygon", polygon((np.inf, 0.0, 0.0)))
    assert bench.status(display, "Topic") == ("error", INVALID)
    assert line(bench)
    bench.publish("/polygon", polygon())
    assert line(bench) is None
