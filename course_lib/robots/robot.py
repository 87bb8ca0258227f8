"""Robots: a URDF, the posture to rest in, and Pinocchio's model; loading one by name, file or text."""

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from course_lib.arrays import Floats
from course_lib.errors import CourseError
from course_lib.robots.models import Posture, data_file, model_of, rest_of
from course_lib.robots.resources import is_installed, package_roots, resolve
from course_lib.robots.urdf import MOVING, Urdf, links_of, parse_urdf
from course_lib.ros.xacro_program import expanded
from course_lib.viewer.mesh_files import MeshFileError, load_mesh

if TYPE_CHECKING:
    import pinocchio as pin


Shapes: TypeAlias = "tuple[pin.GeometryModel, pin.GeometryModel]"  # for collisions and for the eye


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot.

    The kit itself needs no Pinocchio. Its model, for dynamics and collisions, is built when it is first read,
    and raises a CourseError on machines without Pinocchio, like native Windows.

    Args:
        name: What it was loaded as, or its name in the URDF.
        urdf: The text of its description, what /robot_description carries; path is the file that it is from.
        kinematics: Builds Pinocchio's model and its rest posture.
        shapes: Builds the shapes that go with the model.
        rest: The posture that it rests in.
    """

    name: str
    urdf: str
    path: Path | None
    kinematics: "Callable[[], tuple[pin.Model, Floats]]"
    shapes: "Callable[[pin.Model], Shapes]"
    rest: Posture = field(default_factory=Posture)

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
        CourseError: If there is no such robot or file, the URDF is not valid, or a mesh is missing or broken.
    """
    if isinstance(name, str) and "<" in name:
        return _checked(from_text(name))
    if isinstance(name, Path) or "/" in name or name.endswith((".urdf", ".xml", ".xacro")):
        path = Path(name)
        return _checked(from_text(expanded(path) if path.suffix == ".xacro" else _read(path), path))
    return _from_example_robot_data(name)


def _from_example_robot_data(name: str) -> Robot:
    model = model_of(name)
    path = data_file(model.urdf).resolve()
    text = _read(path)

    @cache
    def whole() -> Any:
        return pinocchios("example_robot_data").load_full(name)[0]

    def shapes(_: "pin.Model") -> Shapes:
        return whole().collision_model, whole().visual_model

    moving = [joint.name for joint in parse_urdf(text).joints.values() if joint.kind in MOVING]
    rest = rest_of(model, moving)
    return Robot(name, text, path, lambda: (whole().model, whole().q0), shapes, rest)


def from_text(text: str, path: Path | None = None) -> Robot:
    """Return the robot of a URDF's text, whose shapes are not read yet; see `load_robot`."""
    tree = parse_urdf(text)
    for uri in _meshes(text):
        resolve(uri, path)

    def kinematics() -> "tuple[pin.Model, Floats]":
        pinocchio = pinocchios("pinocchio")
        model = pinocchio.buildModelFromXML(text)
        return model, pinocchio.neutral(model)

    def shapes(model: "pin.Model") -> Shapes:
        pinocchio, roots = pinocchios("pinocchio"), list(map(str, package_roots(path)))
        kinds = (pinocchio.GeometryType.COLLISION, pinocchio.GeometryType.VISUAL)
        try:
            one, other = (pinocchio.buildGeomFromUrdfString(model, text, kind, None, roots) for kind in kinds)
        except (ValueError, RuntimeError) as error:
            raise CourseError(f"The shapes of {tree.name!r} cannot be loaded: {error}") from error
        return one, other

    return Robot(tree.name, text, path, kinematics, shapes)


def _meshes(text: str) -> set[str]:
    return {shape.uri for link in links_of(text) for shape in (*link.visuals, *link.collisions) if shape.uri}


def _checked(robot: Robot) -> Robot:
    """Read the meshes now: those of a person's own file may be broken."""
    for file in map(robot.resolve, _meshes(robot.urdf)):
        try:
            if not is_installed(file):
                load_mesh(file)
        except MeshFileError as error:
            raise CourseError(f"The shapes of {robot.name!r} cannot be loaded: {error}") from error
    return robot


def pinocchios(package: str) -> Any:
    """Import Pinocchio, or a package that needs it; raises a CourseError with advice where it is missing."""
    try:
        return import_module(package)
    except ImportError as error:
        raise CourseError(
            f"Pinocchio's models, for dynamics and collisions, need the package pin, and {error.name} is "
            f"missing on this machine ({sys.platform}). On Windows it comes with WSL2 or conda-forge "
            "(pinocchio); elsewhere run pip install -e . again. All else of a robot works without."
        ) from error


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CourseError(f"Cannot read {path}: {error}. Give a URDF file, or a name like 'ur10'.") from error
