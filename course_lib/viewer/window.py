"""A window for meshcat.Visualizer that draws into a scene, with no server and no page of its own."""

from collections.abc import Callable
from io import BytesIO
from typing import Any, Protocol

import numpy as np
from PIL import Image

from course_lib.errors import CourseError
from course_lib.viewer.camera import Camera
from course_lib.viewer.meshcat_objects import drawable_of, recolored
from course_lib.viewer.picture import screenshot
from course_lib.viewer.scene import Scene

_FURNITURE = ("Lights", "Grid", "Axes")  # of meshcat's own page, which is not there


class Command(Protocol):
    """One of meshcat's commands."""

    def lower(self) -> dict[str, Any]:
        """Return the command as plain values."""


class Window:
    """What ``meshcat.Visualizer(window=...)`` and Pinocchio's MeshcatVisualizer draw into a scene through."""

    web_url = "(the scene of this program)"

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._handlers: dict[str, Callable[[str, dict[str, Any]], None]] = {
            "set_object": self._set_object,
            "set_transform": self._set_transform,
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
        if path.partition("/")[0] not in _FURNITURE:
            handler(path, lowered)

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
        if not path.startswith("Cameras"):
            self.scene.set_object(path, drawable_of(command["object"]))

    def _set_transform(self, path: str, command: dict[str, Any]) -> None:
        matrix = np.reshape(command["matrix"], (4, 4)).T
        if path == "Cameras/default":
            target = matrix[:3, 3]
            offset = np.subtract(self.scene.camera.eye, self.scene.camera.target)
            self.scene.camera = Camera(eye=tuple(target + matrix[:3, :3] @ offset), target=tuple(target))
        else:
            self.scene.set_transform(path, matrix)

    def _set_property(self, path: str, command: dict[str, Any]) -> None:
        """Set what changes a picture; of three.js's many other properties none does."""
        name, value = command["property"], command["value"]
        if path == "Background" and name == "top_color":
            self.scene.background = tuple(round(255 * part) for part in value)
        elif path.startswith("Cameras/default/") and name == "position":
            x, up, minus_y = value  # meshcat writes the camera's place with y up
            target = self.scene.camera.target
            self.scene.camera = Camera(eye=tuple(np.add(target, [x, -minus_y, up])), target=target)
        elif name == "visible":
            self.scene.set_visible(path, value)
        elif name == "position":
            matrix = self.scene.transform(path).copy()
            matrix[:3, 3] = value
            self.scene.set_transform(path, matrix)
        elif name == "color":
            for node in self.scene.node(path).subtree():
                if node.object is not None:
                    self.scene.set_object(node.path, recolored(node.object, value))

    def _set_animation(self, path: str, command: dict[str, Any]) -> None:
        self.scene.set_animation({name: command[name] for name in ("animations", "options")})
