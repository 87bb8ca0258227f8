"""RViz's RobotModel display, and robots drawn without messages."""

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from math import cbrt, pi
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from course_lib.arrays import Floats, Matrix
from course_lib.displays.display import Display, TopicDisplay, node_name, qos_properties
from course_lib.displays.frames import NS, quaternion_of
from course_lib.displays.properties import NEVER, Convert, Property, flag, number, read_only, text, words
from course_lib.displays.shapes import ALONG_X, axes, draw_arrows, placement, rotation_to
from course_lib.errors import CourseError
from course_lib.robots.kinematics import link_poses
from course_lib.robots.robot import Robot, cache_package_searches, import_pinocchio, is_installed, resolve
from course_lib.robots.urdf import (
    UNMOVED,
    Geometry,
    Inertial,
    Joint,
    Link,
    find_slips,
    links_of,
    parse_urdf,
)
from course_lib.ros.graph.topics import Qos
from course_lib.third_party import read_text
from course_lib.viewer.drawables import Drawable, Lines, Mesh, MeshFileError, Solids, load_mesh
from course_lib.viewer.scene import Scene

_LEAD = 11340  # [kg/m³]
# The color of masses, and of links without a material.
_RED = np.array([1.0, 0.0, 0.0, 1.0])
# The color of links without a known transform, which are unshaded as well.
_WHITE = np.ones(4)
# The length of a step [m] and the number of steps: 2 m in total, like RViz's ribbon.
_TRAIL_STEP, _TRAIL_STEPS = 0.02, 100
_TRAIL_WIDTH = 0.01  # [m]
_TRAIL_COLOR = (0.0, 0.5, 0.5, 1.0)
_AXES = axes(0.1, 0.01)


class LinkShapes:
    """The drawables of a link's shapes.

    Args:
        link: A link of the description.
        file: The file of the description, or None; its packages may be in folders above it.
    """

    def __init__(self, link: Link, file: Path | None) -> None:
        self._file = file
        # RViz's error texts.
        self.errors: list[str] = []
        # RViz2 uses the material of the first visual for all shapes of a link.
        paint = link.material
        self._color = _RED if paint is None else np.array(paint.color) * _texture(paint.texture, file)
        for uri in (shape.uri for shape in (*link.visuals, *link.collisions) if shape.uri):
            self._file_of(uri)

    def draw(self, shape: Geometry, alpha: float, is_lost: bool) -> Drawable | None:
        """Draw a shape in its own frame; None if its file cannot be read.

        Args:
            shape: A shape of the link.
            alpha: The alpha of the robot times that of the link; the material's alpha is applied in
                addition.
            is_lost: Whether the link's transform is unknown.
        """
        color = _WHITE if is_lost else self._color * [1, 1, 1, alpha]
        if shape.kind != "mesh":
            return Solids(shape.kind, [np.diag([*shape.size, 1.0])], color, lit=not is_lost)
        mesh = self._mesh(shape.uri)
        if mesh is None:
            return None
        # STL has no materials.
        if not (is_lost or shape.uri.lower().endswith(".stl")):
            color = np.concatenate(
                [mesh.colors[..., :3], np.full_like(mesh.colors[..., :1], color[3])], axis=-1
            )
        return Mesh(mesh.vertices, mesh.faces, color, mesh.normals, lit=not is_lost)

    def check(self, shapes: Iterable[Geometry]) -> None:
        """Record errors of shapes without drawing them. Meshes of the kit are not checked."""
        for uri in (shape.uri for shape in shapes if shape.kind == "mesh"):
            file = self._file_of(uri)
            if file is not None and not is_installed(file):
                self._mesh(uri)

    def _mesh(self, uri: str) -> Mesh | None:
        file = self._file_of(uri)
        try:
            return load_mesh(file) if file else None
        except MeshFileError:
            self._fail(uri)
            return None

    def _file_of(self, uri: str) -> Path | None:
        try:
            return resolve(uri, self._file)
        except CourseError:
            self._fail(uri)
            return None

    def _fail(self, uri: str) -> None:
        problem = f"Could not load mesh resource '{uri}'"
        if problem not in self.errors:
            self.errors.append(problem)


