"""The base of RViz's view controllers: from properties to a camera."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import cos, pi, sin
from typing import Any, ClassVar

import numpy as np

from course_lib.arrays import Floats, Matrix
from course_lib.displays.frames import FIXED_FRAME, Frames
from course_lib.displays.properties import Property, PropertyHolder, flag, frame, number
from course_lib.errors import did_you_mean
from course_lib.viewer.camera import Camera

PITCH_LIMIT = pi / 2 - 0.001  # [rad] RViz keeps the camera off the poles

COMMON = (
    Property("Target Frame", FIXED_FRAME, frame),
    Property("Near Clip Distance", 0.01, number(0.001)),  # [m]
    Property("Invert Z Axis", False, flag),
)


@dataclass(frozen=True)
class Hands:
    """The rules by which a page turns a view by hand."""

    in_place: bool  # around the eye
    aligned: bool  # up is that of the target frame
    locked: bool
    lift: float  # see `ViewController.lift`
    ground: float  # [m] height of the target frame


class ViewController(PropertyHolder):
    """Base of all view controllers; what cannot be found in the scene is looked at from the fixed frame.

    Args:
        properties: By RViz's labels, or as Python names: ``Orbit(distance=6.0, focal_point=(0, 0, 0.5))``.
    """

    class_name: ClassVar[str]
    properties: tuple[Property, ...] = COMMON

    lift: ClassVar[float] = 0.0  # by which part of the distance the camera is moved up in the picture

    def __init__(self, **properties: object) -> None:
        super().__init__()
        self._target: Matrix = np.eye(4)
        self._followed = ""  # the target frame that the camera was last placed with
        self.name = "Current View"
        self.touched: Callable[[], None] = lambda: None  # called when a property has changed
        for label, value in properties.items():
            self[label] = value

    def changed(self, label: str) -> None:
        """Show the change."""
        self.touched()

    def __repr__(self) -> str:
        return self.class_name.rpartition("/")[2]

    def camera(self, frames: Frames) -> Camera:
        """Return the camera; it goes along with the target frame, as long as that is known."""
        name = self["Target Frame"]
        target = frames.transform(frames.fixed_frame if name == FIXED_FRAME else name)
        if target is not None:
            before, self._target = self._target, target
            if self._followed not in ("", name):
                self._keep_place(before[:3, 3] - target[:3, 3])
        self._followed = name
        return self._camera(self._target)

    def lost(self, frames: Frames) -> tuple[str, ...]:
        """Return the hint at an unknown target frame, of which RViz is silent."""
        name, known = self["Target Frame"], frames.buffer.frames()
        if name == FIXED_FRAME or frames.transform(name) is not None:
            return ()
        meant = did_you_mean(name, known) or f"; it knows {', '.join(sorted(known)) or 'no frame'}."
        return (f"tf2 knows no way to the view's Target Frame {name!r}, so the view stays{meant}",)

    def load(self, config: Mapping[str, Any]) -> list[str]:
        """Set properties from a layout, and keep it."""
        self.config, self._followed = config, ""
        return super().load(config)

    def hands(self) -> Hands:
        """Return the rules by which a page turns the view."""
        return Hands("Position" in self._values, False, False, self.lift, float(self._target[2, 3]))

    def return_home(self) -> None:
        """Look from where a new view of this type does, as RViz's key Z has it."""
        kept = ("Target Frame", "Near Clip Distance", "Invert Z Axis")
        self._values |= {p.label: p.default for p in self.properties if p.label not in kept}
        self.touched()

    def take(self, camera: Camera) -> None:
        """Set the properties from a camera that was turned by hand, without showing it again."""
        taken = self._taken(camera, np.subtract(camera.target, camera.eye), self._target)
        self._values |= {label: self._property(label).convert(value) for label, value in taken.items()}

    def mimic(self, other: "ViewController", frames: Frames) -> None:
        """Look from where another view does, as well as this one can."""
        self._values["Target Frame"] = other["Target Frame"]
        self.camera(frames)  # finds the target frame
        self.take(other.camera(frames))

    def _keep_place(self, moved: Floats) -> None:
        """Keep the camera's place when another target frame is chosen, which is [m] away."""
        for label in ("Focal Point", "Position"):
            if label in self._values:
                self._values[label] = point(np.add(self[label], moved))

    def _camera(self, transform_target_to_fixed: Matrix) -> Camera:
        raise NotImplementedError

    def _taken(self, camera: Camera, ahead: Floats, transform_target_to_fixed: Matrix) -> dict[str, Any]:
        """Return the properties of a camera, see `_camera`."""
        raise NotImplementedError


def direction(yaw: float, pitch: float) -> Floats:
    """Return the unit vector with a yaw and an upward pitch, [rad]."""
    return np.array([cos(yaw) * cos(pitch), sin(yaw) * cos(pitch), sin(pitch)])


def point(array: Floats) -> tuple[float, float, float]:
    """Return a vector as plain numbers."""
    x, y, z = array.tolist()
    return x, y, z
