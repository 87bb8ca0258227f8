import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import PoseStamped, Twist
from rclpy.node import Node

from course_lib.robots.mobile_manipulator import MAX_SPEED, OmniBase
from course_lib.ros.graph.graph import Graph

On = Callable[[str], list[Any]]
Run = Callable[..., None]


class Driver(Node):
    """Sends commands and goals."""

    def __init__(self) -> None:
        super().__init__("driver")
        self.speeds = self.create_publisher(Twist, "/cmd_vel", 10)
        self.goals = self.create_publisher(PoseStamped, "/goal_pose", 10)

    def command(self, ahead: float, left: float, turning: float) -> None:
        twist = Twist()
        twist.linear.x, twist.linear.y, twist.angular.z = ahead, left, turning
        self.speeds.publish(twist)

    def goal(self, x: float, y: float, yaw: float, frame: str = "map") -> None:
        goal = PoseStamped()
        goal.header.frame_id = frame
        goal.pose.position.x, goal.pose.position.y = x, y
        goal.pose.orientation.z, goal.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        self.goals.publish(goal)


class Scene:
    """A base and its driver."""

    def __init__(self, run: Run, on: On) -> None:
        self.base, self.driver, self.on, self._run = OmniBase(rate=50.0), Driver(), on, run

    def run(self, seconds: float) -> None:
        self._run(seconds, self.base, self.driver)

    @property
    def poses(self) -> Any:
        """x, y [m] and yaw [rad] of all odometry, shape (N, 3)."""
        poses = [odometry.pose.pose for odometry in self.on("/odom")]
        return np.array(
            [[p.position.x, p.position.y, 2 * math.atan2(p.orientation.z, p.orientation.w)] for p in poses]
        )


@pytest.fixture
def scene(graph: Graph, run: Run, on: On) -> Scene:
    return Scene(run, on)


def test_command_is_integrated_as_in_pinocchio_to_1e_9(scene: Scene) -> None:
    import pinocchio as pin

    scene.driver.command(0.3, -0.2, 0.6)
    scene.run(0.4)
    moved = [o for o in scene.on("/odom") if o.twist.twist.linear.x]
    step = pin.exp6(np.array([0.3, -0.2, 0, 0, 0, 0.6]) * 0.02)  # [m], [rad] in a period
    wanted = pin.SE3.Identity()
    for odometry in moved:
        place, turn = odometry.pose.pose.position, odometry.pose.pose.orientation
        came = pin.XYZQUATToSE3(np.array([place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w]))
        np.testing.assert_allclose(came.homogeneous, wanted.homogeneous, atol=1e-9)
        wanted = wanted * step
    assert len(moved) > 10


def test_command_expires_after_half_a_second(scene: Scene) -> None:
    scene.driver.command(0.4, 0.0, 0.0)
    scene.run(3.0)
    assert scene.poses[-1, 0] == pytest.approx(0.2, abs=0.01)
    assert scene.on("/odom")[-1].twist.twist.linear.x == 0.0


def test_commands_are_clipped_to_the_limits(scene: Scene) -> None:
    scene.driver.command(9.0, -9.0, 9.0)
    scene.run(0.2)
    twist = scene.on("/odom")[-1].twist.twist
    assert [twist.linear.x, twist.linear.y, twist.angular.z] == (MAX_SPEED * (1, -1, 1)).tolist()


@pytest.mark.sample(1)
@pytest.mark.parametrize("goal", [(0.0, 0.5, 0.0), (-1.0, 0.4, 2.0), (0.6, -0.2, -3.0)])
def test_base_reaches_its_goal_and_stays(scene: Scene, goal: tuple[float, float, float]) -> None:
    scene.driver.goal(*goal)
    scene.run(8.0)
    gap = scene.poses[-1] - goal
    assert [*np.abs(gap[:2]), abs(math.remainder(gap[2], math.tau))] == pytest.approx([0.0] * 3, abs=1e-9)
    twists = [o.twist.twist for o in scene.on("/odom")]
    speeds = np.array([(t.linear.x, t.linear.y, t.angular.z) for t in twists])
    assert (np.abs(speeds) <= MAX_SPEED + 1e-12).all()
    assert np.abs(speeds[-1]).max() < 1e-9


def test_goal_without_a_rotation_is_reached_along_a_straight_line(scene: Scene) -> None:
    scene.driver.goal(1.0, 0.5, 0.0)
    scene.run(4.0)
    np.testing.assert_allclose(scene.poses[:, 1], scene.poses[:, 0] / 2, atol=1e-9)


def test_velocity_command_ends_the_drive_to_a_goal(scene: Scene) -> None:
    scene.driver.goal(2.0, 0.0, 0.0)
    scene.run(1.0)
    scene.driver.command(0.0, 0.0, 0.0)
    scene.run(3.0)
    assert scene.poses[-1, 0] < 0.6


@pytest.mark.parametrize(
    ("numbers", "frame", "says"),
    [
        ((1.0, 0.0, 0.0), "base_link", "The goal is in frame 'base_link', expected 'map' or 'odom'."),
        ((math.nan, 0.0, 0.0), "map", "A goal with numbers that are not finite is ignored."),
    ],
)
def test_invalid_goal_is_logged_and_ignored(
    scene: Scene,
    capfd: pytest.CaptureFixture[str],
    numbers: tuple[float, float, float],
    frame: str,
    says: str,
) -> None:
    scene.driver.goal(*numbers, frame)
    scene.driver.command(math.nan, 0.0, 0.0)
    scene.run(1.0)
    assert scene.poses[-1].tolist() == [0.0, 0.0, 0.0]
    errors = capfd.readouterr().err
    assert says in errors
    assert "A command with numbers that are not finite is ignored" in errors


def test_map_odom_and_base_link_form_one_tree(scene: Scene) -> None:
    scene.run(0.1)
    (fixed,) = scene.on("/tf_static")[-1].transforms
    moved = scene.on("/tf")[-1].transforms[0]
    assert (fixed.header.frame_id, fixed.child_frame_id) == ("map", "odom")
    assert (moved.header.frame_id, moved.child_frame_id) == ("odom", "base_link")
