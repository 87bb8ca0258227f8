"""RViz's GridCells display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.marker.drawables import drawn_twice
from course_lib.displays.poses.shapes import rgba_of
from course_lib.displays.properties import Property, color, number
from course_lib.displays.statuses import Level
from course_lib.displays.topic_display import DrawnDisplay
from course_lib.viewer.drawables import Drawable, Points


class GridCellsDisplay(DrawnDisplay):
    """The cells of the last message, as tiles in the xy plane of its frame."""

    class_name = "rviz_default_plugins/GridCells"
    type_name = "nav_msgs/msg/GridCells"
    in_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (25, 255, 0), color),
        Property("Alpha", 1.0, number(0.0, 1.0)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return the coordinates of all cells and their size in one row, [m]."""
        coordinates = [number for cell in message.cells for number in (cell.x, cell.y, cell.z)]
        return np.array([*coordinates, message.cell_width, message.cell_height])

    def process(self, message: Any) -> None:
        """Show the cells; a message that RViz refuses leaves none."""
        self.kept.clear()
        problem = _problem(message)
        if problem:
            self.statuses.set(*problem)
        else:
            super().process(message)
        if not self.kept:
            self.draw()

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Any:
        """Keep the message."""
        return message

    def parts(self) -> Mapping[str, Drawable]:
        """Return the tiles of the last message."""
        return {"cells": _tiles(self.kept[0], rgba_of(self))} if self.kept else {}


def _problem(message: Any) -> tuple[Level, str, str] | None:
    """Return the status, in RViz's words, of a message that it cannot show."""
    if message.cell_width == 0 or message.cell_height == 0:
        return "error", "Topic", "One of the Cell's dimension is zero, cells will be invisible."
    return None if message.cells else ("warn", "Topic", "Message is empty: there are no cells to be shown.")


def _tiles(message: Any, rgba: tuple[float, ...]) -> Points:
    centers = [(cell.x, cell.y, cell.z) for cell in message.cells]
    *rgb, alpha = rgba
    seen = alpha if alpha == 1 else drawn_twice(np.array(alpha))
    return Points(centers, (*rgb, float(seen)), (message.cell_width, message.cell_height), spot="tile")
