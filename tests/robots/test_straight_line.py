import numpy as np
import numpy.typing as npt
import pytest
from rclpy.time import Time

from course_lib.errors import CourseError
from course_lib.robots.kinematics import joints_for, link_poses, straight_line
from course_lib.robots.mobile_manipulator import START, mobile_manipulator
from course_lib.robots.trajectory import sample, waypoints_of

WRIST = "ur10wrist_3_link"
AT_THE_WALL = np.array([[0, 1, 0, 1.7], [-1, 0, 0, 0.16], [0, 0, 1, 2.0], [0, 0, 0, 1]])  # wrist in base_link


def driven(
    start: dict[str, float], goal: tuple[float, float, float], seconds: float
) -> npt.NDArray[np.float64]:
    """Poses of the wrist, shape (N, 4, 4), as the controller's splines go, every 5 ms."""
    robot = mobile_manipulator()
    message = straight_line(robot, WRIST, start, goal, seconds=seconds)
    waypoints = waypoints_of(message, message.joint_names, Time(seconds=1))
    times = np.arange(0.0, seconds + 0.005, 0.005)
    positions = [sample(waypoints, time)[0].tolist() for time in times]
    return np.array(
        [link_poses(robot, dict(zip(message.joint_names, q, strict=True)))[WRIST] for q in positions]
    )


@pytest.mark.parametrize("goal", [(1.7, 0.16, 0.6), (1.6, 0.5, 1.2), (1.7, -0.3, 2.0)])
def test_wrist_deviates_less_than_a_centimeter_from_the_line_and_does_not_rotate(
    goal: tuple[float, float, float],
) -> None:
    start = joints_for(mobile_manipulator(), WRIST, AT_THE_WALL, START)
    poses = driven(start, goal, 4.0)
    begin, way = AT_THE_WALL[:3, 3], np.array(goal) - AT_THE_WALL[:3, 3]
    off = poses[:, :3, 3] - begin
    off -= np.outer(off @ way, way) / (way @ way)
    assert np.linalg.norm(off, axis=1).max() < 0.001  # [m]: ten times better than asked for
    np.testing.assert_allclose(poses[-1, :3, 3], goal, atol=1e-9)
    assert np.abs(poses[:, :3, :3] - AT_THE_WALL[:3, :3]).max() < 0.001


@pytest.mark.parametrize(
    ("link", "goal", "seconds"), [("hand", (1, 0, 1), 1.0), (WRIST, (1, 0), 1.0), (WRIST, (1, 0, 1), 0.0)]
)
def test_invalid_arguments_are_rejected(link: str, goal: tuple[float, ...], seconds: float) -> None:
    with pytest.raises(CourseError, match="expected a link of 'mobile_manipulator', a point, and a time"):
        straight_line(mobile_manipulator(), link, START, goal, seconds=seconds)


@pytest.mark.slow
def test_unreachable_or_too_fast_line_is_rejected() -> None:
    robot = mobile_manipulator()
    start = joints_for(robot, WRIST, AT_THE_WALL, START)
    with pytest.raises(CourseError, match="ur10wrist_3_link cannot reach"):
        straight_line(robot, WRIST, start, (1.7, 0.16, -0.6), seconds=4.0)
    with pytest.raises(
        CourseError, match=r"would move at \d+\.\d\d rad/s, but its limit is \d\.\d\d. Give it more"
    ):
        straight_line(robot, WRIST, start, (1.7, 0.16, 0.6), seconds=0.5)
