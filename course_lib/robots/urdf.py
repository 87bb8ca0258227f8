"""Robot descriptions: links and joints of a URDF."""

import os
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from transforms3d.euler import euler2mat

from course_lib.arrays import Matrix
from course_lib.errors import CourseError

if TYPE_CHECKING:
    import pinocchio as pin


_INERTIA = ("xx", "xy", "xz", "yy", "yz", "zz")
MOVING = ("revolute", "continuous", "prismatic")  # the kinds of joints that one number places


@dataclass(frozen=True, eq=False)
class Geometry:
    """One shape of a link."""

    kind: Literal["box", "cylinder", "sphere", "mesh"]
    transform_shape_to_link: Matrix  # shape (4, 4)
    size: tuple[float, ...]  # full extents along x, y, z, [m]; what a mesh is scaled by
    uri: str = ""  # of a mesh


@dataclass(frozen=True)
class Material:
    """Color of a shape, RGBA in 0..1, or a picture at an address."""

    color: tuple[float, ...]
    texture: str = ""


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass [kg] and inertia [kg m²], shape (3, 3), about the centre of mass."""

    mass: float
    inertia: Matrix
    transform_center_to_link: Matrix  # shape (4, 4)


@dataclass(frozen=True, eq=False)
class Link:
    """A link: visual shapes with the material of the first one, collision shapes, inertia."""

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
    """Return transform_element_to_link, shape (4, 4)."""
    origin = element.find("origin")
    given = {} if origin is None else origin.attrib
    transform = np.eye(4)
    transform[:3, :3] = euler2mat(*_numbers(given.get("rpy", "0 0 0")))
    transform[:3, 3] = _numbers(given.get("xyz", "0 0 0"))
    return transform


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(map(float, text.split()))


@dataclass(frozen=True)
class Follow:
    """The position of a mimic joint: factor times the position of a joint, plus an offset, [rad] or [m]."""

    joint: str
    factor: float
    offset: float


@dataclass(frozen=True)
class Joint:
    """A joint between two links.

    Args:
        limits: Holds lower, soft_lower_limit … where given, [rad] or [m].
        axis: Of the motion, in the child's frame.
        effort: The limit, [N m] or [N]; None without a <limit> tag.
    """

    name: str
    kind: str
    parent: str
    child: str
    limits: Mapping[str, float]
    mimic: Follow | None
    axis: tuple[float, ...]
    effort: float | None

    @property
    def unit(self) -> str:
        """The unit of its position."""
        return "m" if self.kind == "prismatic" else "rad"


@dataclass(frozen=True, eq=False)
class Urdf:
    """A robot's name, root link, joints in the order of the file, and Pinocchio's model."""

    name: str
    root: str
    joints: Mapping[str, Joint]
    model: "pin.Model"

    def followed(self, joint: Joint) -> Follow:
        """Return the position of a joint by the joint at the end of its mimic chain, perhaps itself.

        Raises:
            CourseError: If joints mimic each other in a ring.
        """
        chain, factor, offset = [joint.name], 1.0, 0.0
        while (mimic := self.joints[chain[-1]].mimic) and mimic.joint in self.joints:
            if mimic.joint in chain:
                raise CourseError(f"Found an infinite recursive mimic chain: {[*chain, mimic.joint]}")
            chain.append(mimic.joint)
            factor, offset = factor * mimic.factor, offset + factor * mimic.offset
        return Follow(chain[-1], factor, offset)


@lru_cache(maxsize=32)
def parse_urdf(text: str) -> Urdf:
    """Read a URDF.

    Raises:
        CourseError: If it is none, with urdfdom's reasons; or Pinocchio is missing on this machine.
    """
    pin = needed("pinocchio")
    try:
        robot = ET.fromstring(text)
    except ET.ParseError as error:
        raise CourseError(f"The URDF is not XML: {error}. It begins with {text[:40]!r}.") from None
    with _native_errors() as reasons:
        try:
            model = pin.buildModelFromXML(text)
        except (ValueError, RuntimeError) as error:
            reasons.append(str(error))
            model = None
    if model is None:
        raise CourseError(f"The URDF is not valid: {'; '.join(reasons)}")
    joints = {joint.name: joint for joint in map(_joint, robot.findall("joint"))}
    children = {joint.child for joint in joints.values()}
    links = [link.get("name", "") for link in robot.findall("link")]
    bodies = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
    if sorted(bodies) != sorted(links) or len(children) != len(joints):
        raise CourseError("The URDF is not a tree: each link but one must be the child of exactly one joint.")
    return Urdf(robot.get("name", ""), next(link for link in links if link not in children), joints, model)


def _joint(element: ET.Element) -> Joint:
    def of(tag: str) -> Mapping[str, str]:
        found = element.find(tag)
        return {} if found is None else found.attrib

    wanted = ("lower", "upper", "soft_lower_limit", "soft_upper_limit")
    given = {**of("limit"), **of("safety_controller")}
    limits = {key: float(given[key]) for key in wanted if key in given}
    mimic = of("mimic")
    follow = (
        Follow(mimic["joint"], float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0)))
        if mimic
        else None
    )
    name, kind = element.attrib["name"], element.attrib["type"]
    effort = float(of("limit").get("effort", 0)) if of("limit") else None
    axis = _numbers(of("axis").get("xyz", "1 0 0"))
    return Joint(name, kind, of("parent")["link"], of("child")["link"], limits, follow, axis, effort)


def needed(package: str) -> Any:
    """Import an optional package; raises a CourseError with advice where it is missing."""
    try:
        return import_module(package)
    except ImportError as error:
        raise CourseError(
            f"Robot models need the packages pin and example-robot-data, and {error.name} is missing on this "
            f"machine ({sys.platform}). On Windows run the course in WSL2 or on a JupyterHub; elsewhere run "
            "pip install -e . again."
        ) from error


@contextmanager
def _native_errors() -> Iterator[list[str]]:
    """Collect the errors that C++ prints to stderr within a `with` block."""
    reasons: list[str] = []
    terminal, (reader, writer) = os.dup(2), os.pipe()
    os.set_blocking(writer, False)  # a pipe that is full drops what is too much
    os.dup2(writer, 2)
    try:
        yield reasons
    finally:
        os.dup2(terminal, 2)
        os.close(terminal)
        os.close(writer)
        lines = os.read(reader, 2**16).decode(errors="replace").splitlines()
        os.close(reader)
        reasons[:0] = [line.removeprefix("Error:").strip() for line in lines if line.startswith("Error:")]
