"""The broadcaster of transforms that hold at any time."""

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from tf2_ros.transform_broadcaster import Transforms, as_list


class StaticTransformBroadcaster:
    """A broadcaster on /tf_static, which sends all transforms so far each time; by default TRANSIENT_LOCAL.

    As in ROS 2 Jazzy it keeps the first object that it was given for a child frame: another one for the same
    child changes nothing, the same one with new numbers does.
    """

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        if qos is None:
            qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", qos)
        self.net_message = TFMessage()

    def sendTransform(self, transform: Transforms) -> None:  # noqa: N802  # ROS's name
        """Send a transform or several, with all earlier ones."""
        kept = self.net_message.transforms
        for one in as_list(transform):
            if all(one.child_frame_id != other.child_frame_id for other in kept):
                kept.append(one)
        self.pub_tf.publish(self.net_message)
