"""The Axes display, and the three axes that other displays show too."""

from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.displays.display import Display
from course_lib.displays.grid import FIXED_FRAME
from course_lib.displays.properties import Property, frame, number
from course_lib.viewer.drawables import Solids

AXIS_COLORS = np.column_stack([np.eye(3), np.ones(3)])  # x red, y green, z blue


def axes(length: float, diameter: float, colors: npt.ArrayLike = AXIS_COLORS) -> Solids:
    """Return cylinders along x, y and z.

    Args:
        length: [m].
        diameter: [m]; what RViz calls Radius.
        colors: RGBA of each, shape (3, 4).
    """
    placements = np.zeros((3, 4, 4))
    for axis, placement in enumerate(placements):
        turned = np.roll(np.eye(3), axis + 1, axis=0)  # takes z to the axis
        placement[:3, :3] = turned * [diameter, diameter, length]
        placement[axis, 3] = length / 2
        placement[3, 3] = 1.0
    return Solids("cylinder", placements, colors)


class AxesDisplay(Display):
    """The axes of a frame."""

    class_name = "rviz_default_plugins/Axes"
    properties = (
        *Display.properties,
        Property("Reference Frame", FIXED_FRAME, frame),
        Property("Length", 1.0, number(0.0001)),  # [m]
        Property("Radius", 0.1, number(0.0001)),  # [m]; RViz's word, but it is the diameter
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._drawn = False

    def changed(self, label: str) -> None:
        """Draw the axes anew in the next frame."""
        super().changed(label)
        self._drawn = False

    def reset(self) -> None:
        """Draw the axes anew in the next frame."""
        super().reset()
        self._drawn = False

    def update(self) -> None:
        """Draw the axes, and keep them at their frame."""
        frames, scene, node = self.context.frames, self.context.scene, f"{self.path}/axes"
        name = self["Reference Frame"]
        reference = frames.fixed_frame if name == FIXED_FRAME else name
        transform = frames.transform(reference)
        if not self._drawn:
            scene.set_object(node, axes(self["Length"], self["Radius"]))
            self._drawn = True
        scene.set_visible(node, transform is not None)
        if transform is None:
            self.statuses.set("error", "Transform", frames.problem(reference) or "")
        else:
            self.statuses.set("ok", "Transform", "Transform OK")
            scene.set_transform(node, transform)
