import numpy as np
import numpy.typing as npt
import pytest

from course_lib.errors import CourseError
from course_lib.robots.mobile_manipulator import Wall, flatness

WALL = Wall(2.0, (-1.0, 1.0), (0.0, 2.4))  # [m]
AREA, WIDTH = 2.0 * 2.4, 0.2  # [m²], [m]
SPOT = np.pi * WIDTH**2 / 4  # [m²]


def line(start: tuple[float, float, float], end: tuple[float, float, float]) -> npt.NDArray[np.float64]:
    return np.linspace(start, end, 15)


def within_2_percent(value: float) -> object:
    return pytest.approx(value, rel=0.02)


def test_straight_stripe_covers_its_length_times_its_width_plus_one_spot() -> None:
    stripe = line((1.9, 0.11, 0.6), (1.9, 0.11, 1.9))
    assert WALL.coverage([stripe]) == within_2_percent((1.3 * WIDTH + SPOT) / AREA)


def test_slanted_stripe_covers_the_same_area() -> None:
    stripe = line((1.9, -0.5, 0.6), (1.9, 0.5, 1.9))
    assert WALL.coverage([stripe]) == within_2_percent((np.hypot(1.0, 1.3) * WIDTH + SPOT) / AREA)


def test_curved_stripe_on_the_wall_covers_its_arc() -> None:
    angles = np.linspace(0.3, 1.4, 200)
    stripe = np.array([np.full(200, 1.9), np.cos(angles) - 0.5, np.sin(angles) + 0.4]).T  # radius 1 m
    assert WALL.coverage([stripe]) == within_2_percent((1.1 * WIDTH + SPOT) / AREA)


def test_overlap_of_two_stripes_is_counted_once() -> None:
    stripes = [line((1.9, y, 0.6), (1.9, y, 1.9)) for y in (0.0, 0.15)]
    half, d = WIDTH / 2, 0.15
    shared_spot = 2 * half**2 * np.arccos(d / WIDTH) - d / 2 * np.sqrt(4 * half**2 - d**2)
    both = 1.3 * (WIDTH + d) + 2 * SPOT - shared_spot
    assert WALL.coverage(stripes) == within_2_percent(both / AREA)


def test_paint_next_to_the_wall_or_too_far_in_front_of_it_is_not_counted() -> None:
    beside, far = line((1.9, 1.2, 0.6), (1.9, 1.2, 1.9)), line((1.6, 0.0, 0.6), (1.6, 0.0, 1.9))
    assert WALL.coverage([beside, far]) == 0.0
    half_beside = line((1.9, 1.0, 0.6), (1.9, 1.0, 1.9))
    assert WALL.coverage([half_beside]) == within_2_percent((1.3 * WIDTH + SPOT) / 2 / AREA)


def test_only_the_near_part_of_a_stripe_that_bends_away_is_counted() -> None:
    stripe = line((1.9, 0.0, 0.4), (1.4, 0.0, 1.9))  # 0.1 … 0.6 m before the wall, 0.3 m after 2 / 5 of it
    assert WALL.coverage([stripe]) == within_2_percent((0.6 * WIDTH + SPOT) / AREA)


def test_coverage_is_0_without_paint_and_1_for_a_fully_painted_wall() -> None:
    assert WALL.coverage([]) == 0.0
    small = Wall(2.0, (-0.2, 0.2), (1.0, 1.4))
    assert small.coverage([line((1.9, 0.0, 1.2), (1.9, 0.0, 1.21))], width=2.0) == 1.0


def test_flatness_is_the_depth_of_an_arc() -> None:
    angles = np.linspace(-0.5, 0.5, 101)
    arc = np.array([np.cos(angles), np.zeros(101), np.sin(angles)]).T  # radius 1 m
    assert flatness([arc]) == pytest.approx(1 - np.cos(0.5))
    assert flatness([line((1.9, 0.0, 0.6), (1.9, 0.3, 1.9))]) == flatness([]) == 0.0


def test_invalid_stripes_are_rejected() -> None:
    with pytest.raises(CourseError, match=r"A stripe has shape \(2,\); expected finite points"):
        WALL.coverage([[1.0, 2.0]])
    with pytest.raises(CourseError, match="expected finite points"):
        flatness([[[np.nan, 0.0, 0.0]] * 2])


def test_wall_without_an_area_is_rejected() -> None:
    with pytest.raises(CourseError, match="has no area"):
        Wall(2.0, (1.0, -1.0), (0.0, 2.4))


def test_front_face_of_the_wall_marker_is_at_the_wall() -> None:
    marker = WALL.marker()
    assert marker.pose.position.x - marker.scale.x / 2 == pytest.approx(WALL.x)
    assert (marker.scale.y, marker.scale.z) == (2.0, 2.4)
