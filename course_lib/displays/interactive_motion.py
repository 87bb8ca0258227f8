"""The handles of interactive markers, and the motion of a marker that is dragged.

Handles, names, sizes and titles are completed as in interactive_markers/src/tools.cpp, which RViz's
client applies to all markers. Motion follows RViz's interactive_marker_control.cpp, in the marker's
reference frame [m].
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np

from course_lib.arrays import Floats, Matrix
from course_lib.displays.frames import pose_in_fixed_frame
from course_lib.ros.messages import message_class
from course_lib.viewer.drawables import Camera

MENU, BUTTON, MOVE_AXIS, MOVE_PLANE, ROTATE_AXIS, MOVE_ROTATE = range(1, 7)
MOVE_3D, ROTATE_3D, MOVE_ROTATE_3D = range(7, 10)
INHERIT, FIXED, VIEW_FACING = range(3)
# Types of markers.
_ARROW, _TEXT, _TRIANGLES = 0, 9, 11
# Segments of a ring.
_STEPS = 36
# Width of a ring as a fraction of its radius.
_WIDTH = 0.3
# Brightness of every second segment of a ring.
_DARK = 0.6

# An instance of a generated class.
Message = Any


def make(type_name: str, **fields: Any) -> Message:
    """Create a message of a type."""
    return message_class(type_name)(**fields)


def complete(marker: Message, transparent: bool) -> None:
    """Complete a visualization_msgs/msg/InteractiveMarker in place.

    Args:
        marker: The message to change.
        transparent: Whether handles may be transparent.
    """
    if marker.controls:
        marker.scale = marker.scale or 1.0
        _normalize(marker.pose.orientation)
    for control in marker.controls:
        _normalize(control.orientation)
        if not control.markers and control.interaction_mode in _HANDLES:
            control.markers = list(_HANDLES[control.interaction_mode](marker, control))
        for part in control.markers:
            for axis in "xyz":
                setattr(part.scale, axis, getattr(part.scale, axis) or 1.0)
            _normalize(part.pose.orientation)
            if not transparent and part.color.a > 0:
                part.color.a = 1.0
    names: set[str] = set()
    for number, control in enumerate(marker.controls):
        if control.name in names:
            control.name = f"{control.name}_u{number}"
        names.add(control.name)


def title(marker: Message) -> Message:
    """Return the control that shows the description of an interactive marker."""
    text_marker = _text_marker(marker.description, 0.15 * marker.scale)
    text_marker.pose.position.z = 1.4 * marker.scale
    control = make("visualization_msgs/msg/InteractiveMarkerControl")
    control.orientation_mode, control.always_visible, control.markers = VIEW_FACING, True, [text_marker]
    return control


def rotation_of(quaternion: Message) -> Matrix:
    """Convert a geometry_msgs/msg/Quaternion to a rotation, shape (3, 3)."""
    pose = make("geometry_msgs/msg/Pose", orientation=quaternion)
    return pose_in_fixed_frame(np.eye(4), pose)[:3, :3]


def _normalize(quaternion: Message) -> None:
    """Normalize a geometry_msgs/msg/Quaternion in place; zeros become the identity."""
    numbers = (quaternion.x, quaternion.y, quaternion.z, quaternion.w)
    length = math.hypot(*numbers)
    for axis, number in zip("xyzw", numbers, strict=True):
        setattr(quaternion, axis, number / length if length else float(axis == "w"))


def _arrows(marker: Message, control: Message) -> Iterable[Message]:
    """Yield two arrows that point away from the marker, along the control's x axis."""
    for sign in (1.0, -1.0):
        arrow = _handle(_ARROW, control, (0.15 * marker.scale, 0.25 * marker.scale, 0.2 * marker.scale))
        arrow.points = _points(np.array([[sign * x * marker.scale, 0, 0] for x in (0.5, 0.9)]))
        yield arrow


