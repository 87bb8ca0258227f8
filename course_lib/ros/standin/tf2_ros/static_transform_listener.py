"""The listener that fills a buffer with the transforms on /tf_static only."""

from rclpy.node import Node
from rclpy.qos import QoSProfile

from tf2_ros.buffer import Buffer
from tf2_ros.transform_listener import DEFAULT_STATIC_TF_TOPIC as DEFAULT_STATIC_TF_TOPIC
from tf2_ros.transform_listener import DEFAULT_TF_TOPIC as DEFAULT_TF_TOPIC
from tf2_ros.transform_listener import TransformListener


class StaticTransformListener(TransformListener):
    """Stores received static transforms in a buffer while its node is spun.

    See TransformListener.
    """

    def __init__(
        self,
        buffer: Buffer,
        node: Node,
        *,
        spin_thread: bool = False,
        static_qos: QoSProfile | int | None = None,
        tf_static_topic: str = DEFAULT_STATIC_TF_TOPIC,
    ) -> None:
        super().__init__(
            buffer,
            node,
            spin_thread=spin_thread,
            static_qos=static_qos,
            tf_static_topic=tf_static_topic,
            static_only=True,
        )
