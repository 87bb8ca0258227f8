"""Robots: a URDF with its Pinocchio model, and loading one by name, file or text."""

import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from course_lib.arrays import Floats
from course_lib.errors import CourseError, did_you_mean
from course_lib.robots.resources import package_roots, resolve
from course_lib.robots.urdf import Urdf, needed, parse_urdf
from course_lib.ros.xacro_program import expanded

if TYPE_CHECKING:
    import pinocchio as pin


Shapes: TypeAlias = "tuple[pin.GeometryModel, pin.GeometryModel]"  # for collisions and for the eye


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot; what Pinocchio makes of it is built when it is first read: meshes take half a second.

    Args:
        name: What it was loaded as, or its name in the URDF.
        urdf: The text of its description, what /robot_description carries; path is the file that it is from.
        kinematics: Builds Pinocchio's model and its rest posture.
        shapes: Builds the shapes that go with the model.
    """

    name: str
    urdf: str
    path: Path | None
    kinematics: "Callable[[], tuple[pin.Model, Floats]]"
    shapes: "Callable[[pin.Model], Shapes]"

    @property
    def model(self) -> "pin.Model":
        """Pinocchio's model."""
        return self._kinematics[0]

    @property
    def q0(self) -> Floats:
        """Its rest posture as a configuration of the model, shape (nq,)."""
        return self._kinematics[1]

    @property
    def collision_model(self) -> "pin.GeometryModel":
        """The shapes for collisions."""
        return self._shapes[0]

    @property
    def visual_model(self) -> "pin.GeometryModel":
        """The shapes for the eye."""
        return self._shapes[1]

    @cached_property
    def _kinematics(self) -> "tuple[pin.Model, Floats]":
        return self.kinematics()

    @cached_property
    def _shapes(self) -> Shapes:
        return self.shapes(self.model)

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
        return _checked(from_text(name))
    if isinstance(name, Path) or "/" in name or name.endswith((".urdf", ".xml", ".xacro")):
        path = Path(name)
        return _checked(from_text(expanded(path) if path.suffix == ".xacro" else _read(path), path))
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
    loader = example_robot_data.ROBOTS[name]
    if not loader.urdf_filename:  # cassie
        raise CourseError(f"{name!r} is described by SDF, not URDF, and cannot be loaded here.")
    file = f"{loader.path}/{loader.urdf_subpath}/{loader.urdf_filename}"
    path = Path(example_robot_data.getModelPath(file), file).resolve()

    @cache
    def whole() -> Any:
        return example_robot_data.load_full(name)[0]

    def shapes(_: "pin.Model") -> Shapes:
        return whole().collision_model, whole().visual_model

    return Robot(name, _read(path), path, lambda: (whole().model, whole().q0), shapes)


def from_text(text: str, path: Path | None = None) -> Robot:
    """Return the robot of a URDF's text, whose shapes are not read yet; see `load_robot`."""
    tree, pinocchio = parse_urdf(text), needed("pinocchio")
    for mesh in ET.fromstring(text).iter("mesh"):
        resolve(mesh.get("filename", ""), path)

    def kinematics() -> "tuple[pin.Model, Floats]":
        model = tree.model.copy()  # the tree's own serves every robot with this text
        return model, pinocchio.neutral(model)

    def shapes(model: "pin.Model") -> Shapes:
        roots = list(map(str, package_roots(path)))
        kinds = (pinocchio.GeometryType.COLLISION, pinocchio.GeometryType.VISUAL)
        try:
            one, other = (pinocchio.buildGeomFromUrdfString(model, text, kind, None, roots) for kind in kinds)
        except (ValueError, RuntimeError) as error:
            raise CourseError(f"The shapes of {tree.name!r} cannot be loaded: {error}") from error
        return one, other

    return Robot(tree.name, text, path, kinematics, shapes)


def _checked(robot: Robot) -> Robot:
    """Read the shapes now: those of a person's own file may be broken."""
    assert robot.visual_model is not None
    return robot


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CourseError(f"Cannot read {path}: {error}. Give a URDF file, or a name like 'ur10'.") from error
