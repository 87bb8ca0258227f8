"""The graph endpoints of publishers and subscriptions, and their matching."""

from dataclasses import dataclass
from typing import Any, Generic, Literal, TypedDict, TypeVar
from weakref import WeakKeyDictionary

from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import EndpointInfo, dds_type
from course_lib.ros.messages import RosMessage
from course_lib.ros.mistakes import Mistake, marked
from rclpy.event_handler import Deadline, Events, RmwPolicyKind
from rclpy.exceptions import InvalidHandle
from rclpy.impl.implementation_singleton import RCLError
from rclpy.impl.node_handle import NodeHandle
from rclpy.qos import QoSPolicyKind, QoSProfile

MsgT = TypeVar("MsgT", bound=RosMessage)

_NO_TYPE_SUPPORT = (
    " This might be a ROS 1 message type but it should be a ROS 2 message type."
    " Make sure to source your ROS 2 workspace after your ROS 1 workspace."
)

# The events of each endpoint, by endpoint id. Shared by all programs of a graph.
_events: WeakKeyDictionary[Graph, dict[int, Events]] = WeakKeyDictionary()


class MessageInfo(TypedDict):
    """The times of publication and reception of a message, [ns].

    The middleware does not number messages.
    """

    source_timestamp: int
    received_timestamp: int
    publication_sequence_number: int | None
    reception_sequence_number: int | None


@dataclass(eq=False, repr=False)
class Endpoint:
    """A publisher or subscription in the graph: its node, its id there and its full topic name."""

    node: NodeHandle
    id: int
    topic_name: str
    # The topic or service whose type is registered in the node's context.
    registered_name: str = ""
    is_destroyed: bool = False

    def require(self) -> "Endpoint":
        """Return the endpoint itself. Raise InvalidHandle if it has been destroyed."""
        if self.is_destroyed:
            raise InvalidHandle
        return self

    def destroy(self) -> None:
        """Leave the graph.

        Messages in transit are no longer delivered. Calling it twice is allowed.
        """
        if self.is_destroyed:
            return
        self.is_destroyed = True
        if self.registered_name:
            self.node.context.release_type(self.registered_name)
        _events.get(self.node.graph, {}).pop(self.id, None)
        for publisher, subscription in self.partners():
            for side in _events_of(self.node.graph, publisher, subscription):
                side.matched(-1)
        self.node.graph.remove_endpoint(self.id)

    def partners(self) -> list[tuple[EndpointInfo, EndpointInfo]]:
        """List (publisher, subscription) for each matched endpoint."""
        alike = [pair for pair in self._pairs() if pair[0].type_name == pair[1].type_name]
        return [pair for pair in alike if self.node.graph.incompatible_policy(*pair) is None]

    def watch(self, events: Events) -> None:
        """Report the matching endpoints to `events`, and this endpoint to their events."""
        graph = self.node.graph
        if graph not in _events:
            graph.remote_listeners.append(_on_remote_endpoint)
        _events.setdefault(graph, {})[self.id] = events
        for publisher, subscription in self._pairs():
            _report_pair(graph, publisher, subscription, change=1)

    def _pairs(self) -> list[tuple[EndpointInfo, EndpointInfo]]:
        """List (publisher, subscription) for each endpoint on the topic's other side, matched or not."""
        on_topic = self.node.graph.endpoints_on(self.topic_name)
        me = next((info for info in on_topic if info.id == self.id), None)
        if me is None:
            return []
        partners = [info for info in on_topic if info.kind != me.kind]
        return [(me, other) if me.kind == "pub" else (other, me) for other in partners]


def _on_remote_endpoint(graph: Graph, remote: EndpointInfo, has_joined: bool) -> None:
    """Report to the partners' events that a remote endpoint has joined or is about to leave."""
    change = 1 if has_joined else -1
    for info in graph.endpoints_on(remote.topic):
        if info.kind == "sub" and remote.kind == "pub":
            _report_pair(graph, remote, info, change)
        elif info.kind == "pub" and remote.kind == "sub":
            _report_pair(graph, info, remote, change)


