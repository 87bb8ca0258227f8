# mypy: disable-error-code="import-not-found"
"""A handler of Ctrl+C that was installed after `rclpy.init` replaces rclpy's handler."""

import signal
from types import FrameType

import rclpy


def shut_down(number: int, frame: FrameType | None) -> None:
    """Shut down, as rclpy's handler would."""
    print("signal", number, rclpy.ok(), flush=True)
    rclpy.shutdown()


rclpy.init()
print("default", signal.getsignal(signal.SIGINT) is signal.default_int_handler, flush=True)
print("default", signal.getsignal(signal.SIGTERM) is signal.SIG_DFL, flush=True)
print("default", signal.signal(signal.SIGINT, shut_down) is signal.default_int_handler, flush=True)
node = rclpy.create_node("node")
# Without a timer, the spin of ROS would not end.
node.create_timer(0.1, lambda: None)
rclpy.spin(node)
print("ended", rclpy.ok(), flush=True)
