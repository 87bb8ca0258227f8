"""TRIANGLE_LIST."""

from typing import Any

import numpy as np

from course_lib.displays.marker.drawn import Drawn, Floats, colors, label, points, refused, rgba, scale_of
from course_lib.displays.marker.lists import has_colors
from course_lib.viewer.drawables import OPAQUE_FROM, Mesh


def triangles(marker: Any) -> Drawn:
    """Draw triangles, seen from both sides; shaded only if they have no colours of their own."""
    count = len(marker.points)
    if not count:
        return refused(f"TriMesh marker [{label(marker)}] has no points.")
    if count % 3:
        return refused(
            f"TriMesh marker [{label(marker)}] has a point count which is not divisible by 3 [{count}]"
        )
    scale = scale_of(marker)
    each = _colors(marker)
    lit = each is None
    mesh = Mesh(points(marker) * scale, None, rgba(marker.color) if each is None else each, lit=lit)
    return Drawn({"mesh": mesh}, None if scale.all() else ("warn", "Scale of 0 in one of x/y/z"))


def has_face_colors(marker: Any) -> bool:
    """Say whether there is one colour for each triangle."""
    return len(marker.colors) == len(marker.points) // 3


def _colors(marker: Any) -> Floats | None:
    """Return the colours of the corners, shape (N, 4); None if the marker has one colour.

    RViz multiplies alphas, but blends only if a corner's colour is transparent, or, where each triangle has
    one, if the marker's is.
    """
    if has_colors(marker):
        each = colors(marker)
        blended = each[:, 3].min() < OPAQUE_FROM
    elif has_face_colors(marker):
        each = np.repeat(colors(marker), 3, axis=0)
        blended = marker.color.a < OPAQUE_FROM
    else:
        return None
    each[:, 3] = each[:, 3] * rgba(marker.color)[3] if blended else 1.0
    return each
