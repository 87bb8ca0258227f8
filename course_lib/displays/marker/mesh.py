"""MESH_RESOURCE: a mesh from a file."""

import os
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

import numpy as np
import numpy.typing as npt

from course_lib.displays.marker.drawn import Drawn, Floats, label, refused, rgba
from course_lib.viewer.drawables import Mesh

_OWN_COLOR = np.array([0.9, 0.9, 0.9, 1.0])  # of a mesh that brings its materials
Triangles = tuple[Floats, npt.NDArray[np.int64]]


def mesh(marker: Any) -> Drawn:
    """Draw a mesh, its own units times the scale."""
    uri = marker.mesh_resource
    if not uri:
        return Drawn()
    try:
        path = resolved(uri)
        vertices, faces = _loaded(path, path.stat().st_mtime_ns)
    except (OSError, ValueError, ImportError):
        return refused(f"Mesh resource marker [{label(marker)}] could not load [{uri}]")
    color = rgba(marker.color)
    if marker.mesh_use_embedded_materials:
        color = _tinted(color)
    scale = np.array([marker.scale.x, marker.scale.y, marker.scale.z])
    return Drawn({"mesh": Mesh(vertices * scale, faces, color)})


def resolved(uri: str) -> Path:
    """Return the file of a ``package://`` or ``file://`` address.

    Packages are those of the robot data that comes with the kit, and those on ROS_PACKAGE_PATH.

    Raises:
        ValueError: If it is no such address.
        FileNotFoundError: If no such file exists.
    """
    parts = urlparse(uri)
    if parts.scheme == "file":
        return Path(unquote(parts.path))
    if parts.scheme != "package":
        raise ValueError(uri)
    roots = [Path(root) for root in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if root]
    roots += [Path(entry) / "cmeel.prefix" / "share" for entry in sys.path if entry]
    candidates = (root / parts.netloc / unquote(parts.path).lstrip("/") for root in roots)
    found = next((path for path in candidates if path.is_file()), None)
    if found is None:
        raise FileNotFoundError(uri)
    return found


@lru_cache(maxsize=64)
def _loaded(path: Path, _changed_ns: int) -> Triangles:
    """Return vertices (V, 3), [m], and corners of the faces (F, 3) of an STL, OBJ or DAE file."""
    import coal  # type: ignore[import-untyped]  # here: heavy, and absent on Windows

    model = coal.MeshLoader().load(str(path), np.ones(3))
    faces = [model.tri_indices(i) for i in range(model.num_tris)]
    return np.array(model.vertices()), np.array([(face[0], face[1], face[2]) for face in faces])


def _tinted(color: Floats) -> Floats:
    """Return the mesh's own colour, half way to a tint if one is given."""
    if not color.any():
        return _OWN_COLOR
    tinted: Floats = _OWN_COLOR + (color - _OWN_COLOR) * min(color[3], 0.5)
    tinted[3] = color[3]
    return tinted
