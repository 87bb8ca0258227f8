"""Robots, loaded by name, file or text: a URDF, a rest posture, and Pinocchio's model.

Names are those of example-robot-data. A robot description refers to files by `package://` and
`file://`.
"""

import os
import re
import sys
import xml.etree.ElementTree as ET
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from functools import cache, cached_property, wraps
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias
from urllib.parse import unquote, urlparse

import numpy as np
from transforms3d.quaternions import quat2mat

from course_lib.arrays import Floats, Matrix
from course_lib.errors import CourseError, did_you_mean, shorten_words
from course_lib.robots.urdf import MOVING, Urdf, links_of, parse_urdf
from course_lib.ros.programs.packages import packages, packages_below, share_folder, workspace_of
from course_lib.ros.programs.xacro_program import expand_xacro, is_xacro
from course_lib.third_party import NOT_UTF8, read_text
from course_lib.viewer.drawables import MeshFileError, load_mesh

if TYPE_CHECKING:
    import pinocchio as pin

_schemes = ["package", "file"]
# Limit on the names in a message.
_MOST_MACROS = 5


@contextmanager
def packages_only() -> Iterator[None]:
    """Reject ``file://`` and paths outside of packages within a `with` block, for untrusted addresses."""
    _schemes.remove("file")
    try:
        yield
    finally:
        _schemes.append("file")


def resolve(uri: str, near: Path | None = None) -> Path:
    """Return the file at a ``package://`` or ``file://`` address in the file `near`.

    Raises:
        CourseError: The address is invalid, or the file does not exist.
    """
    parts = urlparse(uri)
    inside = unquote(parts.path).lstrip("/")
    leads_out = "file" not in _schemes and ".." in Path(parts.netloc, inside).parts
    if parts.scheme not in _schemes or leads_out:
        raise CourseError(
            f"{uri!r} is not the address of a file; write package://PACKAGE/PATH or file:///PATH."
        )
    if parts.scheme == "file":
        candidates = [Path("/", parts.netloc, inside)]
    else:
        candidates = [folder / inside for folder in _known_folders(parts.netloc, near)]
    # Unlike Path.is_file, this function returns False for a name that is too long for a file.
    existing = next((path for path in candidates if os.path.isfile(path)), None)
    if existing is None:
        where, package = ".", parts.netloc
        if parts.scheme == "package":
            found = next(filter(None, map(_find_ignoring_case, candidates)), None)
            folder = next((index[package] for index in _package_indexes(near) if package in index), None)
            if found:
                where = f": the file is {found}, and capitals matter."
            elif folder is not None:
                where = f": '{package}' is the package in {folder}."
            else:
                where = (
                    f": there is no package '{package}': put its folder, with its package.xml, into the "
                    "workspace's src."
                )
        raise CourseError(f"The file {uri} does not exist. Correct the address{where}")
    return existing


def _find_ignoring_case(path: Path) -> Path | None:
    """Return the file whose path differs only in capitals, which Windows and macOS ignore."""
    found = next((folder for folder in path.parents if os.path.isdir(folder)), Path("/"))
    for part in path.relative_to(found).parts:
        names = os.listdir(found) if os.path.isdir(found) else []
        name = next((name for name in names if name.casefold() == part.casefold()), None)
        if name is None:
            return None
        found /= name
    return found if os.path.isfile(found) else None


# The folders of packages within `cache_package_searches`: package, file near it, whether `file` is
# allowed.
_cached_folders: ContextVar[dict[tuple[str, Path | None, bool], list[Path]] | None] = ContextVar(
    "_cached_folders", default=None
)


@contextmanager
def cache_package_searches() -> Iterator[None]:
    """Search the folders of each package once within a `with` block, in which many files are resolved.

    Every search stats all folders of the workspace, because a package may have been added in
    the meantime.
    """
    token = _cached_folders.set({})
    try:
        yield
    finally:
        _cached_folders.reset(token)


def _known_folders(name: str, near: Path | None) -> Iterable[Path]:
    """Return the candidate folders of a package, searched once within `cache_package_searches`."""
    known, key = _cached_folders.get(), (name, near, "file" in _schemes)
    if known is None:
        return _package_folders(name, near)
    if key not in known:
        known[key] = list(_package_folders(name, near))
    return known[key]


