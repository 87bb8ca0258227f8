"""demo_nodes_py and demo_nodes_cpp: the nodes of ROS's first tutorials, with the same output.

The nodes of demo_nodes_cpp are programs in C++ on a robot. Here they are written in Python.
"""

import sys

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from rclpy.publisher import Publisher
from std_msgs.msg import String

PERIOD = 1.0  # [s]
# The numbers that the client adds.
A, B = 2, 3


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
