"""Short ways to write transforms."""

from math import cos, sin

import builtin_interfaces.msg
from geometry_msgs.msg import TransformStamped


def stamped(
    parent: str, child: str, stamp_ns: int = 0, x: float = 0.0, y: float = 0.0, yaw: float = 0.0
) -> TransformStamped:
    """A transform with a shift in the plane [m] and a turn about z [rad]."""
    seconds, nanoseconds = divmod(stamp_ns, 10**9)
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id = parent
    message.header.stamp = builtin_interfaces.msg.Time(sec=seconds, nanosec=nanoseconds)
    message.transform.translation.x, message.transform.translation.y = x, y
    message.transform.rotation.z, message.transform.rotation.w = sin(yaw / 2), cos(yaw / 2)
    return message
