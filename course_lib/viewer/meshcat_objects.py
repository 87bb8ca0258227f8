"""What the meshcat package draws, as our own drawables, for pictures made without its JavaScript."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

from course_lib.viewer.arrays import Floats, Matrix
from course_lib.viewer.drawables import Drawable, Lines, Mesh, Points, Shape, Solids
from course_lib.viewer.mesh_files import parse_mesh
from course_lib.viewer.scene import MeshcatObject

Json: TypeAlias = Mapping[str, Any]

_TYPES = {0x12: np.uint8, 0x15: np.int32, 0x16: np.uint32, 0x17: np.float32}  # meshcat's msgpack extensions
_TRANSFORM_UP_TO_Y = np.array(
    [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]
)  # three.js's axis is y


def drawables_of(json: Json) -> list[tuple[Matrix, Drawable]]:
    """Return an object of meshcat as drawables, each with its transform to the object's node.

    Boxes, balls, cylinders, triangles, points and lines are known; anything else is left out.
    """
    thing = json["object"]
    geometry, material = _part(json, "geometry", "geometries"), _part(json, "material", "materials")
    transform_geometry_to_node = np.reshape(thing.get("matrix", np.eye(4)), (4, 4)).T  # column by column
    if geometry.get("type") in _SOLIDS:
        solid = _SOLIDS[geometry["type"]](geometry, _color(material))
        return [(transform_geometry_to_node, solid)]
    if geometry.get("type") == "BufferGeometry" and thing["type"] in (
        "Mesh",
        "Points",
        "Line",
        "LineSegments",
    ):
        return [(transform_geometry_to_node, _buffer(thing["type"], geometry["data"], material))]
    return []


def recolored(thing: MeshcatObject | Mesh, rgba: Sequence[float]) -> MeshcatObject | Mesh:
    """Return the same thing in one colour, RGBA in 0..1."""
    if isinstance(thing, Mesh):
        return Mesh(thing.vertices, thing.faces, rgba, thing.normals, thing.lit)
    red, green, blue, alpha = (round(255 * part) for part in rgba)
    paint = {"color": red << 16 | green << 8 | blue, "opacity": alpha / 255, "transparent": alpha < 255}
    materials = [{**material, **paint} for material in thing.json.get("materials", ())]
    return MeshcatObject({**thing.json, "materials": materials})


def _part(json: Json, field: str, library: str) -> Json:
    """Return what the object means by the id in one of its fields."""
    wanted = json["object"].get(field)
    return next((part for part in json.get(library, ()) if part["uuid"] == wanted), {})


def _box(geometry: Json, color: Floats) -> Solids:
    return Solids("box", [np.diag([geometry["width"], geometry["height"], geometry["depth"], 1])], color)


def _sphere(geometry: Json, color: Floats) -> Solids:
    diameter = 2 * geometry["radius"]
    return Solids("sphere", [np.diag([diameter, diameter, diameter, 1])], color)


def _cylinder(geometry: Json, color: Floats) -> Solids:
    top, bottom = geometry["radiusTop"], geometry["radiusBottom"]
    shape: Shape = "cone" if top == 0 else "cylinder"
    scale = np.diag([2 * bottom, 2 * bottom, geometry["height"], 1])
    return Solids(shape, [_TRANSFORM_UP_TO_Y @ scale], color)


_SOLIDS: dict[str, Callable[[Json, Floats], Solids]] = {
    "BoxGeometry": _box,
    "SphereGeometry": _sphere,
    "CylinderGeometry": _cylinder,
}


def mesh_of(json: Json) -> Mesh | None:
    """Return the mesh file in an object of meshcat, read once, as pages take seconds for it.

    None if there is none, or if it comes with pictures, which the page can draw.
    """
    thing, geometry = json["object"], _part(json, "geometry", "geometries")
    file = thing if thing["type"] == "_meshfile_object" else geometry
    if not str(file.get("type", "")).startswith("_meshfile") or file.get("resources"):
        return None
    material = _part(json, "material", "materials")
    data = file["data"]
    data = data.encode() if isinstance(data, str) else bytes(getattr(data, "data", data))
    mesh = parse_mesh(data, file["format"], tuple(_color(material).tolist()) if material else None)
    transform_mesh_to_node = np.reshape(thing.get("matrix", np.eye(4)), (4, 4)).T
    if np.array_equal(transform_mesh_to_node, np.eye(4)):
        return mesh
    vertices = mesh.vertices @ transform_mesh_to_node[:3, :3].T + transform_mesh_to_node[:3, 3]
    return Mesh(vertices, mesh.faces, mesh.colors)


def _color(material: Json) -> Floats:
    rgb = int(material.get("color", 0xFFFFFF))
    alpha = float(material.get("opacity", 1)) if material.get("transparent") else 1.0
    parts = [(rgb >> shift & 255) / 255 for shift in (16, 8, 0)]
    return np.array([*parts, alpha], np.float32)


def _buffer(kind: str, data: Json, material: Json) -> Drawable:
    points = _array(data["attributes"]["position"]).reshape(-1, 3)
    colors = _color(material)
    if material.get("vertexColors") and "color" in data["attributes"]:
        rgb = _array(data["attributes"]["color"]).reshape(-1, 3)
        colors = np.column_stack([rgb, np.full(len(rgb), colors[3])]).astype(np.float32)
    if kind == "Points":
        size = material.get("size", 0.001)  # [m]
        return Points(points, colors, (size, size))
    if kind != "Mesh":
        return Lines(points, colors, strip=kind == "Line")
    faces = _array(data["index"]).reshape(-1, 3) if "index" in data else None
    return Mesh(points, faces, colors)


def _array(packed: Json) -> Any:
    return np.frombuffer(packed["array"].data, _TYPES[packed["array"].type])
