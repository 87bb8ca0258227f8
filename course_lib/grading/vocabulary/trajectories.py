"""Expectations on trajectories that are sent to an arm."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.wording import Problem, close, heard, number, word
from course_lib.robots.trajectory import Waypoint
from course_lib.ros import standin_path
from course_lib.ros.clock import START_NS

TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"
TOLERANCE, TIME_TOLERANCE = 1e-3, 0.05  # [rad], [s]


@word("trajectory {index} on {topic}")
def expect_trajectory(
    evidence: Evidence,
    topic: str,
    goal: Mapping[str, float],
    *,
    index: int = 0,
    at: float,
    seconds: float,
    points: int | None = None,
    of: int | None = None,
) -> Iterable[Problem]:
    """Expect a trajectory that joint_trajectory_controller takes, and that ends in `goal`.

    Args:
        evidence: With the trajectories.
        topic: Where they come.
        goal: By joint, in any order, [rad]; the arm stands still there.
        index: Which trajectory, counted from 0.
        at: When it comes, [s] after the start.
        seconds: The time of its last point, [s] after that.
        points: How many it has; any number if it is not given.
        of: How many trajectories come; any number if it is not given.
    """
    standin_path.install()  # the judge's process has not imported any ROS name yet
    from rclpy.time import Time

    from course_lib.robots.trajectory import waypoints_of

    came = heard(evidence, topic, TRAJECTORY)
    if len(came) <= index:
        message = f"{len(came)} trajectories came on {topic}, expected at least {index + 1}"
        return [Problem(message, "a trajectory is missing")]
    if len(came) > (of or len(came)):
        message = f"{len(came)} trajectories came on {topic}, expected {of}"
        return [Problem(message, "the count of trajectories is wrong")]
    when, sent = came[index]
    if len(sent.points) != (points or len(sent.points)):
        message = f"the trajectory has {len(sent.points)} points, expected {points}"
        return [Problem(message, "a trajectory has the wrong number of points")]
    try:
        *_, last = waypoints_of(sent, list(goal), Time(nanoseconds=START_NS + round(when * 1e9)))
    except (CourseError, ValueError) as refused:  # rclpy says of a time before 1970 that it is none
        return [Problem(f"the controller says: {refused}", "the controller refuses the trajectory")]
    return list(_differs(last, goal, when, at, seconds))


def _differs(
    last: Waypoint, goal: Mapping[str, Any], when: float, at: float, seconds: float
) -> Iterator[Problem]:
    if not close(when, at, TIME_TOLERANCE):
        message = f"the trajectory came after {number(when, 's')}, expected after {number(at, 's')}"
        yield Problem(message, "a trajectory is sent at the wrong time")
    if not close(last.seconds, seconds, TIME_TOLERANCE):
        message = (
            f"its last point is reached after {number(last.seconds, 's')}, expected {number(seconds, 's')}"
        )
        yield Problem(message, "the time of a trajectory is wrong")
    if len(last.state) < 2:
        message = "its last point has no velocities, so the arm would stop with a jerk"
        yield Problem(message, "a trajectory has no velocities")
    for (joint, expected), position in zip(goal.items(), last.state[0].tolist(), strict=True):
        if not close(position, expected, TOLERANCE):
            message = f"{joint} goes to {number(position, 'rad')}, expected {number(expected, 'rad')}"
            yield Problem(message, "a trajectory leads to the wrong position of a joint")
