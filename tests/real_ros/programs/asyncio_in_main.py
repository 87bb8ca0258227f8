# mypy: disable-error-code="import-not-found"
"""Ctrl+C during `asyncio.run`, which replaces rclpy's handler by its own: rclpy stays initialized."""

import asyncio
import signal

import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("node")
publisher = node.create_publisher(String, "chatter", 10)
try:
    asyncio.run(asyncio.sleep(60.0))
except KeyboardInterrupt:
    print("interrupted", rclpy.ok(), flush=True)
publisher.publish(String())
print("published", signal.getsignal(signal.SIGINT) is signal.default_int_handler, flush=True)
