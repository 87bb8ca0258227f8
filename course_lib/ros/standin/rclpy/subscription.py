"""Subscriptions."""

import inspect
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import Any, TypedDict

from course_lib.ros.messages import deserialize, type_name
from rclpy.callback_groups import CallbackGroup
from rclpy.impl.endpoint import Endpoint, MsgT, TopicEnd
from rclpy.impl.graph_queries import to_qos
from rclpy.impl.node_handle import Entity, NodeHandle
from rclpy.qos import QoSProfile


class MessageInfo(TypedDict):
    """The times of publication and reception of a message, [ns]; the middleware counts nothing."""

    source_timestamp: int
    received_timestamp: int
    publication_sequence_number: int | None
    reception_sequence_number: int | None


class Subscription(Entity, TopicEnd[MsgT]):
    """A subscription to a topic; made by `Node.create_subscription`."""

    def __init__(
        self,
        node: NodeHandle,
        msg_type: type[MsgT],
        topic: str,
        full_topic: str,
        callback: Callable[..., object],
        callback_group: CallbackGroup,
        qos_profile: QoSProfile,
        raw: bool,
    ) -> None:
        Entity.__init__(self, node, callback_group)
        self.callback = callback
        self.raw = raw
        self._takes_info = _takes_info(callback)
        self._queue: deque[tuple[bytes, int, int]] = deque()
        qos = to_qos(qos_profile, "sub")
        self._capacity = qos.depth if qos.history == "keep_last" else None
        added = node.graph.add_subscription(
            node.id, self.entity, full_topic, type_name(msg_type), qos, self._receive
        )
        TopicEnd.__init__(self, Endpoint(node, added, full_topic), msg_type, topic, qos_profile)

    def is_ready(self) -> bool:
        """Return whether a message has come that its callback has not got yet."""
        return bool(self._queue)

    def take(self) -> Callable[[], object] | None:
        """Remove the oldest message; returns the call with a copy of its own, made from the bytes."""
        if not self._queue:
            return None
        cdr, source_ns, received_ns = self._queue.popleft()
        message: Any = cdr if self.raw else deserialize(cdr, self.msg_type)
        if not self._takes_info:
            return partial(self.callback, message)
        info = MessageInfo(
            source_timestamp=source_ns,
            received_timestamp=received_ns,
            publication_sequence_number=None,
            reception_sequence_number=None,
        )
        return partial(self.callback, message, info)

    def get_publisher_count(self) -> int:
        """Count the publishers that it hears."""
        return self.partner_count()

    def destroy(self) -> None:
        """Leave the topic and forget what came in."""
        super().destroy()
        self._queue.clear()

    def _receive(self, cdr: bytes, source_ns: int, received_ns: int) -> None:
        """Queue a message; a full queue loses its oldest one, whose turn the next one takes."""
        if self.deadline is not None:
            self.deadline.note()
        full = len(self._queue) == self._capacity
        if full:
            self._queue.popleft()
        self._queue.append((cdr, source_ns, received_ns))
        if not full:
            self.node_handle.mark_ready(self)


def _takes_info(callback: Callable[..., object]) -> bool:
    """Return whether a callback takes a MessageInfo as well."""
    for count in (1, 2):
        with suppress(TypeError):
            inspect.signature(callback).bind(*[None] * count)
            return count == 2
    raise RuntimeError(
        "Subscription.__init__(): callback should be either be callable with one argument"
        "(to get only the message) or two (to get message and message info)"
    )
