"""RViz's view controllers that look around from a point."""

from dataclasses import replace
from math import asin, atan2, pi
from typing import Any

import numpy as np

from course_lib.arrays import Floats, Matrix
from course_lib.displays.properties import Property, flag, number, vector, words
from course_lib.displays.view_controller import COMMON, PITCH_LIMIT, Hands, ViewController, direction, point
from course_lib.viewer.camera import Camera

_AXES = {
    "+x axis": (1, 0, 0), "-x axis": (-1, 0, 0), "+y axis": (0, 1, 0),
    "-y axis": (0, -1, 0), "+z axis": (0, 0, 1), "-z axis": (0, 0, -1),
}  # fmt: skip


class FPS(ViewController):
    """Looks around from a point."""

    class_name = "rviz_default_plugins/FPS"
    properties: tuple[Property, ...] = (
        *COMMON,
        Property("Yaw", 1.25 * pi, number()),
        Property("Pitch", atan2(10.0, 50.0**0.5), number(-PITCH_LIMIT, PITCH_LIMIT)),  # [rad] downward
        Property("Position", (5.0, 5.0, 10.0), vector),  # [m]
    )

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        turned = self._turned(transform_target_to_fixed)
        eye = transform_target_to_fixed[:3, 3] + turned @ np.array(self["Position"])
        target = eye + turned @ direction(self["Yaw"], -self["Pitch"])
        return Camera(point(eye), point(target), point(turned[:, 2]), near=self["Near Clip Distance"])

    def _taken(self, camera: Camera, ahead: Floats, transform_target_to_fixed: Matrix) -> dict[str, Any]:
        turned = self._turned(transform_target_to_fixed)
        position = point(turned.T @ (camera.eye - transform_target_to_fixed[:3, 3]))
        return {"Position": position, **_angles(turned.T @ ahead)}

    def _turned(self, transform_target_to_fixed: Matrix) -> Floats:
        """Return how the view is turned with the target frame, shape (3, 3)."""
        return np.eye(3)


class FrameAligned(FPS):
    """Looks around from a point of the target frame, and goes along with all of the frame's motion.

    RViz has it from Jazzy 14.1.11 on; it begins at the frame's origin and looks along one of its axes.
    """

    class_name = "rviz_default_plugins/FrameAligned"
    properties = (
        *COMMON,
        Property("Point towards", "-z axis", words("arbitrary", *_AXES)),
        Property("Yaw", 0.0, number()),
        Property("Pitch", PITCH_LIMIT, number(-PITCH_LIMIT, PITCH_LIMIT)),  # [rad] downward
        Property("Position", (0.0, 0.0, 0.0), vector),  # [m]
        Property("Lock Camera", False, flag),
    )

    def changed(self, label: str) -> None:
        """Look along the axis that was chosen, or find out which one it is."""
        ahead = _AXES.get(self["Point towards"])
        if label == "Point towards" and ahead:
            self._values |= {"Position": (0.0, 0.0, 0.0), **_angles(np.array(ahead))}
        elif label in ("Yaw", "Pitch"):
            self._name_axis()
        super().changed(label)

    def take(self, camera: Camera) -> None:
        """Have the properties that look as a view does which was turned by hand."""
        super().take(camera)
        self._name_axis()

    def hands(self) -> Hands:
        """Return the rules by which a page turns the view."""
        return replace(super().hands(), aligned=True, locked=self["Lock Camera"])

    def _name_axis(self) -> None:
        ahead = direction(self["Yaw"], -self["Pitch"])
        near = (name for name, axis in _AXES.items() if ahead @ axis > 0.999)
        self._values["Point towards"] = next(near, "arbitrary")

    def _turned(self, transform_target_to_fixed: Matrix) -> Floats:
        return transform_target_to_fixed[:3, :3]

    def _keep_place(self, moved: Floats) -> None:
        """Jump to the new frame."""


def _angles(ahead: Floats) -> dict[str, float]:
    """Return where a direction points to, [rad]; pitch is downward."""
    x, y, z = ahead / np.linalg.norm(ahead)
    return {
        "Yaw": atan2(y, x) % (2 * pi),
        "Pitch": min(max(-asin(min(max(z, -1.0), 1.0)), -PITCH_LIMIT), PITCH_LIMIT),
    }
