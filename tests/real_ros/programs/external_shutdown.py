# mypy: ignore-errors
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

rclpy.init()
node = Node("n")
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException) as error:
    print(type(error).__name__)
