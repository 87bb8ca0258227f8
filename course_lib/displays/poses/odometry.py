"""The Odometry display."""

from collections.abc import Mapping
from math import atan2
from typing import Any

import numpy as np

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.frames import Matrix, is_unit
from course_lib.displays.poses.arrow import numbers_of, shape_properties, shapes
from course_lib.displays.poses.covariance import (
    COVARIANCE_PROPERTIES,
    Uncertain,
    covariances,
    uncertain,
    uncertain_numbers,
)
from course_lib.displays.properties import Property, integer, number
from course_lib.viewer.drawables import Drawable

_NOT_UNIT = "Message contained unnormalized quaternion (squares of values don't add to 1)"


class OdometryDisplay(DrawnDisplay):
    """Shows where something has been: a pose for each step that it has moved or turned."""

    class_name = "rviz_default_plugins/Odometry"
    type_name = "nav_msgs/msg/Odometry"
    length_label = "Keep"
    properties = (
        *DrawnDisplay.properties,
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
        (pose,) = numbers_of([message.pose.pose])
        is_finite = np.isfinite(self.numbers(message)).all()
        if not is_unit(message.pose.pose.orientation, 10e-3):
            self.statuses.set("error", "Topic", _NOT_UNIT)  # as no other display
        elif not is_finite or self._last is None or not self._is_near(self._last, pose):
            super().process(message)

    def numbers(self, message: Any) -> Matrix:
        """Return those of the pose and its covariance."""
        return uncertain_numbers(message.pose)

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Uncertain:
        """Keep the pose in the fixed frame, with its covariance."""
        (self._last,) = numbers_of([message.pose.pose])
        return uncertain(message.pose, transform_frame_to_fixed)

    def parts(self) -> Mapping[str, Drawable]:
        """Return arrows or axes at the poses, and their covariances."""
        poses = list(self.kept)
        return shapes([one.pose for one in poses], self, "Shape/") | covariances(poses, self) if poses else {}

    def _is_near(self, last: Matrix, new: Matrix) -> bool:
        moved = np.linalg.norm(last[:3] - new[:3]) >= self["Position Tolerance"]
        return not moved and _angle(last[3:], new[3:]) < self["Angle Tolerance"]


def _angle(first: Matrix, second: Matrix) -> float:
    """Return the angle between two orientations, quaternions (x, y, z, w), [rad]."""
    turn = np.cross(second[:3], first[:3]) + second[3] * first[:3] - first[3] * second[:3]
    return 2 * atan2(np.linalg.norm(turn), abs(first @ second))
