# mypy: ignore-errors
import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("n")
while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=0.1)
print("left", rclpy.ok())
rclpy.shutdown()
print("shut down")
