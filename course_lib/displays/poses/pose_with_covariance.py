"""The PoseWithCovariance display."""

from collections.abc import Mapping
from typing import Any

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.poses.arrow import INVALID, shape_properties, shapes
from course_lib.displays.poses.covariance import (
    COVARIANCE_PROPERTIES,
    Uncertain,
    covariances,
    is_finite,
    uncertain,
)
from course_lib.viewer.drawables import Drawable


class PoseWithCovarianceDisplay(DrawnDisplay):
    """Shows the last pose, and how uncertain it is."""

    class_name = "rviz_default_plugins/PoseWithCovariance"
    type_name = "geometry_msgs/msg/PoseWithCovarianceStamped"
    properties = (*DrawnDisplay.properties, *shape_properties(), *COVARIANCE_PROPERTIES)
    _last: Uncertain | None = None

    def reset(self) -> None:
        """Forget the pose."""
        super().reset()
        self._last = None

    def process(self, message: Any) -> None:
        """Show a pose."""
        if not is_finite(message.pose):
            self.statuses.set("error", "Topic", INVALID)
            return
        transform = self.transform_at(message.header)
        if transform is not None:
            self._last = uncertain(message.pose, transform)
            self.draw()

    def parts(self) -> Mapping[str, Drawable]:
        """Return an arrow or axes at the pose, and its covariance."""
        last = self._last
        return {} if last is None else shapes([last.pose], self) | covariances([last], self)
