"""demo_nodes_py: the nodes that every ROS tutorial begins with, with their own words."""

import sys

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from rclpy.publisher import Publisher
from std_msgs.msg import String

PERIOD = 1.0  # [s]
A, B = 2, 3  # that the client adds


class Talker(Node):
    """Counts on `chatter`."""

    def __init__(self) -> None:
        super().__init__("talker")
        self._count = 0
        self._words: Publisher[String] = self.create_publisher(String, "chatter", 10)
        self.create_timer(PERIOD, self._talk)

    def _talk(self) -> None:
        said = String(data=f"Hello World: {self._count}")
        self._count += 1
        self.get_logger().info(f'Publishing: "{said.data}"')
        self._words.publish(said)


class Listener(Node):
    """Prints what `chatter` carries."""

    def __init__(self) -> None:
        super().__init__("listener")
        self.create_subscription(String, "chatter", self._hear, 10)

    def _hear(self, said: String) -> None:
        self.get_logger().info(f"I heard: [{said.data}]")


class AddTwoIntsServer(Node):
    """Adds."""

    def __init__(self) -> None:
        super().__init__("add_two_ints_server")
        self.create_service(AddTwoInts, "add_two_ints", self._add)

    def _add(self, request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
        response.sum = request.a + request.b
        self.get_logger().info(f"Incoming request\na: {request.a} b: {request.b}")
        return response


def add_two_ints() -> None:
    """Ask the server for one sum."""
    node = rclpy.create_node("add_two_ints_client")
    client = node.create_client(AddTwoInts, "add_two_ints")
    while not client.wait_for_service(timeout_sec=1.0):
        sys.stdout.write("service not available, waiting again...\n")
    future = client.call_async(AddTwoInts.Request(a=A, b=B))
    rclpy.spin_until_future_complete(node, future)
    answer = future.result()
    if answer is not None:
        node.get_logger().info(f"Result of add_two_ints: {answer.sum}")