def _ring(marker: Message, control: Message) -> Iterable[Message]:
    """Yield a ring around the control's x axis; a rotating ring has dark and bright segments."""
    ring = _handle(_TRIANGLES, control, (marker.scale,) * 3)
    # Corners of triangles as (circle, step), with the inner circle 0 and the outer 1, and a shade per
    # triangle.
    corners, shades = list[tuple[tuple[int, int], ...]](), list[float]()
    if control.interaction_mode == ROTATE_AXIS:
        # Slanted segments.
        for i in range(_STEPS):
            corners.append(((0, i), (1, i + 1), (0, i + 1), (0, i + 1), (1, i + 1), (1, i + 2)))
            shades += [_DARK + 0.4 * (i % 2)] * 2
    elif control.interaction_mode == MOVE_ROTATE:
        # Teeth.
        for i in range(0, _STEPS, 2):
            corners.append(((0, i), (1, i + 1), (0, i + 1), (0, i + 1), (1, i + 1), (0, i + 2)))
            corners.append(((1, i), (1, i + 1), (0, i), (1, i + 1), (1, i + 2), (0, i + 2)))
            shades += [_DARK, _DARK, 1.0, 1.0]
    else:
        for i in range(_STEPS):
            corners.append(((0, i), (1, i), (0, i + 1), (1, i), (1, i + 1), (0, i + 1)))
    circle_of, step_of = np.reshape(corners, (-1, 2)).T
    angles = np.arange(_STEPS) * (2 * math.pi / _STEPS)
    circle = np.column_stack([np.zeros(_STEPS), 0.5 * np.cos(angles), 0.5 * np.sin(angles)])
    circles = np.stack([circle, (1 + _WIDTH) * circle])
    ring.points = _points(circles[circle_of, step_of % _STEPS])
    c = ring.color
    ring.colors = [
        make("std_msgs/msg/ColorRGBA", r=c.r * shade, g=c.g * shade, b=c.b * shade, a=1.0) for shade in shades
    ]
    yield ring


def _button(marker: Message, control: Message) -> Iterable[Message]:
    """Yield the marker of a menu control: text above the interactive marker."""
    control.orientation_mode, control.independent_marker_orientation = VIEW_FACING, False
    size = 0.25 * marker.scale
    text_marker = _text_marker(control.description, size)
    text_marker.pose.position.x, text_marker.pose.position.z = -0.1 * size, 1.2 * marker.scale - 0.1 * size
    yield text_marker


_HANDLES: Mapping[int, Callable[[Message, Message], Iterable[Message]]] = {
    MOVE_AXIS: _arrows,
    **dict.fromkeys((MOVE_PLANE, ROTATE_AXIS, MOVE_ROTATE), _ring),
    MENU: _button,
}


def _handle(kind: int, control: Message, scale: tuple[float, ...]) -> Message:
    """Return a marker in the color of the control's axis: x red, y green, z blue."""
    marker = make("visualization_msgs/msg/Marker", type=kind)
    marker.pose.orientation = control.orientation
    marker.scale.x, marker.scale.y, marker.scale.z = scale
    x_axis = np.abs(rotation_of(control.orientation)[:, 0])
    marker.color.r, marker.color.g, marker.color.b = map(float, x_axis / x_axis.max())
    marker.color.a = 0.5
    return marker


def _text_marker(text: str, size: float) -> Message:
    marker = make("visualization_msgs/msg/Marker", type=_TEXT, text=text)
    marker.scale.x = marker.scale.y = marker.scale.z = size
    marker.color.r = marker.color.g = marker.color.b = marker.color.a = 1.0
    return marker


def _points(places: Floats) -> list[Message]:
    return [make("geometry_msgs/msg/Point", x=x, y=y, z=z) for x, y, z in places.tolist()]


_TINY = 1e-9
# Points at most this far from an axis [m] are treated as being on it.
_CENTER = 1e-6
# The rotation per pixel [rad]. As in RViz, 300 pixels are a whole turn.
_TURN = 2 * 3.14 / 300


# All markers need the same axes in each frame.
@lru_cache(maxsize=8)
def axes_of(camera: Camera) -> Matrix:
    """Return the axes of a camera's image as rows: right, up and ahead, shape (3, 3)."""
    right, up, backward = camera.view_matrix()[:3, :3]
    axes = np.array([right, up, -backward])
    axes.setflags(write=False)
    return axes


