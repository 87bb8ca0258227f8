"""The PointStamped display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.history_display import HistoryDisplay
from course_lib.displays.marker.shapes import placement
from course_lib.displays.poses.arrow import INVALID, rgba_of
from course_lib.displays.properties import Property, color, integer, number
from course_lib.viewer.drawables import Drawable, Solids


class PointStampedDisplay(HistoryDisplay):
    """Shows the last points as balls; RViz keeps all of them in the frame of the last one."""

    class_name = "rviz_default_plugins/PointStamped"
    type_name = "geometry_msgs/msg/PointStamped"
    properties = (
        *HistoryDisplay.properties,
        Property("Color", (204, 41, 204), color),
        Property("Alpha", 1.0, number()),
        Property("Radius", 0.2, number()),  # [m], RViz's word, but it is the diameter
        Property("History Length", 1, integer(1, 100_000)),
    )

    def process(self, message: Any) -> None:
        """Show a point."""
        point = np.array([message.point.x, message.point.y, message.point.z])
        if not np.isfinite(point).all():
            self.statuses.set("error", "Topic", INVALID)
        elif self.put_in_frame(message.header):
            self.keep(point)

    def parts(self) -> Mapping[str, Drawable]:
        """Return all balls."""
        places = [placement(np.eye(3), self["Radius"], point) for point in self.kept]
        return {"points": Solids("sphere", places, rgba_of(self))} if places else {}
