"""Robot descriptions: links and joints of a URDF.

The rules and error messages are those of urdfdom, the parser of ROS.
"""

import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import lru_cache
from itertools import chain
from math import isfinite, pi, radians
from typing import Literal

import numpy as np
from transforms3d.euler import euler2mat
from transforms3d.quaternions import quat2mat

from course_lib.arrays import Matrix
from course_lib.errors import CourseError, did_you_mean, format_count, join_words
from course_lib.third_party import explain_xml_error

_KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
# Types of joints without an axis.
UNMOVED = ("fixed", "floating")
_VERSIONS = ("1.0", "1.1", "1.2")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
# urdfdom's errors for joints without a <limit>.
_UNLIMITED = {
    "revolute": "Joint [{}] is of type REVOLUTE but it does not specify limits",
    "prismatic": "Joint [{}] is of type PRISMATIC without limits",
}
NOT_A_TREE = "The URDF is not a tree: each link but one must be the child of exactly one joint."


@dataclass(frozen=True)
class _Tag:
    """A tag of a joint: its numeric attributes, and urdfdom's errors for missing ones."""

    name: str
    numbers: tuple[str, ...]
    needed: tuple[tuple[str, str], ...] = ()
    # Prefix of urdfdom's error messages about the tag.
    before: str = ""


_TAGS = (
    _Tag(
        "limit",
        ("lower", "upper", "effort", "velocity"),
        (("effort", "limit has no effort"), ("velocity", "limit has no velocity")),
        "joint [{}]: ",
    ),
    _Tag(
        "safety_controller",
        ("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"),
        (("k_velocity", "joint safety: no k_velocity"),),
    ),
    _Tag("calibration", ("rising", "falling")),
    _Tag("mimic", ("multiplier", "offset"), (("joint", "joint mimic: no mimic joint specified"),)),
    _Tag("dynamics", ("damping", "friction")),
)


def is_number(text: str) -> bool:
    """Return whether urdfdom parses a string as a finite number without surrounding characters."""
    return bool(_NUMBER.fullmatch(text)) and isfinite(float(text))


def find_errors(robot: ET.Element) -> Iterator[str]:
    """Yield urdfdom's errors for a description. urdfdom itself reports only the first one."""
    links, joints = ([e.get("name", "") for e in robot.findall(kind)] for kind in ("link", "joint"))
    if robot.tag != "robot":
        yield "Could not find the 'robot' element in the xml file"
    if not robot.get("name"):
        yield "No name given for the robot."
    if robot.get("version", "1.0") not in _VERSIONS:
        yield "Invalid 'version' specified; versions from 1.0 upto 1.2 are currently supported"
    yield from _find_duplicates("material", [e.get("name", "") for e in robot.findall("material") if len(e)])
    yield from _find_duplicates("link", links)
    if not links:
        yield "No link elements found in urdf file"
    yield from chain.from_iterable(map(_check_joint, robot.findall("joint")))
    yield from _find_duplicates("joint", joints)
    for joint in sorted(robot.findall("joint"), key=lambda joint: joint.get("name", "")):
        name, (parent, child) = joint.get("name"), parent_and_child(joint)
        if not parent or not child:
            yield f"Failed to build tree: Joint [{name}] is missing a parent and/or child link specification."
        elif child not in links:
            yield f"Failed to build tree: child link [{child}] of joint [{name}] not found"
        elif parent not in links:
            yield (
                f"Failed to build tree: parent link [{parent}] of joint [{name}] not found.  This "
                "is not valid according to the URDF spec. Every link you refer to from a joint "
                "needs to be explicitly defined in the robot description. To fix this problem you "
                "can either remove "
                f'this joint [{name}] from your urdf file, or add "<link name="{parent}" />" to your urdf '
                "file."
            )
    roots = sorted(set(links) - {parent_and_child(joint)[1] for joint in robot.findall("joint")})
    if not roots:
        yield "Failed to find root link: No root link found. The robot xml is not a valid tree."
    elif len(roots) > 1:
        yield f"Failed to find root link: Two root links found: [{roots[0]}] and [{roots[1]}]"


def _find_duplicates(kind: str, names: Collection[str]) -> Iterator[str]:
    for name, number in Counter(names).items():
        if number > 1:
            yield f"{kind} '{name}' is not unique."


