import numpy as np
import pytest

from course_lib.errors import CourseError
from course_lib.viewer.drawables import Lines, Mesh, Points, Shape, Solids

RED = (1, 0, 0, 1)


def test_lists_become_read_only_arrays() -> None:
    lines = Lines([[0, 0, 0], [1, 0, 0]], RED)
    assert lines.points.dtype == np.float32
    with pytest.raises(ValueError, match="read-only"):
        lines.points[0, 0] = 1


def test_empty_lists_are_not_drawn() -> None:
    assert Points([], [], (0.1, 0.1)).points.shape == (0, 3)
    assert Solids("box", [], RED).placements.shape == (0, 4, 4)


def test_triangle_soup_gets_its_faces() -> None:
    assert Mesh(np.zeros((6, 3)), None, RED).faces.tolist() == [[0, 1, 2], [3, 4, 5]]


def test_number_of_colors_must_be_one_or_the_number_of_points() -> None:
    with pytest.raises(CourseError, match=r"colors has shape \(3, 4\), expected \(2, 4\) or \(4\)"):
        Lines([[0, 0, 0], [1, 0, 0]], [RED] * 3)


def test_colors_are_clipped_and_nan_is_black() -> None:
    colors = Lines([[0, 0, 0], [1, 0, 0]], [(2, -1, np.nan, 1), RED]).colors
    assert colors.tolist() == [[1, 0, 0, 1], [1, 0, 0, 1]]


def test_face_with_a_missing_vertex_is_rejected() -> None:
    with pytest.raises(CourseError, match="vertex index 3, but the last vertex is 2"):
        Mesh(np.zeros((3, 3)), [[0, 1, 3]], RED)


def test_odd_number_of_line_segment_points_is_rejected() -> None:
    with pytest.raises(CourseError, match="even number of points, but there are 3"):
        Lines(np.zeros((3, 3)), RED, strip=False)


def test_unknown_shape_is_rejected_with_the_known_ones() -> None:
    with pytest.raises(CourseError, match=r"'cube'.*box, sphere, cylinder, cone"):
        Solids("cube", [np.eye(4)], RED)  # type: ignore[arg-type]  # the mistake under test


@pytest.mark.parametrize("shape", ["box", "sphere", "cylinder", "cone"])
def test_mirrored_solid_is_drawn_with_its_outer_sides(shape: Shape) -> None:
    scales = [(-1, 2, 3), (1, -2, 3), (1, 2, -3), (-1, -2, 3), (-1, -2, -3)]
    placements = np.array([np.diag([*scale, 1.0]) for scale in scales])
    drawn = Solids(shape, placements, RED).placements
    assert (np.linalg.det(drawn) > 0).all()
    # The tip of a cone does not move.
    np.testing.assert_array_equal(drawn[:, 2, 2], placements[:, 2, 2])
    np.testing.assert_array_equal(np.abs(drawn), np.abs(placements))
