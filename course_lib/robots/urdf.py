"""Robot descriptions (URDF), read by urdfdom, as in ROS."""

import os
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError

if TYPE_CHECKING:
    import pinocchio as pin

MOVING = ("revolute", "continuous", "prismatic")  # the kinds of joints that one number places


@dataclass(frozen=True)
class Follow:
    """What places a mimic joint: factor times the position of a joint, plus an offset, [rad] or [m]."""

    joint: str
    factor: float
    offset: float


@dataclass(frozen=True)
class Joint:
    """A joint and the links that it joins; limits: those given, lower, soft_lower_limit …, [rad] or [m]."""

    name: str
    kind: str
    parent: str
    child: str
    limits: Mapping[str, float]
    mimic: Follow | None

    @property
    def unit(self) -> str:
        """The unit of its position."""
        return "m" if self.kind == "prismatic" else "rad"


@dataclass(frozen=True, eq=False)
class Urdf:
    """A robot's name, the link that all others hang on, its joints as in the file, Pinocchio's model."""

    name: str
    root: str
    joints: Mapping[str, Joint]
    model: "pin.Model"

    def followed(self, joint: Joint) -> Follow:
        """Return what places a joint in the end: one that mimics none, perhaps itself.

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
        raise CourseError(f"The URDF is no XML: {error}. It begins with {text[:40]!r}.") from None
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
        raise CourseError("The URDF is no tree: each link but one must be the child of exactly one joint.")
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
    return Joint(name, kind, of("parent")["link"], of("child")["link"], limits, follow)


def needed(package: str) -> Any:
    """Import a package that not every machine has; a CourseError says what to do without it."""
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
    """Collect the errors that C++ prints meanwhile, which else only the terminal would show."""
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