def _package_folders(name: str, near: Path | None) -> Iterator[Path]:
    """Yield the candidate folders of a package: first from the index, then folders with its name.

    Folders are searched on ROS_PACKAGE_PATH, in the robot data of the kit, and above `near`.
    """
    for folders_by_name in _package_indexes(near):
        if name in folders_by_name:
            yield folders_by_name[name]
            if folders_by_name[name].parent.name != "share":
                yield share_folder(name, folders_by_name[name])
    search_path = [Path(root) for root in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if root]
    yield from (
        root / name
        for root in search_path + _installed_data() + (list(near.resolve().parents[1:]) if near else [])
    )


def _package_indexes(near: Path | None) -> Iterator[Mapping[str, Path]]:
    """Yield the folders of packages by name: packages in use, then the workspace of `near`."""
    # An untrusted address must not reach files in the working folder.
    yield packages(in_working_folder="file" in _schemes)
    if near is not None and (workspace := workspace_of(near)):
        yield packages_below(workspace)


def is_installed(file: Path) -> bool:
    """Return whether a file belongs to example-robot-data."""
    return any(file.is_relative_to(root) for root in _installed_data())


def _installed_data() -> list[Path]:
    return [Path(entry) / "cmeel.prefix" / "share" for entry in sys.path if entry]


@dataclass(frozen=True)
class Model:
    """Files of a robot, relative to the folder `robots` of the data.

    Args:
        urdf: The robot's description.
        srdf: A file with postures.
        posture: Name of the rest posture; "" for all joints at 0.
    """

    urdf: str
    srdf: str = ""
    posture: str = ""


@dataclass(frozen=True, eq=False)
class Posture:
    """Positions of joints by name, [rad] or [m], others at 0; transform_root_to_ground, shape (4, 4)."""

    positions: Mapping[str, float] = field(default_factory=dict)
    transform_root_to_ground: Matrix = field(default_factory=lambda: np.eye(4))


