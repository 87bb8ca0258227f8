"""A node with a timer."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import Int32


class Counter(Node):
    def __init__(self) -> None:
        super().__init__("counter")
        self.publisher = self.create_publisher(Int32, "count", 10)
        self.count = 0
        self.create_timer(0.1, self.tick)

    def tick(self) -> None:
        self.count += 1
        self.publisher.publish(Int32(data=self.count))


def main() -> None:
    rclpy.init()
    rclpy.spin(Counter())
    rclpy.shutdown()


if __name__ == "__main__":
    main()
