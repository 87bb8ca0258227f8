from io import BytesIO
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Vector3
from PIL import Image
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, UVCoordinate

from course_lib.displays import markers
from course_lib.displays.images import decode_compressed
from course_lib.displays.markers import hints, triangles
from course_lib.viewer.drawables import Mesh
from tests.displays.bench import Bench, marker, points

SIX = points(*[(float(i), float(i % 2), 0.0) for i in range(6)])


def draw_triangles(**fields: Any) -> Mesh:
    part = triangles(marker(Marker.TRIANGLE_LIST, points=SIX, **fields)).drawables["mesh"]
    assert isinstance(part, Mesh)
    return part


def clear(alpha: float, count: int) -> list[ColorRGBA]:
    return [ColorRGBA(g=1.0, a=alpha) for _ in range(count)]


def test_triangles_without_colors_are_shaded_in_the_marker_color() -> None:
    mesh = draw_triangles(scale=Vector3(x=2.0, y=1.0, z=1.0))
    assert mesh.lit
    np.testing.assert_array_equal(mesh.colors, [1, 0, 0, 1])
    np.testing.assert_array_equal(mesh.vertices[3], [6, 1, 0])


@pytest.mark.parametrize("count", [6, 2], ids=["each corner", "each face"])
def test_triangles_with_colors_are_not_shaded(count: int) -> None:
    mesh = draw_triangles(colors=clear(1.0, count))
    assert not mesh.lit
    np.testing.assert_array_equal(mesh.colors, [[0, 1, 0, 1]] * 6)


@pytest.mark.parametrize("count", [1, 3, 5, 7])
def test_colors_that_match_neither_vertices_nor_faces_are_ignored(count: int) -> None:
    np.testing.assert_array_equal(draw_triangles(colors=clear(1.0, count)).colors, [1, 0, 0, 1])


@pytest.mark.parametrize(
    ("count", "own", "each", "alpha"),
    [
        (6, 0.5, 1.0, 1.0),  # opaque corners: RViz does not blend them, regardless of the marker's alpha
        (6, 0.5, 0.5, 0.25),
        (2, 1.0, 0.5, 1.0),  # faces are blended only if the marker is
        (2, 0.5, 0.5, 0.25),
    ],
)
def test_triangles_are_blended_as_in_rviz(count: int, own: float, each: float, alpha: float) -> None:
    mesh = draw_triangles(color=ColorRGBA(r=1.0, a=own), colors=clear(each, count))
    np.testing.assert_allclose(mesh.colors[:, 3], alpha)


@pytest.mark.parametrize(
    ("count", "text"),
    [
        (0, "TriMesh marker [n/0] has no points."),
        (4, "TriMesh marker [n/0] has a point count which is not divisible by 3 [4]"),
    ],
)
def test_points_that_do_not_form_triangles_are_rejected(count: int, text: str) -> None:
    drawing = triangles(marker(Marker.TRIANGLE_LIST, points=SIX[:count]))
    assert drawing.is_rejected
    assert drawing.status == ("error", text)


def test_zero_scale_causes_a_warning() -> None:
    drawing = triangles(marker(Marker.TRIANGLE_LIST, points=SIX, scale=Vector3(x=1.0, y=1.0)))
    assert drawing.status == ("warn", "Scale of 0 in one of x/y/z")


# A square of 1 m as two triangles, with the image upright: v is 0 at the top.
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
QUARTERS = np.array(
    [[(255, 0, 0, 255), (0, 255, 0, 255)], [(0, 0, 255, 255), (255, 255, 255, 128)]], np.uint8
)


def textured(**fields: Any) -> Marker:
    file = BytesIO()
    Image.fromarray(QUARTERS).save(file, "png")
    return marker(
        Marker.TRIANGLE_LIST,
        points=points(*[(x, y, 0.0) for x, y in SQUARE]),
        uv_coordinates=[UVCoordinate(u=x, v=1.0 - y) for x, y in SQUARE],
        texture_resource="embedded://quarters",
        texture=CompressedImage(format="png", data=file.getvalue()),
        **{"color": ColorRGBA(r=1.0, g=1.0, b=1.0, a=1.0)} | fields,
    )


def colors_at(message: Marker, *places: tuple[float, float]) -> list[list[float]]:
    """Return the colors of the vertices nearest to places on the square."""
    mesh = triangles(message).drawables["mesh"]
    assert isinstance(mesh, Mesh)
    assert mesh.lit
    distances = [np.linalg.norm(mesh.vertices[:, :2] - place, axis=1) for place in places]
    return [np.round(mesh.colors[distance.argmin()], 2).tolist() for distance in distances]


def test_embedded_texture_is_drawn_upright_and_tinted_by_the_marker_color() -> None:
    quarters = [(0.2, 0.8), (0.8, 0.8), (0.2, 0.2), (0.8, 0.2)]
    white = [[1, 0, 0, 1], [0, 1, 0, 1], [0, 0, 1, 1], [1, 1, 1, 0.5]]
    assert colors_at(textured(), *quarters) == white
    assert colors_at(textured(), (0.0, 1.0), (1.0, 1.0), (0.0, 0.0)) == white[:3]
    half = colors_at(textured(color=ColorRGBA(r=0.5, g=0.5, b=0.5, a=1.0)), *quarters)
    assert half == [[0.5, 0, 0, 1], [0, 0.5, 0, 1], [0, 0, 0.5, 1], [0.5, 0.5, 0.5, 0.5]]
    assert colors_at(textured(colors=clear(1.0, 6)), *quarters) == white
    assert hints(textured()) == ()


@pytest.mark.parametrize(
    "fields",
    [{"uv_coordinates": []}, {"texture_resource": "file:///a.png"}, {"texture": CompressedImage()}],
    ids=["no coordinates", "a file", "no image"],
)
def test_triangles_have_the_marker_color_where_rviz_draws_no_texture(fields: dict[str, Any]) -> None:
    message = textured()
    for name, value in fields.items():
        setattr(message, name, value)
    mesh = triangles(message).drawables["mesh"]
    assert isinstance(mesh, Mesh)
    assert len(mesh.vertices) == 6
    assert hints(message) != ()


def test_texture_of_a_message_is_decoded_once_for_its_drawing_and_its_hints(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    decoded: list[object] = []

    def count(*arguments: Any) -> Any:
        decoded.append(arguments)
        return decode_compressed(*arguments)

    monkeypatch.setattr(markers, "decode_compressed", count)
    bench = Bench()
    for x in (1.0, 2.0):
        message = textured(color=ColorRGBA(r=0.1, g=0.2, b=0.3, a=1.0))
        message.texture.data = [*message.texture.data, 0]
        message.pose.position.x = x
        bench.show(message)
    assert len(decoded) == 1
