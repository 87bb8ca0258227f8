"""RViz's view controllers: around a point, from above, and from a point."""

from collections.abc import Mapping
from dataclasses import replace
from math import asin, atan2, cos, pi, sin
from typing import Any

import numpy as np

from course_lib.arrays import Floats, Matrix
from course_lib.displays.frames import Frames
from course_lib.displays.layout import text_at
from course_lib.displays.properties import Property, flag, number, vector, words
from course_lib.displays.view_controller import COMMON, PITCH_LIMIT, Hands, ViewController, direction, point
from course_lib.viewer.camera import Camera

__all__ = ["FPS", "FrameAligned", "Orbit", "ThirdPersonFollower", "TopDownOrtho", "ViewController", "XYOrbit"]

_TOP_HEIGHT = 500.0  # [m] of the camera that looks down


class Orbit(ViewController):
    """A camera around a focal point, which follows the target frame's position.

    Args:
        properties: By RViz's labels: `Orbit(distance=6.0)`; in [m] and [rad].
    """

    class_name = "rviz_default_plugins/Orbit"
    properties = (
        *COMMON,
        Property("Distance", 10.0, number(0.001)),  # [m]
        Property("Yaw", pi / 4, number()),
        Property("Pitch", pi / 4, number(-PITCH_LIMIT, PITCH_LIMIT)),  # [rad]
        Property("Focal Point", (0.0, 0.0, 0.0), vector),  # [m]
    )

    turns = False  # about z, with the target frame

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        turned, sign = self._turned(transform_target_to_fixed), self._sign()
        away = turned @ direction(sign * self["Yaw"], sign * self["Pitch"])
        lifted = self._lifted(away, self["Distance"])
        focus = transform_target_to_fixed[:3, 3] + turned @ np.array(self["Focal Point"]) + lifted
        eye = focus + self["Distance"] * away
        return Camera(point(eye), point(focus), (0.0, 0.0, sign), near=self["Near Clip Distance"])

    def _taken(self, camera: Camera, ahead: Floats, transform_target_to_fixed: Matrix) -> dict[str, Any]:
        turned, sign = self._turned(transform_target_to_fixed), self._sign()
        distance = float(np.linalg.norm(ahead))
        x, y, z = away = turned.T @ -ahead / distance
        focus = camera.target - self._lifted(turned @ away, distance) - transform_target_to_fixed[:3, 3]
        yaw, pitch = sign * atan2(y, x) % (2 * pi), sign * asin(min(max(z, -1.0), 1.0))
        return {"Distance": distance, "Yaw": yaw, "Pitch": pitch, "Focal Point": point(turned.T @ focus)}

    def _turned(self, transform_target_to_fixed: Matrix) -> Floats:
        x, y = transform_target_to_fixed[:2, 0]
        return _about_z(atan2(y, x) if self.turns else 0.0)

    def _sign(self) -> float:
        return -1.0 if self["Invert Z Axis"] else 1.0

    def _lifted(self, away: Floats, distance: float) -> Floats:
        """Return how far the camera is moved up in the picture."""
        up = np.array([0.0, 0.0, self._sign()])
        picture_up = up - away * (away @ up)
        lifted: Floats = picture_up * distance * self.lift / max(float(np.linalg.norm(picture_up)), 1e-9)
        return lifted


class XYOrbit(Orbit):
    """An Orbit whose focal point is on the ground, seen in the lower half of the picture.

    Args:
        properties: By RViz's labels: `XYOrbit(distance=6.0)`; in [m] and [rad].
    """

    class_name = "rviz_default_plugins/XYOrbit"
    lift = 0.2

    def mimic(self, other: ViewController, frames: Frames) -> None:
        """Look from where another view does if the ground is ahead of it; else use the defaults."""
        super().mimic(other, frames)
        camera = other.camera(frames)
        eye = np.subtract(camera.eye, self._target[:3, 3])
        _, up, back = camera.view_matrix()[:3, :3]
        if camera.orthographic_scale is None and eye[2] * back[2] > 0 and eye[2] * up[2] > 0:
            far, down = eye[2] / back[2], eye[2] / up[2]  # [m] to the ground, ahead and below
            distance = far * down / (self.lift * far + down)
            focus = (eye - self.lift * distance * up - distance * back) * [1, 1, 0]
            turned = self._turned(self._target)
            self._values |= {"Distance": float(distance), "Focal Point": point(turned.T @ focus)}
        elif camera.orthographic_scale is None:
            self.return_home()


