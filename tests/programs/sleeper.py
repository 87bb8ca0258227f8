"""A loop with time.sleep, as beginners write it."""

import time

import rclpy
from std_msgs.msg import Float64

rclpy.init()
node = rclpy.create_node("sleeper")
publisher = node.create_publisher(Float64, "uptime", 10)
start = time.time()
while rclpy.ok():
    publisher.publish(Float64(data=time.time() - start))
    time.sleep(0.1)
node.destroy_node()
rclpy.shutdown()
