"""Motion of interactive markers: a pointer's ray, and what it does to the pose by the rules of a control.

The rules are those of RViz's interactive_marker_control.cpp. All is in the marker's reference frame, [m].
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from course_lib.arrays import Floats, Matrix
from course_lib.displays.interactive.handles import (
    MOVE_3D,
    MOVE_AXIS,
    MOVE_PLANE,
    MOVE_ROTATE,
    MOVE_ROTATE_3D,
    ROTATE_3D,
    ROTATE_AXIS,
)
from course_lib.viewer.camera import Camera

_TINY = 1e-9
_CENTER = 1e-6  # [m] from an axis to what is on it
_TURN = 2 * 3.14 / 300  # [rad] per pixel: RViz's 300 pixels for a whole turn


@lru_cache(maxsize=8)  # every marker needs it in every frame
def axes_of(camera: Camera) -> Matrix:
    """Return the axes of a camera's picture: rows are right, up and ahead, shape (3, 3)."""
    right, up, behind = camera.view_matrix()[:3, :3]
    axes = np.array([right, up, -behind])
    axes.setflags(write=False)
    return axes


@dataclass(frozen=True)
class Pointer:
    """The ray below a pointer, and how the camera sees it."""

    origin: Floats
    direction: Floats  # of unit length
    axes: Matrix  # of the picture: rows are right, up and ahead
    pixel: float  # [m] at a distance of 1 m; without perspective everywhere
    flat: bool  # no perspective: the origin moves with the pointer, the direction is always the same

    def seen_from(self, transform: Matrix) -> "Pointer":
        """Return the same pointer in another frame; the transform takes coordinates there."""
        rotation = transform[:3, :3]
        origin = rotation @ self.origin + transform[:3, 3]
        return replace(self, origin=origin, direction=rotation @ self.direction, axes=self.axes @ rotation.T)

    @property
    def at(self) -> Floats:
        """The place of the pointer in the picture, right and up, in pixels from a fixed point."""
        right, up, ahead = self.axes @ (self.origin if self.flat else self.direction)
        return np.array([right, up]) / (self.pixel if self.flat else self.pixel * ahead)

    def moved(self, right: float, up: float) -> "Pointer":
        """Return the pointer some pixels further."""
        step = self.pixel * (right * self.axes[0] + up * self.axes[1])
        if self.flat:
            return replace(self, origin=self.origin + step)
        direction = self.direction / (self.axes[2] @ self.direction) + step
        return replace(self, direction=direction / np.linalg.norm(direction))

    def on_plane(self, point: Floats, normal: Floats) -> Floats | None:
        """Return the point below the pointer on a plane; None if the ray does not meet it."""
        slope = float(normal @ self.direction)
        far = float(normal @ (point - self.origin)) / slope if abs(slope) > _TINY else -1.0
        return self.origin + far * self.direction if far >= 0 else None

    def on_line(self, point: Floats, direction: Floats) -> Floats | None:
        """Return the point of a line that is seen nearest to the pointer; None if the line is one dot."""
        depth = 1.0 if self.flat else float(self.axes[2] @ (point - self.origin))
        if depth < _TINY:
            return None
        seen = self.axes @ (point - self.origin)
        along = self.axes @ direction
        slope = along[:2] - (0 if self.flat else seen[:2] * along[2] / depth)
        slope /= depth * self.pixel
        if slope @ slope < 1e-6:
            return None
        ray = self.axes @ self.direction
        start = seen[:2] / (depth * self.pixel) - (0 if self.flat else ray[:2] / ray[2] / self.pixel)
        nearest = self.moved(*(start - slope * (start @ slope) / (slope @ slope)))
        return nearest._crossing(point, direction)

    def _crossing(self, point: Floats, direction: Floats) -> Floats | None:
        """Return the point of a line that is nearest to the ray."""
        across = float(direction @ self.direction)
        bottom = 1.0 - across * across
        if bottom < _TINY:
            return None
        apart = point - self.origin
        far = (float(apart @ self.direction) * across - float(apart @ direction)) / bottom
        found = point + far * direction
        ahead = float(self.axes[2] @ (found - self.origin))
        return found if self.flat or ahead > 0 else None


@dataclass(frozen=True)
class Drag:
    """A control that is held; what it does depends on where it was when it was pressed."""

    mode: int
    axes: Matrix  # of the control when it was pressed: columns are x, y and z
    grab: Floats  # the point that was pressed
    start: Matrix  # pose of the marker then, shape (4, 4)
    pointer: Pointer  # then, or when a key was pressed or released, or at the last relative move
    pose: Matrix  # of the marker now, shape (4, 4)
    turned: float = 0.0  # since then, [rad]
    shift: bool = False  # the keys that are held
    ctrl: bool = False

    def to(self, pointer: Pointer, shift: bool = False, ctrl: bool = False) -> "Drag":
        """Return the drag with the pointer at another place."""
        drag = self
        if (shift, ctrl) != (self.shift, self.ctrl):
            drag = replace(_regrabbed(self, pointer), shift=shift, ctrl=ctrl)
        return _MOVES.get(drag.mode, _rest)(drag, pointer)


Move: TypeAlias = Callable[[Drag, Pointer], Drag]


def _rest(drag: Drag, pointer: Pointer) -> Drag:
    return drag


def _regrabbed(drag: Drag, pointer: Pointer) -> Drag:
    """Return the drag as if it began here, with the marker where it is."""
    grab = drag.grab + drag.pose[:3, 3] - drag.start[:3, 3]
    found = pointer.on_plane(grab, pointer.axes[2])
    return replace(drag, grab=grab if found is None else found, start=drag.pose, pointer=pointer)


