"""What a program can be told about the partners of its publishers and subscriptions."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from rclpy.callback_groups import CallbackGroup
from rclpy.impl.node_handle import Entity, NodeHandle
from rclpy.logging import get_logger
from rclpy.qos import QoSPolicyKind


@dataclass
class QoSRequestedIncompatibleQoSInfo:
    """How many partners did not fit, and which policy was the reason for the last one."""

    total_count: int
    total_count_change: int
    last_policy_kind: QoSPolicyKind


QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo
IncompatibleQosCallback = Callable[[QoSRequestedIncompatibleQoSInfo], object]


class EventCallbacks:
    """The callbacks for one side; where none is given, a warning is logged if `use_default_callbacks`."""

    _warning: str

    def __init__(
        self, *, incompatible_qos: IncompatibleQosCallback | None = None, use_default_callbacks: bool = True
    ) -> None:
        self.incompatible_qos = incompatible_qos
        self.use_default_callbacks = use_default_callbacks

    def incompatible_handler(
        self, node: NodeHandle, topic: str, callback_group: CallbackGroup
    ) -> Callable[[str], None]:
        """Return what is to be told the name of the policy that keeps a partner away."""
        if self.incompatible_qos is not None:
            return EventHandler(node, callback_group, self.incompatible_qos).happen
        if not self.use_default_callbacks:
            return lambda policy: None
        logger = get_logger(node.logger_name)

        def warn(policy: str) -> None:
            logger.warning(self._warning.format(topic, policy))

        return warn


class SubscriptionEventCallbacks(EventCallbacks):
    """What a subscription wants to be told."""

    _warning = (
        "New publisher discovered on topic '{}', offering incompatible QoS. "
        "No messages will be received from it. Last incompatible policy: {}"
    )


class PublisherEventCallbacks(EventCallbacks):
    """What a publisher wants to be told."""

    _warning = (
        "New subscription discovered on topic '{}', requesting incompatible QoS. "
        "No messages will be sent to it. Last incompatible policy: {}"
    )


class EventHandler(Entity):
    """Has an executor call back when an event has happened."""

    def __init__(
        self, node: NodeHandle, callback_group: CallbackGroup, callback: IncompatibleQosCallback
    ) -> None:
        super().__init__(node, callback_group)
        self._callback = callback
        self._events: list[QoSPolicyKind] = []
        self._taken = 0

    def happen(self, policy: str) -> None:
        """Note that a policy keeps a partner away."""
        self._events.append(QoSPolicyKind[policy])
        self.node_handle.mark_ready(self)

    def take(self) -> Callable[[], object]:
        """Take the oldest event that was not told yet."""
        policy = self._events[self._taken]
        self._taken += 1
        return partial(self._callback, QoSRequestedIncompatibleQoSInfo(self._taken, 1, policy))
