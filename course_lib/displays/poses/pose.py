"""The Pose display."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.axes import axes
from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.frames import Matrix, placed
from course_lib.displays.poses.arrow import INVALID, arrow_properties, arrows, is_finite
from course_lib.displays.properties import Property, number
from course_lib.viewer.drawables import Drawable


class PoseDisplay(DrawnDisplay):
    """Shows the last pose as an arrow or as axes."""

    class_name = "rviz_default_plugins/Pose"
    type_name = "geometry_msgs/msg/PoseStamped"
    properties = (
        *DrawnDisplay.properties,
        *arrow_properties(1.0, 0.05, 0.3, 0.1, "Arrow", "Axes"),
        Property("Axes Length", 1.0, number()),  # [m]
        Property("Axes Radius", 0.1, number()),  # [m]
    )
    _pose: Matrix | None = None

    def reset(self) -> None:
        """Forget the pose."""
        super().reset()
        self._pose = None

    def process(self, message: Any) -> None:
        """Show a pose."""
        if not is_finite([message.pose]):
            self.statuses.set("error", "Topic", INVALID)
            return
        transform = self.transform_at(message.header)
        if transform is not None:
            self._pose = placed(transform, message.pose)
            self.context.scene.set_transform(f"{self.path}/drawn", self._pose)
            self.draw()

    def parts(self) -> Mapping[str, Drawable]:
        """Return an arrow or axes at the origin of the pose."""
        if self._pose is None:
            return {}
        if self["Shape"] == "Axes":
            return {"axes": axes(self["Axes Length"], self["Axes Radius"])}
        return arrows([np.eye(4)], self)
