from typing import Any

import numpy as np
import pytest
from map_msgs.msg import OccupancyGridUpdate
from nav_msgs.msg import OccupancyGrid

from course_lib.displays.display import INVALID, Display
from course_lib.displays.map import palette
from course_lib.viewer.drawables import Sheet
from tests.displays.bench import Bench

PATH = "displays/Map/drawn/map"
FREE, WALL, UNKNOWN = 0, 100, -1


def add(bench: Bench, **properties: Any) -> Display:
    return bench.session.add("rviz_default_plugins/Map", "Map", {"Topic": "/map"}, **properties)


def grid(*rows: tuple[int, ...], frame: str = "map", resolution: float = 0.5) -> OccupancyGrid:
    message = OccupancyGrid(data=[cell for row in rows for cell in row])
    message.header.frame_id = frame
    message.info.resolution = resolution
    message.info.height, message.info.width = len(rows), len(rows[0])
    return message


def change(x: int, y: int, *rows: tuple[int, ...]) -> OccupancyGridUpdate:
    data = [cell for row in rows for cell in row]
    return OccupancyGridUpdate(x=x, y=y, width=len(rows[0]), height=len(rows), data=data)


def sheet(bench: Bench) -> Sheet:
    drawable = bench.scene.objects()[PATH]
    assert isinstance(drawable, Sheet)
    return drawable


def test_map_is_placed_at_its_origin_with_rows_along_y() -> None:
    bench = Bench()
    bench.transform("map", "odom", (1.0, 0.0, 0.0))
    add(bench, alpha=1.0)
    message = grid((FREE, WALL), (UNKNOWN, FREE), frame="odom")
    message.info.origin.position.x = 2.0
    bench.publish("/map", message)
    bench.update()
    assert sheet(bench).cells.tolist() == [[0, 100], [255, 0]]
    np.testing.assert_allclose(sheet(bench).colors, palette("map") / 255, atol=1e-6)
    assert sheet(bench).width == 0.5
    assert bench.scene.world_transform(PATH)[:3, 3].tolist() == [3, 0, 0]


def test_statuses_and_dimensions_have_the_texts_of_rviz() -> None:
    bench = Bench()
    display = add(bench)
    assert bench.status(display, "Message") == ("warn", "No map received")
    message = grid((FREE, WALL), (FREE, FREE), (FREE, FREE))
    message.info.origin.position.y = 4.0
    bench.publish("/map", message)
    bench.update()
    assert bench.status(display, "Message") == ("ok", "Map received")
    assert bench.status(display, "Map") == ("ok", "Map OK")
    assert bench.status(display, "Update Topic") == ("ok", "OK")
    assert [display[label] for label in ("Resolution", "Width", "Height")] == [0.5, 2, 3]
    assert [display[label] for label in ("Position", "Orientation")] == [(0, 4, 0), (0, 0, 0, 1)]


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"width": 3}, "Data size doesn't match width*height: width = 3, height = 1, data size = 2"),
        ({"height": 0}, "Map is zero-sized (2x0)"),
        ({"resolution": np.nan}, INVALID),
    ],
)
def test_invalid_map_is_rejected_and_the_last_one_is_kept(changes: dict[str, Any], status: str) -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/map", grid((FREE, FREE)))
    before = sheet(bench)
    wrong = grid((WALL, WALL))
    for field, value in changes.items():
        setattr(wrong.info, field, value)
    bench.publish("/map", wrong)
    bench.update()
    assert bench.status(display, "Map") == ("error", status)
    assert sheet(bench) is before


def test_map_without_cells_causes_a_hint_although_rviz_reports_nothing() -> None:
    bench = Bench()
    display = add(bench)
    empty = OccupancyGrid()
    empty.header.frame_id = "map"
    bench.publish("/map", empty)
    assert bench.status(display, "Map") is None
    assert "no cells" in " ".join(bench.hints(display))


