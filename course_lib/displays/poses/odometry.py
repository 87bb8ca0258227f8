"""The Odometry display."""

from collections.abc import Mapping
from math import atan2
from typing import Any, ClassVar

import numpy as np

from course_lib.displays.frames import Matrix, is_unit
from course_lib.displays.history_display import HistoryDisplay
from course_lib.displays.poses.arrow import INVALID, numbers_of, shape_properties, shapes
from course_lib.displays.poses.covariance import COVARIANCE_PROPERTIES, covariances, is_finite, uncertain
from course_lib.displays.properties import Property, integer, number
from course_lib.viewer.drawables import Drawable

_NOT_UNIT = "Message contained unnormalized quaternion (squares of values don't add to 1)"


class OdometryDisplay(HistoryDisplay):
    """Shows where something has been: a pose for each step that it has moved or turned."""

    class_name = "rviz_default_plugins/Odometry"
    type_name = "nav_msgs/msg/Odometry"
    length_label: ClassVar[str] = "Keep"
    properties = (
        *HistoryDisplay.properties,
        Property("Position Tolerance", 0.1, number(0.0)),  # [m], of a step
        Property("Angle Tolerance", 0.1, number(0.0)),  # [rad]
        Property("Keep", 100, integer(0)),
        *shape_properties(below="Shape/"),
        *COVARIANCE_PROPERTIES,
    )
    _last: Matrix | None = None  # position and quaternion (x, y, z, w) of the last step, shape (7,)

    def reset(self) -> None:
        """Forget all poses."""
        super().reset()
        self._last = None

    def process(self, message: Any) -> None:
        """Show a pose, if it is far enough from the last one that is shown."""
        problem = _problem(message.pose)
        if problem:
            self.statuses.set("error", "Topic", problem)
            return
        (pose,) = numbers_of([message.pose.pose])
        if self._last is not None and self._is_near(self._last, pose):
            return
        transform = self.transform_at(message.header)
        if transform is not None:
            self._last = pose
            self.keep(uncertain(message.pose, transform))

    def parts(self) -> Mapping[str, Drawable]:
        """Return arrows or axes at the poses, and their covariances."""
        poses = list(self.kept)
        return shapes([one.pose for one in poses], self, "Shape/") | covariances(poses, self) if poses else {}

    def _is_near(self, last: Matrix, new: Matrix) -> bool:
        moved = np.linalg.norm(last[:3] - new[:3]) >= self["Position Tolerance"]
        return not moved and _angle(last[3:], new[3:]) < self["Angle Tolerance"]


def _problem(pose: Any) -> str | None:
    """Say in RViz's words why a geometry_msgs/msg/PoseWithCovariance is not shown; no other display asks."""
    if not is_unit(pose.pose.orientation, 10e-3):
        return _NOT_UNIT
    return None if is_finite(pose) else INVALID


def _angle(first: Matrix, second: Matrix) -> float:
    """Return the angle between two orientations, quaternions (x, y, z, w), [rad]."""
    turn = np.cross(second[:3], first[:3]) + second[3] * first[:3] - first[3] * second[:3]
    return 2 * atan2(np.linalg.norm(turn), abs(first @ second))
