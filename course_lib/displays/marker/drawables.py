"""Drawables of single markers: shapes, lists, lines, meshes and triangles."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from itertools import chain
from operator import attrgetter
from typing import Any

import numpy as np

from course_lib.arrays import Floats, Reals
from course_lib.displays.statuses import Level
from course_lib.errors import CourseError
from course_lib.robots.resources import resolve
from course_lib.viewer.drawables import OPAQUE_FROM, Drawable, Lines, Mesh, Points, Shape, Solids, Spot, Text
from course_lib.viewer.mesh_files import load_mesh

SOLIDS: dict[int, Shape] = {1: "box", 2: "sphere", 3: "cylinder"}
ALONG_X = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # takes z of the solids to x
ALONG_MINUS_X = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
_FLAT: tuple[Level, str] = ("warn", "Scale of 0 in one of x/y/z")
LINE_STRIP, LINE_LIST, CUBE_LIST, SPHERE_LIST, POINTS = 4, 5, 6, 7, 8
SPOTS: dict[int, Spot] = {CUBE_LIST: "box", SPHERE_LIST: "sphere", POINTS: "square"}


@dataclass(frozen=True)
class Drawn:
    """The picture of one marker, in the frame of its pose."""

    parts: Mapping[str, Drawable] = field(default_factory=dict)  # what is drawn, by name
    status: tuple[Level, str] | None = None  # RViz's status of the marker, if it has one
    refused: bool = False  # the message is so wrong that RViz does not even look for a transform


def refused(text: str) -> Drawn:
    """Return what RViz draws of a message it does not accept: an error."""
    return Drawn(status=("error", text), refused=True)


def rgba(color: Any) -> Floats:
    """Return a std_msgs/msg/ColorRGBA in 0..1, shape (4,)."""
    values: Floats = np.clip([color.r, color.g, color.b, color.a], 0.0, 1.0)
    return values


def scale_of(marker: Any) -> Floats:
    """Return the scale of a marker, shape (3,)."""
    return np.array([marker.scale.x, marker.scale.y, marker.scale.z])


def points(marker: Any) -> Floats:
    """Return the points of a marker, shape (N, 3), [m]."""
    return _numbers(marker.points, "x", "y", "z")


def colors(marker: Any) -> Floats:
    """Return the colours of a marker's points, shape (N, 4); NaN counts as 0, RViz does not look."""
    values: Floats = np.clip(np.nan_to_num(_numbers(marker.colors, "r", "g", "b", "a")), 0.0, 1.0)
    return values


def _numbers(messages: Collection[Any], *fields: str) -> Floats:
    """Return fields of messages, shape (N, number of fields); there may be a million."""
    each = chain.from_iterable(map(attrgetter(*fields), messages))
    return np.fromiter(each, float, len(fields) * len(messages)).reshape(-1, len(fields))


def label(marker: Any) -> str:
    """Return the name that RViz gives to a marker's status."""
    return f"{marker.ns}/{marker.id}"


SHAFT, HEAD = 0.77, 0.23  # shares of an arrow's length


def solid(marker: Any) -> Drawn:
    """Draw a cube, a sphere or a cylinder: the scale is its full extent."""
    scale = scale_of(marker)
    placement = np.diag([*scale, 1.0])
    body = Solids(SOLIDS[marker.type], [placement], rgba(marker.color))
    return Drawn({"body": body}, None if scale.all() else _FLAT)


def arrow(marker: Any) -> Drawn:
    """Draw an arrow along +x from the pose, or between two points given in the frame of the pose."""
    if len(marker.points) == 1:
        return refused(f"Arrow marker [{label(marker)}] only specified one point of a point to point arrow.")
    if len(marker.points) == 2:
        return _arrow_between(marker)
    length, width, height = scale = scale_of(marker)
    shaft = placement(ALONG_X, (width, height, SHAFT * length), (SHAFT * length / 2, 0.0, 0.0))
    head_center = ((SHAFT + HEAD / 2) * length, 0.0, 0.0)
    head = placement(ALONG_X, (2 * width, 2 * height, HEAD * length), head_center)
    return _arrow(marker, shaft, head, None if scale.all() else _FLAT)


