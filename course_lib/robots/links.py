"""What a robot description says of the looks and the mass of links; `parse_urdf` has checked it."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt
from transforms3d.euler import euler2mat

Matrix: TypeAlias = npt.NDArray[np.float64]
Vector: TypeAlias = tuple[float, ...]

_INERTIA = ("xx", "xy", "xz", "yy", "yz", "zz")


@dataclass(frozen=True, eq=False)
class Geometry:
    """One shape of a link."""

    kind: Literal["box", "cylinder", "sphere", "mesh"]
    transform_shape_to_link: Matrix  # shape (4, 4)
    size: Vector  # full extents along x, y, z, [m]; what a mesh is scaled by
    uri: str = ""  # of a mesh


@dataclass(frozen=True)
class Material:
    """What a shape is painted with: RGBA in 0..1, or the picture at an address."""

    color: Vector
    texture: str = ""


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass [kg] and inertia [kg m²], shape (3, 3), about the centre of mass."""

    mass: float
    inertia: Matrix
    transform_center_to_link: Matrix  # shape (4, 4)


@dataclass(frozen=True, eq=False)
class Link:
    """A link; its shapes for the eye and for collisions, and the material of the first one for the eye."""

    name: str
    visuals: tuple[Geometry, ...]
    collisions: tuple[Geometry, ...]
    material: Material | None
    inertial: Inertial | None


def links_of(text: str) -> list[Link]:
    """Return the links of a URDF that `parse_urdf` takes, in the order of the file."""
    robot = ET.fromstring(text)
    named: dict[str, Material] = {}  # as in urdfdom, the first material of a name is all of that name
    for element in (*robot.findall("material"), *robot.findall("link/visual/material")):
        material = _material(element)
        if material:
            named.setdefault(element.get("name", ""), material)
    return [_link(element, named) for element in robot.findall("link")]


def _link(link: ET.Element, named: dict[str, Material]) -> Link:
    visuals, collisions = (tuple(_geometries(link, kind)) for kind in ("visual", "collision"))
    first, inertial = link.find("visual"), link.find("inertial")
    painted = None if first is None else first.find("material")
    name = "" if painted is None else painted.get("name", "")
    material = None if painted is None else named.get(name) if name else _material(painted)
    mass = None if inertial is None else _inertial(inertial)
    return Link(link.get("name", ""), visuals, collisions, material, mass)


def _geometries(link: ET.Element, kind: str) -> Iterator[Geometry]:
    for element in link.findall(kind):
        placed = _origin(element)
        for shape in element.findall("geometry/*"):
            given = shape.attrib
            if shape.tag == "box":
                yield Geometry("box", placed, _numbers(given["size"]))
            elif shape.tag == "sphere":
                yield Geometry("sphere", placed, (2 * float(given["radius"]),) * 3)
            elif shape.tag == "cylinder":
                diameter = 2 * float(given["radius"])
                yield Geometry("cylinder", placed, (diameter, diameter, float(given["length"])))
            elif shape.tag == "mesh":
                scale = _numbers(given.get("scale", "1 1 1"))
                yield Geometry("mesh", placed, scale, given["filename"])


def _material(element: ET.Element) -> Material | None:
    color, texture = element.find("color"), element.find("texture")
    if texture is not None:
        return Material((1.0, 1.0, 1.0, 1.0), texture.get("filename", ""))
    return None if color is None else Material(_numbers(color.get("rgba", "")))


def _inertial(element: ET.Element) -> Inertial | None:
    mass, inertia = element.find("mass"), element.find("inertia")
    if mass is None or inertia is None:
        return None
    xx, xy, xz, yy, yz, zz = (float(inertia.get(f"i{axes}", 0)) for axes in _INERTIA)
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertial(float(mass.get("value", 0)), matrix, _origin(element))


def _origin(element: ET.Element) -> Matrix:
    """Return where an element is in its link, shape (4, 4)."""
    origin = element.find("origin")
    given = {} if origin is None else origin.attrib
    transform = np.eye(4)
    transform[:3, :3] = euler2mat(*_numbers(given.get("rpy", "0 0 0")))
    transform[:3, 3] = _numbers(given.get("xyz", "0 0 0"))
    return transform


def _numbers(text: str) -> Vector:
    return tuple(map(float, text.split()))
