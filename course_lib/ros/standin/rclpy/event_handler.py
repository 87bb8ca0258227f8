"""Events of publishers and subscriptions: partners that come and go or do not fit, and missed deadlines."""

from collections import Counter, deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from course_lib.ros.clock import Alarm
from rclpy.callback_groups import CallbackGroup
from rclpy.exceptions import UnsupportedEventTypeError as UnsupportedEventTypeError
from rclpy.impl.node_handle import Entity, NodeHandle
from rclpy.logging import get_logger
from rclpy.qos import QoSPolicyKind


@dataclass
class QoSRequestedDeadlineMissedInfo:
    """A count of events: in all, and since the last call."""

    total_count: int
    total_count_change: int


@dataclass
class QoSRequestedIncompatibleQoSInfo(QoSRequestedDeadlineMissedInfo):
    """A count of partners that did not fit, and the policy that was the reason for the last one."""

    last_policy_kind: QoSPolicyKind


@dataclass
class QoSSubscriptionMatchedInfo(QoSRequestedDeadlineMissedInfo):
    """The number of partners that there have been, and that there are."""

    current_count: int
    current_count_change: int


QoSOfferedDeadlineMissedInfo = QoSRequestedDeadlineMissedInfo
QoSMessageLostInfo = QoSRequestedDeadlineMissedInfo
QoSLivelinessLostInfo = QoSRequestedDeadlineMissedInfo
IncompatibleTypeInfo = QoSRequestedDeadlineMissedInfo
QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo
QoSPublisherMatchedInfo = QoSSubscriptionMatchedInfo
Tell = Callable[[Any], object]


class Events:
    """The counts of one publisher or subscription, and the receivers of its events, by the event's name."""

    def __init__(self, tell: Mapping[str, Tell]) -> None:
        self.tell = tell
        self._counts: Counter[str] = Counter()

    def count(self, event: str, **more: Any) -> None:
        """Count an event and report it."""
        self._counts[event] += 1
        kind = QoSRequestedIncompatibleQoSInfo if more else QoSRequestedDeadlineMissedInfo
        self._say(event, kind(self._counts[event], 1, **more))

    def matched(self, change: int) -> None:
        """Report that a partner has come (1) or gone (-1)."""
        self._counts["partners"] += max(change, 0)
        self._counts["matched"] += change
        total, now = self._counts["partners"], self._counts["matched"]
        self._say("matched", QoSSubscriptionMatchedInfo(total, max(change, 0), now, change))

    def _say(self, event: str, info: Any) -> None:
        if event in self.tell:
            self.tell[event](info)


class EventCallbacks:
    """The callbacks for one side, by event; where none is given, a warning may be logged instead.

    Leases are not watched here: with a callback for `liveliness` a warning is logged that it is never called.
    """

    _events: tuple[str, ...] = ("deadline", "incompatible_qos", "incompatible_type", "liveliness", "matched")
    _warning: str

    def __init__(self, *, use_default_callbacks: bool = True, **callbacks: Tell | None) -> None:
        for name in callbacks.keys() - set(self._events):
            raise TypeError(f"{type(self).__name__}.__init__() got an unexpected keyword argument '{name}'")
        self.use_default_callbacks = use_default_callbacks
        self.callbacks = {name: callback for name, callback in callbacks.items() if callback is not None}

    def bind(self, node: NodeHandle, topic: str, callback_group: CallbackGroup) -> Events:
        """Return the receivers: callbacks run in an executor, warnings are logged immediately."""
        tell: dict[str, Tell] = {}
        if self.use_default_callbacks:
            warn = get_logger(node.logger_name).warning
            text = f"Incompatible type on topic '{topic}', no messages will be sent to it."
            tell["incompatible_type"] = lambda _: warn(text)
            tell["incompatible_qos"] = lambda info: warn(
                self._warning.format(topic, QoSPolicyKind(info.last_policy_kind).name)
            )
        if "liveliness" in self.callbacks:
            warning = f"Liveliness is not watched here: its callback on '{topic}' runs on a robot only."
            get_logger(node.logger_name).warning(warning)
        for name, callback in self.callbacks.items():
            tell[name] = EventHandler(node, callback_group, callback).happen
        return Events(tell)


class SubscriptionEventCallbacks(EventCallbacks):
    """The callbacks of a subscription; messages are never lost here."""

    _events = (*EventCallbacks._events, "message_lost")
    _warning = (
        "New publisher discovered on topic '{}', offering incompatible QoS. "
        "No messages will be received from it. Last incompatible policy: {}"
    )


class PublisherEventCallbacks(EventCallbacks):
    """The callbacks of a publisher."""

    _warning = (
        "New subscription discovered on topic '{}', requesting incompatible QoS. "
        "No messages will be sent to it. Last incompatible policy: {}"
    )


class EventHandler(Entity):
    """A callback that an executor runs when an event has happened."""

    def __init__(self, node: NodeHandle, callback_group: CallbackGroup, callback: Tell) -> None:
        super().__init__(node, callback_group)
        self._callback = callback
        self._infos: deque[Any] = deque()

    def happen(self, info: Any) -> None:
        """Note what has happened."""
        self._infos.append(info)
        self.node_handle.mark_ready(self)

    def take(self) -> Callable[[], object]:
        """Remove the oldest event; returns the call that reports it."""
        return partial(self._callback, self._infos.popleft())


class Deadline:
    """A deadline, [ns]: calls back whenever no message has been noted for that long, after the first one."""

    def __init__(self, node: NodeHandle, limit_ns: int, missed: Callable[[], object]) -> None:
        self._node, self._limit_ns, self._missed = node, limit_ns, missed
        self._entity = node.next_entity()
        self._alarm: Alarm | None = None

    def note(self) -> None:
        """Note a message: the time begins again."""
        self.stop()
        graph = self._node.graph
        due_ns = graph.now_ns + self._limit_ns
        self._alarm = graph.call_at(due_ns, self._ring, node=self._node.id, entity=self._entity)

    def stop(self) -> None:
        """Stop until the next message."""
        if self._alarm is not None:
            self._alarm.cancel()

    def _ring(self) -> None:
        self.note()
        self._missed()
