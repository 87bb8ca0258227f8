"""The PoseArray display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.axes import AXIS_COLORS, axes
from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.frames import Matrix
from course_lib.displays.poses.arrow import (
    INVALID,
    arrow_properties,
    arrows,
    is_finite,
    numbers_of,
    rgba_of,
)
from course_lib.displays.properties import Property, number
from course_lib.viewer.drawables import Drawable, Lines, Solids

# A flat arrow of length 1 as three lines: shaft, and both sides of its head (flat_arrows_array.cpp).
_FLAT = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 0), (0.75, 0.2, 0), (1, 0, 0), (0.75, -0.2, 0)])


class PoseArrayDisplay(DrawnDisplay):
    """Shows the poses of the last message as flat arrows, as solid ones, or as axes."""

    class_name = "rviz_default_plugins/PoseArray"
    type_name = "geometry_msgs/msg/PoseArray"
    properties = (
        *DrawnDisplay.properties,
        *arrow_properties(0.23, 0.01, 0.07, 0.03, "Arrow (Flat)", "Arrow (3D)", "Axes"),
        Property("Arrow Length", 0.3, number()),  # [m]
        Property("Axes Length", 0.3, number()),  # [m]
        Property("Axes Radius", 0.01, number()),  # [m]
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
            return
        transform = self.transform_at(message.header)
        if transform is not None:
            self._poses = _matrices(numbers_of(message.poses))
            self.context.scene.set_transform(f"{self.path}/drawn", transform)
            self.draw()

    def parts(self) -> Mapping[str, Drawable]:
        """Return all arrows or axes at once, in the frame of the message."""
        if not len(self._poses):
            return {}
        if self["Shape"] == "Arrow (3D)":
            return arrows(self._poses, self)
        if self["Shape"] == "Axes":
            one = axes(self["Axes Length"], self["Axes Radius"])
            every = (self._poses[:, None] @ one.placements).reshape(-1, 4, 4)
            return {"axes": Solids("cylinder", every, np.tile(AXIS_COLORS, (len(self._poses), 1)))}
        points = (self._poses[:, None, :3, :3] @ (_FLAT * self["Arrow Length"])[:, :, None])[..., 0]
        ends = (points + self._poses[:, None, :3, 3]).reshape(-1, 3)
        return {"arrows": Lines(ends, rgba_of(self), strip=False)}


def _matrices(poses: Matrix) -> Matrix:
    """Return poses, shape (N, 7), as transforms, shape (N, 4, 4); Ogre's: zeros do not turn."""
    x, y, z, w = poses[:, 3:].T
    made = np.tile(np.eye(4), (len(poses), 1, 1))
    made[:, :3, 3] = poses[:, :3]
    made[:, 0, 0], made[:, 1, 1], made[:, 2, 2] = (
        1 - 2 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y))
    )
    made[:, 0, 1], made[:, 1, 0] = 2 * (x * y - w * z), 2 * (x * y + w * z)
    made[:, 0, 2], made[:, 2, 0] = 2 * (x * z + w * y), 2 * (x * z - w * y)
    made[:, 1, 2], made[:, 2, 1] = 2 * (y * z - w * x), 2 * (y * z + w * x)
    return made
