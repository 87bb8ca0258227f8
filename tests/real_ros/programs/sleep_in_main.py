# mypy: ignore-errors
import time

import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("n")
try:
    while True:
        time.sleep(0.1)
except KeyboardInterrupt:
    print("interrupted")
node.destroy_node()
rclpy.try_shutdown()
print("left")
