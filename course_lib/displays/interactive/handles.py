"""Completion of interactive markers: the handles of controls that have none, names, sizes and titles.

The rules are those of interactive_markers/src/tools.cpp, which RViz's client applies to all that it receives.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from course_lib.arrays import Floats, Matrix
from course_lib.displays.frames import placed
from course_lib.ros.messages import message_class

MENU, BUTTON, MOVE_AXIS, MOVE_PLANE, ROTATE_AXIS, MOVE_ROTATE = range(1, 7)
MOVE_3D, ROTATE_3D, MOVE_ROTATE_3D = range(7, 10)
INHERIT, FIXED, VIEW_FACING = range(3)
_ARROW, _TEXT, _TRIANGLES = 0, 9, 11  # types of markers
_STEPS = 36  # of a ring
_WIDTH = 0.3  # of a ring, as a share of its radius
_DARK = 0.6  # of every second piece of a ring

Message = Any  # of the generated classes, which are known by name only


def make(type_name: str, **fields: Any) -> Message:
    """Return a new message of a type."""
    return message_class(type_name)(**fields)


def complete(marker: Message, transparent: bool) -> None:
    """Fill in what a visualization_msgs/msg/InteractiveMarker leaves out.

    Args:
        marker: Is changed.
        transparent: Whether handles may be transparent.
    """
    if marker.controls:
        marker.scale = marker.scale or 1.0
        _normalize(marker.pose.orientation)
    for control in marker.controls:
        _complete_control(marker, control, transparent)
    names: set[str] = set()
    for number, control in enumerate(marker.controls):
        if control.name in names:
            control.name = f"{control.name}_u{number}"
        names.add(control.name)


def title(marker: Message) -> Message:
    """Return the control that shows the description of an interactive marker."""
    words = _words(marker.description, 0.15 * marker.scale)
    words.pose.position.z = 1.4 * marker.scale
    control = make("visualization_msgs/msg/InteractiveMarkerControl")
    control.orientation_mode, control.always_visible, control.markers = VIEW_FACING, True, [words]
    return control


def rotation_of(quaternion: Message) -> Matrix:
    """Return a geometry_msgs/msg/Quaternion as a rotation, shape (3, 3)."""
    pose = make("geometry_msgs/msg/Pose", orientation=quaternion)
    return placed(np.eye(4), pose)[:3, :3]


def _complete_control(marker: Message, control: Message, transparent: bool) -> None:
    _normalize(control.orientation)
    if not control.markers and control.interaction_mode in _HANDLES:
        control.markers = list(_HANDLES[control.interaction_mode](marker, control))
    for part in control.markers:
        for axis in "xyz":
            setattr(part.scale, axis, getattr(part.scale, axis) or 1.0)
        _normalize(part.pose.orientation)
        if not transparent and part.color.a > 0:
            part.color.a = 1.0


def _normalize(quaternion: Message) -> None:
    """Scale a geometry_msgs/msg/Quaternion to length 1; one of zeros does not turn."""
    numbers = (quaternion.x, quaternion.y, quaternion.z, quaternion.w)
    length = math.hypot(*numbers)
    for axis, number in zip("xyzw", numbers, strict=True):
        setattr(quaternion, axis, number / length if length else float(axis == "w"))


def _arrows(marker: Message, control: Message) -> Iterable[Message]:
    """Yield two arrows that point away from the marker, along the control's x."""
    for sign in (1.0, -1.0):
        arrow = _handle(_ARROW, control, (0.15 * marker.scale, 0.25 * marker.scale, 0.2 * marker.scale))
        arrow.points = _points(np.array([[sign * x * marker.scale, 0, 0] for x in (0.5, 0.9)]))
        yield arrow


