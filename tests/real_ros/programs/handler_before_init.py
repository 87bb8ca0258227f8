# mypy: disable-error-code="import-not-found"
"""A handler of Ctrl+C that was installed before `rclpy.init`: rclpy shuts down, then calls it."""

import signal
from types import FrameType

import rclpy
from rclpy.executors import ExternalShutdownException


def report(number: int, frame: FrameType | None) -> None:
    """Print the number of the signal."""
    print("signal", number, flush=True)


signal.signal(signal.SIGINT, report)
rclpy.init()
print("handler", signal.getsignal(signal.SIGINT) is report, flush=True)
node = rclpy.create_node("node")
try:
    rclpy.spin(node)
except ExternalShutdownException:
    print("ended", rclpy.ok(), flush=True)
