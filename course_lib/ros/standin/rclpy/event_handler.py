"""Events of publishers and subscriptions, for example matched endpoints and missed deadlines."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from enum import IntEnum
from typing import Any

from course_lib.ros.graph.graph import Alarm
from rclpy.callback_groups import CallbackGroup
from rclpy.impl.implementation_singleton import UnsupportedEventTypeError as UnsupportedEventTypeError
from rclpy.impl.node_handle import Entity, NodeHandle
from rclpy.logging import get_logger
from rclpy.qos import QoSPolicyKind


class RmwPolicyKind(IntEnum):
    """A QoS policy as events report it, with the names of rclpy's C layer."""

    RMW_QOS_POLICY_INVALID = QoSPolicyKind.INVALID
    RMW_QOS_POLICY_DURABILITY = QoSPolicyKind.DURABILITY
    RMW_QOS_POLICY_DEADLINE = QoSPolicyKind.DEADLINE
    RMW_QOS_POLICY_LIVELINESS = QoSPolicyKind.LIVELINESS
    RMW_QOS_POLICY_RELIABILITY = QoSPolicyKind.RELIABILITY
    RMW_QOS_POLICY_HISTORY = QoSPolicyKind.HISTORY
    RMW_QOS_POLICY_LIFESPAN = QoSPolicyKind.LIFESPAN

    def __str__(self) -> str:
        return f"rmw_qos_policy_kind_t.{self.name}"

    def __repr__(self) -> str:
        return f"<{self}: {self.value}>"


@dataclass(repr=False)
class _Count:
    """The number of events in total, and since the last call."""

    total_count: int
    total_count_change: int


class QoSRequestedDeadlineMissedInfo(_Count):
    """The missed deadlines of a subscription."""


class QoSOfferedDeadlineMissedInfo(_Count):
    """The missed deadlines of a publisher."""


class QoSMessageLostInfo(_Count):
    """The lost messages."""


class QoSLivelinessLostInfo(_Count):
    """The missed assertions of a publisher that it is alive."""


class IncompatibleTypeInfo(_Count):
    """The endpoints with another type."""


@dataclass(repr=False)
class QoSRequestedIncompatibleQoSInfo(_Count):
    """The number of incompatible endpoints, and the policy that rejected the last one."""

    last_policy_kind: RmwPolicyKind


@dataclass(repr=False)
class QoSSubscriptionMatchedInfo(_Count):
    """The total number of matched endpoints, and the number that still exist."""

    current_count: int
    current_count_change: int


@dataclass(repr=False)
class QoSLivelinessChangedInfo:
    """The number of alive and not alive publishers, and the changes since the last call."""

    alive_count: int
    not_alive_count: int
    alive_count_change: int
    not_alive_count_change: int


QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo
QoSPublisherMatchedInfo = QoSSubscriptionMatchedInfo
# Programs print these objects: with the names of rclpy's C layer, and without their values.
for _kind, _name in {
    RmwPolicyKind: "qos_policy_kind_t",
    QoSRequestedDeadlineMissedInfo: "requested_deadline_missed_status_t",
    QoSOfferedDeadlineMissedInfo: "offered_deadline_missed_status_t",
    QoSMessageLostInfo: "message_lost_status_t",
    QoSLivelinessLostInfo: "liveliness_lost_status_t",
    IncompatibleTypeInfo: "incompatible_type_status_t",
    QoSRequestedIncompatibleQoSInfo: "requested_qos_incompatible_event_status_t",
    QoSSubscriptionMatchedInfo: "matched_status_t",
    QoSLivelinessChangedInfo: "liveliness_changed_status_t",
}.items():
    _kind.__name__ = _kind.__qualname__ = f"rmw_{_name}"
    _kind.__module__ = "rclpy._rclpy_pybind11"


class QoSPublisherEventType(IntEnum):
    """The types of publisher events."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2
    RCL_PUBLISHER_INCOMPATIBLE_TYPE = 3
    RCL_PUBLISHER_MATCHED = 4


class QoSSubscriptionEventType(IntEnum):
    """The types of subscription events."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE = 4
    RCL_SUBSCRIPTION_MATCHED = 5


Report = Callable[[Any], object]


@dataclass(eq=False, repr=False)
class Events:
    """The event counters of a publisher or subscription, and receivers of its events, by name."""

    tell: Mapping[str, Report]
    handlers: "list[EventHandler]"
    # The class of the objects that report missed deadlines.
    deadline_info: type[_Count]
    _counts: Counter[str] = field(default_factory=Counter)

    def count(self, event: str, **more: Any) -> None:
        """Count an event and report the new count."""
        self._counts[event] += 1
        if more:
            self._say(event, QoSRequestedIncompatibleQoSInfo(self._counts[event], 1, **more))
        else:
            kind = self.deadline_info if event == "deadline" else IncompatibleTypeInfo
            self._say(event, kind(self._counts[event], 1))

    def matched(self, change: int) -> None:
        """Report that a matched endpoint was added (1) or removed (-1)."""
        self._counts["partners"] += max(change, 0)
        self._counts["matched"] += change
        total, now = self._counts["partners"], self._counts["matched"]
        self._say("matched", QoSSubscriptionMatchedInfo(total, max(change, 0), now, change))

    def _say(self, event: str, info: Any) -> None:
        if event in self.tell:
            self.tell[event](info)


