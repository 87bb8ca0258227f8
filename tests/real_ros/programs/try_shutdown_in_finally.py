# mypy: ignore-errors
import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("n")
rclpy.get_default_context().on_shutdown(lambda: print("on_shutdown"))
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    print("interrupted")
finally:
    node.destroy_node()
    rclpy.try_shutdown()
    print("left")
