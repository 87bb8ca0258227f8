"""ARROW, CUBE, SPHERE, CYLINDER and TEXT_VIEW_FACING."""

from typing import Any

import numpy as np

from course_lib.displays.marker.drawn import Drawn, Floats, label, points, refused, rgba, scale_of
from course_lib.displays.statuses import Level
from course_lib.viewer.drawables import Shape, Solids, Text

SHAFT, HEAD = 0.77, 0.23  # shares of an arrow's length
SOLIDS: dict[int, Shape] = {1: "box", 2: "sphere", 3: "cylinder"}
ALONG_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # takes z of the solids to x
ALONG_MINUS_X = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
_FLAT: tuple[Level, str] = ("warn", "Scale of 0 in one of x/y/z")


def solid(marker: Any) -> Drawn:
    """Draw a cube, a sphere or a cylinder: the scale is its full extent."""
    scale = scale_of(marker)
    placement = np.diag([*scale, 1.0])
    body = Solids(SOLIDS[marker.type], [placement], rgba(marker.color))
    return Drawn({"body": body}, None if scale.all() else _FLAT)


def arrow(marker: Any) -> Drawn:
    """Draw an arrow along +x from the pose, or between two points given in the frame of the pose."""
    if len(marker.points) == 1:
        return refused(f"Arrow marker [{label(marker)}] only specified one point of a point to point arrow.")
    if len(marker.points) == 2:
        return _arrow_between(marker)
    length, width, height = scale = scale_of(marker)
    shaft = placement(ALONG_X, (width, height, SHAFT * length), (SHAFT * length / 2, 0.0, 0.0))
    head_center = ((SHAFT + HEAD / 2) * length, 0.0, 0.0)
    head = placement(ALONG_X, (2 * width, 2 * height, HEAD * length), head_center)
    return _arrow(marker, shaft, head, None if scale.all() else _FLAT)


def text(marker: Any) -> Drawn:
    """Draw text that faces the viewer: z of the scale is the height of its letters."""
    height = marker.scale.z
    if not height or not marker.text:
        return Drawn()
    return Drawn({"text": Text(marker.text, abs(height), rgba(marker.color))})


def _arrow_between(marker: Any) -> Drawn:
    """Draw an arrow of two points: scale x is the shaft's diameter, y the head's, z the head's length."""
    start, end = points(marker)
    distance = float(np.linalg.norm(end - start))
    shaft_diameter, head_diameter, head_length = scale_of(marker)
    status: tuple[Level, str] = ("warn", "Scale of 0 in both x and y")
    said = status if shaft_diameter + head_diameter == 0 else None
    if not distance:
        return Drawn(status=said)
    head_length = min(max(head_length, 0.0), distance) if head_length else HEAD * distance
    shaft_length = distance - head_length
    along = turned_to((end - start) / distance)
    shaft_size = (shaft_diameter, shaft_diameter, shaft_length)
    head_size = (head_diameter, head_diameter, head_length)
    shaft = placement(along, shaft_size, start + along[:, 2] * shaft_length / 2)
    head = placement(along, head_size, end - along[:, 2] * head_length / 2)
    return _arrow(marker, shaft, head, said)


def _arrow(marker: Any, shaft: Floats, head: Floats, status: tuple[Level, str] | None) -> Drawn:
    color = rgba(marker.color)
    return Drawn({"shaft": Solids("cylinder", [shaft], color), "head": Solids("cone", [head], color)}, status)


def turned_to(direction: Floats) -> Floats:
    """Return a rotation that takes z to a direction, shape (3, 3)."""
    helper = np.eye(3)[np.argmin(np.abs(direction))]
    x = np.cross(helper, direction)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(direction, x), direction])


def placement(rotation: Floats, size: Any, center: Any) -> Floats:
    """Return the transform that scales a unit shape, turns it and moves it, shape (4, 4)."""
    transform = np.eye(4)
    transform[:3, :3] = rotation * np.asarray(size)
    transform[:3, 3] = center
    return transform