class EventCallbacks:
    """Event callbacks of a publisher or subscription, by event.

    Without a callback, a warning may be logged.
    Liveliness leases are not monitored here: a `liveliness` callback causes a warning that it is
    never called.
    """

    _events: tuple[str, ...] = ("deadline", "incompatible_qos", "incompatible_type", "liveliness", "matched")
    _warning: str
    _deadline_info: type[_Count]
    deadline: Report | None
    incompatible_qos: Report | None
    incompatible_type: Report | None
    liveliness: Report | None
    matched: Report | None
    use_default_callbacks: bool

    @classmethod
    def require(cls, given: object) -> None:
        """Raise rclpy's error for an object without the event callbacks of this side, unless falsy."""
        if isinstance(given, EventCallbacks) and not isinstance(given, cls):
            raise TypeError("__init__(): incompatible constructor arguments.")
        if given and not isinstance(given, EventCallbacks):
            given.create_event_handlers  # type: ignore[attr-defined]  # noqa: B018 - Python's error

    def bind(self, node: NodeHandle, topic: str, callback_group: CallbackGroup) -> Events:
        """Create the receivers of events.

        Callbacks run in an executor, warnings are logged directly.
        """
        handler_by_event = {name: getattr(self, name) for name in self._events}
        callbacks: dict[str, Report] = {
            name: handler for name, handler in handler_by_event.items() if handler is not None
        }
        tell: dict[str, Report] = {}
        handlers: list[EventHandler] = []
        if self.use_default_callbacks:
            warn = get_logger(node.logger_name).warning
            text = f"Incompatible type on topic '{topic}', no messages will be sent to it."
            tell["incompatible_type"] = lambda _: warn(text)
            tell["incompatible_qos"] = lambda info: warn(
                self._warning.format(topic, QoSPolicyKind(info.last_policy_kind).name)
            )
        if "liveliness" in callbacks:
            warning = f"Liveliness is not watched here: its callback on '{topic}' runs on a robot only."
            get_logger(node.logger_name).warning(warning)
        # The default callbacks log immediately, so the handlers created for them never become
        # ready.
        handlers += [EventHandler(node, callback_group, tell[name]) for name in tell.keys() - callbacks]
        for name, callback in callbacks.items():
            handlers.append(EventHandler(node, callback_group, callback))
            tell[name] = handlers[-1].record
        return Events(tell, handlers, self._deadline_info)


class SubscriptionEventCallbacks(EventCallbacks):
    """The event callbacks of a subscription. Messages are never lost here."""

    _events = (*EventCallbacks._events, "message_lost")
    _deadline_info = QoSRequestedDeadlineMissedInfo
    _warning = (
        "New publisher discovered on topic '{}', offering incompatible QoS. "
        "No messages will be received from it. Last incompatible policy: {}"
    )

    def __init__(
        self,
        *,
        deadline: Report | None = None,
        incompatible_qos: Report | None = None,
        liveliness: Report | None = None,
        message_lost: Report | None = None,
        incompatible_type: Report | None = None,
        matched: Report | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        self.deadline, self.liveliness, self.message_lost = deadline, liveliness, message_lost
        self.incompatible_qos, self.incompatible_type = incompatible_qos, incompatible_type
        self.matched, self.use_default_callbacks = matched, use_default_callbacks


class PublisherEventCallbacks(EventCallbacks):
    """The event callbacks of a publisher."""

    _deadline_info = QoSOfferedDeadlineMissedInfo
    _warning = (
        "New subscription discovered on topic '{}', requesting incompatible QoS. "
        "No messages will be sent to it. Last incompatible policy: {}"
    )

    def __init__(
        self,
        *,
        deadline: Report | None = None,
        liveliness: Report | None = None,
        incompatible_qos: Report | None = None,
        incompatible_type: Report | None = None,
        matched: Report | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        self.deadline, self.liveliness = deadline, liveliness
        self.incompatible_qos, self.incompatible_type = incompatible_qos, incompatible_type
        self.matched, self.use_default_callbacks = matched, use_default_callbacks


class EventHandler(Entity):
    """An entity whose callback an executor runs after an event."""

    def __init__(self, node: NodeHandle, callback_group: CallbackGroup, callback: Report) -> None:
        super().__init__(node, callback_group)
        self.callback = callback
        self._info: Any = None

    def record(self, info: Any) -> None:
        """Record an event. Events that occur before the callback runs are merged into one call."""
        if self._info is None:
            self._course_node.mark_ready(self)
        else:
            changes = (field.name for field in fields(info) if field.name.endswith("_change"))
            info = replace(
                info, **{name: getattr(self._info, name) + getattr(info, name) for name in changes}
            )
        self._info = info

    def _course_take(self) -> Callable[[], object]:
        """Remove the recorded event and return the call that reports it."""
        info, self._info = self._info, None
        return lambda: self.callback(info)


class Deadline:
    """A deadline, [ns], which calls back each time this long has passed without a message.

    It starts with the first message.
    """

    def __init__(self, node: NodeHandle, limit_ns: int, missed: Callable[[], object]) -> None:
        self._node, self._limit_ns, self._missed = node, limit_ns, missed
        self._entity = node.next_entity()
        self._alarm: Alarm | None = None

    def restart(self) -> None:
        """Record a message and restart the deadline."""
        self.stop()
        graph = self._node.graph
        due_ns = graph.now_ns + self._limit_ns
        self._alarm = graph.call_at(due_ns, self._ring, node=self._node.id, entity=self._entity)

    def stop(self) -> None:
        """Stop the deadline until the next message."""
        if self._alarm is not None:
            self._alarm.cancel()

    def _ring(self) -> None:
        self.restart()
        self._missed()
