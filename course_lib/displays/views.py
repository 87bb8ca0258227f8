"""RViz's view controllers: from their properties to a camera."""

from collections.abc import Callable, Mapping
from math import asin, atan2, cos, pi, sin
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from course_lib.displays.frames import FIXED_FRAME, Frames, Matrix
from course_lib.displays.properties import Property, PropertyHolder, flag, frame, number, vector
from course_lib.viewer.camera import Camera

_PITCH = pi / 2 - 0.001  # [rad] RViz keeps the camera off the poles
_TOP_HEIGHT = 500.0  # [m] of the camera that looks down

_COMMON = (
    Property("Target Frame", FIXED_FRAME, frame),
    Property("Near Clip Distance", 0.01, number(0.001)),  # [m]
    Property("Invert Z Axis", False, flag),
)

Array = npt.NDArray[np.float64]


class View(PropertyHolder):
    """Base of all view controllers; what cannot be found in the scene is looked at from the fixed frame.

    Args:
        properties: By RViz's labels, or as Python names: ``Orbit(distance=6.0, focal_point=(0, 0, 0.5))``.
    """

    class_name: ClassVar[str]
    properties: tuple[Property, ...] = _COMMON

    def __init__(self, **properties: object) -> None:
        super().__init__()
        self._target: Matrix = np.eye(4)
        self.config: Mapping[str, Any] = {}  # of the layout it comes from
        self.name = "Current View"
        self.touched: Callable[[], None] = lambda: None  # called when somebody has changed a property
        for label, value in properties.items():
            self[label] = value

    def changed(self, label: str) -> None:
        """Have the change shown."""
        self.touched()

    def __repr__(self) -> str:
        return self.class_name.rpartition("/")[2]

    def camera(self, frames: Frames) -> Camera:
        """Return the camera; it goes along with the target frame, as long as that is known."""
        name = self["Target Frame"]
        target = frames.transform(frames.fixed_frame if name == FIXED_FRAME else name)
        self._target = self._target if target is None else target
        return self._camera(self._target)

    def take(self, camera: Camera) -> None:
        """Have the properties that look as a view does which was turned by hand; nobody is told."""
        taken = self._taken(camera, np.subtract(camera.target, camera.eye), self._target)
        self._values |= {label: self._property(label).convert(value) for label, value in taken.items()}

    def mimic(self, other: "View", frames: Frames) -> None:
        """Look from where another view does, as well as this one can."""
        self._values["Target Frame"] = other["Target Frame"]
        self.camera(frames)  # finds the target frame
        self.take(other.camera(frames))

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        raise NotImplementedError

    def _taken(self, camera: Camera, ahead: Array, transform_target_to_fixed: Matrix) -> dict[str, Any]:
        """Return the properties of a camera, see `_camera`."""
        raise NotImplementedError


class Orbit(View):
    """Turns around a focal point, and goes along with the target frame's position."""

    class_name = "rviz_default_plugins/Orbit"
    properties = (
        *_COMMON,
        Property("Distance", 10.0, number(0.001)),  # [m]
        Property("Yaw", pi / 4, number()),
        Property("Pitch", pi / 4, number(-_PITCH, _PITCH)),  # [rad]
        Property("Focal Point", (0.0, 0.0, 0.0), vector),  # [m]
    )

    turns = False  # about z, with the target frame
    lift = 0.0  # by which part of the distance the camera is moved up in the picture

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        turned, sign = self._turned(transform_target_to_fixed), self._sign()
        away = turned @ _direction(sign * self["Yaw"], sign * self["Pitch"])
        lifted = self._lifted(away, self["Distance"])
        focus = transform_target_to_fixed[:3, 3] + turned @ np.array(self["Focal Point"]) + lifted
        eye = focus + self["Distance"] * away
        return Camera(_point(eye), _point(focus), (0.0, 0.0, sign), near=self["Near Clip Distance"])

    def _taken(self, camera: Camera, ahead: Array, transform_target_to_fixed: Matrix) -> dict[str, Any]:
        turned, sign = self._turned(transform_target_to_fixed), self._sign()
        distance = float(np.linalg.norm(ahead))
        x, y, z = away = turned.T @ -ahead / distance
        focus = camera.target - self._lifted(turned @ away, distance) - transform_target_to_fixed[:3, 3]
        yaw, pitch = sign * atan2(y, x) % (2 * pi), sign * asin(min(max(z, -1.0), 1.0))
        return {"Distance": distance, "Yaw": yaw, "Pitch": pitch, "Focal Point": _point(turned.T @ focus)}

    def _turned(self, transform_target_to_fixed: Matrix) -> Array:
        x, y = transform_target_to_fixed[:2, 0]
        return _about_z(atan2(y, x) if self.turns else 0.0)

    def _sign(self) -> float:
        return -1.0 if self["Invert Z Axis"] else 1.0

    def _lifted(self, away: Array, distance: float) -> Array:
        """Return how far the camera is moved up in the picture."""
        up = np.array([0.0, 0.0, self._sign()])
        picture_up = up - away * (away @ up)
        lifted: Array = picture_up * distance * self.lift / max(float(np.linalg.norm(picture_up)), 1e-9)
        return lifted