def _check_joint(joint: ET.Element) -> Iterator[str]:
    name, kind, axis = joint.get("name"), joint.get("type"), joint.find("axis")
    if name is None:
        yield "unnamed joint found"
    for origin in joint.findall("origin")[:1]:
        vectors = (
            *_check_vector(origin, "xyz"),
            *_check_vector(origin, "rpy"),
            *_check_vector(origin, "quat_xyzw", 4),
        )
        for reason in vectors:
            yield f"{reason}; Malformed parent origin element for joint [{name}]"
    if kind is None:
        yield f"joint [{name}] has no type, check to see if it's a reference."
    elif kind not in _KINDS:
        yield f"Joint [{name}] has no known type [{kind}]"
    if axis is not None and kind not in UNMOVED:
        for reason in _check_vector(axis, "xyz"):
            yield f"Malformed axis element for joint [{name}]: {reason}"
    for tag in _TAGS:
        yield from _check_tag(joint, tag)
    if kind in _UNLIMITED and joint.find("limit") is None:
        yield _UNLIMITED[kind].format(name)


def _check_tag(joint: ET.Element, tag: _Tag) -> Iterator[str]:
    element = joint.find(tag.name)
    if element is None:
        return
    before = tag.before.format(joint.get("name"))
    for attribute in tag.numbers:
        text = element.get(attribute, "0")
        if not is_number(text):
            yield f"{before}{attribute} value ({text}) is not a valid float"
    for attribute, words in tag.needed:
        if attribute not in element.attrib:
            yield before + words
    if tag.name == "dynamics" and not element.attrib.keys() & set(tag.numbers):
        yield "joint dynamics element specified with no damping and no friction"


def _check_vector(element: ET.Element, name: str, length: int = 3) -> Iterator[str]:
    text = element.get(name)
    if text is not None:
        yield from find_vector_errors(text, length)


def find_vector_errors(text: str, length: int) -> Iterator[str]:
    """Yield urdfdom's errors for a string that should be a vector of `length` numbers."""
    words = text.split()
    for word in words:
        if not is_number(word):
            yield f"Unable to parse component [{word}] to a double (while parsing a vector value)"
    if len(words) != length:
        yield f"Parser found {len(words)} elements but {length} expected while parsing vector [{text}]"


def parent_and_child(joint: ET.Element) -> tuple[str, str]:
    """Return the names of a joint's parent and child; "" for a missing one."""
    parent, child = joint.find("parent"), joint.find("child")
    return "" if parent is None else parent.get("link", ""), "" if child is None else child.get("link", "")


_INERTIA = ("xx", "xy", "xz", "yy", "yz", "zz")
# Types of joints with one degree of freedom.
MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True, eq=False)
class Geometry:
    """A shape of a link."""

    kind: Literal["box", "cylinder", "sphere", "mesh"]
    # Shape (4, 4).
    transform_shape_to_link: Matrix
    # Full extents along x, y, z [m], or the scale factors of a mesh.
    size: tuple[float, ...]
    # The address of a mesh.
    uri: str = ""


