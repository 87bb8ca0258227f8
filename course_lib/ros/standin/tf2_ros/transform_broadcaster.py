"""The broadcaster of dynamic transforms."""

from collections.abc import Iterable

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.qos import QoSProfile
from tf2_msgs.msg import TFMessage

Transforms = TransformStamped | Iterable[TransformStamped]


class TransformBroadcaster:
    """Broadcasts transforms on /tf. `qos` may be a QoS profile or a depth."""

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        self.pub_tf = node.create_publisher(TFMessage, "/tf", QoSProfile(depth=100) if qos is None else qos)

    def sendTransform(self, transform: Transforms) -> None:  # noqa: N802  # ROS's name
        """Send one or more transforms."""
        self.pub_tf.publish(TFMessage(transforms=as_list(transform)))


def as_list(transform: Transforms) -> list[TransformStamped]:
    """Return one or more transforms as a list."""
    return list(transform) if isinstance(transform, Iterable) else [transform]
