from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from rclpy.node import Node
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib.robots.mobile_manipulator import START, mobile_manipulator
from course_lib.robots.state_publishers import RobotStatePublisher
from course_lib.robots.trajectory import JointTrajectoryController
from course_lib.ros.graph.graph import Graph
from course_lib.ros.tf2 import Transform

JOINTS = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
NAMES = [f"ur10{joint}_joint" for joint in JOINTS]
DOWN, UP = [0.0, 1.5, 0.5, 0.0, 0.0, 0.0], [0.0, -0.25, 0.5, 0.0, 0.0, 0.0]  # [rad], of seeds/002
On = Callable[[str], list[Any]]
Run = Callable[..., None]


def to(
    positions: Sequence[float], seconds: int, *, velocities: Sequence[float] = (0.0,) * 6
) -> JointTrajectory:
    point = JointTrajectoryPoint(positions=positions, velocities=velocities)
    point.time_from_start.sec = seconds
    return JointTrajectory(joint_names=NAMES, points=[point])


class Operator(Node):
    """Sends trajectories."""

    def __init__(self) -> None:
        super().__init__("operator")
        self.publisher = self.create_publisher(JointTrajectory, "/arm_controller/joint_trajectory", 10)


class Arm:
    """The controller, a client that sends trajectories, and the results."""

    def __init__(self, run: Run, on: On) -> None:
        self.controller = JointTrajectoryController(mobile_manipulator().urdf, start=START, rate=50.0)
        self.operator, self._run, self._on = Operator(), run, on

    def run(self, seconds: float, *trajectories: JointTrajectory) -> None:
        for trajectory in trajectories:
            self.operator.publisher.publish(trajectory)
        self._run(seconds, self.controller, self.operator)

    @property
    def states(self) -> Any:
        """Positions of all joint states, shape (N, 6)."""
        return np.array([state.position for state in self._on("/joint_states")])


@pytest.fixture
def arm(graph: Graph, run: Run, on: On) -> Arm:
    return Arm(run, on)


def test_controller_publishes_the_start_position_at_its_rate(arm: Arm, on: On) -> None:
    arm.run(2.0)
    assert len(arm.states) == 100
    assert np.ptp(arm.states, axis=0).tolist() == [0.0] * 6
    assert list(on("/joint_states")[0].name) == NAMES
    np.testing.assert_allclose(arm.states[0], [START.get(name, 0.0) for name in NAMES])


def test_point_with_velocities_is_reached_along_a_cubic_to_1e_9(arm: Arm) -> None:
    arm.run(0.5, to(DOWN, 3))
    arm.run(4.0)
    moving = np.flatnonzero(np.abs(arm.states - arm.states[0]).max(axis=1) > 0)[0] - 1
    portion = np.clip(np.arange(len(arm.states) - moving) / 150, 0, 1)  # 3 s of 50 states
    cubic = np.outer(3 * portion**2 - 2 * portion**3, np.array(DOWN) - arm.states[0])
    np.testing.assert_allclose(arm.states[moving:], arm.states[0] + cubic, atol=1e-9)


def test_transforms_of_moved_joints_agree_with_pinocchio_to_1e_9(graph: Graph, run: Run, on: On) -> None:
    import pinocchio as pin

    robot = mobile_manipulator()
    controller = JointTrajectoryController(robot.urdf, start=START, rate=50.0)
    operator = Operator()
    operator.publisher.publish(to(DOWN, 1))
    run(0.6, controller, operator, RobotStatePublisher(robot.urdf, publish_frequency=50.0))
    last = {t.child_frame_id: t for message in on("/tf") for t in message.transforms}
    stamp = last["ur10wrist_3_link"].header.stamp
    (state,) = [state for state in on("/joint_states") if state.header.stamp == stamp]
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, np.array(state.position))
    for joint, name in enumerate(NAMES[1:], 2):  # the first one is placed on the base besides
        moved = last[robot.tree.joints[name].child].transform
        place, turn = moved.translation, moved.rotation
        came = Transform("", "", 0, (place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))
        np.testing.assert_allclose(came.matrix(), data.liMi[joint].homogeneous, atol=1e-9)


def test_new_trajectory_replaces_the_old_one_without_a_jump(arm: Arm) -> None:
    arm.run(1.5, to(DOWN, 3))
    arm.run(3.5, to(UP, 2))
    np.testing.assert_allclose(arm.states[-1], UP, atol=1e-9)
    speeds = np.diff(arm.states, axis=0) * 50  # [rad/s]
    assert np.abs(np.diff(speeds, axis=0)).max() < 0.2  # [rad/s] from one period to the next


def test_too_fast_trajectory_is_followed_at_maximum_speed(
    arm: Arm, capfd: pytest.CaptureFixture[str]
) -> None:
    arm.run(0.5, to([3.0, *DOWN[1:]], 1))
    arm.run(3.0)
    assert np.abs(np.diff(arm.states[:, 0])).max() * 50 == pytest.approx(2.16)  # [rad/s], of the URDF
    np.testing.assert_allclose(arm.states[-1, 0], 3.0)
    assert (
        "Joint(s) [ur10shoulder_pan_joint] would exceed velocity limits, limiting" in capfd.readouterr().err
    )


def test_rejected_trajectory_is_logged_and_ignored(arm: Arm, capfd: pytest.CaptureFixture[str]) -> None:
    wrong = to(UP, 1)
    wrong.joint_names = [name.removeprefix("ur10") for name in NAMES]
    arm.run(1.0, to(DOWN, 3))
    arm.run(3.0, wrong)
    assert (
        "Incoming joint shoulder_pan_joint doesn't match the controller's joints." in capfd.readouterr().err
    )
    np.testing.assert_allclose(arm.states[-1], DOWN, atol=1e-9)


def test_future_stamp_delays_the_end_of_a_trajectory(arm: Arm) -> None:
    later = to(UP, 1)
    later.header.stamp = arm.operator.get_clock().now().to_msg()
    later.header.stamp.sec += 2
    arm.run(1.9, later)
    assert np.abs(arm.states[-1] - UP).max() > 0.2  # on its way: it goes from the first update to the point
    arm.run(1.3)
    np.testing.assert_allclose(arm.states[-1], UP, atol=1e-9)