@dataclass(frozen=True)
class Material:
    """The color of a shape, RGBA in 0..1, or the address of a texture."""

    color: tuple[float, ...]
    texture: str = ""


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass [kg] and inertia [kg m²], shape (3, 3), about the center of mass."""

    mass: float
    inertia: Matrix
    # Shape (4, 4).
    transform_center_to_link: Matrix


@dataclass(frozen=True, eq=False)
class Link:
    """A link: visual shapes with the material of the first one, collision shapes, inertia.

    `problems` are urdfdom's messages about malformed elements, which are ignored.
    """

    name: str
    visuals: tuple[Geometry, ...]
    collisions: tuple[Geometry, ...]
    material: Material | None
    inertial: Inertial | None
    problems: tuple[str, ...] = ()


class _MalformedError(Exception):
    """A malformed element of a link, which is ignored. The message is the same as in urdfdom."""


# Child tags by tag, for tags that students write by hand.
_CHILDREN = {
    "robot": {"link", "joint", "material", "transmission", "gazebo", "sensor", "ros2_control"},
    "link": {"visual", "collision", "inertial", "sensor", "gazebo", "contact"},
    "visual": {"origin", "geometry", "material"},
    "collision": {"origin", "geometry"},
    "inertial": {"origin", "mass", "inertia"},
    "joint": {"origin", "parent", "child", "axis", "dynamics", *(tag.name for tag in _TAGS)},
    "material": {"color", "texture"},
}
_OF_ORIGIN = {"xyz", "rpy", "quat_xyzw"}
# Two turns [rad]. A larger angle is probably in degrees.
MANY_RADIANS = 4 * pi


def find_slips(text: str) -> Iterator[str]:
    """Yield hints about parts of a URDF that urdfdom ignores and angles that may be in degrees."""
    robot = _root(text)
    for element in robot.iter():
        names = _CHILDREN.get(element.tag, set())
        for child in element if names else ():
            near = [] if child.tag in names else get_close_matches(child.tag.lower(), names, 1, 0.75)
            if near:
                owner = element.get("name") or element.tag
                yield f"{owner}: <{child.tag}> is ignored. Did you mean <{near[0]}>?"
        for origin in element.findall("origin"):
            owner = element.get("name") or f"<{element.tag}>"
            yield from (f"{owner}: {hint}" for hint in _slips_of_origin(origin))
    named = {e.get("name") for e in robot.iter("material") if len(e)}
    for link in robot.findall("link"):
        for material in link.findall("visual/material"):
            if material.get("name") not in named and not len(material):
                name = material.get("name", "")
                yield (
                    f"{link.get('name')}: no material {name!r} has a color, so this link is red. "
                    f'Write <material name="{name}"><color rgba="0 0 1 1"/></material>.'
                )
        if (mass := link.find("inertial/mass")) is not None and "value" not in mass.attrib:
            yield f'{link.get("name")}: the mass is 0: write <mass value="{(mass.text or "1.0").strip()}"/>.'
    for joint in robot.findall("joint"):
        limit = joint.find("limit")
        lower, upper = (float(limit.get(end, 0)) if limit is not None else 0.0 for end in ("lower", "upper"))
        if joint.get("type") == "revolute" and max(abs(lower), abs(upper)) > MANY_RADIANS:
            yield f"{joint.get('name')}: limits are in radians: 90° is 1.5708, and {upper:g} is in degrees?"
        if lower > upper:
            yield f"{joint.get('name')}: lower={lower:g} is above upper={upper:g}: swap them."


def _slips_of_origin(origin: ET.Element) -> Iterator[str]:
    if wrong := sorted(origin.attrib.keys() - _OF_ORIGIN):
        yield (
            f"{join_words(wrong)} of <origin> {'are' if len(wrong) > 1 else 'is'} ignored: write "
            'xyz="0 0 0.1" rpy="0 0 0".'
        )
    angles = [float(word) for word in origin.get("rpy", "").split() if is_number(word)]
    largest = max(angles, key=abs, default=0.0)
    if abs(largest) > MANY_RADIANS:
        yield f"rpy is in radians: {largest:g}° is {radians(largest):.4f}."


def links_of(text: str) -> list[Link]:
    """Return the links of a URDF that `parse_urdf` accepts, in the order of the file.

    Elements that urdfdom reports and then ignores are added to the `problems` of their link.
    """
    robot = _root(text)
    # As in urdfdom, the first material of a name is used for all materials of this name.
    materials: dict[str, Material] = {}
    global_problems = list[str]()
    for element in robot.findall("material"):
        material = _material(element, global_problems)
        if material is None and len(element):
            # urdfdom keeps the name, with the color that a material has before it is read.
            material = _BLACK
        if material is not None:
            materials.setdefault(element.get("name", ""), material)
    for element in robot.findall("link/visual/material"):
        material = _material(element, [])
        if material is not None:
            materials.setdefault(element.get("name", ""), material)
    links = [_link(element, materials) for element in robot.findall("link")]
    if links and global_problems:
        links[0] = replace(links[0], problems=(*global_problems, *links[0].problems))
    return links


def _link(link: ET.Element, materials: Mapping[str, Material]) -> Link:
    problems = list[str]()
    name, inertial, material = link.get("name", ""), link.find("inertial"), None
    # Like urdfdom, ignore the invalid shapes.
    shapes: dict[str, list[Geometry]] = {"visual": [], "collision": []}
    for kind, valid_shapes in shapes.items():
        for element in link.findall(kind):
            tags = element.findall("geometry/*")
            try:
                if not tags:
                    raise _MalformedError("Geometry tag contains no child element.")
                for tag in tags:
                    valid_shapes.append(_geometry(tag.tag, tag.attrib, _origin(element)))
            except _MalformedError as error:
                problems.append(f"Could not parse {kind} element for Link [{name}]: {error}")
    # A path with an index, visual[1], would take quadratic time.
    first_visual = link.find("visual")
    painted = None if first_visual is None else first_visual.find("material")
    for element in link.findall("visual/material"):
        material_of_tag = _material(element, problems)
        if element is painted:
            material = materials.get(element.attrib["name"]) if element.get("name") else material_of_tag
    body = None
    try:
        if inertial is not None:
            mass, inertia = inertial.find("mass"), inertial.find("inertia")
            if mass is None:
                raise _MalformedError("Inertial element must have a mass element")
            if inertia is None:
                raise _MalformedError("Inertial element must have inertia element")
            xx, xy, xz, yy, yz, zz = (_number(f"i{axes}", inertia.attrib) for axes in _INERTIA)
            matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            body = Inertial(_number("value", mass.attrib), matrix, _origin(inertial))
    except _MalformedError as error:
        problems.append(f"Could not parse inertial element for Link [{name}]: {error}")
    visuals, collisions = map(tuple, shapes.values())
    return Link(name, visuals, collisions, material, body, tuple(problems))


def _geometry(kind: str, attributes: Mapping[str, str], transform: Matrix) -> Geometry:
    """Return a shape, or raise a _MalformedError with urdfdom's message."""
    if kind not in _NEEDED:
        raise _MalformedError(f"Unknown geometry type '{kind}'")
    required, complaint = _NEEDED[kind]
    if not attributes.keys() >= required:
        raise _MalformedError(complaint)
    size: tuple[float, ...]
    if kind == "box":
        size = _vector(attributes["size"])
    elif kind == "mesh":
        size = _vector(attributes.get("scale", "1 1 1"))
    else:
        diameter = 2 * _number("radius", attributes)
        size = (diameter, diameter, diameter if kind == "sphere" else _number("length", attributes))
    if not all(map(isfinite, size)):
        raise _MalformedError(f"The size of this {kind} is too large.")
    return Geometry(kind, transform, size, attributes["filename"] if kind == "mesh" else "")  # type: ignore[arg-type]


