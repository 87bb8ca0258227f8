"""The Grid display."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from course_lib.displays.display import Display
from course_lib.displays.frames import Matrix
from course_lib.displays.properties import Property, color, frame, integer, number, vector, words
from course_lib.viewer.drawables import Lines

FIXED_FRAME = "<Fixed Frame>"  # stands for the fixed frame, whatever it is

# Where the grid's x, normal and z point in the reference frame (grid_display.cpp:updatePlane).
_PLANES = {
    "XY": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "XZ": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "YZ": ((0, 0, 1), (-1, 0, 0), (0, -1, 0)),
}


class GridDisplay(Display):
    """Lines on a plane of a frame."""

    class_name = "rviz_default_plugins/Grid"
    properties = (
        *Display.properties,
        Property("Reference Frame", FIXED_FRAME, frame),
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

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._placed_with: Matrix | None = None
        self._drawn = False

    def changed(self, label: str) -> None:
        """Draw the grid anew in the next frame."""
        super().changed(label)
        self._drawn = False

    def reset(self) -> None:
        """Draw the grid anew in the next frame."""
        super().reset()
        self._drawn = False

    def update(self) -> None:
        """Draw the grid, and keep it at its frame."""
        if not self.enabled:
            return
        name = self["Reference Frame"]
        reference = self.context.frames.fixed_frame if name == FIXED_FRAME else name
        transform = self.context.frames.transform(reference)
        if transform is None:
            fixed_frame = self.context.frames.fixed_frame
            problem = f"Could not transform from [{reference}] to [{fixed_frame}]"
            self.statuses.set("error", "Transform", problem)
        else:
            self.statuses.set("ok", "Transform", "Ok")
        if transform is not self._placed_with or not self._drawn:
            self._draw(transform)

    def _draw(self, transform_reference_to_fixed: Matrix | None) -> None:
        self._placed_with, scene = transform_reference_to_fixed, self.context.scene
        scene.set_visible(f"{self.path}/grid", transform_reference_to_fixed is not None)
        if transform_reference_to_fixed is not None:
            plane = np.eye(4)
            plane[:3, :3] = np.transpose(_PLANES[self["Plane"]])
            plane[:3, 3] = self["Offset"]
            scene.set_transform(f"{self.path}/grid", transform_reference_to_fixed @ plane)
        if not self._drawn:
            rgba = (*(channel / 255 for channel in self["Color"]), self["Alpha"])
            width = self["Line Width"] if self["Line Style"] == "Billboards" else 0.0
            points = np.array(list(self._points()))
            scene.set_object(f"{self.path}/grid", Lines(points, rgba, width, strip=False))
            self._drawn = True

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
