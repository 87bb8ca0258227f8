"""Two nodes with simultaneous timers, which receive each other's messages."""

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Partner(Node):
    def __init__(self, name: str, other: str) -> None:
        super().__init__(name)
        self.heard = 0
        self.publisher = self.create_publisher(String, name, 10)
        self.create_subscription(String, other, self.hear, 10)
        self.create_timer(0.1, self.tick)

    def hear(self, message: String) -> None:
        self.heard += len(message.data)

    def tick(self) -> None:
        self.publisher.publish(String(data=f"{self.get_name()} heard {self.heard}"))


rclpy.init()
executor = SingleThreadedExecutor()
for name, other in (("ping", "pong"), ("pong", "ping")):
    executor.add_node(Partner(name, other))
executor.spin()
