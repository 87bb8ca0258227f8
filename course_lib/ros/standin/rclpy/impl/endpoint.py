"""Publishers and subscriptions as the graph knows them, and their matching."""

from typing import Any, Generic, Literal, TypeVar
from weakref import WeakKeyDictionary

from course_lib.ros.graph import Graph
from course_lib.ros.messages import RosMessage
from course_lib.ros.topics import EndpointInfo
from rclpy.event_handler import Deadline, Events
from rclpy.exceptions import InvalidHandle
from rclpy.impl.node_handle import NodeHandle
from rclpy.qos import QoSPolicyKind, QoSProfile

MsgT = TypeVar("MsgT", bound=RosMessage)

# The events by endpoint; of all programs that share a graph.
_told: WeakKeyDictionary[Graph, dict[int, Events]] = WeakKeyDictionary()


class Endpoint:
    """A publisher or a subscription in the graph: its node, its id there and its full topic."""

    def __init__(self, node: NodeHandle, endpoint: int, topic_name: str) -> None:
        self.node = node
        self.id = endpoint
        self.topic_name = topic_name
        self._destroyed = False

    def require(self) -> "Endpoint":
        """Return itself; raises InvalidHandle if it has been destroyed."""
        if self._destroyed:
            raise InvalidHandle
        return self

    def destroy(self) -> None:
        """Leave the graph, once; messages that are on their way do not arrive any more."""
        if self._destroyed:
            return
        self._destroyed = True
        _told.get(self.node.graph, {}).pop(self.id, None)
        for publisher, subscription in self.partners():
            for side in _sides(self.node.graph, publisher, subscription):
                side.matched(-1)
        self.node.graph.remove_endpoint(self.id)

    def partner_count(self) -> int:
        """Count the endpoints that it exchanges messages with."""
        return len(self.partners())

    def partners(self) -> list[tuple[EndpointInfo, EndpointInfo]]:
        """List (publisher, subscription) for each endpoint that it exchanges messages with."""
        alike = [pair for pair in self._pairs() if pair[0].type_name == pair[1].type_name]
        return [pair for pair in alike if self.node.graph.apart(*pair) is None]

    def watch(self, events: Events) -> None:
        """Report all endpoints on the other side of the topic to `events`, and this one to theirs."""
        _told.setdefault(self.node.graph, {})[self.id] = events
        for publisher, subscription in self._pairs():
            policy = self.node.graph.apart(publisher, subscription)
            for side in _sides(self.node.graph, publisher, subscription):
                if publisher.type_name != subscription.type_name:
                    side.count("incompatible_type")
                elif policy is not None:
                    side.count("incompatible_qos", last_policy_kind=QoSPolicyKind[policy])
                else:
                    side.matched(1)

    def _pairs(self) -> list[tuple[EndpointInfo, EndpointInfo]]:
        """List (publisher, subscription) for each endpoint on the other side of the topic."""
        on_topic = self.node.graph.endpoints_on(self.topic_name)
        me = next((info for info in on_topic if info.id == self.id), None)
        if me is None:
            return []
        others = [info for info in on_topic if info.kind != me.kind]
        return [(me, other) if me.kind == "pub" else (other, me) for other in others]


def _sides(graph: Graph, *infos: EndpointInfo) -> list[Events]:
    """Return the events of endpoints; those of another process are reported there."""
    told = _told.get(graph, {})
    return [told[info.id] for info in infos if info.id in told]


class TopicEnd(Generic[MsgT]):
    """The common part of publishers and subscriptions: message type, topic as given, place in the graph."""

    def __init__(self, handle: Endpoint, msg_type: type[MsgT], topic: str, qos_profile: QoSProfile) -> None:
        self.handle = handle
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile
        self.deadline: Deadline | None = None

    @property
    def topic_name(self) -> str:
        """The fully resolved topic."""
        return self.handle.require().topic_name

    def partner_count(self) -> int:
        """Count the endpoints that it exchanges messages with."""
        return self.handle.require().partner_count()

    def destroy(self) -> None:
        """Leave the topic; call the node's `destroy_publisher` or `destroy_subscription` instead."""
        self.handle.destroy()
        if self.deadline is not None:
            self.deadline.stop()


def require_type(given: Any, kind: Literal["message", "service", "action"]) -> None:
    """Raise the error of rclpy for a class that is not a type of this kind."""
    if not isinstance(given, type) or not hasattr(given, "_TYPE_NAME"):
        raise AttributeError(
            f"type object '{type(given).__name__}' has no attribute '_TYPE_SUPPORT'"
            " This might be a ROS 1 message type but it should be a ROS 2 message type."
            " Make sure to source your ROS 2 workspace after your ROS 1 workspace."
        )
    found = (
        "message" if issubclass(given, RosMessage) else "service" if hasattr(given, "Request") else "action"
    )
    if found != kind:
        first, second = (other for other in ("message", "service", "action") if other != kind)
        raise RuntimeError(
            f"The {kind} type provided is not valid ({given}), this might be a {first} or {second}"
        )