class XYOrbit(Orbit):
    """An Orbit whose focal point is on the ground, seen in the lower half of the picture."""

    class_name = "rviz_default_plugins/XYOrbit"
    lift = 0.2


class ThirdPersonFollower(Orbit):
    """An Orbit that turns about z with the target frame."""

    class_name = "rviz_default_plugins/ThirdPersonFollower"
    turns = True


class FPS(View):
    """Looks around from a point."""

    class_name = "rviz_default_plugins/FPS"
    properties = (
        *_COMMON,
        Property("Yaw", 1.25 * pi, number()),
        Property("Pitch", atan2(10.0, 50.0**0.5), number(-_PITCH, _PITCH)),  # [rad] downward
        Property("Position", (5.0, 5.0, 10.0), vector),  # [m]
    )

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        eye = transform_target_to_fixed[:3, 3] + np.array(self["Position"])
        ahead = _direction(self["Yaw"], -self["Pitch"])
        return Camera(eye=_point(eye), target=_point(eye + ahead), near=self["Near Clip Distance"])

    def _taken(self, camera: Camera, ahead: Array, transform_target_to_fixed: Matrix) -> dict[str, Any]:
        x, y, z = ahead / np.linalg.norm(ahead)
        position = _point(camera.eye - transform_target_to_fixed[:3, 3])
        return {"Yaw": atan2(y, x) % (2 * pi), "Pitch": -asin(min(max(z, -1.0), 1.0)), "Position": position}


class TopDownOrtho(View):
    """Looks straight down, without perspective."""

    class_name = "rviz_default_plugins/TopDownOrtho"
    properties = (
        *_COMMON,
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

    def _taken(self, camera: Camera, ahead: Array, transform_target_to_fixed: Matrix) -> dict[str, Any]:
        right_x, right_y, _ = camera.view_matrix()[0, :3]
        x, y, _ = camera.target - transform_target_to_fixed[:3, 3]
        scale = camera.orthographic_scale or self["Scale"]
        return {"Scale": scale, "Angle": atan2(right_y, right_x), "X": x, "Y": y}


VIEWS: dict[str, type[View]] = {
    view.class_name.rpartition("/")[2]: view
    for view in (Orbit, XYOrbit, ThirdPersonFollower, FPS, TopDownOrtho)
}


def view_of(config: Mapping[str, Any]) -> "tuple[View, *tuple[str, ...]]":
    """Return the view that a layout describes, and what was wrong with it."""
    wanted = str(config.get("Class") or "Orbit").rpartition("/")[2]
    view = VIEWS.get(wanted, Orbit)()
    view.config, view.name = config, str(config.get("Name") or view.name)
    unknown = () if wanted in VIEWS else (f"{wanted} is none of {', '.join(VIEWS)}: Orbit is used.",)
    return view, *unknown, *view.load(config)


def _about_z(yaw: float) -> Array:
    return np.array([[cos(yaw), -sin(yaw), 0.0], [sin(yaw), cos(yaw), 0.0], [0.0, 0.0, 1.0]])


def _direction(yaw: float, pitch: float) -> Array:
    return np.array([cos(yaw) * cos(pitch), sin(yaw) * cos(pitch), sin(pitch)])


def _point(array: Array) -> tuple[float, float, float]:
    x, y, z = array.tolist()
    return x, y, z
