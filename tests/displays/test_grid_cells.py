from typing import Any

import pytest
from geometry_msgs.msg import Point
from nav_msgs.msg import GridCells

from course_lib.displays.display import INVALID, Display
from course_lib.viewer.drawables import Points
from tests.displays.bench import Bench

CELLS = [Point(x=1.0), Point(x=2.0)]
PATH = "displays/GridCells/drawn/cells"


def show(bench: Bench, **fields: Any) -> None:
    message = GridCells(**{"cell_width": 0.5, "cell_height": 0.25, "cells": CELLS, **fields})
    message.header.frame_id = "base"
    bench.publish("/cells", message)
    bench.update()


@pytest.fixture
def bench() -> Bench:
    bench = Bench()
    bench.transform("map", "base", (0.0, 3.0, 0.0))
    return bench


@pytest.fixture
def display(bench: Bench) -> Display:
    display = bench.session.add("rviz_default_plugins/GridCells", "GridCells", {"Topic": "/cells"})
    show(bench)
    return display


def test_each_cell_is_a_tile_of_the_cell_size_in_the_frame_of_the_message(
    bench: Bench, display: Display
) -> None:
    tiles = bench.scene.objects()[PATH]
    assert isinstance(tiles, Points)
    assert (tiles.spot, tiles.size[:2], tiles.points.tolist()) == (
        "tile",
        (0.5, 0.25),
        [[1, 0, 0], [2, 0, 0]],
    )
    assert bench.scene.world_transform(PATH)[1, 3] == 3.0


@pytest.mark.parametrize(
    ("fields", "level", "text"),
    [
        ({"cells": []}, "warn", "Message is empty: there are no cells to be shown."),
        ({"cell_width": 0.0}, "error", "One of the Cell's dimension is zero, cells will be invisible."),
        ({"cells": [Point(x=float("nan"))]}, "error", INVALID),
    ],
)
def test_message_rejected_by_rviz_clears_the_cells_and_has_its_status(
    bench: Bench, display: Display, fields: Any, level: str, text: str
) -> None:
    show(bench, **fields)
    assert PATH not in bench.scene.objects()
    assert bench.status(display, "Topic") == (level, text)