def _report_pair(
    graph: Graph,
    publisher: EndpointInfo,
    subscription: EndpointInfo,
    change: int,
) -> None:
    """Report a pair that has formed (1) or ends (-1) to the events of both sides."""
    policy = graph.incompatible_policy(publisher, subscription)
    for side in _events_of(graph, publisher, subscription):
        if policy is None and publisher.type_name == subscription.type_name:
            side.matched(change)
        elif change > 0 and publisher.type_name != subscription.type_name:
            side.count("incompatible_type")
        elif change > 0 and policy is not None:
            side.count("incompatible_qos", last_policy_kind=RmwPolicyKind(QoSPolicyKind[policy]))


def _events_of(graph: Graph, *infos: EndpointInfo) -> list[Events]:
    """Return the event objects of endpoints that belong to this process.

    Endpoints of other processes are reported in their own process.
    """
    events = _events.get(graph, {})
    return [events[info.id] for info in infos if info.id in events]


class TopicEnd(Generic[MsgT]):
    """Base class of publishers and subscriptions: message type, given topic, endpoint in the graph."""

    def __init__(
        self,
        handle: Endpoint,
        msg_type: type[MsgT],
        topic: str,
        qos_profile: QoSProfile,
    ) -> None:
        self.handle = handle
        handle.registered_name = handle.topic_name
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile
        self.event_handlers: list[Any] = []
        self._course_deadline: Deadline | None = None

    @property
    def logger_name(self) -> str:
        """The name of the node's logger."""
        return self.handle.require().node.logger_name

    @property
    def topic_name(self) -> str:
        """The fully qualified topic name."""
        return self.handle.require().topic_name

    def _course_partner_count(self) -> int:
        """Return the number of matched endpoints."""
        return len(self.handle.require().partners())

    def destroy(self) -> None:
        """Leave the topic.

        Call the node's `destroy_publisher` or `destroy_subscription` instead.
        """
        is_first = not self.handle.is_destroyed
        self.handle.destroy()
        # With an event handler, whose destruction rclpy's executor notices.
        if is_first and self.event_handlers and not self.handle.node.has_left:
            self.handle.node.destroyed_ends.add(self.handle.id)
        if self._course_deadline is not None:
            self._course_deadline.stop()


def claim_topic(
    node: NodeHandle,
    kind: Literal["publisher", "subscription"],
    topic: str,
    type_: str,
) -> None:
    """Register a topic's type.

    Raise the errors of rcl and Fast DDS if the context has another type for it.
    """
    conflict = (
        f"create_publisher() called for existing topic name rt{topic} with incompatible type "
        f"{dds_type(type_)}"
    )
    reason = conflict if kind == "publisher" else "invalid allocator"
    try:
        node.context.claim_type(topic, type_, f"Failed to create {kind}: {reason}")
    except RCLError as error:
        raise marked(error, Mistake.TWO_TYPES) from None


def claim_service(
    node: NodeHandle,
    kind: Literal["service", "client"],
    name: str,
    type_: str,
) -> None:
    """Register a service's type. Raise the error of rcl if the context has another type for it."""
    conflict = f"existing request topic name rq{name}Request with incompatible type {dds_type(type_)}"
    failed = f"failed to create {kind}: create_{kind}() called for {conflict}"
    try:
        node.context.claim_type(f"rq{name}", type_, failed)
    except RCLError as error:
        raise marked(error, Mistake.TWO_TYPES) from None


def require_type(given: Any, kind: Literal["message", "service", "action"]) -> Any:
    """Return the class of a type, or of a message given instead of its class, which rclpy accepts.

    Raise rclpy's error if it is not a type of this kind.
    """
    try:
        given.__class__._TYPE_SUPPORT  # noqa: B018 - as in rclpy
    except AttributeError as error:
        error.args = (f"{error}{_NO_TYPE_SUPPORT}",)
        raise
    interface = given if isinstance(given, type) else type(given)
    is_message = issubclass(interface, RosMessage)
    actual_kind = "message" if is_message else "service" if hasattr(interface, "Request") else "action"
    if actual_kind == kind:
        return interface
    first, second = (other for other in ("message", "service", "action") if other != kind)
    raise RuntimeError(
        f"The {kind} type provided is not valid ({given}), this might be a {first} or {second}"
    )
