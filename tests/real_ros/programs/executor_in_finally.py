# mypy: ignore-errors
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

rclpy.init()
node = Node("n")
executor = MultiThreadedExecutor(2)
executor.add_node(node)
try:
    executor.spin()
except KeyboardInterrupt:
    print("interrupted")
finally:
    print("shut down", executor.shutdown())
    node.destroy_node()
    rclpy.shutdown()
