"""The nodes of demo_nodes_py, demo_nodes_cpp and teleop_twist_keyboard, with ROS's own output.

On a robot, those of demo_nodes_cpp are programs in C++. Here they are written in Python.
"""

import sys
from collections import deque

import rclpy
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from std_msgs.msg import String

PERIOD = 1.0  # [s]
# The numbers that the client adds.
A, B = 2, 3
# Polling period of the keys [s].
KEY_PERIOD = 0.02
# Forward and turning speed as factors of the two maximum speeds. All other keys stop the base.
MOVES = {
    "u": (1, 1), "i": (1, 0), "o": (1, -1),
    "j": (0, 1), "l": (0, -1),
    "m": (-1, -1), ",": (-1, 0), ".": (-1, 1),
}  # fmt: skip
# Factors by which keys change the two maximum speeds.
FASTER = {
    "q": (1.1, 1.1), "w": (1.1, 1.0), "e": (1.0, 1.1),
    "z": (0.9, 0.9), "x": (0.9, 1.0), "c": (1.0, 0.9),
}  # fmt: skip


class Talker(Node):
    """Publishes a counter on `chatter`."""

    def __init__(self, *, is_cpp: bool = False) -> None:
        super().__init__("talker")
        # The talker in C++ counts from 1 and quotes the text in another way.
        self._count, self._quote = (1, "'") if is_cpp else (0, '"')
        self._publisher: Publisher[String] = self.create_publisher(String, "chatter", 10)
        self.create_timer(PERIOD, self._talk)

    def _talk(self) -> None:
        message = String(data=f"Hello World: {self._count}")
        self._count += 1
        self.get_logger().info(f"Publishing: {self._quote}{message.data}{self._quote}")
        self._publisher.publish(message)


class Listener(Node):
    """Prints the messages on `chatter`."""

    def __init__(self) -> None:
        super().__init__("listener")
        self.create_subscription(String, "chatter", self._on_message, 10)

    def _on_message(self, message: String) -> None:
        self.get_logger().info(f"I heard: [{message.data}]")


class AddTwoIntsServer(Node):
    """Offers a service that adds two integers."""

    def __init__(self) -> None:
        super().__init__("add_two_ints_server")
        self.create_service(AddTwoInts, "add_two_ints", self._add)

    def _add(
        self,
        request: AddTwoInts.Request,
        response: AddTwoInts.Response,
    ) -> AddTwoInts.Response:
        response.sum = request.a + request.b
        self.get_logger().info(f"Incoming request\na: {request.a} b: {request.b}")
        return response


class ParameterBlackboard(Node):
    """A node that accepts all parameters, for the tutorials of `ros2 param`."""

    def __init__(self) -> None:
        super().__init__(
            "parameter_blackboard",
            allow_undeclared_parameters=True,
            automatically_declare_parameters_from_overrides=True,
        )
        name, count = self.get_fully_qualified_name(), len(self.get_parameters_by_prefix(""))
        self.get_logger().info(
            f"Parameter blackboard node named '{name}' ready, and serving '{count}' parameters already!"
        )


def add_two_ints() -> None:
    """Call the service once."""
    node = rclpy.create_node("add_two_ints_client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    while not client.wait_for_service(timeout_sec=1.0):
        sys.stdout.write("service not available, waiting again...\n")
    future = client.call_async(AddTwoInts.Request(a=A, b=B))
    rclpy.spin_until_future_complete(node, future)
    answer = future.result()
    if answer is not None:
        node.get_logger().info(f"Result of add_two_ints: {answer.sum}")


class TwistTeleop(Node):
    """Publishes a Twist on `cmd_vel` for each key, like the ROS program of this name."""

    # Rows of three buttons.
    KEYS = ("u", "i", "o", "j", "k", "l", "m", ",", ".", "q", "w", "e", "z", "x", "c")

    def __init__(self) -> None:
        super().__init__("teleop_twist_keyboard")
        # In [m/s] and [rad/s].
        self.declare_parameter("speed", 0.5)
        self.declare_parameter("turn", 1.0)
        self._speed, self._turn = (float(self.get_parameter(name).value) for name in ("speed", "turn"))
        self._twists = self.create_publisher(Twist, "cmd_vel", QoSProfile(depth=10))
        self._pressed: deque[str] = deque()
        self.create_timer(KEY_PERIOD, self._work)

    def press(self, key: str) -> None:
        """Press a key."""
        self._pressed.append(key)

    def _work(self) -> None:
        while self._pressed:
            key = self._pressed.popleft()
            if key in FASTER:
                speed, turn = FASTER[key]
                self._speed, self._turn = self._speed * speed, self._turn * turn
                self.get_logger().info(f"currently:\tspeed {self._speed:.2f}\tturn {self._turn:.2f}")
                continue
            forward, turn = MOVES.get(key, (0, 0))
            self._twists.publish(
                Twist(linear=Vector3(x=forward * self._speed), angular=Vector3(z=turn * self._turn))
            )
