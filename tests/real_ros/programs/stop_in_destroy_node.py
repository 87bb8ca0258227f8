# mypy: ignore-errors
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)

    def destroy_node(self):
        print("stopping")
        self.publisher.publish(Twist())
        super().destroy_node()


rclpy.init()
driver = Driver()
try:
    rclpy.spin(driver)
except KeyboardInterrupt:
    pass
driver.destroy_node()
rclpy.try_shutdown()