def test_map_updates_on_a_separate_topic_change_part_of_the_map() -> None:
    bench = Bench()
    display = add(bench, alpha=1.0)
    bench.publish("/map_updates", change(0, 0, (WALL,)))  # before the first map there is nothing to change
    bench.publish("/map", grid((FREE, FREE, FREE), (FREE, FREE, FREE)))
    bench.publish("/map_updates", change(1, 1, (WALL, UNKNOWN)), at=0.5)
    assert sheet(bench).cells.tolist() == [[0, 0, 0], [0, 100, 255]]
    assert bench.status(display, "Update") == ("ok", "Update OK")
    assert bench.status(display, "Topic") == ("ok", "1 update messages received at 2.0 hz.")


@pytest.mark.parametrize(("x", "y"), [(-1, 0), (2, 0), (0, 1)])
def test_update_outside_the_map_is_an_error_and_changes_nothing(x: int, y: int) -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/map", grid((FREE, FREE, FREE)))
    before = sheet(bench)
    bench.publish("/map_updates", change(x, y, (WALL, WALL)))
    assert bench.status(display, "Update") == ("error", "Update area outside of original map area.")
    assert sheet(bench) is before


def test_update_with_a_wrong_number_of_cells_changes_nothing_and_has_a_hint() -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/map", grid((FREE, FREE, FREE)))
    before, update = sheet(bench), change(0, 0, (WALL, WALL))
    update.data = update.data[:1]
    bench.publish("/map_updates", update)
    assert bench.hints(display) == ["the update has 1 cells instead of 2 x 1, and is ignored."]
    assert sheet(bench) is before
    bench.publish("/map_updates", change(0, 0, (WALL, WALL)))
    assert not bench.hints(display)


def test_costmap_is_drawn_without_transparent_cells_at_full_alpha() -> None:
    bench = Bench()
    display = add(bench, alpha=1.0, color_scheme="costmap")
    bench.publish("/map", grid((FREE, WALL)))
    assert sheet(bench).colors[FREE].tolist() == [0, 0, 0, 1]
    display["Alpha"] = 0.5
    assert sheet(bench).colors[[FREE, WALL], 3].tolist() == [0, 0.5]


def test_map_updates_can_use_a_custom_topic() -> None:
    bench = Bench()
    display = add(bench)
    assert display["Update Topic"] == "/map_updates"
    display["Update Topic"] = "/elsewhere"
    bench.publish("/map", grid((FREE,)))
    bench.publish("/elsewhere", change(0, 0, (WALL,)))
    assert bench.status(display, "Update") == ("ok", "Update OK")
    saved = {"Topic": {"Value": "/map"}, "Update Topic": {"Value": "/mine", "Depth": 7}}
    loaded = bench.session.add("rviz_default_plugins/Map", "Loaded", saved)
    assert (loaded["Update Topic"], loaded["Update Topic/Depth"]) == ("/mine", 7)


@pytest.mark.parametrize(
    ("label", "value"),
    [("Alpha", 0.2), ("Color Scheme", "raw"), ("Draw Behind", True), ("Binary representation", True)],
)
def test_changed_property_redraws_the_map(label: str, value: Any) -> None:
    bench = Bench()
    display = add(bench)
    bench.publish("/map", grid((FREE, 30, WALL)))
    before = sheet(bench)
    display[label] = value
    after = sheet(bench)
    assert (before.colors.tolist(), before.is_behind) != (after.colors.tolist(), after.is_behind)


def test_binary_map_threshold_is_limited_to_0_to_100() -> None:
    bench = Bench()
    display = add(bench, binary_representation=True)
    bench.publish("/map", grid((FREE, 30, WALL)))
    before = sheet(bench).colors.tolist()
    display["Binary threshold"] = 20
    assert sheet(bench).colors.tolist() != before
    display["Binary threshold"] = 1000
    assert display["Binary threshold"] == 100


def test_map_follows_its_frame_or_uses_the_transform_at_its_stamp() -> None:
    bench = Bench()
    display = add(bench)
    message = grid((FREE,), frame="odom")
    message.header.stamp.sec = 1000  # the start of robot time in the test session
    for second in (0.0, 1.0):
        bench.transform("map", "odom", (second, 0.0, 0.0), at=second, static=False)
        if not second:
            bench.publish("/map", message)
    bench.update(1.0)
    assert bench.scene.world_transform(PATH)[0, 3] == 1.0
    display["Use Timestamp"] = True
    assert bench.scene.world_transform(PATH)[0, 3] == 0.0
