"""A window for meshcat.Visualizer that draws into a scene, with no server and no page of its own."""

from collections.abc import Callable
from io import BytesIO
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
from PIL import Image

from course_lib.arrays import Matrix
from course_lib.errors import CourseError
from course_lib.viewer.meshcat_camera import MeshcatCamera
from course_lib.viewer.meshcat_objects import drawable_of, recolored
from course_lib.viewer.picture import screenshot
from course_lib.viewer.scene import Scene

_CAMERA = "Cameras/default"
_FURNITURE = ("Lights", "Grid", "Axes")  # the first names of meshcat's own page, which is not there


class Command(Protocol):
    """One of meshcat's commands."""

    def lower(self) -> dict[str, Any]:
        """Return the command as plain values."""


class Window:
    """What ``meshcat.Visualizer(window=...)`` and Pinocchio's MeshcatVisualizer draw into a scene through."""

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
        """Do nothing: whoever shows the scene opens it."""
        return self

    def wait(self) -> str:
        """Do nothing: nobody has to watch."""
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
