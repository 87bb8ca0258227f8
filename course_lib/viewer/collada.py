"""COLLADA files: triangles with the colours of their materials, as robots have them.

As in RViz, the unit counts and the axis that the file calls up does not.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np

from course_lib.viewer.arrays import Floats, Integers, Matrix
from course_lib.viewer.drawables import Mesh

_PLAIN = np.array([0.7, 0.7, 0.7, 1.0], np.float32)  # where a file says nothing, or has a texture


class _Part(NamedTuple):
    """Triangles of one material: vertices (V, 3), normals (V, 3), faces (F, 3), colour (4,)."""

    vertices: Matrix
    normals: Matrix
    faces: Integers
    color: Floats


def read_collada(data: bytes) -> Mesh:
    """Read a file; raises ValueError, LookupError or SyntaxError if it is broken."""
    root = ElementTree.fromstring(data)
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]  # without the name space
    by_id = {element.get("id", ""): element for element in root.iter()}
    unit = root.find("asset/unit")
    scale = float(unit.get("meter", 1)) if unit is not None else 1.0  # [m]
    parts = [
        part
        for scene in root.iter("visual_scene")
        for node in scene.findall("node")
        for part in _parts(node, np.diag([scale, scale, scale, 1.0]), by_id)
    ]
    if not parts:
        raise ValueError("it has no triangles.")
    counts = [len(part.vertices) for part in parts]
    starts = np.cumsum([0, *counts[:-1]])
    return Mesh(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + start for part, start in zip(parts, starts, strict=True)]),
        np.repeat([part.color for part in parts], counts, axis=0),
        np.concatenate([part.normals for part in parts]),
    )


def _parts(node: Element, transform_parent_to_mesh: Matrix, by_id: dict[str, Element]) -> Iterator[_Part]:
    """Iterate over what a node and all below it draw."""
    transform = transform_parent_to_mesh
    for child in node:
        if child.tag in _PLACED:
            transform = transform @ _PLACED[child.tag](_numbers(child))
    for instance in node.findall("instance_geometry"):
        materials = {
            bound.get("symbol"): bound.get("target", "#")[1:] for bound in instance.iter("instance_material")
        }
        mesh = by_id[instance.get("url", "#")[1:]].find("mesh")
        for group in mesh if mesh is not None else ():
            if group.tag in ("triangles", "polylist"):
                color = _color(by_id.get(materials.get(group.get("material"), "")), by_id)
                yield _part(group, transform, color, by_id)
    for child in node.findall("node"):
        yield from _parts(child, transform, by_id)


def _part(group: Element, transform: Matrix, color: Floats, by_id: dict[str, Element]) -> _Part:
    inputs = {item.get("semantic"): item for item in group.findall("input")}
    width = 1 + max(int(item.get("offset", 0)) for item in inputs.values())
    corners = _numbers(group.find("p")).astype(int).reshape(-1, width)
    corners = corners[_fans(group)] if group.tag == "polylist" else corners
    place = corners[:, int(inputs["VERTEX"].get("offset", 0))]
    vertices = by_id[inputs["VERTEX"].get("source", "#")[1:]]
    points = _source(vertices.find("input[@semantic='POSITION']"), by_id)
    normal = inputs.get("NORMAL")
    if normal is None:
        flat = points[place].reshape(-1, 3, 3)
        directions = np.repeat(np.cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]), 3, axis=0)
        facing = np.arange(len(place))
    else:
        directions, facing = _source(normal, by_id), corners[:, int(normal.get("offset", 0))]
    pairs, faces = np.unique(place * len(directions) + facing, return_inverse=True)
    place, facing = np.divmod(pairs, len(directions))
    turned = directions[facing] @ np.linalg.inv(transform[:3, :3])
    turned /= np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)
    points = points[place] @ transform[:3, :3].T + transform[:3, 3]
    return _Part(points, turned, faces.reshape(-1, 3).astype(np.uint32), color)


def _fans(group: Element) -> Integers:
    """Return the corners of polygons as triangles around the first of each."""
    counts = _numbers(group.find("vcount")).astype(int)
    starts = np.cumsum(counts) - counts
    fans = [
        (start, start + i, start + i + 1)
        for start, n in zip(starts, counts, strict=True)
        for i in range(1, n - 1)
    ]
    return np.array(fans, dtype=np.uint32).ravel()


def _color(material: Element | None, by_id: dict[str, Element]) -> Floats:
    """Return the diffuse colour of a material."""
    effect = material.find("instance_effect") if material is not None else None
    technique = by_id.get(effect.get("url", "#")[1:]) if effect is not None else None
    color = technique.find(".//diffuse/color") if technique is not None else None
    return _PLAIN if color is None else _numbers(color).astype(np.float32)


def _source(item: Element | None, by_id: dict[str, Element]) -> Matrix:
    if item is None:
        raise ValueError("a group of triangles has no positions.")
    return _numbers(by_id[item.get("source", "#")[1:]].find("float_array")).reshape(-1, 3)


def _numbers(element: Element | None) -> Matrix:
    return np.array((element.text or "").split() if element is not None else [], dtype=float)


def _translate(numbers: Matrix) -> Matrix:
    transform = np.eye(4)
    transform[:3, 3] = numbers
    return transform


def _rotate(numbers: Matrix) -> Matrix:
    """Turn around an axis (x, y, z) by an angle in degrees, by Rodrigues' formula."""
    x, y, z = numbers[:3] / np.linalg.norm(numbers[:3])
    angle = np.radians(numbers[3])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    transform = np.eye(4)
    transform[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return transform


_PLACED: dict[str, Callable[[Matrix], Matrix]] = {
    "matrix": lambda numbers: numbers.reshape(4, 4),
    "translate": _translate,
    "rotate": _rotate,
    "scale": lambda numbers: np.diag([*numbers, 1.0]),
}
