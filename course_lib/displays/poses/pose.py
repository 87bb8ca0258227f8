"""RViz's Pose, PoseArray, PoseWithCovariance, Odometry and Path displays."""

from collections.abc import Mapping
from math import atan2
from typing import Any

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.frames import is_unit, placed
from course_lib.displays.poses.shapes import (
    COVARIANCE_PROPERTIES,
    Uncertain,
    arrows,
    axes_at,
    covariances,
    matrices,
    numbers_of,
    rgba_of,
    shape_properties,
    shapes,
    uncertain,
    uncertain_numbers,
)
from course_lib.displays.properties import Property, color, integer, number, vector, words
from course_lib.displays.topic_display import INVALID, DrawnDisplay
from course_lib.viewer.drawables import Drawable, Lines

_FLAT = "Arrow (Flat)"
# A flat arrow of length 1 as three lines: shaft, and both sides of its head (flat_arrows_array.cpp).
_STROKES = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 0), (0.75, 0.2, 0), (1, 0, 0), (0.75, -0.2, 0)])
_NOT_UNIT = "Message contained unnormalized quaternion (squares of values don't add to 1)"
_ARROW = ("Shaft Length", "Shaft Diameter", "Head Length", "Head Diameter")


class PoseDisplay(DrawnDisplay):
    """The last pose as an arrow or as axes."""

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
    """The last pose, and its covariance."""

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
    """The poses of the last message as flat arrows, as solid ones, or as axes."""

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
        """Return all arrows or axes as one drawable, in the frame of the message."""
        if not self.kept or not len(poses := self.kept[0]):
            return {}
        if self["Shape"] != _FLAT:
            return shapes(poses, self)
        points = (poses[:, None, :3, :3] @ (_STROKES * self["Arrow Length"])[:, :, None])[..., 0]
        ends = (points + poses[:, None, :3, 3]).reshape(-1, 3)
        return {"arrows": Lines(ends, rgba_of(self), strip=False)}


class OdometryDisplay(DrawnDisplay):
    """The poses of a moving thing, one for each step that it has moved or turned."""

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


class PathDisplay(DrawnDisplay):
    """The last paths as lines, and their poses as axes or arrows if asked.

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
