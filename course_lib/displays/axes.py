"""The Axes display, and the three axes that other displays show too."""

import numpy as np
import numpy.typing as npt

from course_lib.displays.properties import Property, number
from course_lib.displays.reference_display import ReferenceDisplay
from course_lib.displays.statuses import Level
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


class AxesDisplay(ReferenceDisplay):
    """The axes of a frame."""

    class_name = "rviz_default_plugins/Axes"
    properties = (
        *ReferenceDisplay.properties,
        Property("Length", 1.0, number(0.0001)),  # [m]
        Property("Radius", 0.1, number(0.0001)),  # [m]; RViz's word, but it is the diameter
    )

    def drawing(self) -> Solids:
        """Return the three cylinders."""
        return axes(self["Length"], self["Radius"])

    def said(self, reference: str, is_known: bool) -> tuple[Level, str]:
        """Say why the frame is not known, or that it is."""
        return ("ok", "Transform OK") if is_known else ("error", self.context.frames.problem(reference) or "")