@dataclass(frozen=True)
class Pointer:
    """The ray below a pointer, and its projection in the camera's image."""

    origin: Floats
    # A vector of unit length.
    direction: Floats
    # Image axes: rows are right, up and ahead.
    axes: Matrix
    # Pixel size [m] at a distance of 1 m, or anywhere without perspective.
    pixel: float
    # Whether there is no perspective: the origin moves with the pointer, and the direction is
    # constant.
    is_orthographic: bool

    def transformed_to(self, transform: Matrix) -> "Pointer":
        """Transform the pointer to another frame."""
        rotation = transform[:3, :3]
        origin = rotation @ self.origin + transform[:3, 3]
        return replace(self, origin=origin, direction=rotation @ self.direction, axes=self.axes @ rotation.T)

    @property
    def image_position(self) -> Floats:
        """The position of the pointer in the image, right and up, in pixels from a fixed point."""
        right, up, depth = self.axes @ (self.origin if self.is_orthographic else self.direction)
        return np.array([right, up]) / (self.pixel if self.is_orthographic else self.pixel * depth)

    def shifted(self, right: float, up: float) -> "Pointer":
        """Return the pointer moved by some pixels."""
        step = self.pixel * (right * self.axes[0] + up * self.axes[1])
        if self.is_orthographic:
            return replace(self, origin=self.origin + step)
        direction = self.direction / (self.axes[2] @ self.direction) + step
        return replace(self, direction=direction / np.linalg.norm(direction))

    def intersect_plane(self, point: Floats, normal: Floats) -> Floats | None:
        """Return the intersection of the ray with a plane, or None."""
        slope = float(normal @ self.direction)
        distance = float(normal @ (point - self.origin)) / slope if abs(slope) > _TINY else -1.0
        return self.origin + distance * self.direction if distance >= 0 else None

    def nearest_on_line(self, point: Floats, direction: Floats) -> Floats | None:
        """Return the point of a line that appears nearest to the pointer; None for a line along the ray."""
        depth = 1.0 if self.is_orthographic else float(self.axes[2] @ (point - self.origin))
        if depth < _TINY:
            return None
        start_in_view = self.axes @ (point - self.origin)
        along = self.axes @ direction
        slope = along[:2] - (0 if self.is_orthographic else start_in_view[:2] * along[2] / depth)
        slope /= depth * self.pixel
        if slope @ slope < 1e-6:
            return None
        ray = self.axes @ self.direction
        start = start_in_view[:2] / (depth * self.pixel) - (
            0 if self.is_orthographic else ray[:2] / ray[2] / self.pixel
        )
        # The pixel of the line in the image that is nearest to the pointer, and the point of the
        # line that is nearest to the ray through this pixel.
        nearest = self.shifted(*(start - slope * (start @ slope) / (slope @ slope)))
        across = float(direction @ nearest.direction)
        bottom = 1.0 - across * across
        if bottom < _TINY:
            return None
        offset = point - nearest.origin
        distance = (float(offset @ nearest.direction) * across - float(offset @ direction)) / bottom
        crossing = point + distance * direction
        is_ahead = self.is_orthographic or float(nearest.axes[2] @ (crossing - nearest.origin)) > 0
        return crossing if is_ahead else None


@dataclass(frozen=True)
class Drag:
    """A control that is being dragged. Its motion depends on its state when it was pressed."""

    mode: int
    # The orientation of the control when it was pressed: columns are x, y and z.
    axes: Matrix
    grabbed_point: Floats
    # Pose of the marker at the start of the drag, shape (4, 4).
    start: Matrix
    # The pointer at the start, at the last change of a modifier key, or at the last relative
    # motion.
    pointer: Pointer
    # Current pose of the marker, shape (4, 4).
    pose: Matrix
    # Rotation since the start [rad].
    rotation_angle: float = 0.0
    # Whether this modifier key is held.
    shift: bool = False
    ctrl: bool = False

    def move_to(self, pointer: Pointer, shift: bool = False, ctrl: bool = False) -> "Drag":
        """Return the drag after the pointer has moved."""
        drag = self
        if (shift, ctrl) != (self.shift, self.ctrl):
            # Another key changes the kind of motion, so the drag starts again at the current pose.
            grab = self.grabbed_point + self.pose[:3, 3] - self.start[:3, 3]
            hit = pointer.intersect_plane(grab, pointer.axes[2])
            grab = grab if hit is None else hit
            drag = replace(self, grabbed_point=grab, start=self.pose, pointer=pointer, shift=shift, ctrl=ctrl)
        return _MOVES[drag.mode](drag, pointer) if drag.mode in _MOVES else drag


Move: TypeAlias = Callable[[Drag, Pointer], Drag]


def _move_axis(drag: Drag, pointer: Pointer) -> Drag:
    nearest = pointer.nearest_on_line(drag.grabbed_point, drag.axes[:, 0])
    return drag if nearest is None else _shift(drag, nearest - drag.grabbed_point)


def _move_plane(drag: Drag, pointer: Pointer) -> Drag:
    hit = pointer.intersect_plane(drag.grabbed_point, drag.axes[:, 0])
    return drag if hit is None else _shift(drag, hit - drag.grabbed_point)


def _shift(drag: Drag, step: Floats) -> Drag:
    """Return the drag with the marker moved from its starting pose."""
    pose = drag.start.copy()
    pose[:3, 3] += step
    return replace(drag, pose=pose)


