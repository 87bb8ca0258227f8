"""Robot descriptions: links and joints of a URDF."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Literal

import numpy as np
from transforms3d.euler import euler2mat
from transforms3d.quaternions import quat2mat

from course_lib.arrays import Matrix
from course_lib.errors import CourseError
from course_lib.robots.urdf_rules import NOT_A_TREE, UNMOVED, broken_rules, ends_of

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
    robot = _root(text)
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
    """Yield the shapes that can be read; urdfdom, too, goes on without the others."""
    for element in link.findall(kind):
        for shape in element.findall("geometry/*"):
            try:
                yield _geometry(shape.tag, shape.attrib, _origin(element))
            except (KeyError, ValueError):  # a size that is missing, or no number
                continue


def _geometry(kind: str, given: Mapping[str, str], placed: Matrix) -> Geometry:
    match kind:
        case "box":
            return Geometry("box", placed, _vector(given["size"]))
        case "sphere":
            return Geometry("sphere", placed, (2 * float(given["radius"]),) * 3)
        case "cylinder":
            diameter = 2 * float(given["radius"])
            return Geometry("cylinder", placed, (diameter, diameter, float(given["length"])))
        case "mesh":
            return Geometry("mesh", placed, _vector(given.get("scale", "1 1 1")), given["filename"])
    raise KeyError(kind)


def _material(element: ET.Element) -> Material | None:
    color, texture = element.find("color"), element.find("texture")
    if texture is not None:
        return Material((1.0, 1.0, 1.0, 1.0), texture.get("filename", ""))
    return None if color is None else Material(_numbers(color.get("rgba", "")))


def _inertial(element: ET.Element) -> Inertial | None:
    mass, inertia = element.find("mass"), element.find("inertia")
    if mass is None or inertia is None:
        return None
    try:
        xx, xy, xz, yy, yz, zz = (float(inertia.get(f"i{axes}", 0)) for axes in _INERTIA)
        matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        return Inertial(float(mass.get("value", 0)), matrix, _origin(element))
    except ValueError:
        return None


def _origin(element: ET.Element) -> Matrix:
    """Return transform_element_to_link, shape (4, 4)."""
    origin = element.find("origin")
    given = {} if origin is None else origin.attrib
    transform = np.eye(4)
    transform[:3, :3] = euler2mat(*_vector(given.get("rpy", "0 0 0")))
    transform[:3, 3] = _vector(given.get("xyz", "0 0 0"))
    if "quat_xyzw" in given:
        x, y, z, w = _numbers(given["quat_xyzw"])
        transform[:3, :3] = quat2mat((w, x, y, z))
    return transform


def _vector(text: str) -> tuple[float, ...]:
    x, y, z = _numbers(text)
    return x, y, z


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(map(float, text.split()))


@dataclass(frozen=True)
class Follow:
    """The position of a mimic joint: factor times the position of a joint, plus an offset, [rad] or [m]."""

    joint: str
    factor: float
    offset: float


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between two links.

    Args:
        limits: Holds lower, soft_lower_limit … where given, [rad] or [m].
        axis: Of the motion, in the child's frame.
        effort: The limit, [N m] or [N]; None without a <limit> tag.
        velocity: The limit, [rad/s] or [m/s]; infinite without a <limit> tag.
        transform_joint_to_parent: Where the child is when the position is 0, shape (4, 4).
    """

    name: str
    kind: str
    parent: str
    child: str
    limits: Mapping[str, float]
    mimic: Follow | None
    axis: tuple[float, ...]
    effort: float | None
    velocity: float
    transform_joint_to_parent: Matrix = field(repr=False)

    @property
    def unit(self) -> str:
        """The unit of its position."""
        return "m" if self.kind == "prismatic" else "rad"


@dataclass(frozen=True, eq=False)
class Urdf:
    """A robot's name, root link, and joints in the order of the file."""

    name: str
    root: str
    joints: Mapping[str, Joint]

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

    def downward(self) -> list[Joint]:
        """Return the joints that hang on the root, each after those above it."""
        below: dict[str, list[Joint]] = {}
        for joint in sorted(self.joints.values(), key=lambda joint: joint.name, reverse=True):
            below.setdefault(joint.parent, []).append(joint)
        found, waiting = list[Joint](), below.get(self.root, []).copy()
        while waiting:
            found.append(waiting.pop())
            waiting += below.pop(found[-1].child, [])
        return found


@lru_cache(maxsize=32)
def parse_urdf(text: str) -> Urdf:
    """Read a URDF.

    Raises:
        CourseError: If it is none, with urdfdom's reason.
    """
    robot = _root(text)
    reason = next(broken_rules(robot), None)
    if reason:
        raise CourseError(f"The URDF is not valid: {reason}")
    joints = {joint.name: joint for joint in map(_joint, robot.findall("joint"))}
    children = {joint.child for joint in joints.values()}
    links = [link.get("name", "") for link in robot.findall("link")]
    tree = Urdf(robot.get("name", ""), next(link for link in links if link not in children), joints)
    if len(children) != len(joints) or len(tree.downward()) != len(joints):
        raise CourseError(NOT_A_TREE)
    return tree


def _root(text: str) -> ET.Element:
    """Return the element of the robot."""
    try:
        robot = ET.fromstring(text)
    except ET.ParseError as error:
        raise CourseError(f"The URDF is not XML: {error}. It begins with {text[:40]!r}.") from None
    if robot.get("version", "1.0") == "1.0":  # which has no quaternions
        for origin in robot.iter("origin"):
            origin.attrib.pop("quat_xyzw", None)
    return robot


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
    effort = float(of("limit")["effort"]) if of("limit") else None
    velocity = float(of("limit").get("velocity", "inf"))
    axis = _vector(of("axis").get("xyz", "1 0 0") if kind not in UNMOVED else "1 0 0")
    parent, child = ends_of(element)
    return Joint(name, kind, parent, child, limits, follow, axis, effort, velocity, _origin(element))
