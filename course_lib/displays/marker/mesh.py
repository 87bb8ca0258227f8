"""MESH_RESOURCE: a mesh from a file."""

from typing import Any

from course_lib.displays.marker.drawn import Drawn, Floats, label, refused, rgba, scale_of
from course_lib.errors import CourseError
from course_lib.robots.resources import resolve
from course_lib.viewer.drawables import Mesh
from course_lib.viewer.mesh_files import load_mesh


def mesh(marker: Any) -> Drawn:
    """Draw a mesh, its own units times the scale."""
    uri = marker.mesh_resource
    if not uri:
        return Drawn()
    try:
        own = load_mesh(resolve(uri))
    except CourseError:
        return refused(f"Mesh resource marker [{label(marker)}] could not load [{uri}]")
    color, scale = rgba(marker.color), scale_of(marker)
    colors = _tinted(own.colors.astype(float), color) if marker.mesh_use_embedded_materials else color
    normals = own.normals if scale.min() == scale.max() > 0 else None  # what is stretched gets new ones
    return Drawn({"mesh": Mesh(own.vertices * scale, own.faces, colors, normals)})


def _tinted(own: Floats, color: Floats) -> Floats:
    """Return the mesh's own colours, half way to a tint if one is given."""
    if not color.any():
        return own
    tinted: Floats = own + (color - own) * min(color[3], 0.5)
    tinted[..., 3] = color[3]
    return tinted