# The required attributes of each shape, and urdfdom's error for a missing one.
_NEEDED: Mapping[str, tuple[set[str], str]] = {
    "box": ({"size"}, "Box shape has no size attribute"),
    "sphere": ({"radius"}, "Sphere shape must have a radius attribute"),
    "cylinder": ({"radius", "length"}, "Cylinder shape must have both length and radius attributes"),
    "mesh": ({"filename"}, "Mesh must contain a filename attribute"),
}


def _material(element: ET.Element, problems: list[str]) -> Material | None:
    """Return the material that an element defines, or None if malformed or only a reference."""
    name, color, texture = element.get("name", ""), element.find("color"), element.find("texture")
    if texture is not None and "filename" in texture.attrib:
        return Material((1.0, 1.0, 1.0, 1.0), texture.attrib["filename"])
    if color is None or "rgba" not in color.attrib:
        return None
    text = color.attrib["rgba"]
    for word in text.split():
        if not is_number(word) or not 0 <= float(word) <= 1:
            problems.append(
                f"Material [{name}] has malformed color rgba values: Unable to parse component "
                f"[{word}] to a double (while parsing a color value). Write four numbers from 0 to "
                "1."
            )
            return None
    rgba = tuple(map(float, text.split()))
    if len(rgba) != 4:
        problems.append(
            f"Material [{name}] has {format_count(len(rgba), 'number')} in its color rgba "
            f"[{text}], expected 4: red, green, blue, alpha. It is black, as in RViz2, which does "
            "not report this."
        )
        return _BLACK
    return Material(rgba)


_BLACK = Material((0.0, 0.0, 0.0, 1.0))


def _origin(element: ET.Element) -> Matrix:
    """Return transform_element_to_link, shape (4, 4)."""
    origin = element.find("origin")
    attributes = {} if origin is None else origin.attrib
    transform = np.eye(4)
    transform[:3, :3] = euler2mat(*_vector(attributes.get("rpy", "0 0 0")))
    transform[:3, 3] = _vector(attributes.get("xyz", "0 0 0"))
    if "quat_xyzw" in attributes:
        x, y, z, w = _numbers(attributes["quat_xyzw"], 4)
        transform[:3, :3] = quat2mat((w, x, y, z))
    return transform


def _number(name: str, attributes: Mapping[str, str]) -> float:
    """Return the number in an attribute, or 0 if it is missing."""
    text = attributes.get(name, "0")
    if not is_number(text):
        raise _MalformedError(f"{name} [{text}] is not a valid float")
    return float(text)


