"""Which type of marker is drawn by what."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from course_lib.displays.marker import lists, mesh, shapes, triangles
from course_lib.displays.marker.drawn import Drawn


@dataclass(frozen=True)
class MarkerType:
    """A type of marker that RViz draws.

    Args:
        name: The constant of visualization_msgs/msg/Marker.
        draw: Makes its picture.
    """

    name: str
    draw: Callable[[Any], Drawn]


# 12, ARROW_STRIP, is in the message but not in RViz.
TYPES: Mapping[int, MarkerType] = {
    0: MarkerType("ARROW", shapes.arrow),
    1: MarkerType("CUBE", shapes.solid),
    2: MarkerType("SPHERE", shapes.solid),
    3: MarkerType("CYLINDER", shapes.solid),
    4: MarkerType("LINE_STRIP", lists.lines),
    5: MarkerType("LINE_LIST", lists.lines),
    6: MarkerType("CUBE_LIST", lists.spots),
    7: MarkerType("SPHERE_LIST", lists.spots),
    8: MarkerType("POINTS", lists.spots),
    9: MarkerType("TEXT_VIEW_FACING", shapes.text),
    10: MarkerType("MESH_RESOURCE", mesh.mesh),
    11: MarkerType("TRIANGLE_LIST", triangles.triangles),
}
