"""The broadcaster of static transforms."""

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from tf2_ros.transform_broadcaster import Transforms, as_list


class StaticTransformBroadcaster:
    """Broadcasts static transforms on /tf_static, by default with TRANSIENT_LOCAL durability.

    Each message contains all transforms sent so far. As in ROS 2 Jazzy, the first object for a
    child frame is kept: a second object for the same child has no effect, but changes of the first
    object have.
    """

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        if qos is None:
            qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", qos)
        self.net_message = TFMessage()

    def sendTransform(self, transform: Transforms) -> None:  # noqa: N802  # ROS's name
        """Send one or more transforms, together with all earlier ones."""
        transforms = self.net_message.transforms
        for new in as_list(transform):
            if all(new.child_frame_id != other.child_frame_id for other in transforms):
                transforms.append(new)
        self.pub_tf.publish(self.net_message)
