"""meshcat's objects as drawables, which look alike in pages and in pictures."""

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from typing import Any, TypeAlias

import numpy as np

from course_lib.arrays import Float32s, Matrix
from course_lib.viewer.drawables import (
    Drawable,
    Lines,
    Mesh,
    MeshcatObject,
    Points,
    Shape,
    Solids,
    Text,
    floats,
    rgba,
)
from course_lib.viewer.mesh_files import parse_mesh

Json: TypeAlias = Mapping[str, Any]

_TYPES = {0x12: np.uint8, 0x15: np.int32, 0x16: np.uint32, 0x17: np.float32}  # meshcat's msgpack extensions
_TRANSFORM_UP_TO_Y = np.array(
    [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]
)  # three.js's axis is y


def drawable_of(json: Json) -> Drawable:
    """Return an object of meshcat as a drawable; what has no equal stays for the page's three.js to draw.

    Boxes, balls, cylinders, triangles, points, lines and mesh files have one, unless they carry pictures
    or are wire frames.
    """
    thing = json["object"]
    geometry, material = _part(json, "geometry", "geometries"), _part(json, "material", "materials")
    transform_geometry_to_node = np.reshape(thing.get("matrix", np.eye(4)), (4, 4)).T  # column by column
    file = thing if thing["type"] == "_meshfile_object" else geometry
    special = material.get("map") or material.get("wireframe") or file.get("resources")
    if str(file.get("type", "")).startswith("_meshfile") and not special:
        return _moved(_from_file(file, material), transform_geometry_to_node)
    lit = material.get("type") != "MeshBasicMaterial"
    if thing["type"] == "Mesh" and geometry.get("type") in _SOLIDS and not special:
        shape, transform_unit_to_geometry = _SOLIDS[geometry["type"]](geometry)
        placement = transform_geometry_to_node @ transform_unit_to_geometry
        return Solids(shape, [placement], _color(material), lit)
    if thing["type"] in _BUFFERS and geometry.get("type") == "BufferGeometry" and not special:
        attributes = geometry["data"]["attributes"]
        colors = _colors(attributes, material)
        drawn = _BUFFERS[thing["type"]](_array(attributes["position"]), colors, geometry["data"], material)
        return _moved(drawn, transform_geometry_to_node)
    return MeshcatObject(json)


def recolored(thing: Drawable, color: Sequence[float]) -> Drawable:
    """Return the same thing in one colour, RGBA in 0..1."""
    if isinstance(thing, MeshcatObject):
        red, green, blue, alpha = (round(255 * part) for part in color)
        paint = {"color": red << 16 | green << 8 | blue, "opacity": alpha / 255, "transparent": alpha < 255}
        materials = [{**material, **paint} for material in thing.json.get("materials", ())]
        return MeshcatObject({**thing.json, "materials": materials})
    other = copy(thing)
    setattr(other, "color" if isinstance(other, Text) else "colors", rgba(color))
    return other


def _part(json: Json, field: str, library: str) -> Json:
    """Return what the object means by the id in one of its fields."""
    wanted = json["object"].get(field)
    return next((part for part in json.get(library, ()) if part["uuid"] == wanted), {})


def _color(material: Json) -> Float32s:
    rgb = int(material.get("color", 0xFFFFFF))
    alpha = float(material.get("opacity", 1)) if material.get("transparent") else 1.0
    parts = [(rgb >> shift & 255) / 255 for shift in (16, 8, 0)]
    return np.array([*parts, alpha], np.float32)


def _colors(attributes: Json, material: Json) -> Float32s:
    """Return the colours of the vertices if they count, shape (V, 4), else that of the material."""
    color = _color(material)
    if not material.get("vertexColors") or "color" not in attributes:
        return color
    rgb = _array(attributes["color"])
    return np.column_stack([rgb, np.full(len(rgb), color[3])]).astype(np.float32)


def _array(packed: Json) -> Any:
    """Return an array of triples, shape (N, 3)."""
    return np.frombuffer(packed["array"].data, _TYPES[packed["array"].type]).reshape(-1, 3)


def _moved(drawn: Drawable, transform: Matrix) -> Drawable:
    """Place a mesh, points or lines in their node."""
    if np.array_equal(transform, np.eye(4)):
        return drawn
    other = copy(drawn)
    field = "vertices" if isinstance(drawn, Mesh) else "points"
    placed = getattr(drawn, field) @ transform[:3, :3].T + transform[:3, 3]
    setattr(other, field, floats(field, placed, (None, 3)))
    if isinstance(other, Mesh):
        other.normals = None  # they may not fit any more
    return other


def _from_file(file: Json, material: Json) -> Mesh:
    data = file["data"]
    content = data.encode() if isinstance(data, str) else bytes(data.data)
    return parse_mesh(content, file["format"], tuple(_color(material).tolist()) if material else None)


def _mesh(points: Float32s, colors: Float32s, data: Json, material: Json) -> Mesh:
    lit = material.get("type") != "MeshBasicMaterial"
    return Mesh(points, _array(data["index"]) if "index" in data else None, colors, lit=lit)


def _points(points: Float32s, colors: Float32s, _: Json, material: Json) -> Points:
    size = material.get("size", 0.001)  # [m]
    return Points(points, colors, (size, size))


_BUFFERS: dict[str, Callable[[Float32s, Float32s, Json, Json], Drawable]] = {
    "Mesh": _mesh,
    "Points": _points,
    "Line": lambda points, colors, *_: Lines(points, colors),
    "LineSegments": lambda points, colors, *_: Lines(points, colors, strip=False),
}


def _cylinder(geometry: Json) -> tuple[Shape, Matrix]:
    top, bottom = geometry["radiusTop"], geometry["radiusBottom"]
    scale = np.diag([2 * bottom, 2 * bottom, geometry["height"], 1])
    return "cylinder" if top else "cone", _TRANSFORM_UP_TO_Y @ scale


_SOLIDS: dict[str, Callable[[Json], tuple[Shape, Matrix]]] = {
    "BoxGeometry": lambda box: ("box", np.diag([box["width"], box["height"], box["depth"], 1])),
    "SphereGeometry": lambda ball: ("sphere", np.diag([2 * ball["radius"]] * 3 + [1])),
    "CylinderGeometry": _cylinder,
}
