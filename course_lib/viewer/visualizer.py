"""meshcat's Visualizer and its window, drawing into a scene, with no server and no page of its own."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from io import BytesIO
from math import atan, radians, tan
from typing import Any, Protocol

import meshcat
import numpy as np
import numpy.typing as npt
from meshcat.path import Path
from PIL import Image

from course_lib.arrays import Floats, Matrix
from course_lib.errors import CourseError
from course_lib.viewer.camera import Camera
from course_lib.viewer.meshcat_objects import drawable_of, recolored
from course_lib.viewer.picture import screenshot
from course_lib.viewer.scene import Scene, described

_HEIGHT = 400.0  # [px] of a view, for cameras that say how many metres fit into it
_AHEAD = np.array([0.0, 1.0, 0.0])  # direction of a camera whose target is its own position


class MeshcatCamera:
    """The scene's camera behind meshcat's commands."""

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
        """Set the camera from one of three.js's."""
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


_CAMERA = "Cameras/default"
_FURNITURE = ("Lights", "Grid", "Axes")  # the first names of meshcat's own page, which is not there


class Command(Protocol):
    """One of meshcat's commands."""

    def lower(self) -> dict[str, Any]:
        """Return the command as plain values."""


class Window:
    """A window for meshcat.Visualizer and Pinocchio's MeshcatVisualizer that draws into a scene."""

    web_url = "(the scene of this program)"

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._camera = MeshcatCamera(scene)
        self.aim = self._camera.aim
        self._handlers: dict[str, Callable[[str, dict[str, Any]], None]] = {
            "set_object": self._set_object,
            "set_transform": lambda path, command: self.place(path, np.reshape(command["matrix"], (4, 4)).T),
            "set_property": self._set_property,
            "set_animation": self._set_animation,
            "delete": lambda path, _: self.scene.delete(path),
        }

    def send(self, command: Command) -> None:
        """Carry out a command.

        Raises:
            CourseError: If the scene has nothing like it.
        """
        lowered = command.lower()
        handler = self._handlers.get(lowered["type"])
        if handler is None:
            known = ", ".join(self._handlers)
            raise CourseError(f"meshcat's command {lowered['type']!r} is not known here; these are: {known}.")
        path = lowered["path"].strip("/")
        if not path.startswith(_FURNITURE):
            handler(path, lowered)

    def place(self, path: str, matrix: npt.ArrayLike) -> None:
        """Set a node's transform to its parent, shape (4, 4), in [m]."""
        if path == _CAMERA:
            self._camera.place(np.asarray(matrix, float))
        elif not path.startswith(_FURNITURE):
            self.scene.set_transform(path, matrix)

    def get_image(self, width: int | None = None, height: int | None = None) -> Image.Image:
        """Return a picture of the scene; sizes in pixels."""
        return Image.open(BytesIO(screenshot(self.scene, size=(width or 800, height or 600)).png))

    def open(self) -> "Window":
        """Do nothing: the page that shows the scene opens it."""
        return self

    def wait(self) -> str:
        """Do nothing: no page is needed."""
        return "ok"

    def close(self) -> None:
        """Do nothing: there is no server to stop."""

    def _set_object(self, path: str, command: dict[str, Any]) -> None:
        if path.startswith(_CAMERA):
            self._camera.set_object(command["object"]["object"])
        else:
            self.scene.set_object(path, drawable_of(command["object"]))

    def _set_property(self, path: str, command: dict[str, Any]) -> None:
        """Set what changes a picture; of three.js's many other properties none does."""
        name, value = command["property"], command["value"]
        if path == "Background":
            if name == "top_color":
                self.scene.background = tuple(round(255 * part) for part in value)
        elif path.startswith(_CAMERA):
            self._camera.set_property(name, value)
        elif name == "visible":
            self.scene.set_visible(path, value)
        elif name in ("position", "quaternion", "scale"):
            node = self.scene.find(path)
            self.scene.set_transform(path, _with(np.eye(4) if node is None else node.matrix, name, value))
        elif name == "color":
            for node in self.scene.node(path).subtree():
                if node.object is not None:
                    self.scene.set_object(node.path, recolored(node.object, value))

    def _set_animation(self, path: str, command: dict[str, Any]) -> None:
        self.scene.set_animation({name: command[name] for name in ("animations", "options")})


def _with(matrix: Matrix, name: str, value: npt.ArrayLike) -> Matrix:
    """Change a transform's position [m], quaternion (x, y, z, w) or scale, and keep the other two."""
    from meshcat.transformations import quaternion_matrix  # here: meshcat is slow to load

    changed, numbers = matrix.copy(), np.asarray(value, float)
    scale = np.linalg.norm(matrix[:3, :3], axis=0)
    if name == "position":
        changed[:3, 3] = numbers
    elif name == "quaternion":
        changed[:3, :3] = quaternion_matrix(np.roll(numbers, 1))[:3, :3] * scale  # its order: w, x, y, z
    else:
        changed[:3, :3] = matrix[:3, :3] / np.where(scale, scale, 1) * numbers
    return changed


_CAMERA_OBJECT = "/Cameras/default/rotated/<object>"
_IDENTITY = np.eye(4)


class Visualizer(meshcat.Visualizer):  # type: ignore[misc]  # meshcat has no types
    """A meshcat.Visualizer that draws into a scene: ``MeshcatVisualizer.initViewer(viewer=...)``."""

    __slots__ = ("place",)  # the path as the scene writes it

    def __init__(self, scene: Scene) -> None:
        super().__init__(window=Window(scene))
        self.place = "/".join(self.path.entries)

    @staticmethod
    def view_into(window: Window, path: Path) -> "Visualizer":
        """Return the part of the tree at a path."""
        part = Visualizer.__new__(Visualizer)
        part.window, part.path, part.place = window, path, "/".join(path.entries)
        return part

    def __getitem__(self, path: str) -> "Visualizer":
        return self.view_into(self.window, self.path.append(path))

    def set_transform(self, matrix: npt.ArrayLike = _IDENTITY) -> None:
        """Place this part in its parent, by the transform from the one to the other, shape (4, 4), in [m]."""
        self.window.place(self.place, matrix)

    def set_cam_pos(self, value: npt.ArrayLike) -> None:
        """Put the camera's eye at a point (x, y, z) in [m], as meshcat 0.3.3 does."""
        x, y, z = np.asarray(value, float)
        self[_CAMERA_OBJECT].set_property("position", [x, z, -y])

    def set_cam_target(self, value: npt.ArrayLike) -> None:
        """Point the camera at (x, y, z), [m], as meshcat 0.3.3 does."""
        self.window.aim(value)

    def get_image(self, w: int | None = None, h: int | None = None) -> Image.Image:
        """Return a picture of the scene; sizes in pixels."""
        image: Image.Image = self.window.get_image(w, h)
        return image

    def jupyter_cell(self, height: int = 400) -> Any:
        """Return a view for a cell; height in pixels."""
        from course_lib.viewer.widget import SceneWidget  # here: heavy

        return SceneWidget(self.window.scene, height, words=described(self.window.scene, "3D view"))
