"""The Polygon display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.frames import Matrix
from course_lib.displays.marker.drawn import points
from course_lib.displays.poses.arrow import rgba_of
from course_lib.displays.properties import Property, color, number
from course_lib.viewer.drawables import Drawable, Lines


class PolygonDisplay(DrawnDisplay):
    """Shows the last polygon as a closed line."""

    class_name = "rviz_default_plugins/Polygon"
    type_name = "geometry_msgs/msg/PolygonStamped"
    in_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (25, 255, 0), color),
        Property("Alpha", 1.0, number(0.0, 1.0)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return the corners, shape (N, 3), [m]."""
        return points(message.polygon)

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Keep the corners, and once more the first."""
        corners = self.numbers(message)
        return np.vstack([corners, corners[:1]])

    def parts(self) -> Mapping[str, Drawable]:
        """Return the line through all corners."""
        return {"line": Lines(self.kept[0], rgba_of(self))} if self.kept and len(self.kept[0]) else {}
