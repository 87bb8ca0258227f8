"""Calls a service from several threads, sets a parameter by its service, and publishes the responses."""

from __future__ import annotations

from contextlib import suppress

import rclpy
from example_interfaces.srv import AddTwoInts
from rcl_interfaces.msg import SetParametersResult
from rcl_interfaces.srv import SetParameters
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
from std_msgs.msg import Int64


class Adder(Node):
    def __init__(self) -> None:
        super().__init__("adder")
        self.declare_parameter("more", 0)
        self.add_on_set_parameters_callback(lambda parameters: SetParametersResult(successful=True))
        group = ReentrantCallbackGroup()
        self.create_service(AddTwoInts, "add", self.add, callback_group=group)

    def add(self, request: AddTwoInts.Request, response: AddTwoInts.Response) -> AddTwoInts.Response:
        response.sum = request.a + request.b + self.get_parameter("more").value
        return response


class Asker(Node):
    def __init__(self) -> None:
        super().__init__("asker")
        self.sums = self.create_publisher(Int64, "sums", 10)
        answers = MutuallyExclusiveCallbackGroup()  # not that of the timers, which wait for them
        self.adds = self.create_client(AddTwoInts, "add", callback_group=answers)
        self.sets = self.create_client(SetParameters, "/adder/set_parameters", callback_group=answers)
        self.count = 0
        self.create_timer(0.1, self.ask)
        self.create_timer(0.25, self.change)

    def ask(self) -> None:
        self.count += 1
        if self.count % 2:
            self.sums.publish(Int64(data=self.adds.call(AddTwoInts.Request(a=self.count)).sum))
        else:
            future = self.adds.call_async(AddTwoInts.Request(b=self.count))
            future.add_done_callback(self.tell)

    def tell(self, done: Future[AddTwoInts.Response]) -> None:
        response = done.result()
        assert response is not None
        self.sums.publish(Int64(data=response.sum))

    async def change(self) -> None:
        more = Parameter("more", value=self.count).to_parameter_msg()
        response = await self.sets.call_async(SetParameters.Request(parameters=[more]))
        assert response is not None
        self.get_logger().info(f"changed: {response.results[0].successful}")


def main() -> None:
    rclpy.init()
    executor = MultiThreadedExecutor(4)
    for node in (Adder(), Asker()):
        executor.add_node(node)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == "__main__":
    main()
