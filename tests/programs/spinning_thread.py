"""A thread that spins while the main thread publishes the received messages."""

import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Echo(Node):
    def __init__(self) -> None:
        super().__init__("echo")
        self.last = "nothing"
        self.publisher = self.create_publisher(String, "said", 10)
        self.create_subscription(String, "said", self.hear, 10)
        self.create_timer(0.07, lambda: self.publisher.publish(String(data="tick")))

    def hear(self, message: String) -> None:
        self.last = message.data


rclpy.init()
node = Echo()
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
for number in range(20):
    time.sleep(0.1)
    node.publisher.publish(String(data=f"{number} after {node.last}"))
