"""meshcat's Visualizer on a scene of ours: no server, and with what Pinocchio asks of newer versions."""

from typing import Any

import meshcat
import numpy as np
import numpy.typing as npt
from meshcat.path import Path
from PIL import Image

from course_lib.viewer.scene import Scene
from course_lib.viewer.window import Window

_CAMERA = "/Cameras/default/rotated/<object>"
_IDENTITY = np.eye(4)


class Visualizer(meshcat.Visualizer):  # type: ignore[misc]  # meshcat has no types
    """Draws into a scene, for code written for meshcat: ``MeshcatVisualizer.initViewer(viewer=...)``."""

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
        self[_CAMERA].set_property("position", [x, z, -y])

    def set_cam_target(self, value: npt.ArrayLike) -> None:
        """Have the camera look at a point (x, y, z) in [m], as meshcat 0.3.3 does."""
        self.window.aim(value)

    def get_image(self, w: int | None = None, h: int | None = None) -> Image.Image:
        """Return a picture of the scene; sizes in pixels."""
        image: Image.Image = self.window.get_image(w, h)
        return image

    def jupyter_cell(self, height: int = 400) -> Any:
        """Return a view for a cell; height in pixels."""
        from course_lib.viewer.widget import SceneWidget  # here: heavy

        return SceneWidget(self.window.scene, height)