def _move_axis(drag: Drag, pointer: Pointer) -> Drag:
    found = pointer.on_line(drag.grab, drag.axes[:, 0])
    return drag if found is None else _shifted(drag, found - drag.grab)


def _move_plane(drag: Drag, pointer: Pointer) -> Drag:
    found = pointer.on_plane(drag.grab, drag.axes[:, 0])
    return drag if found is None else _shifted(drag, found - drag.grab)


def _shifted(drag: Drag, step: Floats) -> Drag:
    """Return the drag with the marker moved from where it was pressed."""
    pose = drag.start.copy()
    pose[:3, 3] += step
    return replace(drag, pose=pose)


def _rotate_axis(drag: Drag, pointer: Pointer) -> Drag:
    axis, at = drag.axes[:, 0], drag.start[:3, 3]
    center = at + axis * (axis @ (drag.grab - at))
    found = pointer.on_plane(center, axis)
    if found is None:
        return drag
    angle = _angle(drag.grab - center, found - center, axis)
    return replace(drag, pose=_turned(drag.start, axis, angle), turned=angle)


def _move_rotate(drag: Drag, pointer: Pointer) -> Drag:
    """Turn the marker towards the pointer and pull it there, like a trailer."""
    axis, at, start = drag.axes[:, 0], drag.pose[:3, 3], drag.start[:3, 3]
    offset = rotation(axis, drag.turned) @ (drag.grab - start)
    center = at + axis * (axis @ offset)
    found = pointer.on_plane(center, axis)
    if found is None or (far := float(np.linalg.norm(found - center))) < _CENTER:
        return drag
    before = at + offset - center
    angle = _angle(before, found - center, axis)
    pose = _turned(drag.pose, axis, angle)
    pose[:3, 3] += (found - center) * (1 - np.linalg.norm(before) / far)
    return replace(drag, pose=pose, turned=drag.turned + angle)


def _move_3d(drag: Drag, pointer: Pointer) -> Drag:
    """Move the marker across the picture; with Shift away from the viewer, or back."""
    if not drag.shift:
        found = pointer.on_plane(drag.grab, pointer.axes[2])
        return drag if found is None else _shifted(drag, found - drag.grab)
    right, up = pointer.at - drag.pointer.at
    pose = drag.pose.copy()
    pose[:3, 3] += _z_scale(drag) * (right if abs(right) > abs(up) else up) * drag.pointer.direction
    return replace(drag, pose=pose, pointer=pointer)


def _z_scale(drag: Drag) -> float:
    """Return how far the marker moves away for a pixel, [m]."""
    ends = [ray.on_plane(drag.grab, drag.axes[:, 0]) for ray in (drag.pointer, drag.pointer.moved(0, -10))]
    if ends[0] is None or ends[1] is None:
        return 0.001
    return float(np.linalg.norm(ends[1] - ends[0])) / 10 or 0.001


def _rotate_3d(drag: Drag, pointer: Pointer) -> Drag:
    """Turn the marker round the picture's axes; with Shift round the line of sight."""
    step_right, step_up = (pointer.at - drag.pointer.at) * _TURN
    right, up, ahead = pointer.axes
    if drag.shift:
        pose = _turned(drag.pose, ahead, -step_up if abs(step_up) > abs(step_right) else step_right)
    else:
        pose = _turned(_turned(drag.pose, right, -step_up), up, step_right)
    return replace(drag, pose=pose, pointer=pointer)


def _move_rotate_3d(drag: Drag, pointer: Pointer) -> Drag:
    return (_rotate_3d if drag.ctrl else _move_3d)(drag, pointer)


_MOVES: Mapping[int, Move] = {
    MOVE_AXIS: _move_axis,
    MOVE_PLANE: _move_plane,
    ROTATE_AXIS: _rotate_axis,
    MOVE_ROTATE: _move_rotate,
    MOVE_3D: _move_3d,
    ROTATE_3D: _rotate_3d,
    MOVE_ROTATE_3D: _move_rotate_3d,
}


def _angle(before: Floats, after: Floats, axis: Floats) -> float:
    """Return the angle between two directions about an axis, [rad]; 0 if the first one has no length."""
    if np.linalg.norm(before) < _CENTER:
        return 0.0
    sine, cosine = axis @ np.cross(before, after), before @ after - (axis @ before) * (axis @ after)
    return float(np.arctan2(sine, cosine))


def _turned(pose: Matrix, axis: Floats, angle: float) -> Matrix:
    """Return a pose turned about its own position."""
    turned = pose.copy()
    turned[:3, :3] = rotation(axis, angle) @ pose[:3, :3]
    return turned


def rotation(axis: Floats, angle: float) -> Matrix:
    """Return the rotation by an angle about a unit axis, shape (3, 3)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: Matrix = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turned


def facing(control: Matrix, camera: Matrix, turned: float) -> Matrix:
    """Return the orientation of a control that faces the viewer: x ahead, z up in the picture.

    Args:
        control: Its own orientation, shape (3, 3).
        camera: Rows are right, up and ahead, shape (3, 3).
        turned: By hand, about the line of sight, [rad].
    """
    _, up, ahead = camera
    wanted = np.column_stack([ahead, np.cross(up, ahead), up])
    faced: Matrix = rotation(ahead, turned) @ wanted @ control.T
    return faced
