# mypy: ignore-errors
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
node = Node("driver")
node.create_timer(0.1, lambda: None)
publisher = node.create_publisher(Twist, "cmd_vel", 10)
try:
    rclpy.spin(node)
except KeyboardInterrupt:
    print("interrupted", rclpy.ok())
    publisher.publish(Twist())
    print("stopped the robot")
finally:
    node.destroy_node()
    rclpy.shutdown()
    print("shut down")
