"""The Path display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.drawn_display import INVALID, DrawnDisplay
from course_lib.displays.frames import Matrix
from course_lib.displays.poses.arrow import arrows, axes_at, matrices, numbers_of, rgba_of
from course_lib.displays.properties import Property, color, integer, number, vector, words
from course_lib.viewer.drawables import Drawable, Lines

_ARROW = ("Shaft Length", "Shaft Diameter", "Head Length", "Head Diameter")


class PathDisplay(DrawnDisplay):
    """Shows the last paths as lines, and their poses as axes or arrows if asked.

    The frame is that of the path; RViz does not look at the headers of its poses.
    """

    class_name = "rviz_default_plugins/Path"
    type_name = "nav_msgs/msg/Path"
    length_label = "Buffer Length"
    properties = (
        *DrawnDisplay.properties,
        Property("Line Style", "Lines", words("Lines", "Billboards")),
        Property("Line Width", 0.03, number(0.001)),  # [m], of Billboards; Lines are one pixel wide
        Property("Color", (25, 255, 0), color),
        Property("Alpha", 1.0, number()),
        Property("Buffer Length", 1, integer(1)),
        Property("Offset", (0.0, 0.0, 0.0), vector),  # [m], in the fixed frame
        Property("Pose Style", "None", words("None", "Axes", "Arrows")),
        Property("Length", 0.3, number()),  # [m], of the axes
        Property("Radius", 0.03, number()),  # [m], RViz's word, but it is their diameter
        Property("Pose Color", (255, 85, 255), color),  # of the arrows
        *(Property(label, size, number()) for label, size in zip(_ARROW, (0.1, 0.1, 0.2, 0.3), strict=True)),
    )

    def process(self, message: Any) -> None:
        """Show a path; one that cannot be shown takes the place of an older one all the same."""
        self.keep(self._poses(message))

    def _poses(self, message: Any) -> Matrix:
        """Return the poses of a path in the fixed frame, shape (N, 4, 4); none if RViz refuses it."""
        numbers = numbers_of([stamped.pose for stamped in message.poses])
        if not np.isfinite(numbers).all():
            self.statuses.set("error", "Topic", INVALID)
            return np.empty((0, 4, 4))
        transform = self.transform_at(message.header)
        return np.empty((0, 4, 4)) if transform is None else transform @ matrices(numbers)

    def parts(self) -> Mapping[str, Drawable]:
        """Return a line for each path, and what stands at all poses."""
        offset = np.eye(4)
        offset[:3, 3] = self["Offset"]
        paths = [offset @ path for path in self.kept if len(path)]
        width = self["Line Width"] if self["Line Style"] == "Billboards" else 0.0
        lines: dict[str, Drawable] = {
            f"line {i}": Lines(path[:, :3, 3], rgba_of(self), width) for i, path in enumerate(paths)
        }
        return lines | self._at(np.concatenate(paths)) if paths else lines

    def _at(self, poses: Matrix) -> dict[str, Drawable]:
        if self["Pose Style"] == "Axes":
            return axes_at(poses, self["Length"], self["Radius"])
        if self["Pose Style"] == "Arrows":
            rgb = [channel / 255 for channel in self["Pose Color"]]
            return arrows(poses, *(self[label] for label in _ARROW), rgba=(*rgb, 1.0))
        return {}
