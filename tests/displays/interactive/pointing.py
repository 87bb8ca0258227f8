"""Pointers of a test camera, and commands in the form in which pages send them."""

from typing import Any

import numpy as np

from course_lib.arrays import Floats, Vector
from course_lib.displays.interactive_motion import Pointer
from course_lib.displays.panel.protocol import UseControl
from course_lib.viewer.drawables import Camera

PIXEL = 0.0015  # [m] at a distance of 1 m


def pointer_at(place: Floats, camera: Camera) -> Pointer:
    """Return the pointer at a point of the scene."""
    right, up, behind = camera.view_matrix()[:3, :3]
    axes = np.array([right, up, -behind])
    eye = np.array(camera.eye)
    if camera.orthographic_scale is None:
        ray = place - eye
        return Pointer(eye, ray / np.linalg.norm(ray), axes, PIXEL, is_orthographic=False)
    aside = axes[:2] @ (place - eye)
    return Pointer(eye + aside @ axes[:2], axes[2], axes, 1 / camera.orthographic_scale, is_orthographic=True)


def command(
    path: str,
    event: str,
    at: Vector,
    *,
    camera: Camera | None = None,
    button: int = 0,
    on: bool = True,
    **keys: Any,
) -> UseControl:
    """Return the command that a page sends for a pointer at a point, `on` an object or the background."""
    camera = camera or Camera(eye=(10.0, 0.0, 5.0))
    pointer = pointer_at(np.array(at), camera)
    return UseControl(
        path=path,
        event=event,
        button=button,
        origin=vector(pointer.origin),
        direction=vector(pointer.direction),
        eye=camera.eye,
        target=camera.target,
        up=camera.up,
        scale=camera.orthographic_scale or 0.0,
        pixel=pointer.pixel,
        shift=keys.get("shift", False),
        ctrl=keys.get("ctrl", False),
        point=at if on else None,
    )


def vector(numbers: Floats) -> Vector:
    x, y, z = map(float, numbers)
    return x, y, z
