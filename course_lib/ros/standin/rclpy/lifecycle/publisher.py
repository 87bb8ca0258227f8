"""Publishers that publish only while their node is active."""

from typing import Any

from rclpy.impl.endpoint import MsgT
from rclpy.lifecycle.managed_entity import SimpleManagedEntity
from rclpy.publisher import Publisher


class LifecyclePublisher(SimpleManagedEntity, Publisher[MsgT]):
    """A publisher managed by its node's state; made by `LifecycleNode.create_lifecycle_publisher`."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    @SimpleManagedEntity.when_enabled
    def publish(self, msg: MsgT | bytes) -> None:
        """Publish a message, or the bytes of one; while its node is not active, do nothing."""
        Publisher.publish(self, msg)
