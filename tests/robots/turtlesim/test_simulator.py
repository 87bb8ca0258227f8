"""The topics, log output and services of turtlesim, compared with its source code."""

import math
from typing import Any

import pytest
from geometry_msgs.msg import TransformStamped, Twist, Vector3
from rclpy.action import ActionClient
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from std_srvs.srv import Empty
from tf2_ros import Buffer, TransformBroadcaster, TransformException, TransformListener
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative

from course_lib.displays.turtle_view import TurtleView
from course_lib.robots.turtlesim import SIZE, TurtlesimNode
from course_lib.ros.time.driving import spin_for
from course_lib.viewer.drawables import Lines, Solids
from tests.robots.turtlesim.student import MIDDLE, Student


def test_turtle_starts_in_the_center_and_publishes_its_pose_at_60_hz(
    capfd: pytest.CaptureFixture[str], run: tuple[TurtlesimNode, Student]
) -> None:
    _, student = run
    student.wait(1.0)
    assert 61 <= len(student.poses) <= 63
    assert student.poses[0] == Pose(x=MIDDLE, y=MIDDLE)
    assert student.colors[0] == Color(r=255, g=255, b=255)
    assert (
        "Spawning turtle [turtle1] at x=[5.544445], y=[5.544445], theta=[0.000000]" in capfd.readouterr().err
    )


def test_command_lasts_one_second_and_draws_a_line(run: tuple[TurtlesimNode, Student]) -> None:
    simulator, student = run
    student.drive(2.0, math.pi / 2)
    student.wait(3.0)
    x, y, theta = student.place
    radius = 4 / math.pi  # [m], and a quarter of the circle in a second
    assert (x, y, theta) == pytest.approx((MIDDLE + radius, MIDDLE + radius, math.pi / 2), abs=0.06)
    assert (student.poses[-1].linear_velocity, student.poses[-1].angular_velocity) == (0.0, 0.0)
    assert student.colors[-1] == Color(r=0xB3, g=0xB8, b=0xFF)
    assert [len(strip.points) for strip in simulator.canvas.strips] == [pytest.approx(63, abs=2)]


def test_only_a_holonomic_turtle_moves_sideways(run: tuple[TurtlesimNode, Student]) -> None:
    simulator, student = run
    student.drive(0.0, left=1.0)
    student.wait(0.5)
    assert student.place == (5.54, 5.54, 0.0)
    simulator.set_parameters([Parameter("holonomic", value=True)])
    student.drive(0.0, left=1.0)
    student.wait(2.0)
    x, y, theta = student.place
    assert (x, y, theta) == pytest.approx((5.54, 6.54, 0.0), abs=0.04)


def test_turtle_stops_at_the_wall(
    run: tuple[TurtlesimNode, Student], capfd: pytest.CaptureFixture[str]
) -> None:
    _, student = run
    student.drive(20.0)
    student.wait(0.5)
    assert student.place == (round(SIZE, 2), 5.54, 0.0)
    assert "Oh no! I hit the wall! (Clamping from [x=11." in capfd.readouterr().err


def test_services_move_turtles_and_change_pens(run: tuple[TurtlesimNode, Student]) -> None:
    simulator, student = run
    student.call(SetPen, "turtle1/set_pen", r=255, width=9)
    student.call(TeleportAbsolute, "turtle1/teleport_absolute", x=1.0, y=2.0, theta=math.pi / 2)
    student.call(TeleportRelative, "turtle1/teleport_relative", linear=3.0)
    student.wait(0.1)
    assert student.place == (1.0, 5.0, 1.57)
    (strip,) = simulator.canvas.strips
    assert (strip.pen.color, strip.pen.width, len(strip.points)) == ((255, 0, 0), 9, 3)
    student.call(SetPen, "turtle1/set_pen", off=1)
    student.call(TeleportAbsolute, "turtle1/teleport_absolute", x=9.0, y=9.0)
    assert len(simulator.canvas.strips[0].points) == 3
    student.call(Empty, "clear")
    assert simulator.canvas.strips == []


def test_turtles_are_spawned_and_killed_by_name(
    run: tuple[TurtlesimNode, Student], capfd: pytest.CaptureFixture[str]
) -> None:
    simulator, student = run
    assert student.call(Spawn, "spawn", x=1.0, y=1.0).name == "turtle2"
    assert student.call(Spawn, "spawn", name="leo").name == "leo"
    assert student.call(Spawn, "spawn", name="leo").name == ""
    student.call(Kill, "kill", name="turtle1")
    student.call(Kill, "kill", name="nobody")
    assert set(simulator.turtles) == {"turtle2", "leo"}
    assert "/turtle1/pose" not in [
        name for name, _ in simulator.get_publisher_names_and_types_by_node("turtlesim", "/")
    ]
    student.call(Empty, "reset")
    assert set(simulator.turtles) == {"turtle1"}
    errors = capfd.readouterr().err
    assert "A turtle named [leo] already exists" in errors
    assert "Tried to kill turtle [nobody], which does not exist" in errors


