from typing import Any

import numpy as np
import pytest
from rclpy.time import Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.errors import CourseError
from course_lib.robots.trajectory import waypoints_of

NOW = Time(seconds=1_700_000_000)


def point(seconds: float, **fields: Any) -> JointTrajectoryPoint:
    point = JointTrajectoryPoint(**fields)
    point.time_from_start.sec, point.time_from_start.nanosec = divmod(round(seconds * 1e9), 10**9)
    return point


def trajectory(*points: JointTrajectoryPoint, names: tuple[str, ...] = ("b", "a")) -> JointTrajectory:
    return JointTrajectory(joint_names=list(names), points=list(points))


def test_values_are_in_the_joint_order_of_the_controller() -> None:
    message = trajectory(
        point(0.5, positions=[1.0, 2.0]), point(2.0, positions=[3.0, 4.0], velocities=[0.0, 0.0])
    )
    first, second = waypoints_of(message, ["a", "b"], NOW)
    assert (first.seconds, first.state.tolist()) == (0.5, [[2.0, 1.0]])
    assert (second.seconds, second.state.tolist()) == (2.0, [[4.0, 3.0], [0.0, 0.0]])


def test_accelerations_without_velocities_are_ignored() -> None:
    (waypoint,) = waypoints_of(
        trajectory(point(1, positions=[1.0, 2.0], accelerations=[5.0, 5.0])), ["a", "b"], NOW
    )
    assert waypoint.state.shape == (1, 2)


GOOD = point(1, positions=[0.0, 0.0])
STAMPED = trajectory(GOOD)
STAMPED.header.stamp.sec = 1_600_000_000

REFUSED = [  # the texts of ros2_controllers 4.42.1, joint_trajectory_controller.cpp; the last one is ours
    (trajectory(GOOD, names=("a",)), "Joints on incoming trajectory don't match the controller joints."),
    (trajectory(GOOD, names=("a", "a")), "Joints on incoming trajectory don't match the controller joints."),
    (trajectory(), "Empty trajectory received."),
    (trajectory(GOOD, names=("a", "elbow")), "Incoming joint elbow doesn't match the controller's joints."),
    (
        trajectory(point(1, positions=[0.0, 0.0], velocities=[0.0, 0.25])),
        "Velocity of last trajectory point of joint a is not zero: 0.250000000000000",
    ),
    (
        STAMPED,
        "Received trajectory with non-zero start time (1600000000.000000) that ends in the past "
        "(1600000001.000000)",
    ),
    (
        trajectory(GOOD, GOOD),
        "Time between points 0 and 1 is not strictly increasing, it is 1.000000 and 1.000000 respectively",
    ),
    (
        trajectory(point(1, positions=[0.0])),
        "Mismatch between joint_names size (2) and positions (1) at point #0.",
    ),
    (
        trajectory(GOOD, point(2, positions=[0.0, 0.0], velocities=[0.0])),
        "Mismatch between joint_names size (2) and velocities (1) at point #1.",
    ),
    (
        trajectory(point(1, positions=[0.0, 0.0], effort=[0.0, 0.0])),
        "Trajectories with effort fields are only supported for controllers using the 'effort' "
        "command interface.",
    ),
    (trajectory(point(1, positions=[0.0, np.inf])), "The positions at point #0 are not all finite."),
]


@pytest.mark.parametrize(("message", "says"), REFUSED, ids=[says[:30] for _, says in REFUSED])
def test_rejected_trajectory_has_the_message_of_the_controller(message: JointTrajectory, says: str) -> None:
    with pytest.raises(CourseError) as refused:
        waypoints_of(message, ["a", "b"], NOW)
    assert str(refused.value) == says