def text(marker: Any) -> Drawn:
    """Draw text that faces the viewer: z of the scale is the height of its letters."""
    height = marker.scale.z
    if not height or not marker.text:
        return Drawn()
    return Drawn({"text": Text(marker.text, abs(height), rgba(marker.color))})


def _arrow_between(marker: Any) -> Drawn:
    """Draw an arrow of two points: scale x is the shaft's diameter, y the head's, z the head's length."""
    start, end = points(marker)
    distance = float(np.linalg.norm(end - start))
    shaft_diameter, head_diameter, head_length = scale_of(marker)
    status: tuple[Level, str] = ("warn", "Scale of 0 in both x and y")
    said = status if shaft_diameter + head_diameter == 0 else None
    if not distance:
        return Drawn(status=said)
    head_length = min(max(head_length, 0.0), distance) if head_length else HEAD * distance
    shaft_length = distance - head_length
    along = turned_to((end - start) / distance)
    shaft_size = (shaft_diameter, shaft_diameter, shaft_length)
    head_size = (head_diameter, head_diameter, head_length)
    shaft = placement(along, shaft_size, start + along[:, 2] * shaft_length / 2)
    head = placement(along, head_size, end - along[:, 2] * head_length / 2)
    return _arrow(marker, shaft, head, said)


def _arrow(marker: Any, shaft: Floats, head: Floats, status: tuple[Level, str] | None) -> Drawn:
    color = rgba(marker.color)
    return Drawn({"shaft": Solids("cylinder", [shaft], color), "head": Solids("cone", [head], color)}, status)


def turned_to(direction: Floats) -> Floats:
    """Return a rotation that takes z to a direction, shape (3, 3)."""
    helper = np.eye(3)[np.argmin(np.abs(direction))]
    x = np.cross(helper, direction)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(direction, x), direction])


def placement(rotation: Floats, size: Any, center: Any) -> Floats:
    """Return the transform that scales a unit shape, turns it and moves it, shape (4, 4)."""
    transform = np.eye(4)
    transform[:3, :3] = rotation * np.asarray(size)
    transform[:3, 3] = center
    return transform


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
    """Return whether RViz uses the colours of the points: only if there is one for each."""
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


def drawn_twice(alpha: Reals) -> Reals:
    """Return the alpha of something that is drawn over itself once more."""
    return 1 - (1 - alpha) ** 2


def mesh(marker: Any) -> Drawn:
    """Draw a mesh, its own units times the scale."""
    uri = marker.mesh_resource
    if not uri:
        return Drawn()
    try:
        own = load_mesh(resolve(uri))
    except CourseError:
        return refused(f"Mesh resource marker [{label(marker)}] could not load [{uri}]")
    color, scale = rgba(marker.color), scale_of(marker)
    colors = _tinted(own.colors.astype(float), color) if marker.mesh_use_embedded_materials else color
    normals = own.normals if scale.min() == scale.max() > 0 else None  # what is stretched gets new ones
    return Drawn({"mesh": Mesh(own.vertices * scale, own.faces, colors, normals)})


def _tinted(own: Floats, color: Floats) -> Floats:
    """Return the mesh's own colours, half way to a tint if one is given."""
    if not color.any():
        return own
    tinted: Floats = own + (color - own) * min(color[3], 0.5)
    tinted[..., 3] = color[3]
    return tinted


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
    """Return whether there is one colour for each triangle."""
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


# The function that draws each type, by the constants of visualization_msgs/msg/Marker.
DRAW: Mapping[int, Callable[[Any], Drawn]] = {
    0: arrow,
    **dict.fromkeys(SOLIDS, solid),
    **dict.fromkeys((LINE_STRIP, LINE_LIST), lines),
    **dict.fromkeys(SPOTS, spots),
    9: text,
    10: mesh,
    11: triangles,
}
