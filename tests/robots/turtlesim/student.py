"""A node that drives turtlesim."""

from typing import Any

import numpy as np
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from turtlesim.msg import Color, Pose

from course_lib.robots.turtlesim import SIZE, TurtlesimNode
from course_lib.ros.time.driving import spin_for

MIDDLE = float(np.float32(SIZE / 2))


class Student(Node):
    """Subscribes to the first turtle's pose, drives it, and calls services."""

    def __init__(self, simulator: TurtlesimNode) -> None:
        super().__init__("student")
        self.simulator = simulator
        self.poses: list[Pose] = []
        self.colors: list[Color] = []
        self.create_subscription(Pose, "turtle1/pose", self.poses.append, 10)
        self.create_subscription(Color, "turtle1/color_sensor", self.colors.append, 10)
        self.twists = self.create_publisher(Twist, "turtle1/cmd_vel", 10)

    def drive(self, forward: float, turn: float = 0.0, left: float = 0.0) -> None:
        self.twists.publish(Twist(linear=Vector3(x=forward, y=left), angular=Vector3(z=turn)))

    def wait(self, seconds: float) -> None:
        spin_for(seconds, self.simulator, self)

    def call(self, kind: Any, service: str, /, **request: Any) -> Any:
        future = self.create_client(kind, service).call_async(kind.Request(**request))
        self.wait(0.1)
        return future.result()

    @property
    def place(self) -> tuple[float, float, float]:
        last = self.poses[-1]
        return round(last.x, 2), round(last.y, 2), round(last.theta, 2)
