# mypy: ignore-errors
import signal

import rclpy
from rclpy.node import Node

signal.signal(signal.SIGINT, signal.SIG_DFL)
rclpy.init()
print(signal.getsignal(signal.SIGINT) is signal.SIG_DFL)
try:
    rclpy.spin(Node("n"))
except BaseException as error:
    print(type(error).__name__)
print(rclpy.ok())
