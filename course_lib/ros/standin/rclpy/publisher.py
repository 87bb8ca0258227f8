"""Publishers."""

from course_lib.ros.messages import serialize
from course_lib.ros.mistakes import Mistake, marked
from course_lib.ros.time.time_lock import time_lock
from rclpy.duration import Duration
from rclpy.impl.endpoint import MsgT, TopicEnd
from rclpy.impl.implementation_singleton import RCLError


class Publisher(TopicEnd[MsgT]):
    """A publisher on a topic, created by `Node.create_publisher`."""

    def publish(self, msg: MsgT | bytes) -> None:
        """Publish a message, or the bytes of a serialized message.

        The message is copied, so later changes to it have no effect. Raises a TypeError for a
        message of another type.
        """
        handle = self.handle.require()
        if type(msg) is not self.msg_type and not isinstance(msg, (self.msg_type, bytes)):
            raise TypeError(f"Expected {self.msg_type}, got {type(msg)}")
        if not handle.node.context.is_valid:
            error = RCLError("Failed to publish: publisher's context is invalid")
            # In a notebook a cell with rclpy.shutdown() is more likely than Ctrl+C.
            raise marked(error, Mistake.SHUT_DOWN) if handle.node.graph.notebook else error
        # Without this call, a thread that publishes in a tight loop would stop robot time.
        time_lock.poll()
        handle.node.graph.publish(handle.id, msg if isinstance(msg, bytes) else serialize(msg))
        if self._course_deadline is not None:
            self._course_deadline.restart()

    def get_subscription_count(self) -> int:
        """Return the number of matched subscriptions."""
        if not self.handle.require().node.context.is_valid:
            raise RCLError("failed to get subscription count: publisher's context is invalid")
        missing = f"no subscription to {self.topic_name} matches."
        time_lock.poll(lambda: "" if self._course_partner_count() else missing)
        return self._course_partner_count()

    def wait_for_all_acked(self, timeout: Duration = Duration(seconds=-1)) -> bool:  # noqa: B008
        """Return True: published messages have already been delivered, because none are lost in transit."""
        self.handle.require()
        if not isinstance(timeout, Duration):
            timeout._duration_handle  # noqa: B018 - Python's error, as in rclpy
        return True

    def assert_liveliness(self) -> None:
        """Do nothing. Liveliness leases are not monitored here."""
        self.handle.require()