def _vector(text: str) -> tuple[float, float, float]:
    x, y, z = _numbers(text, 3)
    return x, y, z


def _numbers(text: str, length: int) -> tuple[float, ...]:
    reason = next(find_vector_errors(text, length), None)
    if reason:
        raise _MalformedError(reason)
    return tuple(map(float, text.split()))


@dataclass(frozen=True)
class Mimic:
    """The position of a mimic joint: factor times the position of another joint plus offset, [rad] or [m]."""

    joint: str
    factor: float
    offset: float


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between two links.

    Args:
        limits: The given limits, like lower or soft_lower_limit, [rad] or [m].
        axis: Axis of the motion in the child's frame.
        effort: Limit of the effort, [N m] or [N]; None without a <limit> tag.
        velocity: Limit of the velocity, [rad/s] or [m/s]; infinite without a <limit> tag.
        transform_joint_to_parent: The pose of the child at position 0, shape (4, 4).
    """

    name: str
    kind: str
    parent: str
    child: str
    limits: Mapping[str, float]
    mimic: Mimic | None
    axis: tuple[float, ...]
    effort: float | None
    velocity: float
    transform_joint_to_parent: Matrix = field(repr=False)

    @property
    def unit(self) -> str:
        """The unit of the joint's position."""
        return "m" if self.kind == "prismatic" else "rad"


@dataclass(frozen=True, eq=False)
class Urdf:
    """A robot's name, root link, and joints in the order of the file."""

    name: str
    root: str
    joints: Mapping[str, Joint]

    def resolve_mimic(self, joint: Joint) -> Mimic:
        """Express a joint's position by the position of the last joint in its mimic chain.

        Raises:
            CourseError: Joints mimic each other in a cycle.
        """
        chain, factor, offset = [joint.name], 1.0, 0.0
        while (mimic := self.joints[chain[-1]].mimic) and mimic.joint in self.joints:
            if mimic.joint in chain:
                raise CourseError(f"Found an infinite recursive mimic chain: {[*chain, mimic.joint]}")
            chain.append(mimic.joint)
            factor, offset = factor * mimic.factor, offset + factor * mimic.offset
        return Mimic(chain[-1], factor, offset)

    def joints_from_root(self) -> list[Joint]:
        """Return the joints connected to the root, parents before children."""
        below: dict[str, list[Joint]] = {}
        for joint in sorted(self.joints.values(), key=lambda joint: joint.name, reverse=True):
            below.setdefault(joint.parent, []).append(joint)
        joints, waiting = list[Joint](), below.get(self.root, []).copy()
        while waiting:
            joints.append(waiting.pop())
            waiting += below.pop(joints[-1].child, [])
        return joints


@lru_cache(maxsize=32)
def parse_urdf(text: str) -> Urdf:
    """Parse a URDF.

    Raises:
        CourseError: It is invalid. The message contains urdfdom's reason.
    """
    robot = _root(text)
    reason = next(find_errors(robot), None)
    if reason:
        advice = _advise(robot, reason)
        raise CourseError(
            f"The URDF is not valid: {reason.rstrip('.')}. {advice}"
            if advice
            else f"The URDF is not valid: {reason}"
        )
    joints = {joint.name: joint for joint in map(_joint, robot.findall("joint"))}
    children = {joint.child for joint in joints.values()}
    links = [link.get("name", "") for link in robot.findall("link")]
    tree = Urdf(robot.get("name", ""), next(link for link in links if link not in children), joints)
    if len(children) != len(joints) or len(tree.joints_from_root()) != len(joints):
        parents = Counter(joint.child for joint in joints.values())
        shared = next((link for link, count in parents.items() if count > 1), "")
        names = [joint.name for joint in joints.values() if joint.child == shared]
        twice = f" {shared!r} is the child of {join_words(names)}." if shared else ""
        raise CourseError(f"{NOT_A_TREE}{twice}")
    return tree