class ThirdPersonFollower(XYOrbit):
    """An XYOrbit that turns about z with the target frame.

    Args:
        properties: By RViz's labels: `ThirdPersonFollower(target_frame="base_link")`; in [m] and [rad].
    """

    class_name = "rviz_default_plugins/ThirdPersonFollower"
    turns = True


class TopDownOrtho(ViewController):
    """A camera that looks straight down, without perspective.

    Args:
        properties: By RViz's labels: `TopDownOrtho(scale=80.0)`; the scale is in [px/m].
    """

    class_name = "rviz_default_plugins/TopDownOrtho"
    properties = (
        *COMMON,
        Property("Scale", 10.0, number(1e-6)),  # [px / m]
        Property("Angle", 0.0, number()),  # [rad]
        Property("X", 0.0, number()),  # [m]
        Property("Y", 0.0, number()),  # [m]
    )

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        x, y, z = transform_target_to_fixed[:3, 3] + np.array([self["X"], self["Y"], 0.0])
        angle = self["Angle"]
        return Camera(
            eye=(x, y, z + _TOP_HEIGHT),
            target=(x, y, z),
            up=(-sin(angle), cos(angle), 0.0),
            near=self["Near Clip Distance"],
            orthographic_scale=self["Scale"],
        )

    def _taken(self, camera: Camera, ahead: Floats, transform_target_to_fixed: Matrix) -> dict[str, Any]:
        right_x, right_y, _ = camera.view_matrix()[0, :3]
        x, y, _ = camera.target - transform_target_to_fixed[:3, 3]
        scale = camera.orthographic_scale or self["Scale"]
        return {"Scale": scale, "Angle": atan2(right_y, right_x), "X": x, "Y": y}

    def _keep_place(self, moved: Floats) -> None:
        self._values |= {"X": self["X"] + float(moved[0]), "Y": self["Y"] + float(moved[1])}


_AXES = {
    "+x axis": (1, 0, 0), "-x axis": (-1, 0, 0), "+y axis": (0, 1, 0),
    "-y axis": (0, -1, 0), "+z axis": (0, 0, 1), "-z axis": (0, 0, -1),
}  # fmt: skip


class FPS(ViewController):
    """A camera that looks around from a point.

    Args:
        properties: By RViz's labels: `FPS(position=(2.0, 0.0, 1.0))`; in [m] and [rad].
    """

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
    """A camera that looks around from a point of the target frame, and follows all of its motion.

    RViz has it from Jazzy 14.1.11 on; it begins at the frame's origin and looks along one of its axes.

    Args:
        properties: By RViz's labels: `FrameAligned(target_frame="camera")`; in [m] and [rad].
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
        """Set the properties from a camera that was turned by hand."""
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


class FailedView(Orbit):
    """A view controller of an unknown class; its configuration is kept as it came."""


VIEWS: dict[str, type[ViewController]] = {
    view.class_name.rpartition("/")[2]: view
    for view in (Orbit, XYOrbit, ThirdPersonFollower, FPS, TopDownOrtho, FrameAligned)
}


def view_of(config: Mapping[str, Any]) -> "tuple[ViewController, *tuple[str, ...]]":
    """Return the view that a layout describes, and what was wrong with it."""
    wanted = text_at(config, "Class") or Orbit.class_name
    package, _, short = wanted.rpartition("/")
    known = short in VIEWS and package in ("", "rviz", "rviz_default_plugins")  # rviz: of ROS 1
    view = VIEWS[short]() if known else FailedView()
    view.name = text_at(config, "Name") or view.name
    unknown = f"{wanted} is none of {', '.join(VIEWS)}: Orbit is used, and its settings are kept."
    return view, *(() if known else (unknown,)), *view.load(config)


def _about_z(yaw: float) -> Floats:
    return np.array([[cos(yaw), -sin(yaw), 0.0], [sin(yaw), cos(yaw), 0.0], [0.0, 0.0, 1.0]])
