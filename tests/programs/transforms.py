"""Sends transforms, and looks them up in threads: with timeouts, at now, by coroutines."""

import threading

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import (
    Buffer,
    StaticTransformBroadcaster,
    TransformBroadcaster,
    TransformException,
    TransformListener,
)


class Sender(Node):
    """Sends world -> base at 20 Hz and base -> camera once."""

    def __init__(self) -> None:
        super().__init__("sender")
        self.broadcaster = TransformBroadcaster(self)
        StaticTransformBroadcaster(self).sendTransform(self.stamped("base", "camera"))
        self.create_timer(0.05, lambda: self.broadcaster.sendTransform(self.stamped("world", "base")))

    def stamped(self, parent: str, child: str) -> TransformStamped:
        """Return a transform with the present time."""
        now = self.get_clock().now()
        message = TransformStamped(child_frame_id=child)
        message.header.frame_id, message.header.stamp = parent, now.to_msg()
        message.transform.translation.x = now.nanoseconds % 10**9 / 1e9
        return message


def look(buffer: Buffer, node: Node) -> None:
    """Look up a transform repeatedly until it is available."""
    while rclpy.ok():
        when = node.get_clock().now()
        try:
            found = buffer.lookup_transform("world", "camera", when, timeout=Duration(seconds=0.2))
            text = f"{found.transform.translation.x:.3f}"
        except TransformException as error:
            text = str(error)
        waited_ms = (node.get_clock().now() - when).nanoseconds // 10**6
        node.get_logger().info(f"{text} after {waited_ms} ms")
        node.get_clock().sleep_for(Duration(seconds=0.17))


rclpy.init()
looker, sender, tf_buffer = Node("looker"), Sender(), Buffer()
TransformListener(tf_buffer, Node("listener"), spin_thread=True)
threading.Thread(target=look, args=(tf_buffer, looker), daemon=True).start()


async def wait() -> None:
    """Await a transform that becomes available with the next broadcast."""
    found = await tf_buffer.lookup_transform_async("world", "camera", Time())
    looker.get_logger().info(f"{found.header.stamp.nanosec} ns")


executor = rclpy.get_global_executor()
executor.create_task(wait)
rclpy.spin(sender)
