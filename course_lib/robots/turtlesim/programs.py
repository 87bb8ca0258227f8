"""turtlesim's other programs: one copies a turtle, one draws squares, one is steered by keys."""

import math
from collections import deque
from typing import Any

from geometry_msgs.msg import Twist, Vector3
from rclpy.action import ActionClient
from rclpy.action.client import ClientGoalHandle
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Empty
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose

from course_lib.robots.turtlesim.turtle import QOS

PERIOD = 0.016  # [s]
EDGE = 2.0  # [m] of a square
SPEED, TURN = 1.0, 0.4  # [m/s], [rad/s] along it
NEAR, ALIGNED = 0.1, 0.01  # [m], [rad] of a goal
STILL = 0.0001  # [m/s], [rad/s]
ARROWS = {"↑": (1.0, 0.0), "↓": (-1.0, 0.0), "←": (0.0, 1.0), "→": (0.0, -1.0)}  # forward, turn
# Headings in eighths of a turn; on a keyboard these keys lie round F, which cancels.
HEADINGS = {"g": 0, "t": 1, "r": 2, "e": 3, "d": 4, "c": -3, "v": -2, "b": -1}
KEYS = ("e", "r", "t", "d", "f", "g", "c", "v", "b", "←", "↑", "→", "", "↓", "")


class TurtleMimic(Node):
    """Drives a turtle as another one moves: from `input/pose` to `output/cmd_vel`."""

    def __init__(self) -> None:
        super().__init__("turtle_mimic")
        self._twists = self.create_publisher(Twist, "output/cmd_vel", QOS)
        self.create_subscription(Pose, "input/pose", self._copy, QOS)

    def _copy(self, pose: Pose) -> None:
        self._twists.publish(_twist(pose.linear_velocity, pose.angular_velocity))


class DrawSquare(Node):
    """Resets turtlesim, then drives the first turtle along squares."""

    def __init__(self) -> None:
        super().__init__("draw_square")
        self._twists = self.create_publisher(Twist, "turtle1/cmd_vel", QOS)
        self.create_subscription(Pose, "turtle1/pose", self._hear, QOS)
        self._pose: Pose | None = None
        self._goal: Pose | None = None
        self._turns, self._stops = False, False
        self.create_client(Empty, "reset").call_async(Empty.Request())
        self.create_timer(PERIOD, self._drive)

    def _hear(self, pose: Pose) -> None:
        self._pose = pose

    def _drive(self) -> None:
        pose = self._pose
        if pose is None:
            return
        goal = self._goal or self._aim(pose)
        if self._stops and pose.linear_velocity < STILL and pose.angular_velocity < STILL:
            self.get_logger().info("Reached goal")
            self._stops, self._turns = False, not self._turns
            self._aim(pose)
        elif self._stops or _reached(pose, goal):
            self._stops = True
            self._twists.publish(_twist(0.0, 0.0))
        else:
            self._twists.publish(_twist(0.0, TURN) if self._turns else _twist(SPEED, 0.0))

    def _aim(self, pose: Pose) -> Pose:
        """Set the next goal: the end of an edge, or a quarter of a turn."""
        ahead = 0.0 if self._turns else EDGE
        theta = math.remainder(pose.theta + self._turns * math.pi / 2, math.tau)
        x, y = pose.x + math.cos(pose.theta) * ahead, pose.y + math.sin(pose.theta) * ahead
        self._goal = goal = Pose(x=x, y=y, theta=theta)
        self.get_logger().info(f"New goal [{goal.x:f} {goal.y:f}, {goal.theta:f}]")
        return goal


class TurtleTeleop(Node):
    """Steers the first turtle by keys, which a program or a button presses."""

    def __init__(self) -> None:
        super().__init__("teleop_turtle")
        for kind in ("angular", "linear"):
            self.declare_parameter(f"scale_{kind}", 2.0)
        self._twists = self.create_publisher(Twist, "turtle1/cmd_vel", QOS)
        self._rotate = ActionClient(self, RotateAbsolute, "turtle1/rotate_absolute")
        self._goal: ClientGoalHandle | None = None
        self._pressed: deque[str] = deque()
        self.create_timer(PERIOD, self._work)

    def press(self, key: str) -> None:
        """Press a key: an arrow, or one of the letters round F; others do nothing."""
        self._pressed.append(key.lower())

    def _work(self) -> None:
        while self._pressed:
            key = self._pressed.popleft()
            if key in ARROWS:
                forward, turn = ARROWS[key]
                self._twists.publish(_twist(forward * self._scale("linear"), turn * self._scale("angular")))
            elif key in HEADINGS:
                goal = RotateAbsolute.Goal(theta=HEADINGS[key] * math.pi / 4)
                self._rotate.send_goal_async(goal).add_done_callback(self._remember)
            elif key == "f" and self._goal is not None:
                self._goal.cancel_goal_async()

    def _scale(self, kind: str) -> float:
        return float(self.get_parameter(f"scale_{kind}").value)

    def _remember(self, sent: "Future[Any]") -> None:
        self._goal = sent.result()


def _twist(forward: float, turn: float) -> Twist:
    return Twist(linear=Vector3(x=forward), angular=Vector3(z=turn))


def _reached(pose: Pose, goal: Pose) -> bool:
    near = abs(pose.x - goal.x) < NEAR and abs(pose.y - goal.y) < NEAR
    return near and abs(pose.theta - goal.theta) < ALIGNED
