"""RViz's Grid and Axes displays, which need no topic."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Matrix
from course_lib.displays.display import Display
from course_lib.displays.frames import FIXED_FRAME
from course_lib.displays.properties import Property, color, frame, integer, number, vector, words
from course_lib.displays.statuses import Level
from course_lib.viewer.drawables import Drawable, Lines, Solids

AXIS_COLORS = np.column_stack([np.eye(3), np.ones(3)])  # x red, y green, z blue
# Where the grid's x, normal and z point in the reference frame (grid_display.cpp:updatePlane).
_PLANES = {
    "XY": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "XZ": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "YZ": ((0, 0, 1), (-1, 0, 0), (0, -1, 0)),
}
_MOST_LINES = 100_000


class ReferenceDisplay(Display):
    """A display whose picture depends on its properties alone, and moves with its Reference Frame."""

    properties = (*Display.properties, Property("Reference Frame", FIXED_FRAME, frame))

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._placed_with: Matrix | None = None
        self._drawn = False

    def drawing(self) -> Drawable:
        """Return what is to be seen."""
        raise NotImplementedError

    def offset(self) -> Matrix:
        """Return where it lies in the reference frame, shape (4, 4)."""
        return np.eye(4)

    def said(self, reference: str, is_known: bool) -> tuple[Level, str]:
        """Return RViz's status of the reference frame."""
        raise NotImplementedError

    def changed(self, label: str) -> None:
        """Redraw in the next frame."""
        super().changed(label)
        self._drawn = False

    def reset(self) -> None:
        """Redraw in the next frame."""
        super().reset()
        self._drawn = False

    def update(self) -> None:
        """Draw, and stay at the frame."""
        if not (self.enabled and self.context.draws):
            return
        name = self["Reference Frame"]
        reference = self.context.frames.fixed_frame if name == FIXED_FRAME else name
        transform = self.context.frames.transform(reference)
        level, text = self.said(reference, transform is not None)
        self.statuses.set(level, "Transform", text)
        if transform is not self._placed_with or not self._drawn:
            self._draw(transform)

    def _draw(self, transform_reference_to_fixed: Matrix | None) -> None:
        self._placed_with, scene = transform_reference_to_fixed, self.context.scene
        node = f"{self.path}/drawing"
        scene.set_visible(node, transform_reference_to_fixed is not None)
        if transform_reference_to_fixed is not None:
            scene.set_transform(node, transform_reference_to_fixed @ self.offset())
        if not self._drawn:
            scene.set_object(node, self.drawing())
            self._drawn = True


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
        """Return RViz's status of the reference frame, with tf2's reason if it is not known."""
        return ("ok", "Transform OK") if is_known else ("error", self.context.frames.problem(reference) or "")


class GridDisplay(ReferenceDisplay):
    """Lines on a plane of a frame."""

    class_name = "rviz_default_plugins/Grid"
    properties = (
        *ReferenceDisplay.properties,
        Property("Plane Cell Count", 10, integer(1)),
        Property("Normal Cell Count", 0, integer(0)),
        Property("Cell Size", 1.0, number(0.0001)),  # [m]
        Property("Line Style", "Lines", words("Lines", "Billboards")),
        Property("Line Style/Line Width", 0.03, number(0.001)),  # [m]
        Property("Color", (160, 160, 164), color),
        Property("Alpha", 0.5, number(0.0, 1.0)),
        Property("Plane", "XY", words(*_PLANES)),
        Property("Offset", (0.0, 0.0, 0.0), vector),  # [m]
    )

    def drawing(self) -> Lines:
        """Return the lines, in the grid's own frame."""
        rgba = (*(channel / 255 for channel in self["Color"]), self["Alpha"])
        width = self["Line Width"] if self["Line Style"] == "Billboards" else 0.0
        cells, layers = self["Plane Cell Count"] + 1, self["Normal Cell Count"]
        count = 2 * cells * (layers + 1) + cells**2 * (layers > 0)
        too_many = f"These cells have {count} lines; up to {_MOST_LINES} are drawn here."
        self.statuses.hint("Cells", *([too_many] if count > _MOST_LINES else []))
        points = list(self._points()) if count <= _MOST_LINES else np.empty((0, 3))
        return Lines(points, rgba, width, strip=False)

    def offset(self) -> Matrix:
        """Return where the plane lies in the reference frame, shape (4, 4)."""
        plane = np.eye(4)
        plane[:3, :3] = np.transpose(_PLANES[self["Plane"]])
        plane[:3, 3] = self["Offset"]
        return plane

    def said(self, reference: str, is_known: bool) -> tuple[Level, str]:
        """Return RViz's status of the reference frame."""
        problem = f"Could not transform from [{reference}] to [{self.context.frames.fixed_frame}]"
        return ("ok", "Ok") if is_known else ("error", problem)

    def _points(self) -> Iterator[tuple[float, float, float]]:
        """Yield the ends of all lines, in pairs; y is the grid's normal."""
        cells, layers = self["Plane Cell Count"], self["Normal Cell Count"]
        extent = self["Cell Size"] * cells / 2
        steps = np.linspace(extent, -extent, cells + 1)
        top = self["Cell Size"] * layers / 2
        for y in np.linspace(top, -top, layers + 1):
            for step in steps:
                yield from ((step, y, -extent), (step, y, extent), (-extent, y, step), (extent, y, step))
        for x, z in ((x, z) for x in steps for z in steps if layers):
            yield from ((x, -top, z), (x, top, z))
