"""A wait for one message on a topic."""

from typing import Any

from rclpy.executors import wait_until
from rclpy.node import Node
from rclpy.qos import QoSProfile


def wait_for_message(
    msg_type: Any, node: Node, topic: str, *, qos_profile: QoSProfile | int = 1, time_to_wait: float = -1
) -> tuple[bool, Any]:
    """Return (True, message) for the next one on a topic, (False, None) if none came in time.

    `time_to_wait` is in [s]; negative: without limit. Nobody has to spin the node.
    """
    heard: list[Any] = []
    subscription = node.create_subscription(msg_type, topic, heard.append, qos_profile)

    def is_there() -> bool:
        return bool(heard) or subscription.is_ready()

    try:
        limit = None if time_to_wait < 0 else time_to_wait
        wait_until(node.handle, is_there, limit, f"a message on {subscription.topic_name}")
        take = None if heard else subscription.take()
        if take is not None:
            take()
        return bool(heard), heard[0] if heard else None
    finally:
        node.destroy_subscription(subscription)