def _texture(uri: str, file: Path | None) -> Matrix:
    """Return the mean RGBA of an image, or white if it cannot be read."""
    from PIL import Image

    try:
        with Image.open(resolve(uri, file)) as picture:
            pixels = np.asarray(picture.convert("RGBA"), dtype=float) / 255
    except Exception:
        # Image decoders can raise any exception for a damaged file.
        return _WHITE
    mean: Matrix = pixels.mean(axis=(0, 1))
    return mean


def mass(inertial: Inertial) -> Solids:
    """Draw a mass as a lead sphere."""
    diameter = 2 * cbrt(0.75 * inertial.mass / (pi * _LEAD))
    ball = np.diag([diameter, diameter, diameter, 1.0])
    ball[:3, 3] = inertial.transform_center_to_link[:3, 3]
    return Solids("sphere", [ball], _RED)


def inertia(inertial: Inertial) -> Solids | None:
    """Draw an inertia as a homogeneous box, or return None if it is physically impossible."""
    if not np.isfinite(inertial.inertia).all():
        return None
    # The moments of inertia about the principal axes.
    moments, axes = np.linalg.eigh(inertial.inertia)
    # The squares of the extents, times mass / 6.
    squares = moments.sum() - 2 * moments
    if inertial.mass <= 0 or squares.min() < 0 or moments.min() <= 0:
        return None
    box = np.eye(4)
    box[:3, :3] = axes * np.sign(np.linalg.det(axes)) * np.sqrt(6 * squares / inertial.mass)
    return Solids("box", [inertial.transform_center_to_link @ box], _RED)


@dataclass(frozen=True)
class LinkSettings:
    """The visible parts of a link."""

    # Whether each kind is visible: visual, collision, mass, inertia, axes, trail.
    shown: Mapping[str, bool]
    alpha: float
    # Whether the transform of the link is unknown.
    is_lost: bool = False
    # If False, nothing is drawn, and only the files are checked.
    is_visible: bool = True


class DrawnLink:
    """The scene nodes of a link. Invisible parts have no nodes."""

    def __init__(self, scene: Scene, path: str, link: Link, file: Path | None) -> None:
        self.name = link.name
        # Whether the link has anything to draw.
        self.has_geometry = bool(link.visuals or link.collisions)
        self.shapes = LinkShapes(link, file)
        self._scene = scene
        self._path = path
        self._body = link.inertial
        self._transform: Matrix | None = None
        self._settings: LinkSettings | None = None
        # Whether the link is drawn without a transform; None before it is drawn.
        self.is_shown_as_lost: bool | None = None
        # Settings with which each kind was drawn.
        self._drawn_settings: dict[str, object] = {}
        self._trail: deque[Matrix] = deque(maxlen=_TRAIL_STEPS)
        self._shapes = {"visual": link.visuals, "collision": link.collisions}

    def show(self, settings: LinkSettings) -> None:
        """Show the requested parts, and hide the others."""
        if settings == self._settings:
            return
        self._settings, self.is_shown_as_lost = settings, settings.is_lost
        for kind, is_shown in settings.shown.items():
            node = f"{self._path}/{kind}"
            look = (settings.alpha, settings.is_lost) if kind in self._shapes else None
            if not settings.is_visible:
                self.shapes.check(self._shapes.get(kind, ()) if is_shown else ())
            elif is_shown and self._drawn_settings.get(kind, ()) != look:
                self._drawn_settings[kind] = look
                self._scene.delete(node)
                for name, (drawable, transform) in self._drawables(kind, settings):
                    self._scene.set_object(f"{node}/{name}", drawable)
                    self._scene.set_transform(f"{node}/{name}", transform)
                if self._transform is not None and kind != "trail":
                    self._scene.set_transform(node, self._transform)
            if kind in self._drawn_settings:
                self._scene.set_visible(node, is_shown)
        if not settings.shown["trail"]:
            self._trail.clear()

    def place(self, transform_link_to_fixed: Matrix) -> None:
        """Move the link."""
        if transform_link_to_fixed is self._transform:
            return
        self._transform = transform_link_to_fixed
        for kind in self._drawn_settings.keys() - {"trail"}:
            self._scene.set_transform(f"{self._path}/{kind}", transform_link_to_fixed)
        if "trail" in self._drawn_settings:
            # The trail grows up to 2 m and then loses its oldest part.
            position = transform_link_to_fixed[:3, 3]
            trail = self._trail
            start = trail[-1] if trail else position
            way = float(np.linalg.norm(position - start))
            steps = int(way / _TRAIL_STEP) if trail else 1
            for step in range(max(steps - _TRAIL_STEPS, 0) + 1, steps + 1):
                trail.append(start + (position - start) * (step * _TRAIL_STEP / (way or 1.0)))
            if steps and len(trail) > 1:
                self._scene.set_object(
                    f"{self._path}/trail", Lines(np.array(trail), _TRAIL_COLOR, _TRAIL_WIDTH)
                )

    def _drawables(
        self,
        kind: str,
        settings: LinkSettings,
    ) -> Iterable[tuple[str, tuple[Drawable, Matrix]]]:
        for index, shape in enumerate(self._shapes.get(kind, ())):
            drawable = self.shapes.draw(shape, settings.alpha, settings.is_lost)
            if drawable is not None:
                scale = shape.size if shape.kind == "mesh" else (1.0, 1.0, 1.0)
                transform: Matrix = shape.transform_shape_to_link @ np.diag([*scale, 1.0])
                yield str(index), (drawable, transform)
        body = self._body
        other = {"mass": body and mass(body), "inertia": body and inertia(body), "axes": _AXES}.get(kind)
        if other:
            yield kind, (other, np.eye(4))


