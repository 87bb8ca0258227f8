"""RViz's PointStamped, Polygon, Range, AccelStamped, TwistStamped and Wrench displays."""

from collections.abc import Iterator, Mapping
from math import isinf, tan
from typing import Any, ClassVar

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.marker.drawables import ALONG_MINUS_X, ALONG_X, placement, points, turned_to
from course_lib.displays.poses.shapes import arrows, rgba_of
from course_lib.displays.properties import Property, color, flag, integer, number
from course_lib.displays.topic_display import INVALID, DrawnDisplay
from course_lib.viewer.drawables import Drawable, Lines, Solids

_BACK = 0.008824  # share of the range by which RViz draws the cone nearer, to make up for its model


class PolygonDisplay(DrawnDisplay):
    """The last polygon as a closed line."""

    class_name = "rviz_default_plugins/Polygon"
    type_name = "geometry_msgs/msg/PolygonStamped"
    in_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (25, 255, 0), color),
        Property("Alpha", 1.0, number(0.0, 1.0)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return the corners, shape (N, 3), [m]."""
        return points(message.polygon)

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Keep the corners, and once more the first."""
        corners = self.numbers(message)
        return np.vstack([corners, corners[:1]])

    def parts(self) -> Mapping[str, Drawable]:
        """Return the line through all corners."""
        return {"line": Lines(self.kept[0], rgba_of(self))} if self.kept and len(self.kept[0]) else {}


class PointStampedDisplay(DrawnDisplay):
    """The last points as balls; RViz keeps all of them in the frame of the last one."""

    class_name = "rviz_default_plugins/PointStamped"
    type_name = "geometry_msgs/msg/PointStamped"
    length_label, in_frame = "History Length", True
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (204, 41, 204), color),
        Property("Alpha", 1.0, number()),
        Property("Radius", 0.2, number()),  # [m], RViz's word, but it is the diameter
        Property("History Length", 1, integer(1, 100_000)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return the point, shape (3,), [m]."""
        return np.array([message.point.x, message.point.y, message.point.z])

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Keep the point."""
        return self.numbers(message)

    def parts(self) -> Mapping[str, Drawable]:
        """Return all balls."""
        places = [placement(np.eye(3), self["Radius"], point) for point in self.kept]
        return {"points": Solids("sphere", places, rgba_of(self))} if places else {}


class RangeDisplay(DrawnDisplay):
    """The last measurements of a range finder as cones along +x, of the measured length."""

    class_name = "rviz_default_plugins/Range"
    type_name = "sensor_msgs/msg/Range"
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (255, 255, 255), color),
        Property("Alpha", 0.5, number(0.0, 1.0)),
        Property("Buffer Length", 1, integer(1)),
    )
    length_label = "Buffer Length"

    def made(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Keep where the unit cone goes."""
        placed: Matrix = transform_frame_to_fixed @ _cone(_shown_range(message), message.field_of_view)
        return placed

    def parts(self) -> Mapping[str, Drawable]:
        """Return all cones."""
        return {"cones": Solids("cone", list(self.kept), rgba_of(self))} if self.kept else {}


def _shown_range(message: Any) -> float:
    """Return the length of the cone, [m]: 0 for what is out of range, and for NaN.

    A sensor with one distance only says -Inf for "something is nearer".
    """
    if message.min_range <= message.range <= message.max_range:
        return float(message.range)
    fixed = message.min_range == message.max_range
    return float(message.min_range) if fixed and isinf(message.range) and message.range < 0 else 0.0


def _cone(length: float, opening: float) -> Matrix:
    """Place the unit cone with its tip at the origin, open along +x."""
    width = 2 * length * tan(opening / 2)
    return placement(ALONG_MINUS_X, (width, width, length), (length / 2 - _BACK * length, 0.0, 0.0))


_UNIT_ARROW = (1.0, 0.1, 0.3, 0.2)  # lengths and diameters of shaft and head, to be stretched
_ANGLES = np.arange(4, 33) * 2 * np.pi / 32  # of the points of a circle with a gap for its tip
_ALONG_Y = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # takes x to y
_NAN_STATUS = "Message might contain floating point values (nans or infs)"


def _properties(straight: str, turning: str) -> tuple[Property, ...]:
    return (
        *DrawnDisplay.properties,
        Property(f"{straight} Color", (204, 51, 51), color),
        Property(f"{turning} Color", (204, 204, 51), color),
        Property("Alpha", 1.0, number()),
        Property(f"{straight} Arrow Scale", 2.0, number()),  # [m] per unit of the message
        Property(f"{turning} Arrow Scale", 2.0, number()),
        Property("Arrow Width", 0.5, number()),  # [m]; ten times that of the shaft
        Property("History Length", 1, integer(1, 100_000)),
    )


class ScrewDisplay(DrawnDisplay):
    """A straight vector as an arrow, and a turning one as an arrow with a circle around it."""

    path_to_vectors: ClassVar[tuple[str, str, str]]  # the message's field, and both vectors in it
    labels: ClassVar[tuple[str, str]] = ("Linear", "Angular")
    length_label = "History Length"
    properties = (*_properties(*labels), Property("Hide Small Values", True, flag))

    def process(self, message: Any) -> None:
        """Show a message."""
        field, *names = self.path_to_vectors
        both = [getattr(getattr(message, field), name) for name in names]
        vectors = self._accepted(np.array([(v.x, v.y, v.z) for v in both]))
        transform = None if vectors is None else self.transform_at(message.header)
        if vectors is not None and transform is not None:
            self.keep((transform, vectors))

    def parts(self) -> Mapping[str, Drawable]:
        """Return the arrows of all vectors, and what goes around those that turn."""
        width = self["Arrow Width"]
        parts: dict[str, Drawable] = {}
        for row, label in enumerate(self.labels):
            shown = list(self._shown(row, self[f"{label} Arrow Scale"]))
            rgba = rgba_of(self, f"{label} Color")
            if shown:
                poses = [at @ _along(direction, length, width) for at, direction, length in shown]
                parts |= {
                    f"{label} {name}": part for name, part in arrows(poses, *_UNIT_ARROW, rgba=rgba).items()
                }
            if shown and row:
                tips, circles = zip(*(_around(*one, width) for one in shown), strict=True)
                parts["tips"] = Solids("cone", tips, rgba)
                parts |= {f"circle {i}": Lines(c, rgba, abs(width) * 0.05) for i, c in enumerate(circles)}
        return parts

    def _accepted(self, vectors: Matrix) -> Matrix | None:
        """Return the vectors to show, or None if RViz refuses them; wrenches may have zeros for NaNs."""
        if np.isfinite(vectors).all():
            return vectors
        if self._values.get("Accept NaN Values"):
            self.statuses.set("ok", "Topic", _NAN_STATUS)
            return np.nan_to_num(vectors, posinf=0.0, neginf=0.0)
        self.statuses.set("error", "Topic", INVALID)
        return None

    def _shown(self, row: int, scale: float) -> Iterator[tuple[Matrix, Matrix, float]]:
        """Iterate over transform, direction and length of the vectors that are long enough."""
        hides = self._values.get("Hide Small Values", True)  # wrenches have no such property
        for transform, vectors in self.kept:
            size = float(np.linalg.norm(vectors[row]))
            if size and (size * scale > self["Arrow Width"] or not hides):
                yield transform, vectors[row] / size, size * scale


class WrenchDisplay(ScrewDisplay):
    """Forces and torques."""

    class_name = "rviz_default_plugins/Wrench"
    type_name = "geometry_msgs/msg/WrenchStamped"
    path_to_vectors = ("wrench", "force", "torque")
    labels = ("Force", "Torque")
    properties = (*_properties(*labels), Property("Accept NaN Values", False, flag))


class TwistStampedDisplay(ScrewDisplay):
    """Velocities."""

    class_name = "rviz_default_plugins/TwistStamped"
    type_name = "geometry_msgs/msg/TwistStamped"
    path_to_vectors = ("twist", "linear", "angular")


class AccelStampedDisplay(ScrewDisplay):
    """Accelerations."""

    class_name = "rviz_default_plugins/AccelStamped"
    type_name = "geometry_msgs/msg/AccelStamped"
    path_to_vectors = ("accel", "linear", "angular")


def _along(direction: Matrix, length: float, width: float) -> Matrix:
    """Turn and stretch what is along x."""
    return placement(turned_to(direction) @ ALONG_X.T, (length, width, width), (0.0, 0.0, 0.0))


def _around(transform: Matrix, direction: Matrix, length: float, width: float) -> tuple[Matrix, Matrix]:
    """Return where the tip of a circle is, shape (4, 4), and its points, shape (N, 3), in the fixed frame."""
    turned = transform @ placement(_from_z(direction), 1.0, (0.0, 0.0, 0.0))
    radius, height = length / 4, length / 2
    circle = np.column_stack(
        [radius * np.cos(_ANGLES), radius * np.sin(_ANGLES), np.full(len(_ANGLES), height)]
    )
    cone = placement(ALONG_X, (0.2 * width, 0.2 * width, 0.1 * width), (0.05 * width, 0.0, 0.0))
    tip = turned @ placement(_ALONG_Y, 1.0, (radius, 0.0, height)) @ cone
    return tip, circle @ turned[:3, :3].T + turned[:3, 3]


def _from_z(direction: Matrix) -> Matrix:
    """Return the shortest rotation from z to a direction; from z to -z Ogre turns about y."""
    if direction[2] < -1 + 1e-9:
        return np.diag([-1.0, 1.0, -1.0])
    x, y, _ = direction
    cross = np.array([[0, 0, x], [0, 0, y], [-x, -y, 0]])
    turn: Matrix = np.eye(3) + cross + cross @ cross / (1 + direction[2])
    return turn
