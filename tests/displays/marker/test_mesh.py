from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from course_lib.displays.markers import MarkerDrawing, hints, mesh
from course_lib.viewer.drawables import Mesh
from tests.displays.bench import marker

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n"
UPPER_ARM = "package://example-robot-data/robots/ur_description/meshes/ur10/visual/upperarm.dae"


@pytest.fixture
def obj(tmp_path: Path) -> str:
    path = tmp_path / "my mesh.obj"
    path.write_text(OBJ)
    return f"file://{tmp_path}/my%20mesh.obj"


def draw_mesh(uri: str, **fields: Any) -> Mesh:
    part = mesh(marker(Marker.MESH_RESOURCE, mesh_resource=uri, **fields)).drawables["mesh"]
    assert isinstance(part, Mesh)
    return part


def test_mesh_is_drawn_with_the_color_and_scale_of_the_marker(obj: str) -> None:
    part = draw_mesh(obj, scale=Vector3(x=2.0, y=1.0, z=1.0))
    np.testing.assert_array_equal(part.vertices.max(axis=0), [2, 1, 1])
    assert len(part.faces) == 2
    np.testing.assert_array_equal(part.colors, [1, 0, 0, 1])


def test_mesh_of_the_robot_data_is_found_by_its_package() -> None:
    pytest.importorskip("pinocchio", reason="robot data comes with pin, which has no wheels here")
    part = draw_mesh(UPPER_ARM)
    assert len(part.faces) > 1000
    assert np.ptp(part.vertices, axis=0).max() == pytest.approx(0.7, abs=0.2)  # [m]


@pytest.mark.parametrize("tint", [False, True])
def test_mesh_with_embedded_materials_is_tinted_only_on_request(obj: str, tint: bool) -> None:
    color = ColorRGBA(r=1.0, a=1.0) if tint else ColorRGBA()
    part = draw_mesh(obj, mesh_use_embedded_materials=True, color=color)
    red, green, _, alpha = np.broadcast_to(part.colors, (4, 4))[0]
    assert alpha == 1.0
    assert (red > green) == tint


@pytest.mark.parametrize(
    ("alpha", "expected"),
    # The material is (0.7, 0.7, 0.7).
    [
        (1.0, (0.85, 0.35, 0.35, 1.0)),
        (0.5, (0.675 / 0.75, 0.175 / 0.75, 0.175 / 0.75, 0.75)),
        (0.0, (0, 0, 0, 0)),
    ],
)
def test_tint_of_embedded_materials_has_half_of_their_strength_at_most(
    obj: str, alpha: float, expected: tuple[float, ...]
) -> None:
    color = ColorRGBA(r=1.0, a=alpha)
    part = draw_mesh(obj, mesh_use_embedded_materials=True, color=color)
    np.testing.assert_allclose(np.broadcast_to(part.colors, (4, 4))[0], expected, atol=1e-6)


@pytest.mark.parametrize(
    ("rgba", "expected"),
    [((1, 0, 0, 1), (1, 0, 0, 1)), ((0, 1, 0, 0.8), (0, 1, 0, 0.5)), ((0, 0, 0, 0), (0, 0, 0, 1))],
)
def test_stl_with_embedded_materials_has_only_the_color_of_the_marker(
    tmp_path: Path, rgba: tuple[float, ...], expected: tuple[float, ...]
) -> None:
    path = tmp_path / "leg.STL"
    trimesh.creation.box().export(path, file_type="stl")
    red, green, blue, alpha = map(float, rgba)
    color = ColorRGBA(r=red, g=green, b=blue, a=alpha)
    message = marker(Marker.MESH_RESOURCE, mesh_resource=path.as_uri(), color=color)
    message.mesh_use_embedded_materials = True
    part = mesh(message).drawables["mesh"]
    assert isinstance(part, Mesh)
    np.testing.assert_allclose(part.colors, expected, atol=1e-6)
    assert any("STL files have no materials" in hint for hint in hints(message)) == (not any(rgba))


@pytest.mark.parametrize(
    "uri",
    ["file:///nowhere.stl", "package://nobody/arm.stl", "https://example.org/a.stl", "arm.stl", "file:///"],
)
def test_unloadable_mesh_is_an_error_with_rviz_text(uri: str) -> None:
    drawing = mesh(marker(Marker.MESH_RESOURCE, 5, mesh_resource=uri))
    assert drawing.is_rejected
    assert drawing.status == ("error", f"Mesh resource marker [n/5] could not load [{uri}]")


def test_invalid_mesh_file_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "arm.stl"
    path.write_text("not a mesh")
    assert mesh(marker(Marker.MESH_RESOURCE, mesh_resource=f"file://{path}")).is_rejected


def test_mesh_without_a_resource_is_not_drawn_and_has_no_status() -> None:
    assert mesh(marker(Marker.MESH_RESOURCE)) == MarkerDrawing()
