"""The Polygon display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.marker.drawn import points
from course_lib.displays.poses.arrow import INVALID, rgba_of
from course_lib.displays.properties import Property, color, number
from course_lib.viewer.arrays import Matrix
from course_lib.viewer.drawables import Drawable, Lines


class PolygonDisplay(DrawnDisplay):
    """Shows the last polygon as a closed line."""

    class_name = "rviz_default_plugins/Polygon"
    type_name = "geometry_msgs/msg/PolygonStamped"
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (25, 255, 0), color),
        Property("Alpha", 1.0, number(0.0, 1.0)),
    )
    _corners: Matrix = np.empty((0, 3))  # in the frame of the message, [m]

    def reset(self) -> None:
        """Forget the polygon."""
        super().reset()
        self._corners = np.empty((0, 3))

    def process(self, message: Any) -> None:
        """Show a polygon."""
        corners = points(message.polygon)
        if not np.isfinite(corners).all():
            self.statuses.set("error", "Topic", INVALID)
        elif self.put_in_frame(message.header):
            self._corners = corners
            self.draw()

    def parts(self) -> Mapping[str, Drawable]:
        """Return the line through all corners and back to the first."""
        corners = self._corners
        return {"line": Lines(np.vstack([corners, corners[:1]]), rgba_of(self))} if len(corners) else {}