def _ring(marker: Message, control: Message) -> Iterable[Message]:
    """Yield a ring round the control's x; rings that turn have dark and bright pieces."""
    ring = _handle(_TRIANGLES, control, (marker.scale,) * 3)
    corners, shades = _PIECES.get(control.interaction_mode, _plain)()
    angles = np.arange(_STEPS) * (2 * math.pi / _STEPS)
    circle = np.column_stack([np.zeros(_STEPS), 0.5 * np.cos(angles), 0.5 * np.sin(angles)])
    both = np.stack([circle, (1 + _WIDTH) * circle])
    ring.points = _points(both[corners[:, 0], corners[:, 1] % _STEPS])
    c = ring.color
    ring.colors = [
        make("std_msgs/msg/ColorRGBA", r=c.r * shade, g=c.g * shade, b=c.b * shade, a=1.0) for shade in shades
    ]
    yield ring


def _button(marker: Message, control: Message) -> Iterable[Message]:
    """Yield the description of a menu, above the marker."""
    control.orientation_mode, control.independent_marker_orientation = VIEW_FACING, False
    size = 0.25 * marker.scale
    words = _words(control.description, size)
    words.pose.position.x, words.pose.position.z = -0.1 * size, 1.2 * marker.scale - 0.1 * size
    yield words


# Corners of triangles as (circle, step): the inner circle is 0, the outer 1; and a shade for each triangle.
Pieces = tuple[Matrix, list[float]]


def _plain() -> Pieces:
    steps = range(_STEPS)
    corners = [((0, i), (1, i), (0, i + 1), (1, i), (1, i + 1), (0, i + 1)) for i in steps]
    return np.reshape(corners, (-1, 2)), []


def _slanted() -> Pieces:
    steps = range(_STEPS)
    corners = [((0, i), (1, i + 1), (0, i + 1), (0, i + 1), (1, i + 1), (1, i + 2)) for i in steps]
    return np.reshape(corners, (-1, 2)), [_DARK + 0.4 * (i % 2) for i in steps for _ in range(2)]


def _toothed() -> Pieces:
    corners, shades = list[tuple[tuple[int, int], ...]](), list[float]()
    for i in range(0, _STEPS, 2):
        corners.append(((0, i), (1, i + 1), (0, i + 1), (0, i + 1), (1, i + 1), (0, i + 2)))
        corners.append(((1, i), (1, i + 1), (0, i), (1, i + 1), (1, i + 2), (0, i + 2)))
        shades += [_DARK, _DARK, 1.0, 1.0]
    return np.reshape(corners, (-1, 2)), shades


_PIECES: Mapping[int, Callable[[], Pieces]] = {ROTATE_AXIS: _slanted, MOVE_ROTATE: _toothed}
_HANDLES: Mapping[int, Callable[[Message, Message], Iterable[Message]]] = {
    MOVE_AXIS: _arrows,
    **dict.fromkeys((MOVE_PLANE, ROTATE_AXIS, MOVE_ROTATE), _ring),
    MENU: _button,
}


def _handle(kind: int, control: Message, scale: tuple[float, ...]) -> Message:
    """Return a marker in the colour of the control's axis: x is red, y green, z blue."""
    marker = make("visualization_msgs/msg/Marker", type=kind)
    marker.pose.orientation = control.orientation
    marker.scale.x, marker.scale.y, marker.scale.z = scale
    x_axis = np.abs(rotation_of(control.orientation)[:, 0])
    marker.color.r, marker.color.g, marker.color.b = map(float, x_axis / x_axis.max())
    marker.color.a = 0.5
    return marker


def _words(words: str, size: float) -> Message:
    marker = make("visualization_msgs/msg/Marker", type=_TEXT, text=words)
    marker.scale.x = marker.scale.y = marker.scale.z = size
    marker.color.r = marker.color.g = marker.color.b = marker.color.a = 1.0
    return marker


def _points(places: Floats) -> list[Message]:
    return [make("geometry_msgs/msg/Point", x=x, y=y, z=z) for x, y, z in places.tolist()]
