"""The controller's action: results, tolerances and preemption, with the texts of ros2_controllers 4.42.1."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from action_msgs.msg import GoalStatus
from control_msgs.action import FollowJointTrajectory
from control_msgs.msg import JointTolerance
from rclpy.action import ActionClient
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.robots.mobile_manipulator import START, mobile_manipulator
from course_lib.robots.trajectory import JointTrajectoryController
from course_lib.ros.graph.graph import Graph

NAMES = [
    f"ur10{joint}_joint"
    for joint in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
]
DOWN, UP = [0.0, 1.5, 0.5, 0.0, 0.0, 0.0], [0.0, -0.25, 0.5, 0.0, 0.0, 0.0]  # [rad]
FAR = [3.0, -1.2, 0.5, 0.0, 0.0, 0.0]  # [rad]: 3 s for the shoulder pan, within 1 s too fast
Run = Callable[..., None]
On = Callable[[str], list[Any]]


class Client:
    """A controller and a client of its action."""

    def __init__(self, run: Run, on: On) -> None:
        self.controller = JointTrajectoryController(mobile_manipulator().urdf, start=START, rate=50.0)
        self.node, self._run, self._on = Node("client"), run, on
        self.client = ActionClient(
            self.node, FollowJointTrajectory, "/arm_controller/follow_joint_trajectory"
        )
        self.feedback: list[Any] = []

    def run(self, seconds: float) -> None:
        self._run(seconds, self.controller, self.node)

    def send(self, positions: list[float], seconds: int, **tolerances: Any) -> Any:
        """Send a goal and wait for the response. Return the goal handle."""
        point = JointTrajectoryPoint(positions=positions, velocities=[0.0] * 6)
        point.time_from_start.sec = seconds
        goal = FollowJointTrajectory.Goal(trajectory=JointTrajectory(joint_names=NAMES, points=[point]))
        for name, tolerance in tolerances.items():
            setattr(goal, name, tolerance)
        answer = self.client.send_goal_async(goal, lambda message: self.feedback.append(message.feedback))
        self.run(0.1)
        return answer.result()

    def ends(self, handle: Any, seconds: float) -> tuple[int, int, str]:
        """Return status, error code and error string of a goal, waiting some seconds for its result."""
        result = handle.get_result_async()
        self.run(seconds)
        assert result.done()
        return (
            result.result().status,
            result.result().result.error_code,
            result.result().result.error_string,
        )

    @property
    def position(self) -> Any:
        return np.array(self._on("/joint_states")[-1].position)


@pytest.fixture
def client(graph: Graph, run: Run, on: On) -> Client:
    return Client(run, on)


def within(joint: str, position: float) -> list[JointTolerance]:
    return [JointTolerance(name=f"ur10{joint}_joint", position=position)]


def test_goal_is_executed_with_feedback_and_succeeds(
    client: Client, capfd: pytest.CaptureFixture[str]
) -> None:
    handle = client.send(UP, 1, goal_tolerance=within("elbow", 0.01), path_tolerance=within("elbow", 0.01))
    assert client.ends(handle, 1.5) == (GoalStatus.STATUS_SUCCEEDED, 0, "Goal successfully reached!")
    np.testing.assert_allclose(client.position, UP, atol=1e-9)
    assert client.feedback[0].joint_names == NAMES
    assert len(client.feedback) >= 50
    errors = np.array([feedback.error.positions for feedback in client.feedback])
    np.testing.assert_allclose(errors, 0.0, atol=1e-9)
    error_output = capfd.readouterr().err
    for line in ("Received new action goal", "Accepted new action goal", "Goal reached, success!"):
        assert line in error_output


def test_joint_outside_its_path_tolerance_aborts_the_goal_and_stops_the_arm(
    client: Client, capfd: pytest.CaptureFixture[str]
) -> None:
    handle = client.send(FAR, 1, path_tolerance=within("shoulder_pan", 0.1))
    says = "Aborted due to path tolerance violation"
    assert client.ends(handle, 2.0) == (GoalStatus.STATUS_ABORTED, -4, says)
    stopped = client.position
    client.run(1.0)
    np.testing.assert_allclose(client.position, stopped, atol=1e-9)
    assert stopped[0] < 2.5
    errors = capfd.readouterr().err
    for line in (
        "State tolerances failed for joint 0:",
        "Position Tolerance: 0.100000",
        "state tolerance violation",
    ):
        assert line in errors


def test_late_goal_waits_for_its_time_tolerance_and_is_aborted(client: Client) -> None:
    late = FollowJointTrajectory.Goal().goal_time_tolerance
    late.nanosec = 100_000_000
    handle = client.send(FAR, 1, goal_tolerance=within("shoulder_pan", 0.01), goal_time_tolerance=late)
    status, code, says = client.ends(handle, 2.0)
    assert (status, code) == (GoalStatus.STATUS_ABORTED, -5)
    assert says.startswith("Aborted due to goal_time_tolerance exceeding by 0.1")


def test_goal_without_a_time_tolerance_waits_until_the_joints_arrive(client: Client) -> None:
    handle = client.send(FAR, 1, goal_tolerance=within("shoulder_pan", 0.01))
    assert client.ends(handle, 2.0)[0] == GoalStatus.STATUS_SUCCEEDED
    assert client.position[0] == pytest.approx(3.0, abs=0.01)


def test_goal_without_tolerances_succeeds_on_time_and_the_joints_still_arrive(client: Client) -> None:
    handle = client.send(FAR, 1)
    assert client.ends(handle, 1.0)[0] == GoalStatus.STATUS_SUCCEEDED
    client.run(1.0)
    assert client.position[0] == pytest.approx(3.0, abs=1e-9)


def test_new_goal_aborts_the_previous_one(client: Client) -> None:
    first, second = client.send(DOWN, 3), client.send(UP, 1)
    says = "Current goal preempted by new incoming action."
    assert client.ends(first, 0.1) == (GoalStatus.STATUS_ABORTED, -1, says)
    assert client.ends(second, 1.5)[0] == GoalStatus.STATUS_SUCCEEDED


@pytest.mark.slow
def test_canceled_goal_stops_the_arm(client: Client) -> None:
    handle = client.send(DOWN, 3)
    handle.cancel_goal_async()
    assert client.ends(handle, 0.2)[0] == GoalStatus.STATUS_CANCELED
    stopped = client.position
    client.run(1.0)
    np.testing.assert_allclose(client.position, stopped, atol=1e-9)


def test_goal_with_an_invalid_trajectory_is_rejected(
    client: Client, capfd: pytest.CaptureFixture[str]
) -> None:
    assert not client.send([0.0], 1).accepted
    assert "Mismatch between joint_names size (6) and positions (1) at point #0." in capfd.readouterr().err


@pytest.mark.parametrize(
    ("tolerance", "says"),
    [
        (within("hand", 0.1), "joint 'ur10hand_joint' specified in goal.path_tolerance does not exist."),
        (within("elbow", -0.5), "specified in goal.path_tolerance has a invalid position tolerance."),
    ],
)
def test_invalid_tolerance_is_logged_and_not_enforced(
    client: Client, capfd: pytest.CaptureFixture[str], tolerance: list[JointTolerance], says: str
) -> None:
    handle = client.send(FAR, 1, path_tolerance=tolerance)
    assert client.ends(handle, 1.5)[0] == GoalStatus.STATUS_SUCCEEDED
    assert f"{says} Using default tolerances." in capfd.readouterr().err
