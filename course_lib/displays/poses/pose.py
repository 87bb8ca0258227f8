"""The Pose display."""

from collections.abc import Mapping
from typing import Any

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.frames import Matrix, placed
from course_lib.displays.poses.arrow import INVALID, is_finite, shape_properties, shapes
from course_lib.viewer.drawables import Drawable


class PoseDisplay(DrawnDisplay):
    """Shows the last pose as an arrow or as axes."""

    class_name = "rviz_default_plugins/Pose"
    type_name = "geometry_msgs/msg/PoseStamped"
    properties = (*DrawnDisplay.properties, *shape_properties())
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
            self.draw()

    def parts(self) -> Mapping[str, Drawable]:
        """Return an arrow or axes at the pose."""
        return {} if self._pose is None else shapes([self._pose], self)
