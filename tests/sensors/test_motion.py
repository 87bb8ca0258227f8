import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.errors import CourseError
from course_lib.sensors.world import check_transform, circle, placed, straight

times = st.floats(0, 1000)


def test_straight_motion_alternates_direction_and_faces_forward() -> None:
    pose = straight((0, 0, 1), (0, 4, 1), 2.0)
    np.testing.assert_allclose(pose(0.5), placed(0, 1, 1, np.pi / 2), atol=1e-9)
    np.testing.assert_allclose(pose(2.5), placed(0, 3, 1, -np.pi / 2), atol=1e-9)
    np.testing.assert_allclose(pose(4.5), pose(0.5), atol=1e-9)


@given(times, st.sampled_from([10.0, -10.0]))
def test_circular_motion_keeps_its_radius_and_looks_ahead(seconds: float, period: float) -> None:
    pose = circle((1, 2, 3), 2.0, period)
    here, soon = pose(seconds), pose(seconds + 1e-4)
    assert np.linalg.norm(here[:3, 3] - (1, 2, 3)) == pytest.approx(2)
    step = (soon - here)[:3, 3]
    assert step / np.linalg.norm(step) @ here[:3, 0] == pytest.approx(1, abs=1e-4)


@given(times)
def test_motions_are_rigid_transforms(seconds: float) -> None:
    check_transform("circle", circle((0, 0, 0), 1, 3)(seconds))
    check_transform("straight", straight((0, 0, 0), (1, 2, 3), 1)(seconds))


def test_invalid_motions_are_reported() -> None:
    with pytest.raises(CourseError, match=r"start and goal are both \[0.0, 0.0, 0.0\]"):
        straight((0, 0, 0), (0, 0, 0), 1)
    with pytest.raises(CourseError, match=r"speed \[m/s\] is -1; expected a number > 0"):
        straight((0, 0, 0), (1, 0, 0), -1)
    with pytest.raises(CourseError, match=r"period \[s\] is 0"):
        circle((0, 0, 0), 1, 0)
    with pytest.raises(CourseError, match=r"center \[m\] has shape \(2,\)"):
        circle((0, 0), 1, 1)