# urdfdom's errors, with advice.
_ADVICE = (
    ("is missing a parent", 'Write <parent link="NAME"/> and <child link="NAME"/> into this joint.'),
    (r"component \[[^]]*[,;]", "Separate the numbers with spaces, without commas."),
    (r"component \[[^]]*\$", "This is the text of a xacro file: load_robot expands it, or xacro FILE."),
    (r"component \[[^]]*\{", "A property of xacro is read with a $, as in ${height}."),
    (
        r"component \[[^]]*(pi|[*/+(])",
        "A URDF contains numbers and no formulas: write 1.5708 for pi/2, or a xacro file with ${pi/2}.",
    ),
    (r"component \[", "Write numbers with points, separated by spaces, like 0 0 0.5."),
    (r"\d+ elements but (\d)", "Write {1} numbers, separated by spaces."),
    (
        "limit has no|does not specify limits|without limits",
        'A limit looks like <limit lower="-1.57" upper="1.57" effort="10" velocity="1"/>, in rad and '
        "rad/s, or in m and m/s for a prismatic joint. A joint without limits is continuous.",
    ),
    ("No name given for the robot", 'Begin with <robot name="arm">.'),
    ("is not unique", "Give the second one another name."),
    ("has no type", "The types are " + ", ".join(_KINDS) + "."),
    ("No root link", "Joints form a circle: the root is a link that is the child of no joint."),
)


# Types of joints by the names that they have elsewhere.
_EVERYDAY_KINDS = {
    **dict.fromkeys(("rotational", "rotary", "rotation", "hinge", "revolve"), "revolute"),
    **dict.fromkeys(("linear", "slider", "sliding", "translational"), "prismatic"),
    **dict.fromkeys(("wheel", "endless"), "continuous"),
    "rigid": "fixed",
}


def _advise(robot: ET.Element, reason: str) -> str:
    """Return advice for urdfdom's error about a robot, or ""."""
    links = [link.get("name", "") for link in robot.findall("link")]
    if robot.tag != "robot":
        return f'The first tag is <{robot.tag}>, and a URDF begins with <robot name="arm">.'
    if not links:
        # The file probably consists of macros, for which `load_robot` has advice.
        return ""
    if kind := re.search(r"no known type \[(.*)\]", reason):
        word = kind[1].lower()
        meant = _EVERYDAY_KINDS.get(word)
        suggestion = f". Did you mean {meant}?" if meant else did_you_mean(word, _KINDS) or "."
        return f"The types are {', '.join(_KINDS)}{suggestion}"
    if end := re.search(r"(?:child|parent) link \[(.*)\] of joint", reason):
        wrong = next((e.tag for e in robot if e.get("name") == end[1] and e.tag != "joint"), "")
        if wrong:
            return f"A link's tag is <link>, and {end[1]} is in a <{wrong}>."
        return did_you_mean(end[1], links).removeprefix(". ") or f'Add <link name="{end[1]}"/>.'
    if roots := re.search(r"Two root links found: \[(.*)\] and \[(.*)\]", reason):
        # The root without children is the forgotten one.
        parents = {parent_and_child(joint)[0] for joint in robot.findall("joint")}
        loose = roots[1] if roots[1] not in parents else roots[2]
        return f'Every link but one needs a joint: add one with <child link="{loose}"/>.'
    for pattern, advice in _ADVICE:
        if found := re.search(pattern, reason):
            return advice.replace("{1}", found[1] if found.groups() else "")
    return ""


def _root(text: str) -> ET.Element:
    """Return the root element of the description."""
    try:
        robot = ET.fromstring(text)
    except ET.ParseError as error:
        advice = explain_xml_error(text, error.code, *error.position) or f"It begins with {text[:40]!r}."
        raise CourseError(f"The URDF is not XML: {error}. {advice}") from None
    # Version 1.0 of the format does not support quaternions.
    if robot.get("version", "1.0") == "1.0":
        for origin in robot.iter("origin"):
            origin.attrib.pop("quat_xyzw", None)
    return robot


def _joint(element: ET.Element) -> Joint:
    def of(tag: str) -> Mapping[str, str]:
        tag_element = element.find(tag)
        return {} if tag_element is None else tag_element.attrib

    limit_names = ("lower", "upper", "soft_lower_limit", "soft_upper_limit")
    limit_values = {**of("limit"), **of("safety_controller")}
    limits = {key: float(limit_values[key]) for key in limit_names if key in limit_values}
    mimic = of("mimic")
    follow = (
        Mimic(mimic["joint"], float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0)))
        if mimic
        else None
    )
    name, kind = element.attrib["name"], element.attrib["type"]
    effort = float(of("limit")["effort"]) if of("limit") else None
    velocity = float(of("limit").get("velocity", "inf"))
    axis = _vector(of("axis").get("xyz", "1 0 0") if kind not in UNMOVED else "1 0 0")
    parent, child = parent_and_child(element)
    return Joint(name, kind, parent, child, limits, follow, axis, effort, velocity, _origin(element))
