"""LINE_STRIP, LINE_LIST, POINTS, CUBE_LIST and SPHERE_LIST."""

from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.displays.marker.drawn import Drawn, Floats, colors, label, points, rgba, scale_of
from course_lib.displays.statuses import Level
from course_lib.viewer.drawables import Lines, Points, Spot

LINE_STRIP, LINE_LIST, CUBE_LIST, SPHERE_LIST, POINTS = 4, 5, 6, 7, 8
SPOTS: dict[int, Spot] = {CUBE_LIST: "box", SPHERE_LIST: "sphere", POINTS: "square"}


def lines(marker: Any) -> Drawn:
    """Draw lines that turn their flat side to the viewer; x of the scale is their width."""
    strip = marker.type == LINE_STRIP
    if not strip and len(marker.points) % 2:
        return Drawn(status=("error", f"Line list marker [{label(marker)}] has an odd number of points."))
    if len(marker.points) < 2 or not marker.scale.x:
        return Drawn()
    each = colors(marker) if has_colors(marker) else rgba(marker.color)
    return Drawn({"lines": Lines(points(marker), each, abs(marker.scale.x), strip)})


def spots(marker: Any) -> Drawn:
    """Draw a square, a box or a sphere at each point, as RViz's point clouds do.

    Their spheres are discs: an oblong one is an ellipse, x by y of the scale, that faces the viewer.
    """
    if not marker.points:
        return Drawn()
    each = _spot_colors(marker)
    status: tuple[Level, str] = ("warn", "All points have a zero alpha value.")
    said = status if has_colors(marker) and not each[:, 3].any() else None
    size = tuple(abs(scale_of(marker)))
    return Drawn({"spots": Points(points(marker), each, size, spot=SPOTS[marker.type])}, said)


def has_colors(marker: Any) -> bool:
    """Say whether RViz uses the colours of the points: only if there is one for each."""
    return len(marker.colors) == len(marker.points)


def _spot_colors(marker: Any) -> Floats:
    """Return a colour for each point, shape (N, 4).

    RViz multiplies the alphas of material and point, so that of one colour for all counts twice; and it draws
    each point twice (point_cloud.cpp: as a part of the cloud, and as an object of its own).
    """
    if has_colors(marker):
        each = colors(marker)
    else:
        each = np.tile(rgba(marker.color), (len(marker.points), 1))
        each[:, 3] **= 2
    each[:, 3] = drawn_twice(each[:, 3])
    return each


def drawn_twice(alpha: npt.NDArray[np.floating]) -> npt.NDArray[np.floating]:
    """Return the alpha of something that is drawn over itself once more."""
    return 1 - (1 - alpha) ** 2
