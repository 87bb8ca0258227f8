"""meshcat's camera: an eye and a target in a frame that can be moved as a whole."""

from collections.abc import Mapping
from dataclasses import replace
from math import atan, radians, tan
from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Floats, Matrix
from course_lib.viewer.camera import Camera
from course_lib.viewer.scene import Scene

_HEIGHT = 400.0  # [px] of a view, for cameras that say how many metres fit into it
_AHEAD = np.array([0.0, 1.0, 0.0])  # where a camera looks that is told to look at itself


class MeshcatCamera:
    """Moves the scene's camera as meshcat's commands ask for."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._transform_camera_to_scene: Matrix = np.eye(4)  # of the node /Cameras/default

    def place(self, transform_camera_to_scene: Matrix) -> None:
        """Move the whole frame, with the eye and the target in it."""
        eye, target = self._local(self._scene.camera.eye), self._local(self._scene.camera.target)
        self._transform_camera_to_scene = transform_camera_to_scene
        self._look(eye, target)

    def aim(self, target: npt.ArrayLike) -> None:
        """Look at a point in the frame, shape (3,), in [m]."""
        self._look(self._local(self._scene.camera.eye), np.asarray(target, float))

    def set_property(self, name: str, value: Any) -> None:
        """Set the eye's position, with y up as in meshcat, or three.js's zoom, fov [deg] or near [m]."""
        camera = self._scene.camera
        if name == "position":
            x, up, minus_y = value
            self._look(np.array([x, -minus_y, up], float), self._local(camera.target))
        elif name == "zoom":
            self._scene.camera = replace(camera, vertical_fov=_zoomed(Camera.vertical_fov, value))
        elif name == "fov":
            self._scene.camera = replace(camera, vertical_fov=radians(value))
        elif name == "near":
            self._scene.camera = replace(camera, near=float(value))

    def set_object(self, json: Mapping[str, Any]) -> None:
        """Take one of three.js's cameras."""
        zoom = json.get("zoom", 1.0)
        if json["type"] == "OrthographicCamera":
            scale = _HEIGHT * zoom / (json["top"] - json["bottom"])
            self._scene.camera = replace(self._scene.camera, orthographic_scale=scale)
        else:
            fov = _zoomed(radians(json["fov"]), zoom)
            camera = replace(self._scene.camera, vertical_fov=fov, near=json["near"], orthographic_scale=None)
            self._scene.camera = camera

    def _look(self, eye: Floats, target: Floats) -> None:
        if np.array_equal(eye, target):  # Pinocchio's disableCameraControl
            target = eye + _AHEAD
        rotation, origin = self._transform_camera_to_scene[:3, :3], self._transform_camera_to_scene[:3, 3]
        points = {"eye": rotation @ eye + origin, "target": rotation @ target + origin, "up": rotation[:, 2]}
        vectors: dict[str, Any] = {name: tuple(point.tolist()) for name, point in points.items()}
        self._scene.camera = replace(self._scene.camera, **vectors)

    def _local(self, point: npt.ArrayLike) -> Floats:
        rotation, origin = self._transform_camera_to_scene[:3, :3], self._transform_camera_to_scene[:3, 3]
        local: Floats = rotation.T @ (np.asarray(point) - origin)
        return local


def _zoomed(fov: float, zoom: float) -> float:
    return 2 * atan(tan(fov / 2) / zoom)
