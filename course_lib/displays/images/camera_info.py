"""The CameraInfo display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.frames import Matrix
from course_lib.displays.poses.arrow import rgba_of
from course_lib.displays.properties import Property, color, flag, number
from course_lib.viewer.drawables import Drawable, Lines, Mesh

_CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1)])  # of the picture: x right, y down
_EDGES = np.array([(0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1)])  # the camera is point 0
_SIDES = np.array([(0, 2, 1), (0, 3, 2), (0, 4, 3), (0, 1, 4)])
_WIDTH = 0.01  # [m], of the edges


class CameraInfoDisplay(DrawnDisplay):
    """Shows what a camera sees as a pyramid: its tip is the camera, which looks along z."""

    class_name = "rviz_default_plugins/CameraInfo"
    type_name = "sensor_msgs/msg/CameraInfo"
    in_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Far clip", 1.0, number()),  # [m], height of the pyramid
        Property("Show edges", True, flag),
        Property("Show polygons", True, flag),
        Property("Not show side polygons", True, flag),  # and RViz has no others
        Property("Color", (85, 255, 255), color),
        Property("Edge color", (125, 125, 125), color),
        Property("Alpha", 0.5, number()),
    )

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix | None:
        """Keep the directions of the corners, shape (4, 3), one metre ahead."""
        rays = _rays(message)
        if rays is None:
            self.statuses.set("error", "Camera Info", "Invalid intrinsic matrix")
        else:
            self.statuses.set("ok", "Camera Info", "OK")
        return rays

    def parts(self) -> Mapping[str, Drawable]:
        """Return the edges and sides that are asked for."""
        parts: dict[str, Drawable] = {}
        if not self.kept or self.kept[0] is None:
            return parts
        points = np.vstack([np.zeros(3), self.kept[0] * self["Far clip"]])
        if self["Show edges"]:
            rgba = rgba_of(self, "Edge color")
            parts["edges"] = Lines(points[_EDGES].reshape(-1, 3), rgba, _WIDTH, strip=False)
        if self["Show polygons"] and not self["Not show side polygons"]:
            *rgb, alpha = rgba_of(self)
            squared = (*(channel**2 for channel in rgb), alpha)  # a texture and vertices of the same colour
            parts["sides"] = Mesh(points, _SIDES, squared, lit=False)
        return parts


def _rays(info: Any) -> Matrix | None:
    """Return the directions of the corners of a sensor_msgs/msg/CameraInfo; None without a focal length."""
    fx, cx, tx = info.p[[0, 2, 3]]
    fy, cy, ty = info.p[[5, 6, 7]]
    if not (np.isfinite(info.p).all() and fx and fy):
        return None
    width = (info.roi.width or info.width) // (info.binning_x or 1)
    height = (info.roi.height or info.height) // (info.binning_y or 1)
    x, y = (_CORNERS * (width, height)).T
    return np.column_stack([(x - cx - tx) / fx, (y - cy - ty) / fy, np.ones(4)])
