"""Publishers."""

from collections.abc import Callable

from course_lib.ros.messages import serialize
from rclpy.exceptions import RCLError
from rclpy.impl.endpoint import MsgT, TopicEnd
from rclpy.impl.qos_conversion import to_qos
from rclpy.impl.watchdog import Watchdog


class Publisher(TopicEnd[MsgT]):
    """Publishes messages on a topic; made by `Node.create_publisher`."""

    _lease: Watchdog | None = None

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
            self.deadline.feed()
        if self._lease is not None:
            self.assert_liveliness()

    def get_subscription_count(self) -> int:
        """Count the subscriptions that it reaches."""
        return self.partner_count()

    def assert_liveliness(self) -> None:
        """Say that it is alive, as publishing does; only of use with MANUAL_BY_TOPIC and a lease."""
        if self._lease is not None:
            if self._lease.has_barked:
                self._tell_of_life(1, -1)
            self._lease.feed()

    def lease(self, on_lost: Callable[[], object]) -> None:
        """Watch over its lease, if it has one: if it is over, its subscriptions and `on_lost` are told."""
        qos = to_qos(self.qos_profile, "pub")
        if qos.liveliness != "manual_by_topic" or qos.lease_ns is None:
            return

        def lose() -> None:
            on_lost()
            self._tell_of_life(-1, 1)

        self._lease = Watchdog(self.handle.node, qos.lease_ns, lose)

    def destroy(self) -> None:
        """Leave the topic; call the node's `destroy_publisher` instead."""
        super().destroy()
        if self._lease is not None:
            self._lease.stop()

    def _tell_of_life(self, change: int, failed: int) -> None:
        for _, subscription in self.handle.partners():
            self.handle.tell_of_life(subscription, change, failed)
