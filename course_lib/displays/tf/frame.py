"""One frame of the TF display in the scene (frame_info.cpp)."""

from collections.abc import Mapping
from math import floor
from typing import NamedTuple

import numpy as np

from course_lib.displays.axes import AXIS_COLORS, axes
from course_lib.displays.display import node_name
from course_lib.displays.frames import Matrix
from course_lib.displays.marker.shapes import placement, turned_to
from course_lib.viewer.drawables import Solids, Text
from course_lib.viewer.scene import Scene

PARTS = ("axes", "arrows", "names")  # the nodes that all frames have theirs below

_LENGTH, _WIDTH = 0.2, 0.02  # [m] of an axis
_SHAFT, _HEAD, _HEAD_LENGTH = 0.01, 0.04, 0.1  # [m] diameters, and the head's length
_SHAFT_COLOR, _HEAD_COLOR = np.array([0.8, 0.8, 0.3, 1.0]), np.array([1.0, 0.1, 0.6, 1.0])
_NAME_HEIGHT = 0.1  # [m]
_WHITE = np.ones(4)
_GREY = np.array([0.7, 0.7, 0.7, 1.0])
_STEPS = 48  # of fading, within the timeout


class Look(NamedTuple):
    """How a frame is drawn."""

    age: float  # since its last transform, in timeouts; it goes grey from 1/3 to 2/3, and fades until 1
    scale: float  # Marker Scale


class DrawnFrame:
    """Axes, name and an arrow to the parent; what is not to be seen is not even made."""

    def __init__(self, scene: Scene, path: str, frame: str) -> None:
        self._scene = scene
        self._frame = frame
        self.nodes = {part: f"{path}/{part}/{node_name(frame)}" for part in PARTS}
        self._made: dict[str, Look] = {}
        self._shown: dict[str, bool] = {}
        self._placed: tuple[Matrix | None, Matrix | None] = (None, None)

    def show(self, wanted: Mapping[str, bool], look: Look) -> None:
        """Show some parts of it and hide the others."""
        look = Look(max(floor(look.age * _STEPS) / _STEPS, 1 / 3), look.scale)
        for part in PARTS:
            if wanted[part] and self._made.get(part) != look:
                self._made[part] = look
                self._placed = (None, None)
                self._draw(part, look)
            if part in self._made and self._shown.get(part, True) != wanted[part]:
                self._shown[part] = wanted[part]
                self._scene.set_visible(self.nodes[part], wanted[part])

    def place(self, transform: Matrix, transform_parent: Matrix | None, scale: float) -> None:
        """Move it; both transforms lead to the fixed frame."""
        before, before_parent = self._placed
        if before is transform and before_parent is transform_parent:
            return
        self._placed = (transform, transform_parent)
        for part in self._made.keys() - {"arrows"}:
            self._scene.set_transform(self.nodes[part], transform)
        if "arrows" in self._made and transform_parent is not None:
            self._place_arrow(transform[:3, 3], transform_parent[:3, 3], scale)

    def _draw(self, part: str, look: Look) -> None:
        put, node = self._scene.set_object, self.nodes[part]
        if part == "axes":
            put(node, axes(look.scale * _LENGTH, look.scale * _WIDTH, _faded(AXIS_COLORS, look.age)))
        elif part == "names":
            height = look.scale * _NAME_HEIGHT
            put(node, Text(self._frame, height, _faded(_WHITE, look.age), below=True))
        else:
            put(f"{node}/shaft", Solids("cylinder", [np.eye(4)], _faded(_SHAFT_COLOR, look.age)))
            put(f"{node}/head", Solids("cone", [np.eye(4)], _faded(_HEAD_COLOR, look.age)))

    def _place_arrow(self, start: Matrix, end: Matrix, scale: float) -> None:
        length = float(np.linalg.norm(end - start))
        if not length:
            return
        direction = (end - start) / length
        head = _HEAD_LENGTH * scale * (length if length < _HEAD_LENGTH * scale else 1.0)  # as in RViz
        turned, node = turned_to(direction), self.nodes["arrows"]
        sizes = ((_SHAFT * scale, length - head), (_HEAD * scale, head))
        centers = ((length - head) / 2, length - head / 2)
        for part, (width, along), center in zip(("shaft", "head"), sizes, centers, strict=True):
            placed = placement(turned, (width, width, along), start + direction * center)
            self._scene.set_transform(f"{node}/{part}", placed)


def _faded(color: Matrix, age: float) -> Matrix:
    """Return RGBA after an age in timeouts."""
    if age <= 2 / 3:
        share = 2 - 3 * age
        faded: Matrix = share * color + (1 - share) * _GREY
        return faded
    fading: Matrix = np.broadcast_to(_GREY * [1, 1, 1, max(0.0, 3 - 3 * age)], color.shape)
    return fading