def _rotate_axis(drag: Drag, pointer: Pointer) -> Drag:
    axis, at = drag.axes[:, 0], drag.start[:3, 3]
    center = at + axis * (axis @ (drag.grabbed_point - at))
    hit = pointer.intersect_plane(center, axis)
    if hit is None:
        return drag
    angle = _angle(drag.grabbed_point - center, hit - center, axis)
    return replace(drag, pose=_rotate(drag.start, axis, angle), rotation_angle=angle)


def _move_rotate(drag: Drag, pointer: Pointer) -> Drag:
    """Turn the marker towards the pointer and move it there, like a towed trailer."""
    axis, at, start = drag.axes[:, 0], drag.pose[:3, 3], drag.start[:3, 3]
    offset = rotation(axis, drag.rotation_angle) @ (drag.grabbed_point - start)
    center = at + axis * (axis @ offset)
    hit = pointer.intersect_plane(center, axis)
    if hit is None or (distance := float(np.linalg.norm(hit - center))) < _CENTER:
        return drag
    before = at + offset - center
    angle = _angle(before, hit - center, axis)
    pose = _rotate(drag.pose, axis, angle)
    pose[:3, 3] += (hit - center) * (1 - np.linalg.norm(before) / distance)
    return replace(drag, pose=pose, rotation_angle=drag.rotation_angle + angle)


def _move_3d(drag: Drag, pointer: Pointer) -> Drag:
    """Move the marker parallel to the image; with Shift along the line of sight."""
    if not drag.shift:
        hit = pointer.intersect_plane(drag.grabbed_point, pointer.axes[2])
        return drag if hit is None else _shift(drag, hit - drag.grabbed_point)
    right, up = pointer.image_position - drag.pointer.image_position
    # The distance along the line of sight for one pixel, [m].
    rays = (drag.pointer, drag.pointer.shifted(0, -10))
    start, end = (ray.intersect_plane(drag.grabbed_point, drag.axes[:, 0]) for ray in rays)
    scale = 0.001 if start is None or end is None else float(np.linalg.norm(end - start)) / 10 or 0.001
    pose = drag.pose.copy()
    pose[:3, 3] += scale * (right if abs(right) > abs(up) else up) * drag.pointer.direction
    return replace(drag, pose=pose, pointer=pointer)


def _rotate_3d(drag: Drag, pointer: Pointer) -> Drag:
    """Rotate the marker about the axes of the image; with Shift about the line of sight."""
    step_right, step_up = (pointer.image_position - drag.pointer.image_position) * _TURN
    right, up, forward = pointer.axes
    if drag.shift:
        pose = _rotate(drag.pose, forward, -step_up if abs(step_up) > abs(step_right) else step_right)
    else:
        pose = _rotate(_rotate(drag.pose, right, -step_up), up, step_right)
    return replace(drag, pose=pose, pointer=pointer)


_MOVES: Mapping[int, Move] = {
    MOVE_AXIS: _move_axis,
    MOVE_PLANE: _move_plane,
    ROTATE_AXIS: _rotate_axis,
    MOVE_ROTATE: _move_rotate,
    MOVE_3D: _move_3d,
    ROTATE_3D: _rotate_3d,
    MOVE_ROTATE_3D: lambda drag, pointer: (_rotate_3d if drag.ctrl else _move_3d)(drag, pointer),
}


def _angle(before: Floats, after: Floats, axis: Floats) -> float:
    """Return the angle between two directions about an axis [rad], or 0 if the first one has length 0."""
    if np.linalg.norm(before) < _CENTER:
        return 0.0
    sine, cosine = axis @ np.cross(before, after), before @ after - (axis @ before) * (axis @ after)
    return float(np.arctan2(sine, cosine))


def _rotate(pose: Matrix, axis: Floats, angle: float) -> Matrix:
    """Rotate a pose about its own position."""
    rotated_pose = pose.copy()
    rotated_pose[:3, :3] = rotation(axis, angle) @ pose[:3, :3]
    return rotated_pose


def rotation(axis: Floats, angle: float) -> Matrix:
    """Return the rotation by an angle about a unit axis, shape (3, 3)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    matrix: Matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return matrix


def facing(control: Matrix, camera: Matrix, angle: float) -> Matrix:
    """Return the orientation of a control that faces the viewer: x ahead, z up in the image.

    Args:
        control: The control's own orientation, shape (3, 3).
        camera: The camera axes; rows are right, up and ahead, shape (3, 3).
        angle: The rotation about the line of sight by dragging [rad].
    """
    _, up, forward = camera
    target_axes = np.column_stack([forward, np.cross(up, forward), up])
    faced: Matrix = rotation(forward, angle) @ target_axes @ control.T
    return faced
