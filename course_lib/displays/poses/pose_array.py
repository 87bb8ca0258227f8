"""The PoseArray display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.poses.arrow import (
    INVALID,
    is_finite,
    matrices,
    numbers_of,
    rgba_of,
    shape_properties,
    shapes,
)
from course_lib.displays.properties import Property, number
from course_lib.viewer.drawables import Drawable, Lines

_FLAT = "Arrow (Flat)"
# A flat arrow of length 1 as three lines: shaft, and both sides of its head (flat_arrows_array.cpp).
_STROKES = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 0), (0.75, 0.2, 0), (1, 0, 0), (0.75, -0.2, 0)])


class PoseArrayDisplay(DrawnDisplay):
    """Shows the poses of the last message as flat arrows, as solid ones, or as axes."""

    class_name = "rviz_default_plugins/PoseArray"
    type_name = "geometry_msgs/msg/PoseArray"
    properties = (
        *DrawnDisplay.properties,
        *shape_properties((0.23, 0.01, 0.07, 0.03), (0.3, 0.01), (_FLAT, "Arrow (3D)", "Axes")),
        Property("Arrow Length", 0.3, number()),  # [m]
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._poses = np.zeros((0, 4, 4))

    def reset(self) -> None:
        """Forget the poses."""
        super().reset()
        self._poses = np.zeros((0, 4, 4))

    def process(self, message: Any) -> None:
        """Show poses."""
        if not is_finite(message.poses):
            self.statuses.set("error", "Topic", INVALID)
        elif self.put_in_frame(message.header):
            self._poses = matrices(numbers_of(message.poses))
            self.draw()

    def parts(self) -> Mapping[str, Drawable]:
        """Return all arrows or axes at once, in the frame of the message."""
        if not len(self._poses):
            return {}
        if self["Shape"] != _FLAT:
            return shapes(self._poses, self)
        points = (self._poses[:, None, :3, :3] @ (_STROKES * self["Arrow Length"])[:, :, None])[..., 0]
        ends = (points + self._poses[:, None, :3, 3]).reshape(-1, 3)
        return {"arrows": Lines(ends, rgba_of(self), strip=False)}
