"""Robots: a URDF with its Pinocchio model, and loading one by name, file or text."""

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.arrays import Floats
from course_lib.errors import CourseError, did_you_mean
from course_lib.robots.resources import package_roots, resolve
from course_lib.robots.urdf import Urdf, needed, parse_urdf
from course_lib.ros.xacro_program import expanded

if TYPE_CHECKING:
    import pinocchio as pin


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot.

    Args:
        name: What it was loaded as, or its name in the URDF.
        model: Pinocchio's model; with it go its shapes for collisions and for the eye.
        q0: Its rest posture as a configuration of the model, shape (nq,).
        urdf: The text of its description, what /robot_description carries; path is the file that it is from.
    """

    name: str
    model: "pin.Model"
    collision_model: "pin.GeometryModel"
    visual_model: "pin.GeometryModel"
    q0: Floats
    urdf: str
    path: Path | None = None

    @property
    def tree(self) -> Urdf:
        """The description's links and joints."""
        return parse_urdf(self.urdf)

    def resolve(self, uri: str) -> Path:
        """Return the file of a ``package://`` or ``file://`` address in the description."""
        return resolve(uri, self.path)


def load_robot(name: str | Path) -> Robot:
    """Load a robot.

    Args:
        name: A model of example-robot-data like "ur10", a URDF or xacro file, or the text of a URDF.

    Raises:
        CourseError: If there is no such robot or file, the URDF is not valid, a mesh is missing, or robots
            cannot be loaded on this machine.
    """
    if isinstance(name, str) and "<" in name:
        return _from_text(name, None)
    if isinstance(name, Path) or "/" in name or name.endswith((".urdf", ".xml", ".xacro")):
        path = Path(name)
        return _from_text(expanded(path) if path.suffix == ".xacro" else _read(path), path)
    return _from_example_robot_data(name)


def _from_example_robot_data(name: str) -> Robot:
    example_robot_data = needed("example_robot_data")
    known = sorted(example_robot_data.ROBOTS)
    if name not in known:
        meant = did_you_mean(name, known, 3) or f", like {known[0]}."
        raise CourseError(
            f"There is no robot {name!r} among the {len(known)} models{meant} "
            'A file ends in .urdf, like load_robot("my_robot.urdf").'
        )
    try:
        wrapper, rest, file, _ = example_robot_data.load_full(name)
    except ImportError as error:  # cassie
        raise CourseError(f"{name!r} is described by SDF, not URDF, and cannot be loaded here.") from error
    path = Path(file).resolve()
    return Robot(name, wrapper.model, wrapper.collision_model, wrapper.visual_model, rest, _read(path), path)


def _from_text(text: str, path: Path | None) -> Robot:
    tree, pin = parse_urdf(text), needed("pinocchio")
    for mesh in ET.fromstring(text).iter("mesh"):
        resolve(mesh.get("filename", ""), path)
    model = tree.model.copy()  # the tree's own serves every robot with this text
    kinds, roots = (pin.GeometryType.COLLISION, pin.GeometryType.VISUAL), list(map(str, package_roots(path)))
    try:
        shapes = [pin.buildGeomFromUrdfString(model, text, kind, None, roots) for kind in kinds]
    except (ValueError, RuntimeError) as error:
        raise CourseError(f"The shapes of {tree.name!r} cannot be loaded: {error}") from error
    return Robot(tree.name, model, shapes[0], shapes[1], pin.neutral(model), text, path)


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CourseError(f"Cannot read {path}: {error}. Give a URDF file, or a name like 'ur10'.") from error
