# mypy: ignore-errors
import rclpy
from rclpy.node import Node

rclpy.init()
rclpy.spin(Node("n"))
print("spun")
