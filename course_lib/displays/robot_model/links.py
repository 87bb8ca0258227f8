"""Links of a robot model: their looks and their nodes in the scene."""

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import cbrt, pi
from pathlib import Path

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.reference_display import axes
from course_lib.errors import CourseError
from course_lib.robots.resources import is_installed, resolve
from course_lib.robots.urdf import Geometry, Inertial, Link
from course_lib.viewer.drawables import Drawable, Lines, Mesh, Solids
from course_lib.viewer.mesh_files import MeshFileError, load_mesh
from course_lib.viewer.scene import Scene

_LEAD = 11340  # [kg/m³]
_RED = np.array([1.0, 0.0, 0.0, 1.0])  # masses, and links that the description does not paint
_WHITE = np.ones(4)  # links without a known transform; they are not shaded either
_TRAIL_STEP, _TRAIL_STEPS = 0.02, 100  # [m], of 2 m; as RViz's ribbon
_TRAIL_WIDTH = 0.01  # [m]
_TRAIL_COLOR = (0.0, 0.5, 0.5, 1.0)
_AXES = axes(0.1, 0.01)


class Looks:
    """The drawables of a link's shapes.

    Args:
        link: Of the description.
        file: The file of the description, or None: packages may lie above it.
    """

    def __init__(self, link: Link, file: Path | None) -> None:
        self._file = file
        self.errors: list[str] = []  # RViz's words
        self._color = self._painted(link)
        for uri in (shape.uri for shape in (*link.visuals, *link.collisions) if shape.uri):
            self._file_of(uri)

    def drawn(self, shape: Geometry, alpha: float, lost: bool) -> Drawable | None:
        """Draw a shape in its own frame; None if its file cannot be read.

        Args:
            shape: One of the link.
            alpha: Of the robot, times that of the link; the description's material counts besides.
            lost: Whether nobody knows where the link is.
        """
        color = _WHITE if lost else self._color * [1, 1, 1, alpha]
        if shape.kind != "mesh":
            return Solids(shape.kind, [np.diag([*shape.size, 1.0])], color, lit=not lost)
        mesh = self._mesh(shape.uri)
        if mesh is None:
            return None
        if not (lost or shape.uri.lower().endswith(".stl")):  # STL has no materials of its own
            color = np.concatenate(
                [mesh.colors[..., :3], np.full_like(mesh.colors[..., :1], color[3])], axis=-1
            )
        return Mesh(mesh.vertices, mesh.faces, color, mesh.normals, lit=not lost)

    def check(self, shapes: Iterable[Geometry]) -> None:
        """Note the errors of shapes without drawing them; the meshes that come with the kit have none."""
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

    def _painted(self, link: Link) -> Matrix:
        """Return the RGBA of the first visual's material, which RViz2 takes for all shapes of a link."""
        if link.material is None:
            return _RED
        return np.array(link.material.color) * _texture(link.material.texture, self._file)


def _texture(uri: str, file: Path | None) -> Matrix:
    """Return the mean RGBA of a picture, white if there is none."""
    from PIL import Image

    try:
        with Image.open(resolve(uri, file)) as picture:
            pixels = np.asarray(picture.convert("RGBA"), dtype=float) / 255
    except (CourseError, OSError):
        return _WHITE
    mean: Matrix = pixels.mean(axis=(0, 1))
    return mean


def placement(shape: Geometry) -> Matrix:
    """Return where a drawn shape goes in its link, shape (4, 4); meshes are scaled there."""
    scale = shape.size if shape.kind == "mesh" else (1.0, 1.0, 1.0)
    placed: Matrix = shape.transform_shape_to_link @ np.diag([*scale, 1.0])
    return placed


def mass(inertial: Inertial) -> Solids:
    """Draw a mass as a ball of lead."""
    diameter = 2 * cbrt(0.75 * inertial.mass / (pi * _LEAD))
    ball = np.diag([diameter, diameter, diameter, 1.0])
    ball[:3, 3] = inertial.transform_center_to_link[:3, 3]
    return Solids("sphere", [ball], _RED)


