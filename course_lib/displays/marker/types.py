"""Which type of marker is drawn by what."""

from collections.abc import Callable, Mapping
from typing import Any

from course_lib.displays.marker import lists, mesh, shapes, triangles
from course_lib.displays.marker.drawn import Drawn

# By the constants of visualization_msgs/msg/Marker; 12, ARROW_STRIP, is in the message but not in RViz.
TYPES: Mapping[int, Callable[[Any], Drawn]] = {
    0: shapes.arrow,
    **dict.fromkeys(shapes.SOLIDS, shapes.solid),
    **dict.fromkeys((lists.LINE_STRIP, lists.LINE_LIST), lists.lines),
    **dict.fromkeys(lists.SPOTS, lists.spots),
    9: shapes.text,
    10: mesh.mesh,
    11: triangles.triangles,
}
