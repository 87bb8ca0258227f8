"""RViz's Polygon, PointStamped and Range displays."""

from collections.abc import Mapping
from math import isinf, tan
from typing import Any

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.marker.drawables import ALONG_MINUS_X, placement, points
from course_lib.displays.poses.arrow import rgba_of
from course_lib.displays.properties import Property, color, integer, number
from course_lib.viewer.drawables import Drawable, Lines, Solids

_BACK = 0.008824  # share of the range by which RViz draws the cone nearer, to make up for its model


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


class RangeDisplay(DrawnDisplay):
    """Shows the last measurements of a range finder as cones along +x, as long as what was measured."""

    class_name = "rviz_default_plugins/Range"
    type_name = "sensor_msgs/msg/Range"
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (255, 255, 255), color),
        Property("Alpha", 0.5, number(0.0, 1.0)),
        Property("Buffer Length", 1, integer(1)),
    )
    length_label = "Buffer Length"

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Keep where the unit cone goes."""
        placed: Matrix = transform_frame_to_fixed @ _cone(_shown_range(message), message.field_of_view)
        return placed

    def parts(self) -> Mapping[str, Drawable]:
        """Return all cones."""
        return {"cones": Solids("cone", list(self.kept), rgba_of(self))} if self.kept else {}


def _shown_range(message: Any) -> float:
    """Return the length of the cone, [m]: 0 for what is out of range, and for NaN.

    A sensor with one distance only says -Inf for "something is nearer".
    """
    if message.min_range <= message.range <= message.max_range:
        return float(message.range)
    fixed = message.min_range == message.max_range
    return float(message.min_range) if fixed and isinf(message.range) and message.range < 0 else 0.0


def _cone(length: float, opening: float) -> Matrix:
    """Place the unit cone with its tip at the origin, open along +x."""
    width = 2 * length * tan(opening / 2)
    return placement(ALONG_MINUS_X, (width, width, length), (length / 2 - _BACK * length, 0.0, 0.0))
