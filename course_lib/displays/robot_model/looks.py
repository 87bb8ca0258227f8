"""How the links of a robot look in RViz (robot_link.cpp)."""

from math import cbrt, pi
from pathlib import Path

import numpy as np

from course_lib.errors import CourseError
from course_lib.robots.links import Geometry, Inertial, Link, Matrix
from course_lib.robots.resources import resolve
from course_lib.viewer.drawables import Drawable, Mesh, Solids
from course_lib.viewer.mesh_files import MeshFileError, load_mesh

_LEAD = 11340  # [kg/m³]
_RED = np.array([1.0, 0.0, 0.0, 1.0])  # masses, and links that the description does not paint
_WHITE = np.ones(4)  # links that nobody knows the place of; they are not shaded either


class Looks:
    """Turns shapes of one link into what is drawn.

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
