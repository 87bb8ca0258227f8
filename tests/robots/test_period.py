import math

import pytest

from course_lib.errors import CourseError
from course_lib.robots.joint_trajectory_controller import JointTrajectoryController
from course_lib.robots.mobile_manipulator import OmniBase, mobile_manipulator
from course_lib.robots.period import period_of
from course_lib.ros.graph import Graph


def test_a_period_is_one_through_the_rate() -> None:
    assert period_of(20) == 0.05


@pytest.mark.parametrize("rate", [0, -1.0, math.nan, math.inf])
def test_a_rate_that_is_none_is_refused_by_every_node(graph: Graph, rate: float) -> None:
    urdf = mobile_manipulator().urdf
    for make in (period_of, lambda r: OmniBase(rate=r), lambda r: JointTrajectoryController(urdf, rate=r)):
        with pytest.raises(CourseError, match="expected one above 0"):
            make(rate)