MODELS = {
    "a1": Model("a1_description/urdf/a1.urdf", "a1_description/srdf/a1.srdf", "standing"),
    "alex_nub_hands": Model("alex_description/urdf/alex_nub_hands.urdf"),
    "alex_psyonic_hands": Model(
        "alex_description/urdf/alex_psyonic_hands.urdf",
        "alex_description/srdf/alex_psyonic_hands.srdf",
        "default",
    ),
    "alex_sake_hands": Model(
        "alex_description/urdf/alex_sake_hands.urdf", "alex_description/srdf/alex_sake_hands.srdf", "default"
    ),
    "alexander": Model(
        "alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf",
        "alexander_description/srdf/alexander.srdf",
        "default",
    ),
    "allegro_left_hand": Model("allegro_hand_description/urdf/allegro_left_hand.urdf"),
    "allegro_right_hand": Model("allegro_hand_description/urdf/allegro_right_hand.urdf"),
    "anymal": Model(
        "anymal_b_simple_description/robots/anymal.urdf",
        "anymal_b_simple_description/srdf/anymal.srdf",
        "standing",
    ),
    "anymal_c": Model(
        "anymal_c_simple_description/urdf/anymal.urdf",
        "anymal_c_simple_description/srdf/anymal.srdf",
        "standing",
    ),
    "anymal_kinova": Model(
        "anymal_b_simple_description/robots/anymal-kinova.urdf",
        "anymal_b_simple_description/srdf/anymal-kinova.srdf",
        "standing_with_arm_up",
    ),
    "asr_twodof": Model("asr_twodof_description/urdf/TwoDofs.urdf"),
    "b1": Model("b1_description/urdf/b1.urdf", "b1_description/srdf/b1.srdf", "standing"),
    "b1_z1": Model(
        "b1_description/urdf/b1-z1.urdf", "b1_description/srdf/b1-z1.srdf", "standing_with_arm_home"
    ),
    "baxter": Model(
        "baxter_description/urdf/baxter.urdf", "baxter_description/srdf/baxter_manipulation.srdf", "neutral"
    ),
    "bluevolta_bravo7_gripper": Model(
        "bluevolta_description/urdf/bluevolta_bravo7_gripper.urdf",
        "bluevolta_description/srdf/bluevolta_bravo7_gripper.srdf",
        "standing",
    ),
    "bluevolta_bravo7_no_ee": Model(
        "bluevolta_description/urdf/bluevolta_bravo7_no_ee.urdf",
        "bluevolta_description/srdf/bluevolta_bravo7_no_ee.srdf",
        "standing",
    ),
    "bolt": Model("bolt_description/robots/bolt.urdf", "bolt_description/srdf/bolt.srdf", "standing"),
    "borinot": Model(
        "borinot_description/urdf/borinot_flying_arm_2.urdf",
        "borinot_description/srdf/borinot_flying_arm_2.srdf",
        "home",
    ),
    "bravo7_gripper": Model(
        "bravo7_description/urdf/bravo7_gripper.urdf",
        "bravo7_description/srdf/bravo7_gripper.srdf",
        "standing",
    ),
    "bravo7_no_ee": Model(
        "bravo7_description/urdf/bravo7_no_ee.urdf", "bravo7_description/srdf/bravo7_no_ee.srdf", "standing"
    ),
    "centauro": Model(
        "centauro_description/urdf/centauro.urdf",
        "centauro_description/srdf/centauro.srdf",
        "homing_balanced",
    ),
    "double_pendulum": Model("double_pendulum_description/urdf/double_pendulum.urdf"),
    "double_pendulum_continuous": Model("double_pendulum_description/urdf/double_pendulum_continuous.urdf"),
    "double_pendulum_simple": Model("double_pendulum_description/urdf/double_pendulum_simple.urdf"),
    "falcon_bravo7_gripper": Model(
        "falcon_description/urdf/falcon_bravo7_gripper.urdf",
        "falcon_description/srdf/falcon_bravo7_gripper.srdf",
        "standing",
    ),
    "falcon_bravo7_no_ee": Model(
        "falcon_description/urdf/falcon_bravo7_no_ee.urdf",
        "falcon_description/srdf/falcon_bravo7_no_ee.srdf",
        "standing",
    ),
    "finger_edu": Model(
        "finger_edu_description/robots/finger_edu.urdf",
        "finger_edu_description/srdf/finger_edu.srdf",
        "hanging",
    ),
    "g1": Model("g1_description/urdf/g1_29dof_rev_1_0.urdf"),
    "g1_with_hands": Model("g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf"),
    "go1": Model("go1_description/urdf/go1.urdf", "go1_description/srdf/go1.srdf", "standing"),
    "go2": Model("go2_description/urdf/go2.urdf", "go2_description/srdf/go2.srdf", "standing"),
    "hector": Model("hector_description/robots/quadrotor_base.urdf"),
    "hextilt": Model(
        "hextilt_description/urdf/hextilt_flying_arm_5.urdf",
        "hextilt_description/srdf/hextilt_flying_arm_5.srdf",
        "home",
    ),
    "human": Model("human_description/robots/human.urdf"),
    "hyq": Model("hyq_description/robots/hyq_no_sensors.urdf", "hyq_description/srdf/hyq.srdf", "standing"),
    "icub": Model("icub_description/robots/icub.urdf", "icub_description/srdf/icub.srdf", "half_sitting"),
    "icub_reduced": Model(
        "icub_description/robots/icub_reduced.urdf", "icub_description/srdf/icub.srdf", "half_sitting"
    ),
    "iris": Model("iris_description/robots/iris_simple.urdf"),
    "kinova": Model("kinova_description/robots/kinova.urdf", "kinova_description/srdf/kinova.srdf", "arm_up"),
    "laikago": Model("laikago_description/urdf/laikago.urdf"),
    "panda": Model("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf", "default"),
    "panda_collision": Model("panda_description/urdf/panda_collision.urdf"),
    "pr2": Model("pr2_description/urdf/pr2.urdf", "pr2_description/srdf/pr2.srdf", "tuck_left_arm"),
    "quadruped": Model("quadruped_description/urdf/quadruped.urdf"),
    "romeo": Model("romeo_description/urdf/romeo.urdf"),
    "simple_humanoid": Model(
        "simple_humanoid_description/urdf/simple_humanoid.urdf",
        "simple_humanoid_description/srdf/simple_humanoid.srdf",
        "half_sitting",
    ),
    "simple_humanoid_classical": Model(
        "simple_humanoid_description/urdf/simple_humanoid_classical.urdf",
        "simple_humanoid_description/srdf/simple_humanoid_classical.srdf",
        "half_sitting",
    ),
    "so100": Model("so_arm_description/urdf/so100.urdf"),
    "so101": Model("so_arm_description/urdf/so101.urdf"),
    "solo12": Model("solo_description/robots/solo12.urdf", "solo_description/srdf/solo.srdf", "standing"),
    "solo8": Model("solo_description/robots/solo.urdf", "solo_description/srdf/solo.srdf", "standing"),
    "talos": Model("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    "talos_arm": Model("talos_data/robots/talos_left_arm.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    "talos_box": Model(
        "talos_data/robots/talos_reduced_box.urdf", "talos_data/srdf/talos.srdf", "half_sitting"
    ),
    "talos_full": Model("talos_data/robots/talos_full_v2.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    "talos_full_box": Model(
        "talos_data/robots/talos_full_v2_box.urdf", "talos_data/srdf/talos.srdf", "half_sitting"
    ),
    "talos_legs": Model("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf", "half_sitting"),
    "tiago": Model("tiago_description/robots/tiago.urdf"),
    "tiago_dual": Model("tiago_description/robots/tiago_dual.urdf"),
    "tiago_no_hand": Model("tiago_description/robots/tiago_no_hand.urdf"),
    "tiago_pro": Model("tiago_pro_description/robots/tiago_pro.urdf"),
    "ur10": Model("ur_description/urdf/ur10_robot.urdf"),
    "ur10_limited": Model("ur_description/urdf/ur10_joint_limited_robot.urdf"),
    "ur3": Model("ur_description/urdf/ur5_robot.urdf"),
    "ur3_gripper": Model("ur_description/urdf/ur3_gripper.urdf"),
    "ur3_limited": Model("ur_description/urdf/ur3_joint_limited_robot.urdf"),
    "ur5": Model("ur_description/urdf/ur5_robot.urdf"),
    "ur5_gripper": Model("ur_description/urdf/ur5_gripper.urdf"),
    "ur5_limited": Model("ur_description/urdf/ur5_joint_limited_robot.urdf"),
    "xarm7": Model("xarm_description/urdf/xarm7.urdf", "xarm_description/srdf/xarm7.srdf", "home"),
    "z1": Model("z1_description/urdf/z1.urdf", "z1_description/srdf/z1.srdf", "arm_up"),
}
_NO_URDF = ("cassie",)


def model_of(name: str) -> Model:
    """Return a robot of the kit by its name."""
    if name in _NO_URDF:
        raise CourseError(
            f"{name!r} is described by SDF, not URDF, and cannot be loaded. Choose another one, "
            f"like {next(iter(MODELS))!r}."
        )
    if name not in MODELS:
        suggestion = did_you_mean(name, list(MODELS), 3) or f", like {next(iter(MODELS))}."
        raise CourseError(
            f"There is no robot {name!r} among the {len(MODELS)} models{suggestion} "
            'For a file, pass its path, like load_robot("my_robot.urdf").'
        )
    return MODELS[name]


def data_file(inside: str) -> Path:
    """Return a file of the robots' data."""
    try:
        return resolve(f"package://example-robot-data/robots/{inside}")
    except CourseError as error:
        raise CourseError(
            f"The robots' descriptions are in the package example-robot-data, and {inside} of it "
            "is missing on this machine. Run pip install example-robot-data==5.0.0."
        ) from error


def rest_posture(model: Model, joints: Collection[str]) -> Posture:
    """Return the rest posture of a robot, restricted to these joints.

    The file also contains others.
    """
    if not model.srdf:
        return Posture()
    states = ET.parse(data_file(model.srdf)).getroot().findall("group_state")
    (state,) = (state for state in states if state.get("name") == model.posture)
    positions, transform = dict[str, float](), np.eye(4)
    for joint in state.findall("joint"):
        values = list(map(float, joint.get("value", "").split()))
        # Position of the root [m] and its quaternion (x, y, z, w).
        if len(values) == 7:
            x, y, z, w = values[3:]
            transform[:3, 3], transform[:3, :3] = values[:3], quat2mat((w, x, y, z))
        elif joint.get("name") in joints:
            (positions[joint.get("name", "")],) = values
    return Posture(positions, transform)


# This is not an identifier, so no argument can have this name.
_XACRO_NAME = "name of xacro"
# The two kinds of shapes: for collisions, and for display.
Shapes: TypeAlias = "tuple[pin.GeometryModel, pin.GeometryModel]"


@dataclass(frozen=True, eq=False)
class Robot:
    """A robot.

    The kit itself does not need Pinocchio. Pinocchio's model, for dynamics and collisions, is built
    when it is first used; this raises a CourseError on machines without Pinocchio, like native
    Windows.

    Args:
        name: The name or model it was loaded by, or its name in the URDF.
        urdf: The text of its description, as published on /robot_description.
        path: The file of the description.
        kinematics: Builds Pinocchio's model and its rest posture.
        shapes: Builds the shapes of the model.
        rest: The rest posture.
    """

    name: str
    urdf: str = field(repr=False)
    path: Path | None
    kinematics: "Callable[[], tuple[pin.Model, Floats]]" = field(repr=False)
    shapes: "Callable[[pin.Model], Shapes]" = field(repr=False)
    rest: Posture = field(default_factory=Posture, repr=False)

    @property
    def model(self) -> "pin.Model":
        """Pinocchio's model."""
        return self._kinematics[0]

    @property
    def q0(self) -> Floats:
        """The rest posture as a configuration of the model, shape (nq,)."""
        return self._kinematics[1]

    @property
    def collision_model(self) -> "pin.GeometryModel":
        """The shapes for collisions."""
        return self._shapes[0]

    @property
    def visual_model(self) -> "pin.GeometryModel":
        """The shapes for display."""
        return self._shapes[1]

    @cached_property
    def _kinematics(self) -> "tuple[pin.Model, Floats]":
        return self.kinematics()

    @cached_property
    def _shapes(self) -> Shapes:
        return self.shapes(self.model)

    @property
    def tree(self) -> Urdf:
        """The links and joints of the description."""
        return parse_urdf(self.urdf)

    def resolve(self, uri: str) -> Path:
        """Return the file of a ``package://`` or ``file://`` address in the description."""
        return resolve(uri, self.path)


def _allow_argument_name(load: Callable[..., Robot]) -> Callable[..., Robot]:
    """Allow a xacro argument called `name`, as in `load_robot("ur.urdf.xacro", name="ur")`.

    The function's own parameter `name` cannot be positional-only, because programs also call
    `load_robot(name="ur10")`.
    """

    @wraps(load)
    def call(*positional: Any, **arguments: object) -> Robot:
        if positional and "name" in arguments:
            arguments[_XACRO_NAME] = arguments.pop("name")
        return load(*positional, **arguments)

    return call


@_allow_argument_name
def load_robot(name: str | Path, **arguments: object) -> Robot:
    """Load a robot.

    Args:
        name: A model of example-robot-data like "ur10", a URDF or xacro file, its address like
            "package://my_robot/urdf/arm.xacro", or the text of a URDF.
        arguments: Values for the arguments of a xacro file, like ``prefix="left_"``.

    Raises:
        CourseError: The robot or file does not exist, the URDF is invalid, or a mesh is missing or
            broken.
    """
    if _XACRO_NAME in arguments:
        arguments["name"] = arguments.pop(_XACRO_NAME)
    if isinstance(name, str) and "<" in name:
        _reject_arguments("the text of a description", arguments)
        return _check_meshes(from_text(name))
    if isinstance(name, Path) or "/" in name or name.endswith((".urdf", ".xml", ".xacro")):
        path = resolve(name) if isinstance(name, str) and "://" in name else Path(name)
        # Many xacro files are called .urdf, because launch files process all descriptions with
        # xacro.
        text = _read(path)
        if path.suffix == ".xacro" or is_xacro(text):
            description = expand_xacro(path, arguments)
        else:
            _reject_arguments(f"{path}, which has no xacro elements,", arguments)
            description = text
        try:
            return _check_meshes(from_text(description, path))
        except CourseError as error:
            # A string that is not XML may be the beginning of a description with links.
            is_xml = "is not XML" not in str(error)
            advice = _advice_without_links(text) if is_xml and "<link" not in description else ""
            message = f"{str(error).rstrip('.')}.{advice}" if advice else str(error)
            raise CourseError(f"{path}{_line_of_error(text, str(error))}: {message}") from error
    _reject_arguments(f"the model {name!r}", arguments)
    return _from_example_robot_data(name)


def _advice_without_links(text: str) -> str:
    """Return advice for a description without links, such as a file of macros or materials."""
    macros = re.findall(r"<xacro:macro\s[^>]*?name\s*=\s*[\"']([\w.:-]+)", text)
    if not macros:
        return " The file defines no links: load the file that includes it." if "<robot" in text else ""
    return (
        f" The file only defines {'the macro' if len(macros) == 1 else 'macros'}, "
        f"{', '.join(macros[:_MOST_MACROS])}{', …' if len(macros) > _MOST_MACROS else ''}: load a "
        f"file that includes it, and calls the macro as <xacro:{macros[0]} …/>."
    )


def _line_of_error(text: str, message: str) -> str:
    """Return ", line 12" for the line of a file with a name quoted in the message, or ""."""
    files = re.findall(r"/([^\s/:]+\.\w+)", message)
    names = ["".join(groups) for groups in re.findall(r"\[([^\[\]]+)\]|'([^']+)'", message)]
    # The name of a broken or missing file is more specific than the robot's name in the same
    # message.
    quoted_names = [f"/{file}" for file in files] or [
        f"{quote}{name}{quote}" for name in names for quote in "\"'"
    ]
    lines = list(enumerate(text.splitlines(), start=1))
    return next((f", line {number}" for word in quoted_names for number, line in lines if word in line), "")


def _reject_arguments(subject: str, arguments: Mapping[str, object]) -> None:
    if arguments:
        raise CourseError(
            f"{subject} has no arguments, but {', '.join(arguments)} was given. Only xacro files "
            "take arguments."
        )


def _from_example_robot_data(name: str) -> Robot:
    model = model_of(name)
    path = data_file(model.urdf).resolve()
    text = _read(path)

    @cache
    def whole() -> Any:
        return import_pinocchio("example_robot_data").load_full(name)[0]

    def shapes(_: "pin.Model") -> Shapes:
        return whole().collision_model, whole().visual_model

    moving = [joint.name for joint in parse_urdf(text).joints.values() if joint.kind in MOVING]
    rest_pose = rest_posture(model, moving)
    return Robot(name, text, path, lambda: (whole().model, whole().q0), shapes, rest_pose)


def from_text(text: str, path: Path | None = None) -> Robot:
    """Return the robot of a URDF's text. Its shapes are loaded later."""
    tree = parse_urdf(text)
    with cache_package_searches():
        for uri in _meshes(text):
            resolve(uri, path)

    def kinematics() -> "tuple[pin.Model, Floats]":
        pinocchio = import_pinocchio("pinocchio")
        model = pinocchio.buildModelFromXML(text)
        return model, pinocchio.neutral(model)

    def shapes(model: "pin.Model") -> Shapes:
        pinocchio = import_pinocchio("pinocchio")
        kinds = (pinocchio.GeometryType.COLLISION, pinocchio.GeometryType.VISUAL)
        # Pinocchio finds packages only by the names of their folders, so it gets paths.
        resolved = text
        with cache_package_searches():
            files = {uri: resolve(uri, path) for uri in _meshes(text)}
        for uri, file in files.items():
            for quote in "\"'":
                resolved = resolved.replace(f"{quote}{uri}{quote}", f"{quote}{file}{quote}")
        try:
            one, other = (
                pinocchio.buildGeomFromUrdfString(model, resolved, kind, None, []) for kind in kinds
            )
        except (ValueError, RuntimeError) as error:
            raise CourseError(f"The shapes of {tree.name!r} cannot be loaded: {error}") from error
        return one, other

    return Robot(tree.name, text, path, kinematics, shapes)


def _meshes(text: str) -> Iterable[str]:
    """Return the addresses of all meshes, each once, in the order of the description."""
    shapes = (shape for link in links_of(text) for shape in (*link.visuals, *link.collisions))
    return dict.fromkeys(shape.uri for shape in shapes if shape.uri)


def _check_meshes(robot: Robot) -> Robot:
    """Print warnings for ignored elements, and load the meshes, which may be broken in the user's files."""
    for problem in (problem for link in links_of(robot.urdf) for problem in link.problems):
        sys.stderr.write(f"warning: {robot.name}: {shorten_words(problem)}\n")
    for file in map(robot.resolve, _meshes(robot.urdf)):
        try:
            if not is_installed(file):
                load_mesh(file)
        except MeshFileError as error:
            raise CourseError(f"The shapes of {robot.name!r} cannot be loaded: {error}") from error
    return robot


def import_pinocchio(package: str) -> Any:
    """Import Pinocchio or a package that needs it, or raise a CourseError with instructions to install it."""
    try:
        return import_module(package)
    except ImportError as error:
        if not isinstance(error, ModuleNotFoundError):
            raise CourseError(
                f"Pinocchio cannot load a library of the system: {error}. Containers and small "
                "Linux systems lack libgomp.so.1: sudo apt install libgomp1"
            ) from error
        raise CourseError(
            "Pinocchio's models, for dynamics and collisions, need the package pin, and "
            f"{error.name} is missing on this machine ({sys.platform}). On Windows it is "
            "available in WSL2 or from conda-forge (pinocchio); elsewhere run pip install -e . "
            "again. Everything else works without it."
        ) from error


def _read(path: Path) -> str:
    try:
        return read_text(path)
    except UnicodeDecodeError as error:
        raise CourseError(f"Cannot read {path}: {NOT_UTF8}.") from error
    except OSError as error:
        raise CourseError(f"Cannot read {path}: {error}. Pass a URDF file, or a name like 'ur10'.") from error