# The styles of the tree, and RViz's name of its top row with each.
_LINKS, _JOINTS = "Links in Alphabetic Order", "Joints in Alphabetic Order"
_LINK_TREE, _JOINT_TREE = "Tree of links", "Tree of links and joints"
_TOP_ROWS = {
    _LINKS: "Links",
    _JOINTS: "Joints",
    _LINK_TREE: "Link Tree",
    _JOINT_TREE: "Link/Joint Tree",
}
# RViz saves an empty style before it has a robot, and loads it as the first one.
_STYLES = (*_TOP_ROWS, "")
_ALL, _STYLE = "Links/All Links Enabled", "Links/Link Tree Style"
_EXPAND = "Links/Expand Tree"
_EXPAND_DETAILS = {"Links": "Links/Expand Link Details", "Joints": "Links/Expand Joint Details"}
_TOPIC = "Description Topic"
_SWITCHES = {
    "visual": "Visual Enabled",
    "collision": "Collision Enabled",
    "mass": "Mass Properties/Mass",
    "inertia": "Mass Properties/Inertia",
}
_OF_LINKS = {"axes": "Show Axes", "trail": "Show Trail"}


class RobotModelDisplay(TopicDisplay):
    """A robot described by URDF, with each link at its tf frame.

    It does not subscribe to joint states.
    """

    class_name = "rviz_default_plugins/RobotModel"
    type_name = "std_msgs/msg/String"
    topic_label = _TOPIC
    properties = (
        *Display.properties,
        Property("Visual Enabled", True, flag),
        Property("Collision Enabled", False, flag),
        Property("Mass Properties/Mass", False, flag),
        Property("Mass Properties/Inertia", False, flag),
        Property("Update Interval", 0.0, number(0.0)),  # [s]
        Property("Alpha", 1.0, number(0.0, 1.0)),
        Property("Description Source", "Topic", words("Topic", "File")),
        Property("Description File", "", text, shown_if=(("Description Source", "File"),)),
        *qos_properties(label=_TOPIC),
        Property("TF Prefix", "", text),
        Property(_STYLE, _STYLES[0], words(*_STYLES)),
        *(
            Property(f"Links/Expand {detail}", False, flag, shown_if=((_STYLE, *styles),))
            for detail, styles in (
                ("Tree", (_LINK_TREE, _JOINT_TREE)),
                ("Link Details", (_LINKS, _LINK_TREE, _JOINT_TREE, "")),
                ("Joint Details", (_JOINTS, _JOINT_TREE)),
            )
        ),
        Property(_ALL, True, flag),
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._urdf: str | None = None
        self._links: list[DrawnLink] = []  # by name
        self._joints: list[Joint] = []  # parents before children
        # The labels of the links that the check box of a joint shows and hides.
        self._switches: dict[str, list[str]] = {}
        # The rows of links and joints by their path in the panel, which depends on the style:
        # ("Links", name) or ("Joints", name).
        self._rows: dict[tuple[str, ...], tuple[str, ...]] = {}
        # The joint of each visible drawable of joints, and the transform of the joint's parent.
        self._drawn_joints: dict[str, Joint] = {}
        self._parent_transforms: dict[str, Matrix] = {}
        # The time of the last update; None requests an immediate one.
        self._updated_ns: int | None = None
        # Whether the robot is visible, and the properties with which the links are shown.
        self._shown_state: tuple[bool, dict[str, Any]] | None = None

    def has_row(self, prop: Property) -> bool:
        """Return whether the panel has a row: RViz hides an unused topic and empty links."""
        is_used = {_TOPIC: self["Description Source"] == "Topic", "Links": bool(self._links)}
        if len(prop.names) == 2 and prop.names[0] == "Joints":
            # RViz removes the check box of a joint that moves no geometry.
            return bool(self._switches[prop.names[1]])
        return is_used.get(prop.path[0], True) and super().has_row(prop)

    def __setitem__(self, label: str, value: Any) -> None:
        names = self._property(label).names
        if len(names) == 2 and names[0] == "Joints" and not self._switches[names[1]]:
            raise CourseError(
                f"{self}: with {_STYLE.partition('/')[2]} {self[_STYLE]!r}, joint {names[1]!r} has no check "
                f"box, because its link has no geometry. With {_JOINT_TREE!r}, it shows and hides all links "
                "below the joint."
            )
        super().__setitem__(label, value)

    def qos(self) -> Qos:
        """Return the requested quality of service: transient local, until a policy is changed."""
        policies = [prop for prop in self.properties if prop.label.startswith(f"{_TOPIC}/")]
        is_changed = any(self[prop.label] != prop.default for prop in policies)
        return super().qos() if is_changed else Qos(depth=1, durability="transient_local")

    def on_property_change(self, label: str) -> None:
        """Restart after a change of the description.

        Other properties take effect in the next frame.
        """
        super().on_property_change(label)
        switches = [f"Links/{link.name}" for link in self._links if link.has_geometry]
        if label == _ALL:
            self._values |= dict.fromkeys(switches, self[_ALL])
        elif label.startswith("Joints/"):
            _, joint, *setting = self._property(label).names
            if not setting:
                self._values |= dict.fromkeys(self._switches[joint], self[label])
        elif label == _STYLE:
            self._values |= dict.fromkeys((_EXPAND, *_EXPAND_DETAILS.values()), False)
            self._arrange()
        elif label == "TF Prefix" and self.is_started:
            self.reset()
        elif label in ("Description File", "Description Source") and self.is_started:
            self.start()
        if label in switches or label.startswith("Joints/"):
            self._values[_ALL] = all(self[switch] for switch in switches)
        self._update_joint_check_boxes()
        self._updated_ns = None

    def start(self) -> None:
        """Discard the robot, and read its file or subscribe to its topic."""
        self._urdf = None
        if self["Description Source"] == "Topic":
            super().start()
            return
        self.subscriptions = ()
        super(TopicDisplay, self).start()
        if self.enabled and self._file:
            try:
                self._urdf = read_text(self._file)
            except (OSError, UnicodeDecodeError) as error:
                self.statuses.hint("URDF", f"{self._file}: {error}")
            if self._urdf:
                self._load()
            else:
                self.statuses.set("error", "URDF", "URDF is empty")

    def reset(self) -> None:
        """Redraw the robot, which does not depend on the fixed frame."""
        super().reset()
        self._load()

    def process(self, message: Any) -> None:
        """Draw the robot of a description."""
        self._urdf = message.data
        self._load()

    def update(self) -> None:
        """Place the links by their transforms, unless the frame is not displayed."""
        if not self.context.is_drawn:
            return
        now_ns, last_ns = self.context.now_ns, self._updated_ns
        if last_ns is not None and now_ns - last_ns < self["Update Interval"] * NS:
            return
        self._updated_ns = now_ns
        before = self._problems()
        # The properties of all links are read only if one of them
        # has changed, because frames are many.
        state = self.context.is_seen, dict(self._values)
        is_changed, self._shown_state = state != self._shown_state, state
        with cache_package_searches():
            for link in self._links:
                frames, frame = self.context.frames, self._frame_of(link.name)
                transform = frames.transform(frame)
                if transform is None:
                    self.statuses.set(
                        "error", frame, f"No transform from [{frame}] to [{frames.fixed_frame}]"
                    )
                else:
                    self.statuses.set("ok", frame, "Transform OK")
                    link.place(transform)
                if not is_changed and link.is_shown_as_lost == (transform is None):
                    continue
                row = f"Links/{link.name}"
                is_enabled = self[row] if link.has_geometry else True
                visibility = {kind: is_enabled and self[label] for kind, label in _SWITCHES.items()}
                visibility |= {
                    kind: is_enabled and self[f"{row}/{label}"] for kind, label in _OF_LINKS.items()
                }
                alpha = self["Alpha"] * self[f"{row}/Alpha"]
                link.show(LinkSettings(visibility, alpha, transform is None, self.context.is_seen))
        self._update_joints(is_changed)
        if self._problems() != before:
            self._report_problems()

    def _update_joints(self, is_changed: bool) -> None:
        """Draw the requested axes of joints, which move with the parent links."""
        scene = self.context.scene
        if is_changed:
            before, self._drawn_joints = self._drawn_joints, {}
            for joint in self._joints:
                row, path = f"Joints/{joint.name}", f"{self.path}/joints/{node_name(joint.name)}"
                is_enabled = self[row] if self._switches[joint.name] else True
                drawables: dict[str, Drawable] = {}
                if is_enabled and self[f"{row}/Show Axes"]:
                    drawables["axes"] = _AXES
                if is_enabled and self.get(f"{row}/Show Joint Axis", False):
                    # RViz's green arrow. Arrows point along x, and `rotation_to` maps z. An axis of
                    # zeros draws nothing.
                    direction = np.array([*joint.axis])
                    if length := np.linalg.norm(direction):
                        pose = placement(rotation_to(direction / length) @ ALONG_X.T, 1.0, 0.0)
                        rgba = (0.0, 0.8, 0.0, 1.0)
                        drawables |= draw_arrows([pose], 0.15, 0.05, 0.05, 0.08, rgba=rgba)
                for name, drawable in drawables.items():
                    node = f"{path}/{name}"
                    self._drawn_joints[node] = joint
                    if node not in before:
                        scene.set_object(node, drawable)
            for node in before.keys() - self._drawn_joints.keys():
                scene.delete(node)
                self._parent_transforms.pop(node, None)
        for node, joint in self._drawn_joints.items():
            transform = self.context.frames.transform(self._frame_of(joint.parent))
            if transform is not None and transform is not self._parent_transforms.get(node):
                self._parent_transforms[node] = transform
                scene.set_transform(node, transform @ joint.transform_joint_to_parent)

    def panel_rows(self) -> Iterator[tuple[tuple[str, ...], Property]]:
        """Yield the displayed properties, with links and joints arranged by the style."""
        by_row: dict[tuple[str, ...], list[Property]] = {row: [] for row in self._rows.values()}
        by_row[()] = []
        for prop in self.properties:
            if prop.names[:2] in by_row and self.has_row(prop):
                by_row[prop.names[:2]].append(prop)
        yield from ((prop.path, prop) for prop in by_row[()])
        # In a tree, the rows of children follow the row Details.
        details = ("Details",) if self._is_tree else ()
        for path, row in self._rows.items():
            for prop in by_row[row]:
                names = prop.names[2:]
                yield (*path, *(details if names else ()), *names), prop

    def row_name(self, path: tuple[str, ...]) -> str:
        """Return the name of a row, which for the links depends on the style."""
        return _TOP_ROWS.get(self[_STYLE], "Links") if path == ("Links",) else path[-1]

    def is_expanded(self, path: tuple[str, ...]) -> bool:
        """Return whether an Expand property shows the rows below a link, a joint or its details."""
        is_details = not self._is_tree or path[-1] == "Details"
        row = self._rows.get(path[:-1] if self._is_tree and is_details else path)
        if row is None:
            return False
        return bool(self[_EXPAND_DETAILS[row[0]] if is_details else _EXPAND])

    @classmethod
    def describe(cls, prop: Property) -> str:
        """Return RViz's description of a property, or ""."""
        description = super().describe(prop)
        is_of_joint = prop.names[:1] == ("Joints",)
        return description.replace("this link", "this joint") if is_of_joint else description

    @property
    def _is_tree(self) -> bool:
        return self[_STYLE] in (_LINK_TREE, _JOINT_TREE)

    def _arrange(self) -> None:
        """Arrange the rows of links and joints, and the links of each joint, by the style."""
        style, links = self[_STYLE], [link.name for link in self._links]
        below = {link.name: [f"Links/{link.name}"] * link.has_geometry for link in self._links}
        self._rows = {("Links", name): ("Links", name) for name in links}
        if style == _JOINTS:
            names = sorted(joint.name for joint in self._joints)
            self._rows = {("Links", name): ("Joints", name) for name in names}
        elif self._is_tree and self._links:
            for joint in reversed(self._joints):
                below[joint.parent] = below[joint.parent] + below[joint.child]
            root = self._joints[0].parent if self._joints else links[0]
            paths: dict[str, tuple[str, ...]] = {root: ("Links", root)}
            self._rows = {paths[root]: ("Links", root)}
            for joint in self._joints:
                path = paths[joint.parent]
                if style == _JOINT_TREE:
                    path = (*path, joint.name)
                    self._rows[path] = ("Joints", joint.name)
                paths[joint.child] = path = (*path, joint.child)
                self._rows[path] = ("Links", joint.child)
        self._switches = {joint.name: below[joint.child] for joint in self._joints}
        self._update_joint_check_boxes()

    def _update_joint_check_boxes(self) -> None:
        """Tick the check boxes of the joints below which all links are visible."""
        for joint, switches in self._switches.items():
            if f"Joints/{joint}" in self._values:
                self._values[f"Joints/{joint}"] = all(self[switch] for switch in switches)

    def _joint_value(self, joint: Joint, label: str) -> Any:
        transform = self.context.frames.transform(self._frame_of(joint.parent))
        if transform is None:
            return ""
        pose = transform @ joint.transform_joint_to_parent
        numbers = pose[:3, 3] if label == "Position" else quaternion_of(pose[:3, :3])
        return tuple(round(float(number), 6) for number in numbers)

    def _joint_rows(self, joint: Joint, has_geometry: bool) -> Iterator[Property]:
        """Yield the properties of a joint, which RViz does not restore from a layout.

        Args:
            joint: The joint.
            has_geometry: Whether a link below it has geometry; others have no check box.
        """

        def row(name: str, value: Any, convert: Convert = read_only) -> Property:
            label = f"Joints/{joint.name}/{name}"
            return Property(label, value, convert, ("Joints", joint.name, name), is_saved=False)

        names = ("Joints", joint.name)
        if has_geometry:
            yield Property("/".join(names), True, flag, names, is_saved=False)
        yield row("Show Axes", False, flag)
        for label in ("Position", "Orientation"):
            yield row(label, partial(self._joint_value, joint, label))
        yield row("Type", joint.kind)
        # A joint without <limit> has no effort.
        if joint.effort is not None:
            for bound in ("lower", "upper"):
                yield row(f"{bound.title()} Limit", joint.limits.get(bound, 0.0))
        if joint.kind not in UNMOVED:
            yield row("Show Joint Axis", False, flag)
            yield row("Joint Axis", joint.axis)

    def _frame_of(self, link: str) -> str:
        prefix = self["TF Prefix"]
        return f"{prefix}/{link}" if prefix else link

    def _link_value(self, link: str, label: str) -> Any:
        return self.context.frames.pose_value(label, self._frame_of(link))

    @property
    def _file(self) -> Path | None:
        """The file of the description."""
        path = self["Description File"]
        return Path(path) if path and self["Description Source"] == "File" else None

    def _load(self) -> None:
        """Create the links of the description, replacing earlier ones."""
        for group in ("links", "joints"):
            self.context.scene.delete(f"{self.path}/{group}")
        self._links, self._joints, self._updated_ns, self._shown_state = [], [], None, None
        self._drawn_joints.clear()
        self._parent_transforms.clear()
        self._arrange()
        self.remove_properties("Links")
        self.remove_properties("Joints")
        if self._urdf is None:
            return
        try:
            tree = parse_urdf(self._urdf)
        except CourseError as error:
            self.statuses.clear()
            self.statuses.set("error", "URDF", "URDF failed Model parse")
            self.statuses.hint("URDF", str(error))
            return
        self.statuses.hint("URDF")
        self.statuses.set("ok", "URDF", "URDF parsed OK")
        scene, path = self.context.scene, f"{self.path}/links"
        links = links_of(self._urdf)
        with cache_package_searches():
            self._links = [
                DrawnLink(scene, f"{path}/{node_name(link.name)}", link, self._file)
                for link in sorted(links, key=lambda link: link.name)
            ]
        rows: list[Property] = []
        for link in self._links:
            row, names = f"Links/{link.name}", ("Links", link.name)
            # A link without geometry has no check box.
            if link.has_geometry:
                rows.append(Property(row, True, flag, names))
            shown_if = () if link.has_geometry else NEVER
            rows.append(Property(f"{row}/Alpha", 1.0, number(0.0, 1.0), (*names, "Alpha"), shown_if))
            rows += [Property(f"{row}/{label}", False, flag, (*names, label)) for label in _OF_LINKS.values()]
            for label in ("Position", "Orientation"):
                value = partial(self._link_value, link.name, label)
                rows.append(Property(f"{row}/{label}", value, read_only, (*names, label)))
        joints = tree.joints_from_root()
        moving = {link.name for link in self._links if link.has_geometry}
        for joint in reversed(joints):
            if joint.child in moving:
                moving.add(joint.parent)
        joint_rows: list[Property] = []
        for joint in joints:
            joint_rows += self._joint_rows(joint, joint.child in moving)
        wrong = self.add_properties(*rows, *joint_rows)
        # The type and limits of an earlier description with the same names are outdated.
        self._values |= {row.label: row.default for row in joint_rows if row.is_read_only}
        self._joints = joints
        self._arrange()
        self.statuses.hint("Links", *wrong)
        problems = [problem for link in links for problem in link.problems]
        self.statuses.hint("URDF", *problems, *find_slips(self._urdf))
        self._report_problems()

    def _problems(self) -> str:
        """Return RViz's text about the shapes that could not be loaded."""
        failed = (link for link in self._links if link.shapes.errors)
        return "".join(f"\n• for link '{link.name}':\n" + "\n".join(link.shapes.errors) for link in failed)

    def _report_problems(self) -> None:
        if problems := self._problems():
            self.statuses.set("error", "URDF", f"Errors loading geometries:{problems}")


Configuration: TypeAlias = Mapping[str, float] | npt.ArrayLike | None


def draw_robot(
    scene: Scene, path: str, robot: Robot, configuration: Configuration, alpha: float = 1.0
) -> None:
    """Draw a robot's links below a node, replacing its contents.

    Args:
        scene: The scene.
        path: The node.
        robot: A robot from `load_robot`.
        configuration: Joint positions by name [rad] or [m], or Pinocchio's vector, which also
            places the root of a model with a free-flyer; None uses the rest posture.
        alpha: From 0.0, invisible, to 1.0, opaque.

    Raises:
        CourseError: A joint does not exist, or a mesh cannot be read.
    """
    poses, settings = _poses(robot, configuration), LinkSettings({"visual": True, "trail": False}, alpha)
    scene.delete(path)
    for link in links_of(robot.urdf):
        drawn_link = DrawnLink(scene, f"{path}/{node_name(link.name)}", link, robot.path)
        drawn_link.place(poses[link.name])
        drawn_link.show(settings)
        if drawn_link.shapes.errors:
            raise CourseError(f"{robot.name!r} cannot be drawn: {'; '.join(drawn_link.shapes.errors)}")


def _poses(robot: Robot, configuration: Configuration) -> dict[str, Floats]:
    """Return transform_link_to_ground of all links, shape (4, 4) each."""
    if configuration is not None and not isinstance(configuration, Mapping):
        values = np.asarray(configuration, dtype=float)
        pinocchio, model = import_pinocchio("pinocchio"), robot.model
        if values.shape != (model.nq,):
            raise CourseError(
                f"The configuration has shape {values.shape}, expected ({model.nq},), or a dict."
            )
        if not np.isfinite(values).all():
            raise CourseError(f"The configuration is {values.tolist()}, expected finite numbers.")
        data = model.createData()
        # Circle points and quaternions that are only approximately normalized are accepted.
        pinocchio.framesForwardKinematics(model, data, pinocchio.normalize(model, values))
        frames, body = zip(model.frames, data.oMf, strict=True), pinocchio.FrameType.BODY
        body_poses = {frame.name: pose.homogeneous for frame, pose in frames if frame.type == body}
        rest_poses = link_poses(robot, robot.rest.positions)
        root = body_poses.get(robot.tree.root, np.eye(4))
        # The models may not contain all links.
        return {link: root @ pose for link, pose in rest_poses.items()} | body_poses
    poses = link_poses(robot, robot.rest.positions if configuration is None else configuration)
    return {link: robot.rest.transform_root_to_ground @ pose for link, pose in poses.items()}
