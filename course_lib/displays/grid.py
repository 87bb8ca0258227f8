"""The Grid display."""

from collections.abc import Iterator

import numpy as np

from course_lib.displays.frames import Matrix
from course_lib.displays.properties import Property, color, integer, number, vector, words
from course_lib.displays.reference_display import ReferenceDisplay
from course_lib.displays.statuses import Level
from course_lib.viewer.drawables import Lines

# Where the grid's x, normal and z point in the reference frame (grid_display.cpp:updatePlane).
_PLANES = {
    "XY": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "XZ": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "YZ": ((0, 0, 1), (-1, 0, 0), (0, -1, 0)),
}

_MOST_LINES = 100_000


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
        """Say whether the frame is known."""
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
