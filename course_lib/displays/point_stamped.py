"""The PointStamped display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.frames import Matrix
from course_lib.displays.marker.shapes import placement
from course_lib.displays.poses.arrow import rgba_of
from course_lib.displays.properties import Property, color, integer, number
from course_lib.viewer.drawables import Drawable, Solids


class PointStampedDisplay(DrawnDisplay):
    """Shows the last points as balls; RViz keeps all of them in the frame of the last one."""

    class_name = "rviz_default_plugins/PointStamped"
    type_name = "geometry_msgs/msg/PointStamped"
    length_label, in_frame = "History Length", True
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (204, 41, 204), color),
        Property("Alpha", 1.0, number()),
        Property("Radius", 0.2, number()),  # [m], RViz's word, but it is the diameter
        Property("History Length", 1, integer(1, 100_000)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return the point, shape (3,), [m]."""
        return np.array([message.point.x, message.point.y, message.point.z])

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Keep the point."""
        return self.numbers(message)

    def parts(self) -> Mapping[str, Drawable]:
        """Return all balls."""
        places = [placement(np.eye(3), self["Radius"], point) for point in self.kept]
        return {"points": Solids("sphere", places, rgba_of(self))} if places else {}
