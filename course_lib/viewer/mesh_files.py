"""Meshes from files, read once into the arrays that are drawn."""

import re
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from course_lib.arrays import Float32s, Matrix
from course_lib.errors import CourseError
from course_lib.viewer.drawables import Mesh

Part: TypeAlias = tuple[Any, Matrix]  # a mesh of trimesh, and the transform from it to the file's frame

FORMATS = ("dae", "stl", "obj")

# What paints the parts of a DAE file; pycollada drops those whose material is broken, RViz does not.
_PAINT = re.compile(rb"<bind_material>.*?</bind_material>", re.S)
_PLAIN = np.array([0.7, 0.7, 0.7, 1.0], np.float32)  # of a file without colours


class MeshFileError(CourseError):
    """A mesh file cannot be read."""


def load_mesh(path: Path) -> Mesh:
    """Read a DAE, STL or OBJ file; as in RViz, the unit that it names counts, the axis that it calls up not.

    Raises:
        MeshFileError: If it is not such a file, or broken.
    """
    try:
        return parse_mesh(path.read_bytes(), path.suffix.lstrip(".").lower(), folder=path.parent)
    except (OSError, MeshFileError) as error:
        raise MeshFileError(f"{path}: {error}") from error


@lru_cache(maxsize=128)
def parse_mesh(
    data: bytes, file_format: str, color: tuple[float, ...] | None = None, folder: Path | None = None
) -> Mesh:
    """Read the content of a file, see `load_mesh`; its textures are looked for in the folder.

    The colour is that of all of it, RGBA; None takes the file's own materials, and grey where it has none.
    """
    from trimesh.units import unit_conversion  # here: heavy

    if file_format not in FORMATS:
        raise MeshFileError(f"{file_format!r} is not a known format of meshes; take {', '.join(FORMATS)}.")
    try:
        scene, parts = _read(data, file_format, folder)
        if not parts and _PAINT.search(data):
            scene, parts = _read(_PAINT.sub(b"", data), file_format, folder)
        unit = unit_conversion(scene.units or "meters", "meters")  # [m]
    except Exception as error:  # its readers raise whatever a broken file leads to
        raise MeshFileError(f"This is not a {file_format.upper()} file that can be read: {error}") from error
    if not any(len(mesh.faces) for mesh, _ in parts):
        raise MeshFileError(
            f"This is not a {file_format.upper()} file that can be read: it has no triangles."
        )
    return _joined(parts, unit, color)


def _read(data: bytes, file_format: str, folder: Path | None) -> tuple[Any, list[Part]]:
    """Return trimesh's scene, and its meshes with the transforms from them to the file's frame."""
    import trimesh
    from trimesh.resolvers import FilePathResolver

    textures = FilePathResolver(str(folder)) if folder else None
    scene: Any = trimesh.load_scene(BytesIO(data), file_type=file_format, resolver=textures)
    placed = (scene.graph[node] for node in scene.graph.nodes_geometry)
    parts = [(scene.geometry[name], place) for place, name in placed]
    return scene, [(mesh, place) for mesh, place in parts if isinstance(mesh, trimesh.Trimesh)]


def _joined(parts: list[Part], unit: float, color: tuple[float, ...] | None) -> Mesh:
    meshes = [mesh for mesh, _ in parts]
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    # A file's own normals, if it has any, are in the cache; trimesh would make up others.
    smooth = all("vertex_normals" in mesh._cache for mesh in meshes)
    return Mesh(
        np.concatenate([mesh.vertices @ place[:3, :3].T + place[:3, 3] for mesh, place in parts]) * unit,
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]),
        np.concatenate([_colors(mesh) for mesh in meshes]) if color is None else color,
        np.concatenate([_normals(mesh, place) for mesh, place in parts]) if smooth else None,
    )


def _normals(mesh: Any, transform_mesh_to_file: Matrix) -> Matrix:
    """Return unit normals at a mesh's vertices, shape (V, 3), after a transform that may stretch."""
    turned = mesh.vertex_normals @ np.linalg.pinv(transform_mesh_to_file[:3, :3])
    normals: Matrix = turned / np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)
    return normals


def _colors(part: Any) -> Float32s:
    """Return the colours of a part's vertices, shape (V, 4): their own, or those of their material."""
    visual, colors = part.visual, _PLAIN
    if visual.kind == "texture" and getattr(visual.material, "image", None) and visual.uv is not None:
        visual = visual.to_color()  # the texture's, where it touches them
    if visual.kind == "vertex":
        colors = visual.vertex_colors / np.float32(255)
    elif visual.kind == "texture":
        colors = visual.material.main_color / np.float32(255)
    return np.broadcast_to(colors, (len(part.vertices), 4))