@pytest.mark.parametrize(("interrupt", "status"), [(None, 4), ("cancel", 5), ("drive", 6), ("again", 6)])
def test_rotation_succeeds_or_is_ended_by_its_client_or_a_command(
    run: tuple[TurtlesimNode, Student], interrupt: str | None, status: int
) -> None:
    _, student = run
    remaining: list[float] = []
    client = ActionClient(student, RotateAbsolute, "turtle1/rotate_absolute")
    sent = client.send_goal_async(
        RotateAbsolute.Goal(theta=-1.5), lambda message: remaining.append(message.feedback.remaining)
    )
    student.wait(0.5)
    goal: Any = sent.result()
    ended: Any = goal.get_result_async()
    if interrupt == "cancel":
        goal.cancel_goal_async()
    elif interrupt == "drive":
        student.drive(0.0)
    elif interrupt == "again":
        client.send_goal_async(RotateAbsolute.Goal(theta=1.0))
    student.wait(4.0)
    assert ended.result().status == status
    assert remaining[0] == pytest.approx(-1.5)
    if interrupt is None:
        assert student.place[2] == pytest.approx(-1.5, abs=0.03)
        assert ended.result().result.delta == pytest.approx(1.5, abs=0.03)


class Broadcaster(Node):
    """Publishes a turtle's pose as a transform, as the tutorials of tf2 do."""

    def __init__(self, turtle: str) -> None:
        super().__init__(f"broadcaster_{turtle}")
        self.turtle, self.broadcaster = turtle, TransformBroadcaster(self)
        self.create_subscription(Pose, f"/{turtle}/pose", self.hear, 1)

    def hear(self, pose: Pose) -> None:
        transform = TransformStamped(child_frame_id=self.turtle)
        transform.header.stamp, transform.header.frame_id = self.get_clock().now().to_msg(), "world"
        transform.transform.translation = Vector3(x=pose.x, y=pose.y)
        transform.transform.rotation.z = math.sin(pose.theta / 2)
        transform.transform.rotation.w = math.cos(pose.theta / 2)
        self.broadcaster.sendTransform(transform)


class Follower(Node):
    """Spawns a second turtle that follows the first, as the tutorials of tf2 do."""

    def __init__(self) -> None:
        super().__init__("follower")
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.create_client(Spawn, "spawn").call_async(Spawn.Request(name="turtle2", x=4.0, y=2.0))
        self.twists = self.create_publisher(Twist, "turtle2/cmd_vel", 1)
        self.create_timer(0.1, self.follow)

    def follow(self) -> None:
        try:
            ahead = self.buffer.lookup_transform("turtle2", "turtle1", Time()).transform.translation
        except TransformException:
            return
        turn = 1.0 * math.atan2(ahead.y, ahead.x)
        forward = 0.5 * math.hypot(ahead.x, ahead.y)
        self.twists.publish(Twist(linear=Vector3(x=forward), angular=Vector3(z=turn)))


@pytest.mark.slow
def test_second_turtle_follows_the_first_over_tf2(run: tuple[TurtlesimNode, Student]) -> None:
    simulator, student = run
    nodes = [Broadcaster("turtle1"), Broadcaster("turtle2"), Follower()]
    student.call(TeleportAbsolute, "turtle1/teleport_absolute", x=9.0, y=8.0)
    spin_for(15.0, simulator, student, *nodes)
    one, two = simulator.turtles["turtle1"], simulator.turtles["turtle2"]
    assert math.dist((one.x, one.y), (two.x, two.y)) < 0.3


@pytest.mark.slow
def test_view_shows_turtles_at_their_poses_with_their_lines(run: tuple[TurtlesimNode, Student]) -> None:
    simulator, student = run
    view = TurtleView(simulator)
    student.drive(1.0)
    student.wait(2.0)
    scene = view.viewer.scene
    line = scene.objects()["turtlesim/lines/0"]
    assert isinstance(line, Lines)
    assert line.points[-1][0] == pytest.approx(simulator.turtles["turtle1"].x)
    assert scene.transform("turtlesim/turtles/turtle1")[0, 3] == simulator.turtles["turtle1"].x
    student.call(Spawn, "spawn", name="leo", x=2.0, y=2.0)
    student.call(Kill, "kill", name="turtle1")
    student.call(Empty, "clear")
    simulator.set_parameters([Parameter("background_r", value=255)])
    student.wait(0.1)
    turtles = {path.split("/")[2] for path in scene.objects() if "/turtles/" in path}
    assert (turtles, [path for path in scene.objects() if "/lines/" in path]) == ({"leo"}, [])
    water = scene.objects()["turtlesim/water"]
    assert isinstance(water, Solids)
    assert water.colors[0] == pytest.approx(1.0)