def inertia(inertial: Inertial) -> Solids | None:
    """Draw an inertia as the box of even density that has it; None if no body can have it."""
    if not np.isfinite(inertial.inertia).all():
        return None
    moments, axes = np.linalg.eigh(inertial.inertia)  # about the axes
    squares = moments.sum() - 2 * moments  # of the extents, times mass / 6
    if inertial.mass <= 0 or squares.min() < 0 or moments.min() <= 0:
        return None
    box = np.eye(4)
    box[:3, :3] = axes * np.sign(np.linalg.det(axes)) * np.sqrt(6 * squares / inertial.mass)
    return Solids("box", [inertial.transform_center_to_link @ box], _RED)


@dataclass(frozen=True)
class Wanted:
    """The visible parts of a link."""

    shown: Mapping[str, bool]  # by kind: visual, collision, mass, inertia, axes, trail
    alpha: float
    lost: bool = False  # its transform is not known
    seen: bool = True  # else nothing is drawn, and only the files that may be broken are read


class DrawnLink:
    """A link below its node of the scene; what is not to be seen is not even made."""

    def __init__(self, scene: Scene, path: str, link: Link, file: Path | None) -> None:
        self.name = link.name
        self.has_geometry = bool(link.visuals or link.collisions)  # whether it can be seen at all
        self.looks = Looks(link, file)
        self._scene = scene
        self._path = path
        self._body = link.inertial
        self._transform: Matrix | None = None
        self._wanted: Wanted | None = None
        self._made: dict[str, object] = {}  # what each kind was drawn with
        self._trail: deque[Matrix] = deque(maxlen=_TRAIL_STEPS)
        self._shapes = {"visual": link.visuals, "collision": link.collisions}

    def show(self, wanted: Wanted) -> None:
        """Show what is wanted, and hide the rest."""
        if wanted == self._wanted:
            return
        self._wanted = wanted
        for kind, shown in wanted.shown.items():
            node = f"{self._path}/{kind}"
            look = (wanted.alpha, wanted.lost) if kind in self._shapes else None
            if not wanted.seen:
                self.looks.check(self._shapes.get(kind, ()) if shown else ())
            elif shown and self._made.get(kind, ()) != look:
                self._made[kind] = look
                self._scene.delete(node)
                self._draw(node, kind, wanted)
            if kind in self._made:
                self._scene.set_visible(node, shown)
        if not wanted.shown["trail"]:
            self._trail.clear()

    def place(self, transform_link_to_fixed: Matrix) -> None:
        """Move the link."""
        if transform_link_to_fixed is self._transform:
            return
        self._transform = transform_link_to_fixed
        for kind in self._made.keys() - {"trail"}:
            self._scene.set_transform(f"{self._path}/{kind}", transform_link_to_fixed)
        if "trail" in self._made:
            self._follow(transform_link_to_fixed[:3, 3])

    def _draw(self, node: str, kind: str, wanted: Wanted) -> None:
        for name, (drawable, transform) in self._parts(kind, wanted):
            self._scene.set_object(f"{node}/{name}", drawable)
            self._scene.set_transform(f"{node}/{name}", transform)
        if self._transform is not None and kind != "trail":
            self._scene.set_transform(node, self._transform)

    def _parts(self, kind: str, wanted: Wanted) -> Iterable[tuple[str, tuple[Drawable, Matrix]]]:
        for index, shape in enumerate(self._shapes.get(kind, ())):
            drawable = self.looks.drawn(shape, wanted.alpha, wanted.lost)
            if drawable is not None:
                yield str(index), (drawable, placement(shape))
        body = self._body
        other = {"mass": body and mass(body), "inertia": body and inertia(body), "axes": _AXES}.get(kind)
        if other:
            yield kind, (other, np.eye(4))

    def _follow(self, position: Matrix) -> None:
        """Lengthen the trail, and let its end go after 2 m."""
        trail = self._trail
        start = trail[-1] if trail else position
        way = float(np.linalg.norm(position - start))
        steps = int(way / _TRAIL_STEP) if trail else 1
        for step in range(max(steps - _TRAIL_STEPS, 0) + 1, steps + 1):
            trail.append(start + (position - start) * (step * _TRAIL_STEP / (way or 1.0)))
        if steps and len(trail) > 1:
            self._scene.set_object(f"{self._path}/trail", Lines(np.array(trail), _TRAIL_COLOR, _TRAIL_WIDTH))
