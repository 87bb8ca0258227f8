"""turtlesim's node: turtles on a square of water."""

import numpy as np
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.node import Node
from std_srvs.srv import Empty
from turtlesim.srv import Kill, Spawn

from course_lib.robots.turtlesim.canvas import SIZE, Canvas, Color
from course_lib.robots.turtlesim.turtle import Turtle

PERIOD = 0.016  # [s]
WATER = {"r": 0x45, "g": 0x56, "b": 0xFF}


class TurtlesimNode(Node):
    """The simulator, with one turtle in the middle at the start."""

    def __init__(self) -> None:
        super().__init__("turtlesim")
        for (letter, value), color in zip(WATER.items(), ("Red", "Green", "Blue"), strict=True):
            text = f"{color} channel of the background color"
            limits = [IntegerRange(from_value=0, to_value=255, step=1)]
            descriptor = ParameterDescriptor(description=text, integer_range=limits)
            self.declare_parameter(f"background_{letter}", value, descriptor)
        text = "If true, then turtles will be holonomic"
        self.declare_parameter("holonomic", False, ParameterDescriptor(description=text))
        self.turtles: dict[str, Turtle] = {}
        self.canvas, self._count = Canvas(), 0
        self.create_service(Empty, "clear", self._clear)
        self.create_service(Empty, "reset", self._reset)
        self.create_service(Spawn, "spawn", self._on_spawn)
        self.create_service(Kill, "kill", self._kill)
        self.get_logger().info(f"Starting turtlesim with node name {self.get_fully_qualified_name()}")
        self._spawn("", SIZE / 2, SIZE / 2, 0.0)
        self.create_timer(PERIOD, self._update)

    @property
    def background(self) -> Color:
        """Red, green and blue of the water."""
        red, green, blue = (int(self.get_parameter(f"background_{letter}").value) for letter in WATER)
        return red, green, blue

    def _update(self) -> None:
        for turtle in list(self.turtles.values()):
            turtle.update(PERIOD)

    def _spawn(self, name: str, x: float, y: float, theta: float) -> str:
        """Add a turtle; without a name it gets the next free one. Returns "" if the name is taken."""
        if name in self.turtles:
            return ""
        while not name or name in self.turtles:
            self._count += 1
            name = f"turtle{self._count}"
        x, y, theta = (float(np.float32(number)) for number in (x, y, theta))  # as ROS's are
        self.turtles[name] = Turtle(self, name, self.canvas, x, y, theta)
        place = f"x=[{x:f}], y=[{y:f}], theta=[{theta:f}]"
        self.get_logger().info(f"Spawning turtle [{name}] at {place}")
        return name

    def _on_spawn(self, request: Spawn.Request, response: Spawn.Response) -> Spawn.Response:
        response.name = self._spawn(request.name, request.x, request.y, request.theta)
        if not response.name:
            self.get_logger().error(f"A turtle named [{request.name}] already exists")
        return response

    def _kill(self, request: Kill.Request, response: Kill.Response) -> Kill.Response:
        if request.name in self.turtles:
            self.turtles.pop(request.name).destroy()
        else:
            text = f"Tried to kill turtle [{request.name}], which does not exist"
            self.get_logger().error(text)
        return response

    def _clear(self, request: Empty.Request, response: Empty.Response) -> Empty.Response:
        self.get_logger().info("Clearing turtlesim.")
        self.canvas.clear()
        return response

    def _reset(self, request: Empty.Request, response: Empty.Response) -> Empty.Response:
        self.get_logger().info("Resetting turtlesim.")
        while self.turtles:
            self.turtles.popitem()[1].destroy()
        self._count = 0
        self._spawn("", SIZE / 2, SIZE / 2, 0.0)
        self.canvas.clear()
        return response
