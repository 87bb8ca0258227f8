# mypy: ignore-errors
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


def main() -> None:
    rclpy.init()
    node = Node("driver")
    publisher = node.create_publisher(Twist, "cmd_vel", 10)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        print("interrupted")
    finally:
        publisher.publish(Twist())
        print("stopped the robot")
        node.destroy_node()
        rclpy.shutdown()


main()
