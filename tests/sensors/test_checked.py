from typing import Any

import numpy as np
import pytest

from course_lib.errors import CourseError
from course_lib.sensors.world import (
    check_array,
    check_count,
    check_limits,
    check_number,
    check_rays,
    check_transform,
    pose_function,
)


def changed(row: int, column: int, value: float) -> Any:
    matrix = np.eye(4)
    matrix[row, column] = value
    return matrix


@pytest.mark.parametrize(
    ("matrix", "text"),
    [
        (changed(0, 3, np.nan), "pose contains nan; expected finite numbers"),
        (changed(0, 0, 2), r"upper left 3x3 of pose is \[\[2.0, .*not a rotation"),
        (changed(0, 0, -1), "right-handed"),
        (changed(3, 0, 1), r"last row of pose is \[1.0, 0.0, 0.0, 1.0\]; it must be \[0, 0, 0, 1\]"),
        (np.eye(3), r"pose has shape \(3, 3\); expected numbers of shape \(4, 4\)"),
        ("here", "pose is 'here'; expected numbers"),
    ],
)
def test_invalid_transform_error_has_the_reason(matrix: Any, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        check_transform("pose", matrix)


def test_lists_are_accepted_and_results_are_read_only() -> None:
    matrix = check_transform("pose", np.eye(4).tolist())
    with pytest.raises(ValueError, match="read-only"):
        matrix[0, 0] = 2
    assert check_array("points", [(1, 2)], (-1, 2)).dtype == np.float64


def test_invalid_pose_from_a_function_is_reported_with_the_time() -> None:
    pose = pose_function("pose of lidar", lambda seconds: changed(0, 3, np.nan if seconds > 1 else 0))
    pose(0.5)
    with pytest.raises(CourseError, match=r"pose of lidar at 1\.5 s contains nan"):
        pose(1.5)


@pytest.mark.parametrize("count", [0, -3, 2.5, "many", True, None])
def test_counts_are_positive_integers(count: Any) -> None:
    with pytest.raises(CourseError, match=f"beams is {count!r}; expected a whole number, 1 or more"):
        check_count("beams", count)


def test_out_of_range_numbers_are_reported() -> None:
    with pytest.raises(CourseError, match="dropout is 2; expected a number >= 0 and <= 1"):
        check_number("dropout", 2, low=0, high=1)
    with pytest.raises(CourseError, match=r"range_max \[m\] is 1; expected a number > 3"):
        check_limits("range", "m", 3, 1)


@pytest.mark.parametrize(
    ("rays", "text"),
    [
        (np.ones((720, 3)), r"rays have shape \(720, 3\); expected one or more as columns, shape \(3, N\)"),
        (np.empty((3, 0)), r"rays have shape \(3, 0\)"),
        ([[1, 2], [0, 0], [0, 0]], r"A ray is \[2.0, 0.0, 0.0\]; divide rays by their length"),
        ([[1, np.nan], [0, 0], [0, 0]], r"A ray is \[nan, 0.0, 0.0\]"),
    ],
)
def test_invalid_rays_are_reported(rays: Any, text: str) -> None:
    with pytest.raises(CourseError, match=text):
        check_rays(rays)
