"""Subscriptions."""

import inspect
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

from course_lib.ros.messages import deserialize, type_name
from course_lib.ros.time.time_lock import time_lock
from rclpy.callback_groups import CallbackGroup
from rclpy.impl.endpoint import Endpoint, MsgT, TopicEnd
from rclpy.impl.graph_queries import to_qos
from rclpy.impl.node_handle import Entity, NodeHandle
from rclpy.qos import QoSProfile

if TYPE_CHECKING:
    from rclpy.impl.endpoint import MessageInfo


class Subscription(Entity, TopicEnd[MsgT]):
    """A subscription to a topic, created by `Node.create_subscription`."""

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
        self.__message_class: Any = msg_type if isinstance(msg_type, type) else type(msg_type)
        self.__queue: deque[tuple[bytes, int, int]] = deque()
        offered = [info.qos for info in node.graph.endpoints_on(full_topic) if info.kind == "pub"]
        qos = to_qos(qos_profile, "sub", offered)
        self.__capacity = qos.depth if qos.history == "keep_last" else None
        subscription_id = node.graph.add_subscription(
            node.id, self._course_entity, full_topic, type_name(msg_type), qos, self.__receive
        )
        TopicEnd.__init__(self, Endpoint(node, subscription_id, full_topic), msg_type, topic, qos_profile)

    @property
    def callback(self) -> Callable[..., object]:
        """The callback, which takes the message, or the message and a MessageInfo."""
        return self.__callback

    @callback.setter
    def callback(self, callback: Callable[..., object]) -> None:
        # A hint reads the local variable `callback` of the function that raises the error.
        for count in (1, 2):
            with suppress(TypeError):
                inspect.signature(callback).bind(*[None] * count)
                # Whether it accepts a MessageInfo as second argument.
                self.__takes_info = count == 2
                break
        else:
            raise RuntimeError(
                "Subscription.__init__(): callback should be either be callable with one argument"
                "(to get only the message) or two (to get message and message info)"
            )
        self.__callback = callback

    def _course_is_ready(self) -> bool:
        """Return whether a received message waits for the callback."""
        return bool(self.__queue)

    def _course_take(self) -> Callable[[], object] | None:
        """Dequeue the oldest message, and return a function that calls the callback with it."""
        if not self.__queue:
            return None
        cdr, source_ns, received_ns = self.__queue.popleft()
        message: Any = cdr if self.raw else deserialize(cdr, self.__message_class)
        if not self.__takes_info:
            return partial(self.callback, message)
        info: MessageInfo = {
            "source_timestamp": source_ns,
            "received_timestamp": received_ns,
            "publication_sequence_number": None,
            "reception_sequence_number": None,
        }
        return partial(self.callback, message, info)

    def get_publisher_count(self) -> int:
        """Return the number of matched publishers."""
        missing = f"no publisher of {self.topic_name} matches."
        time_lock.poll(lambda: "" if self._course_partner_count() else missing)
        return self._course_partner_count()

    def destroy(self) -> None:
        """Leave the topic and discard the received messages."""
        super().destroy()
        self.__queue.clear()

    def __receive(self, cdr: bytes, source_ns: int, received_ns: int) -> None:
        """Queue a message.

        A full queue drops its oldest message. The new message takes its turn in the executor, so
        that a burst of messages does not delay other callbacks.
        """
        if self._course_deadline is not None:
            self._course_deadline.restart()
        full = len(self.__queue) == self.__capacity
        if full:
            self.__queue.popleft()
        self.__queue.append((cdr, source_ns, received_ns))
        if not full:
            self._course_node.mark_ready(self)
            self._course_node.record_work()
