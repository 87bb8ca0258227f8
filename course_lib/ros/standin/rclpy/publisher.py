"""Publishers."""

from course_lib.ros.messages import serialize
from rclpy.exceptions import RCLError
from rclpy.impl.endpoint import MsgT, TopicEnd


class Publisher(TopicEnd[MsgT]):
    """A publisher on a topic; made by `Node.create_publisher`."""

    def publish(self, msg: MsgT | bytes) -> None:
        """Publish a message, or the bytes of one, as it is now.

        Changing it afterwards changes nothing for its receivers. One of another type raises a TypeError.
        """
        handle = self.handle.require()
        if not isinstance(msg, (self.msg_type, bytes)):
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        if not handle.node.context.is_valid:
            raise RCLError("Failed to publish: publisher's context is invalid")
        handle.node.graph.publish(handle.id, msg if isinstance(msg, bytes) else serialize(msg))
        if self.deadline is not None:
            self.deadline.note()

    def get_subscription_count(self) -> int:
        """Count the subscriptions that it reaches."""
        return self.partner_count()

    def assert_liveliness(self) -> None:
        """Do nothing: leases are not watched here."""
