"""Publishers that publish only while their node is active."""

from typing import Any

from rclpy.impl.endpoint import MsgT
from rclpy.lifecycle.managed_entity import SimpleManagedEntity
from rclpy.publisher import Publisher


class LifecyclePublisher(SimpleManagedEntity, Publisher[MsgT]):
    """A publisher that is active while its node is; created by `create_lifecycle_publisher`."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    @SimpleManagedEntity.when_enabled
    def publish(self, msg: MsgT | bytes) -> None:
        """Publish a message or serialized bytes. Do nothing while the node is not active."""
        Publisher.publish(self, msg)
