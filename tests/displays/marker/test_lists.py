import numpy as np
import pytest
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

from course_lib.displays.markers import MarkerDrawing, lines, spots
from course_lib.viewer.drawables import Lines, Points
from tests.displays.bench import marker, points

FOUR = points((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 2.0))
BLUE = ColorRGBA(b=1.0, a=1.0)
THIN = Vector3(x=0.1)


def only(drawn: MarkerDrawing) -> Lines | Points:
    (part,) = drawn.drawables.values()
    assert isinstance(part, Lines | Points)
    return part


@pytest.mark.parametrize(("kind", "strip"), [(Marker.LINE_STRIP, True), (Marker.LINE_LIST, False)])
def test_line_width_is_the_x_scale(kind: int, strip: bool) -> None:
    part = only(lines(marker(kind, points=FOUR, scale=THIN)))
    assert isinstance(part, Lines)
    assert part.width == pytest.approx(0.1)
    assert part.strip == strip
    np.testing.assert_array_equal(part.points[3], [0, 1, 2])


def test_odd_number_of_line_list_points_is_an_error() -> None:
    drawing = lines(marker(Marker.LINE_LIST, 3, points=FOUR[:3], scale=THIN))
    assert (drawing.drawables, drawing.is_rejected) == ({}, False)
    assert drawing.status == ("error", "Line list marker [n/3] has an odd number of points.")


@pytest.mark.parametrize(("count", "width"), [(4, 0.0), (0, 0.1), (1, 0.1)])
def test_lines_without_width_or_points_are_not_drawn_and_have_no_status(count: int, width: float) -> None:
    shape = marker(Marker.LINE_STRIP, points=FOUR[:count], scale=Vector3(x=width))
    assert lines(shape) == MarkerDrawing()


@pytest.mark.parametrize("count", [0, 3, 5])
def test_colors_that_do_not_match_the_points_are_ignored(count: int) -> None:
    shape = marker(Marker.LINE_STRIP, points=FOUR, colors=[BLUE] * count, scale=THIN)
    np.testing.assert_array_equal(only(lines(shape)).colors, [1, 0, 0, 1])
    shape.type = Marker.CUBE_LIST
    np.testing.assert_array_equal(only(spots(shape)).colors, [[1, 0, 0, 1]] * 4)


@pytest.mark.parametrize("kind", [Marker.LINE_LIST, Marker.POINTS, Marker.CUBE_LIST, Marker.SPHERE_LIST])
def test_colors_matching_the_points_are_used(kind: int) -> None:
    draw = lines if kind == Marker.LINE_LIST else spots
    part = only(draw(marker(kind, points=FOUR, colors=[BLUE] * 4)))
    np.testing.assert_array_equal(part.colors, [[0, 0, 1, 1]] * 4)


@pytest.mark.parametrize(
    ("kind", "spot"), [(Marker.POINTS, "square"), (Marker.CUBE_LIST, "box"), (Marker.SPHERE_LIST, "sphere")]
)
def test_each_list_element_has_the_full_extent_of_the_scale(kind: int, spot: str) -> None:
    part = only(spots(marker(kind, points=FOUR, scale=Vector3(x=0.4, y=0.3, z=0.2))))
    assert isinstance(part, Points)
    assert (part.spot, part.pixels) == (spot, False)
    assert part.size == pytest.approx((0.4, 0.3, 0.2))
    np.testing.assert_array_equal(part.points[3], [0, 1, 2])


def test_points_are_drawn_twice_and_the_alpha_of_a_uniform_color_is_applied_twice() -> None:
    shape = marker(Marker.CUBE_LIST, points=FOUR, color=ColorRGBA(r=1.0, a=0.5))
    np.testing.assert_allclose(only(spots(shape)).colors[0], [1, 0, 0, 1 - (1 - 0.25) ** 2])
    shape.colors = [ColorRGBA(r=1.0, a=0.5)] * 4
    np.testing.assert_allclose(only(spots(shape)).colors[0], [1, 0, 0, 1 - (1 - 0.5) ** 2])


def test_fully_transparent_points_cause_a_warning_but_a_uniform_color_does_not() -> None:
    shape = marker(Marker.POINTS, points=FOUR, colors=[ColorRGBA(r=1.0)] * 4)
    assert spots(shape).status == ("warn", "All points have a zero alpha value.")
    assert spots(marker(Marker.POINTS, points=FOUR, color=ColorRGBA(r=1.0))).status is None


def test_sphere_list_without_points_is_not_drawn_and_has_no_status() -> None:
    assert spots(marker(Marker.SPHERE_LIST)) == MarkerDrawing()


def test_nan_color_is_drawn_black() -> None:
    nan = ColorRGBA(r=float("nan"), a=1.0)
    np.testing.assert_array_equal(
        only(spots(marker(Marker.POINTS, points=FOUR, colors=[nan] * 4))).colors[0], [0, 0, 0, 1]
    )
