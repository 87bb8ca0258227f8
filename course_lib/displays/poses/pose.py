"""The Pose, PoseWithCovariance and PoseArray displays."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from course_lib.displays.drawn_display import DrawnDisplay
from course_lib.displays.frames import Matrix, placed
from course_lib.displays.poses.arrow import matrices, numbers_of, rgba_of, shape_properties, shapes
from course_lib.displays.poses.covariance import (
    COVARIANCE_PROPERTIES,
    Uncertain,
    covariances,
    uncertain,
    uncertain_numbers,
)
from course_lib.displays.properties import Property, number
from course_lib.viewer.drawables import Drawable, Lines

_FLAT = "Arrow (Flat)"
# A flat arrow of length 1 as three lines: shaft, and both sides of its head (flat_arrows_array.cpp).
_STROKES = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 0), (0.75, 0.2, 0), (1, 0, 0), (0.75, -0.2, 0)])


class PoseDisplay(DrawnDisplay):
    """Shows the last pose as an arrow or as axes."""

    class_name = "rviz_default_plugins/Pose"
    type_name = "geometry_msgs/msg/PoseStamped"
    properties = (*DrawnDisplay.properties, *shape_properties())

    def numbers(self, message: Any) -> Matrix:
        """Return those of the pose."""
        return numbers_of([message.pose])

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Keep where the pose is in the fixed frame."""
        return placed(transform_frame_to_fixed, message.pose)

    def parts(self) -> Mapping[str, Drawable]:
        """Return an arrow or axes at the pose."""
        return shapes(list(self.kept), self) if self.kept else {}


class PoseWithCovarianceDisplay(DrawnDisplay):
    """Shows the last pose, and how uncertain it is."""

    class_name = "rviz_default_plugins/PoseWithCovariance"
    type_name = "geometry_msgs/msg/PoseWithCovarianceStamped"
    properties = (*PoseDisplay.properties, *COVARIANCE_PROPERTIES)

    def numbers(self, message: Any) -> Matrix:
        """Return those of the pose and its covariance."""
        return uncertain_numbers(message.pose)

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Uncertain:
        """Keep the pose in the fixed frame, with its covariance."""
        return uncertain(message.pose, transform_frame_to_fixed)

    def parts(self) -> Mapping[str, Drawable]:
        """Return an arrow or axes at the pose, and its covariance."""
        poses = list(self.kept)
        return shapes([one.pose for one in poses], self) | covariances(poses, self) if poses else {}


class PoseArrayDisplay(DrawnDisplay):
    """Shows the poses of the last message as flat arrows, as solid ones, or as axes."""

    class_name = "rviz_default_plugins/PoseArray"
    type_name = "geometry_msgs/msg/PoseArray"
    in_frame = True
    properties = (
        *DrawnDisplay.properties,
        *shape_properties((0.23, 0.01, 0.07, 0.03), (0.3, 0.01), (_FLAT, "Arrow (3D)", "Axes")),
        Property("Arrow Length", 0.3, number()),  # [m]
    )

    def numbers(self, message: Any) -> Matrix:
        """Return those of all poses."""
        return numbers_of(message.poses)

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Keep the poses, shape (N, 4, 4)."""
        return matrices(self.numbers(message))

    def parts(self) -> Mapping[str, Drawable]:
        """Return all arrows or axes at once, in the frame of the message."""
        if not self.kept or not len(poses := self.kept[0]):
            return {}
        if self["Shape"] != _FLAT:
            return shapes(poses, self)
        points = (poses[:, None, :3, :3] @ (_STROKES * self["Arrow Length"])[:, :, None])[..., 0]
        ends = (points + poses[:, None, :3, 3]).reshape(-1, 3)
        return {"arrows": Lines(ends, rgba_of(self), strip=False)}
