from typing import Any

import pytest
from geometry_msgs.msg import Pose, Quaternion, Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, UVCoordinate

from course_lib.displays.markers import hints
from tests.displays.bench import marker, points

TWO = points((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
THREE = [*TWO, *points((0.0, 1.0, 0.0))]
CORNERS = [UVCoordinate(), UVCoordinate(u=1.0), UVCoordinate(v=1.0)]
RED = ColorRGBA(r=1.0, a=1.0)
FLAT = Vector3()

SILENT: dict[str, tuple[int, dict[str, Any], str]] = {
    "alpha 0": (Marker.CUBE, {"color": ColorRGBA(r=1.0)}, "color.a is 0"),
    "alpha 0, colours that do not count": (
        Marker.POINTS,
        {"points": TWO, "color": ColorRGBA(), "colors": [RED]},
        "color.a is 0",
    ),
    "too few colours": (Marker.POINTS, {"points": TWO, "colors": [RED]}, "one entry for each point"),
    "line without width": (Marker.LINE_STRIP, {"points": TWO, "scale": FLAT}, "the width of the line"),
    "points without size": (Marker.POINTS, {"points": TWO, "scale": FLAT}, "the size of the points"),
    "cubes without size": (Marker.CUBE_LIST, {"points": TWO, "scale": FLAT}, "0 in one of x/y/z"),
    "too many points": (Marker.POINTS, {"points": TWO * 50_001}, "100,002 points make every message slow"),
    "no points": (Marker.SPHERE_LIST, {}, "points is empty"),
    "text without height": (Marker.TEXT_VIEW_FACING, {"text": "hi", "scale": FLAT}, "height of the letters"),
    "text without glyphs": (
        Marker.TEXT_VIEW_FACING,
        {"text": "ロボット 1"},
        "characters 'ロボット', so boxes",
    ),
    "no text": (Marker.TEXT_VIEW_FACING, {}, "text is empty"),
    "no mesh": (Marker.MESH_RESOURCE, {}, "mesh_resource is empty"),
    "texture in a file": (
        Marker.TRIANGLE_LIST,
        {"points": THREE, "texture_resource": "file:///a.png", "uv_coordinates": CORNERS},
        "only if the name begins with embedded://",
    ),
    "texture without coordinates": (
        Marker.TRIANGLE_LIST,
        {"points": THREE, "texture_resource": "embedded://a"},
        "one entry for each point",
    ),
    "texture that is not an image": (
        Marker.TRIANGLE_LIST,
        {"points": THREE, "texture_resource": "embedded://a", "uv_coordinates": CORNERS},
        "not a PNG or JPEG file",
    ),
    "arrow strip": (Marker.ARROW_STRIP, {}, "Unknown marker type: 12"),
    "no rotation": (
        Marker.CUBE,
        {"pose": Pose(orientation=Quaternion(x=0.0, y=0.0, z=0.0, w=0.0))},
        "Set orientation.w = 1.0",
    ),
    "long rotation": (Marker.CUBE, {"pose": Pose(orientation=Quaternion(z=1.0, w=1.0))}, "(0, 0, 1, 1)"),
}

FINE: dict[str, tuple[int, dict[str, Any]]] = {
    "cube": (Marker.CUBE, {}),
    "own colours": (Marker.POINTS, {"points": TWO, "color": ColorRGBA(), "colors": [RED, RED]}),
    "a colour for each face": (Marker.TRIANGLE_LIST, {"points": THREE, "colors": [RED]}),
    "materials of the mesh": (
        Marker.MESH_RESOURCE,
        {"color": ColorRGBA(), "mesh_resource": "file:///a.dae", "mesh_use_embedded_materials": True},
    ),
    "rounded rotation": (Marker.CUBE, {"pose": Pose(orientation=Quaternion(z=0.7071, w=0.7071))}),
    "accents and Arabic": (Marker.TEXT_VIEW_FACING, {"text": "Zoë روبوت"}),
    "colours of a cube": (Marker.CUBE, {"colors": [RED]}),
}


@pytest.mark.parametrize("name", SILENT)
def test_markers_that_rviz_silently_ignores_have_a_hint(name: str) -> None:
    kind, fields, text = SILENT[name]
    assert any(text in hint for hint in hints(marker(kind, **fields)))


@pytest.mark.parametrize("name", FINE)
def test_valid_markers_have_no_hint(name: str) -> None:
    kind, fields = FINE[name]
    assert hints(marker(kind, **fields)) == ()
