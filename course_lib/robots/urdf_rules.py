"""Rules for the URDF of a robot: those of urdfdom, which RViz and robot_state_publisher read it with."""

import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import chain
from math import isfinite

_KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
UNMOVED = ("fixed", "floating")  # the kinds of joints without an axis
_VERSIONS = ("1.0", "1.1", "1.2")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
# urdfdom's words for joints without a <limit>
_UNLIMITED = {
    "revolute": "Joint [{}] is of type REVOLUTE but it does not specify limits",
    "prismatic": "Joint [{}] is of type PRISMATIC without limits",
}
NOT_A_TREE = "The URDF is not a tree: each link but one must be the child of exactly one joint."


@dataclass(frozen=True)
class _Tag:
    """Numbers that a tag of a joint may have, and urdfdom's words for an attribute that is missing."""

    name: str
    numbers: tuple[str, ...]
    needed: tuple[tuple[str, str], ...] = ()
    before: str = ""  # what stands before its words


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
    """Return whether urdfdom takes a text for a number: not infinite, and with nothing round it."""
    return bool(_NUMBER.fullmatch(text)) and isfinite(float(text))


def broken_rules(robot: ET.Element) -> Iterator[str]:
    """Yield urdfdom's reasons to refuse a description; the first one is what it says."""
    links, joints = ([e.get("name", "") for e in robot.findall(kind)] for kind in ("link", "joint"))
    if robot.tag != "robot":
        yield "Could not find the 'robot' element in the xml file"
    if not robot.get("name"):
        yield "No name given for the robot."
    if robot.get("version", "1.0") not in _VERSIONS:
        yield "Invalid 'version' specified; versions from 1.0 upto 1.2 are currently supported"
    yield from _repeated("material", [e.get("name", "") for e in robot.findall("material") if len(e)])
    yield from _repeated("link", links)
    if not links:
        yield "No link elements found in urdf file"
    yield from chain.from_iterable(map(_of_joint, robot.findall("joint")))
    yield from _repeated("joint", joints)
    yield from _of_ends(robot, set(links))
    yield from _of_roots(robot, set(links))


def _repeated(kind: str, names: Collection[str]) -> Iterator[str]:
    for name, number in Counter(names).items():
        if number > 1:
            yield f"{kind} '{name}' is not unique."


def _of_joint(joint: ET.Element) -> Iterator[str]:
    name, kind, axis = joint.get("name"), joint.get("type"), joint.find("axis")
    if name is None:
        yield "unnamed joint found"
    for origin in joint.findall("origin")[:1]:
        vectors = *_of_vector(origin, "xyz"), *_of_vector(origin, "rpy"), *_of_vector(origin, "quat_xyzw", 4)
        for reason in vectors:
            yield f"{reason}; Malformed parent origin element for joint [{name}]"
    if kind is None:
        yield f"joint [{name}] has no type, check to see if it's a reference."
    elif kind not in _KINDS:
        yield f"Joint [{name}] has no known type [{kind}]"
    if axis is not None and kind not in UNMOVED:
        for reason in _of_vector(axis, "xyz"):
            yield f"Malformed axis element for joint [{name}]: {reason}"
    for tag in _TAGS:
        yield from _of_tag(joint, tag)
    if kind in _UNLIMITED and joint.find("limit") is None:
        yield _UNLIMITED[kind].format(name)


def _of_tag(joint: ET.Element, tag: _Tag) -> Iterator[str]:
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


def _of_vector(element: ET.Element, name: str, length: int = 3) -> Iterator[str]:
    text = element.get(name)
    if text is None:
        return
    words = text.split()
    for word in words:
        if not is_number(word):
            yield f"Unable to parse component [{word}] to a double (while parsing a vector value)"
    if len(words) != length:
        yield f"Parser found {len(words)} elements but {length} expected while parsing vector [{text}]"


def ends_of(joint: ET.Element) -> tuple[str, str]:
    """Return the names of a joint's parent and child, empty where they are missing."""
    parent, child = joint.find("parent"), joint.find("child")
    return "" if parent is None else parent.get("link", ""), "" if child is None else child.get("link", "")


def _of_ends(robot: ET.Element, links: Collection[str]) -> Iterator[str]:
    for joint in sorted(robot.findall("joint"), key=lambda joint: joint.get("name", "")):
        name, (parent, child) = joint.get("name"), ends_of(joint)
        if not parent or not child:
            yield f"Failed to build tree: Joint [{name}] is missing a parent and/or child link specification."
        elif child not in links:
            yield f"Failed to build tree: child link [{child}] of joint [{name}] not found"
        elif parent not in links:
            yield (
                f"Failed to build tree: parent link [{parent}] of joint [{name}] not found.  This is not "
                "valid according to the URDF spec. Every link you refer to from a joint needs to be "
                "explicitly defined in the robot description. To fix this problem you can either remove "
                f'this joint [{name}] from your urdf file, or add "<link name="{parent}" />" to your urdf '
                "file."
            )


def _of_roots(robot: ET.Element, links: set[str]) -> Iterator[str]:
    children = {ends_of(joint)[1] for joint in robot.findall("joint")}
    roots = sorted(links - children)
    if not roots:
        yield "Failed to find root link: No root link found. The robot xml is not a valid tree."
    elif len(roots) > 1:
        yield f"Failed to find root link: Two root links found: [{roots[0]}] and [{roots[1]}]"
