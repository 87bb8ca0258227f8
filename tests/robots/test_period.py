import math

import pytest

from course_lib.errors import CourseError
from course_lib.robots.mobile_manipulator import OmniBase, mobile_manipulator
from course_lib.robots.trajectory import JointTrajectoryController, period_of
from course_lib.ros.graph.graph import Graph


def test_period_is_the_reciprocal_of_the_rate() -> None:
    assert period_of(20) == 0.05


@pytest.mark.parametrize("rate", [0, -1.0, math.nan, math.inf])
def test_every_node_rejects_an_invalid_rate(graph: Graph, rate: float) -> None:
    urdf = mobile_manipulator().urdf
    for make in (period_of, lambda r: OmniBase(rate=r), lambda r: JointTrajectoryController(urdf, rate=r)):
        with pytest.raises(CourseError, match="expected a positive number"):
            make(rate)
