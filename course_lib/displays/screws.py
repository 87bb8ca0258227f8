"""Displays of forces and velocities: Wrench, TwistStamped and AccelStamped (WrenchVisual, ScrewVisual)."""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.drawn_display import INVALID, DrawnDisplay
from course_lib.displays.marker.drawables import ALONG_X, placement, turned_to
from course_lib.displays.poses.arrow import arrows, rgba_of
from course_lib.displays.properties import Property, color, flag, integer, number
from course_lib.viewer.drawables import Drawable, Lines, Solids

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
    """Shows a straight vector as an arrow, and a turning one as an arrow with a circle around it."""

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
    """Shows forces and torques."""

    class_name = "rviz_default_plugins/Wrench"
    type_name = "geometry_msgs/msg/WrenchStamped"
    path_to_vectors = ("wrench", "force", "torque")
    labels = ("Force", "Torque")
    properties = (*_properties(*labels), Property("Accept NaN Values", False, flag))


class TwistStampedDisplay(ScrewDisplay):
    """Shows velocities."""

    class_name = "rviz_default_plugins/TwistStamped"
    type_name = "geometry_msgs/msg/TwistStamped"
    path_to_vectors = ("twist", "linear", "angular")


class AccelStampedDisplay(ScrewDisplay):
    """Shows accelerations."""

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
