"""Publishers."""

from typing import Generic, TypeVar

from course_lib.ros.messages import Message, serialize
from rclpy.exceptions import RCLError
from rclpy.impl.endpoint import Endpoint
from rclpy.qos import QoSProfile

MsgT = TypeVar("MsgT", bound=Message)


class Publisher(Generic[MsgT]):
    """Publishes messages on a topic; made by `Node.create_publisher`."""

    def __init__(self, handle: Endpoint, msg_type: type[MsgT], topic: str, qos_profile: QoSProfile) -> None:
        self._handle = handle
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile

    @property
    def handle(self) -> Endpoint:
        """The publisher as the graph knows it."""
        return self._handle

    @property
    def topic_name(self) -> str:
        """The fully resolved topic."""
        return self._handle.require().topic_name

    def publish(self, msg: MsgT | bytes) -> None:
        """Publish a message, or the bytes of one, as it is now.

        Changing it afterwards changes nothing for its receivers. One of another type raises a TypeError.
        """
        handle = self._handle.require()
        if not isinstance(msg, (self.msg_type, bytes)):
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        if not handle.node.context.is_valid:
            raise RCLError("Failed to publish: publisher's context is invalid")
        handle.node.graph.publish(handle.id, msg if isinstance(msg, bytes) else serialize(msg))

    def get_subscription_count(self) -> int:
        """Count the subscriptions that it reaches."""
        return self._handle.require().partner_count()

    def destroy(self) -> None:
        """Leave the topic; call `Node.destroy_publisher` instead."""
        self._handle.destroy()
