"""Waiting for one message on a topic."""

from typing import Any

from rclpy.executors import wait_until
from rclpy.impl.implementation_singleton import INVALID_CONTEXT, RCLError
from rclpy.node import Node
from rclpy.qos import QoSProfile


def wait_for_message(
    msg_type: Any,
    node: Node,
    topic: str,
    *,
    qos_profile: QoSProfile | int = 1,
    time_to_wait: float = -1,
) -> tuple[bool, Any]:
    """Return (True, message) for the next message on a topic, (False, None) after the timeout.

    `time_to_wait` is in [s]; negative: without limit. The node need not be spun.
    """
    if not node.context.is_valid:
        raise RCLError(f"failed to initialize wait set: {INVALID_CONTEXT}")
    messages: list[Any] = []
    subscription = node.create_subscription(msg_type, topic, messages.append, qos_profile)

    def is_there() -> bool:
        return bool(messages) or subscription._course_is_ready()

    try:
        limit = None if time_to_wait < 0 else time_to_wait
        wait_until(node.handle, is_there, limit, f"a message on {subscription.topic_name}")
        take = None if messages else subscription._course_take()
        if take is not None:
            take()
        return bool(messages), messages[0] if messages else None
    finally:
        node.destroy_subscription(subscription)
