"""MESH_RESOURCE: a mesh from a file."""

import os
import sys
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

from course_lib.displays.marker.drawn import Drawn, Floats, label, refused, rgba, scale_of
from course_lib.viewer.drawables import Mesh
from course_lib.viewer.mesh_files import MeshFileError, load_mesh


def mesh(marker: Any) -> Drawn:
    """Draw a mesh, its own units times the scale."""
    uri = marker.mesh_resource
    if not uri:
        return Drawn()
    try:
        own = load_mesh(resolved(uri))
    except (OSError, ValueError, MeshFileError):
        return refused(f"Mesh resource marker [{label(marker)}] could not load [{uri}]")
    color, scale = rgba(marker.color), scale_of(marker)
    colors = _tinted(own.colors.astype(float), color) if marker.mesh_use_embedded_materials else color
    normals = own.normals if scale.min() == scale.max() > 0 else None  # what is stretched gets new ones
    return Drawn({"mesh": Mesh(own.vertices * scale, own.faces, colors, normals)})


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


def _tinted(own: Floats, color: Floats) -> Floats:
    """Return the mesh's own colours, half way to a tint if one is given."""
    if not color.any():
        return own
    tinted: Floats = own + (color - own) * min(color[3], 0.5)
    tinted[..., 3] = color[3]
    return tinted
