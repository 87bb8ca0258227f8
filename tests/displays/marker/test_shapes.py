from math import pi

import numpy as np
import pytest
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from course_lib.displays.markers import MarkerDrawing, arrow, solid, text
from course_lib.viewer.drawables import Solids, Text
from tests.displays.bench import marker, points


def part(drawn: MarkerDrawing, name: str) -> Solids:
    found = drawn.drawables[name]
    assert isinstance(found, Solids)
    return found


def ends(solids: Solids) -> tuple[np.ndarray, np.ndarray]:
    """Return where bottom and top of a solid are."""
    placement = solids.placements[0].astype(float)
    return placement @ [0, 0, -0.5, 1], placement @ [0, 0, 0.5, 1]


@pytest.mark.parametrize(
    ("kind", "shape"), [(Marker.CUBE, "box"), (Marker.SPHERE, "sphere"), (Marker.CYLINDER, "cylinder")]
)
def test_scale_of_a_solid_is_its_full_extent(kind: int, shape: str) -> None:
    drawing = solid(marker(kind, scale=Vector3(x=1.0, y=2.0, z=3.0)))
    assert part(drawing, "body").shape == shape
    np.testing.assert_array_equal(part(drawing, "body").placements[0], np.diag([1.0, 2.0, 3.0, 1.0]))
    assert drawing.status is None


@pytest.mark.parametrize("kind", [Marker.CUBE, Marker.SPHERE, Marker.CYLINDER, Marker.ARROW])
def test_zero_scale_causes_a_warning_with_rviz_text(kind: int) -> None:
    draw = arrow if kind == Marker.ARROW else solid
    drawing = draw(marker(kind, scale=Vector3(x=1.0, y=0.0, z=1.0)))
    assert drawing.status == ("warn", "Scale of 0 in one of x/y/z")


def test_colors_are_clipped_to_the_valid_range() -> None:
    drawing = solid(marker(color=ColorRGBA(r=255.0, g=0.5, b=-1.0, a=1.0)))
    np.testing.assert_array_equal(part(drawing, "body").colors, [1.0, 0.5, 0.0, 1.0])


@pytest.mark.parametrize("count", [0, 3])
def test_arrow_without_two_points_extends_from_its_pose_along_x(count: int) -> None:
    shape = marker(
        Marker.ARROW, scale=Vector3(x=2.0, y=0.2, z=0.4), points=points(*[(1.0, 1.0, 1.0)] * count)
    )
    drawing = arrow(shape)
    tail, neck = ends(part(drawing, "shaft"))
    base, tip = ends(part(drawing, "head"))
    np.testing.assert_allclose(tail[:3], [0, 0, 0], atol=1e-6)
    np.testing.assert_allclose(neck[:3], [0.77 * 2, 0, 0], atol=1e-6)
    np.testing.assert_allclose(base, neck, atol=1e-6)
    np.testing.assert_allclose(tip[:3], [2, 0, 0], atol=1e-6)


def test_arrow_is_scaled_in_y_and_z_and_its_head_is_twice_as_wide() -> None:
    drawing = arrow(marker(Marker.ARROW, scale=Vector3(x=2.0, y=0.2, z=0.4)))
    extents = [
        np.linalg.norm(part(drawing, name).placements[0][:3, :3], axis=1) for name in ("shaft", "head")
    ]
    np.testing.assert_allclose(extents[0], [0.77 * 2, 0.2, 0.4], atol=1e-6)
    np.testing.assert_allclose(extents[1], [0.23 * 2, 0.4, 0.8], atol=1e-6)


@pytest.mark.parametrize(
    ("head", "length"), [(0.0, 0.23 * 5), (0.5, 0.5), (9.0, 5.0)], ids=["default", "given", "longer than all"]
)
def test_two_point_arrow_has_diameters_and_a_head_length(head: float, length: float) -> None:
    scale = Vector3(x=0.1, y=0.3, z=head)
    drawing = arrow(marker(Marker.ARROW, scale=scale, points=points((1.0, 0.0, 0.0), (1.0, 3.0, 4.0))))
    tail, neck = ends(part(drawing, "shaft"))
    base, tip = ends(part(drawing, "head"))
    np.testing.assert_allclose(tail[:3], [1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(tip[:3], [1, 3, 4], atol=1e-6)
    assert np.linalg.norm(tip - base) == pytest.approx(length, abs=1e-6)
    np.testing.assert_allclose(neck, base, atol=1e-6)
    widths = [np.linalg.norm(part(drawing, name).placements[0][:3, 0]) for name in ("shaft", "head")]
    np.testing.assert_allclose(widths, [0.1, 0.3], atol=1e-6)


def test_two_point_arrow_without_diameters_causes_a_warning() -> None:
    shape = marker(Marker.ARROW, scale=Vector3(z=1.0), points=points((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
    assert arrow(shape).status == ("warn", "Scale of 0 in both x and y")


def test_arrow_with_two_equal_points_is_not_drawn() -> None:
    assert arrow(marker(Marker.ARROW, points=points(*[(1.0, 2.0, 3.0)] * 2))).drawables == {}


def test_arrow_with_one_point_is_rejected() -> None:
    drawing = arrow(marker(Marker.ARROW, 7, points=points((1.0, 0.0, 0.0))))
    assert drawing.is_rejected
    assert drawing.status == (
        "error",
        "Arrow marker [n/7] only specified one point of a point to point arrow.",
    )


def test_text_height_is_the_z_scale() -> None:
    drawing = text(marker(Marker.TEXT_VIEW_FACING, text="Person (0.95)", scale=Vector3(z=0.3)))
    words = drawing.drawables["text"]
    assert isinstance(words, Text)
    assert words.text == "Person (0.95)"
    assert words.height == pytest.approx(0.3)


@pytest.mark.parametrize(("x", "in_letters"), [(0.0, 0.0), (0.6, 2.0), (-0.6, 2.0)])
def test_text_has_spaces_of_the_x_scale_unless_it_is_zero(x: float, in_letters: float) -> None:
    drawing = text(marker(Marker.TEXT_VIEW_FACING, text="a b", scale=Vector3(x=x, z=0.3)))
    words = drawing.drawables["text"]
    assert isinstance(words, Text)
    assert words.space_width == pytest.approx(in_letters)


@pytest.mark.parametrize(("words", "height"), [("", 1.0), ("hello", 0.0)])
def test_empty_text_or_text_of_zero_height_is_not_drawn_and_has_no_status(words: str, height: float) -> None:
    drawing = text(marker(Marker.TEXT_VIEW_FACING, text=words, scale=Vector3(z=height)))
    assert drawing == MarkerDrawing()


def test_proportions_of_an_arrow_add_up_to_its_length() -> None:
    drawing = arrow(marker(Marker.ARROW, scale=Vector3(x=pi, y=1.0, z=1.0)))
    assert ends(part(drawing, "head"))[1][0] == pytest.approx(pi)
