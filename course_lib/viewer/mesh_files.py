"""Meshes from files, read once into the arrays that are drawn."""

from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np

from course_lib.errors import CourseError
from course_lib.viewer.arrays import Floats
from course_lib.viewer.collada import read_collada
from course_lib.viewer.drawables import Mesh

_STL = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])


class MeshFileError(CourseError):
    """A mesh file cannot be read."""


@lru_cache(maxsize=128)
def load_mesh(path: Path, color: tuple[float, float, float, float] | None = None) -> Mesh:
    """Read a DAE, STL or OBJ file.

    Args:
        path: The file; it is read once, as a program's meshes do not change.
        color: RGBA of all of it; None takes the file's own materials, and grey where it has none.

    Raises:
        MeshFileError: If it is no such file, or a broken one.
    """
    try:
        return parse_mesh(path.read_bytes(), path.suffix.lstrip(".").lower(), color)
    except (OSError, MeshFileError) as error:
        raise MeshFileError(f"{path}: {error}") from error


@lru_cache(maxsize=128)
def parse_mesh(data: bytes, file_format: str, color: tuple[float, float, float, float] | None = None) -> Mesh:
    """Read the content of a file, see `load_mesh`."""
    reader = _READERS.get(file_format)
    if reader is None:
        raise MeshFileError(
            f"{file_format!r} is no format of meshes that is known; take {', '.join(_READERS)}."
        )
    try:
        mesh = reader(data)
        if not len(mesh.faces):
            raise ValueError("it has no triangles.")
    except (ValueError, LookupError, SyntaxError, CourseError) as error:  # XML's ParseError is a SyntaxError
        raise MeshFileError(f"This is no {file_format.upper()} file that can be read: {error}") from error
    return mesh if color is None else Mesh(mesh.vertices, mesh.faces, color, mesh.normals)


def _read_stl(data: bytes) -> Mesh:
    count = int.from_bytes(data[80:84], "little")
    if len(data) >= 84 + 50 * count > 84:
        corners = np.frombuffer(data, _STL, count, 84)["corners"]
    else:
        numbers = [line.split()[1:] for line in data.decode().splitlines() if line.split()[:1] == ["vertex"]]
        corners = np.array(numbers, float)
    return _soup(corners.reshape(-1, 3))


def _read_obj(data: bytes) -> Mesh:
    vertices: list[list[str]] = []
    faces: list[tuple[int, int, int]] = []
    for line in data.decode("utf-8", "replace").splitlines():
        kind, *words = line.split() or [""]
        if kind == "v":
            vertices.append(words[:3])
        elif kind == "f":
            numbers = [int(word.partition("/")[0]) for word in words]
            corners = [number - 1 if number > 0 else number + len(vertices) for number in numbers]
            faces += [(corners[0], b, c) for b, c in pairwise(corners[1:])]
    return Mesh(np.array(vertices, float), np.array(faces), _GREY)


def _soup(corners: Floats) -> Mesh:
    """Join equal corners of triangles, shape (3 * T, 3)."""
    vertices, faces = np.unique(corners, axis=0, return_inverse=True)
    return Mesh(vertices, faces.reshape(-1, 3), _GREY)


_GREY = np.array([0.7, 0.7, 0.7, 1.0])
_READERS: dict[str, Callable[[bytes], Mesh]] = {"dae": read_collada, "stl": _read_stl, "obj": _read_obj}
