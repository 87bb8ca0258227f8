"""Waiting for one message."""

from typing import TYPE_CHECKING, Any

from rclpy.client import wait_until
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.node import Node


def wait_for_message(
    msg_type: Any, node: "Node", topic: str, *, qos_profile: QoSProfile | int = 1, time_to_wait: float = -1
) -> tuple[bool, Any]:
    """Wait for the next message on a topic, without a callback; nobody has to spin the node.

    At most `time_to_wait` [s]; negative: without limit. Returns (True, the message), or (False, None).
    """
    came: list[Any] = []
    subscription = node.create_subscription(msg_type, topic, came.append, qos_profile)
    try:
        limit, what = (None if time_to_wait < 0 else time_to_wait), f"a message on {topic}"
        wait_until(node.handle, lambda: bool(came) or subscription.has_message, limit, what)
        call = subscription.take()
        if call is not None:
            call()
    finally:
        node.destroy_subscription(subscription)
    return (True, came[0]) if came else (False, None)
