"""Publishers, subscriptions and their QoS matching."""

import struct
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

from course_lib.ros.qos import Qos, incompatible

OnMessage = Callable[[bytes, int, int], None]  # (cdr, source_ns, received_ns)
OWN_TOPICS = ("/rosout", "/parameter_events")  # of every node
SERVICE_TOPICS = (("rq", "Request"), ("rr", "Reply"))  # round a service's name, as in DDS
SERVICE_HEADER = struct.Struct("<qq")  # before the CDR bytes: the client's endpoint, its count of requests


@dataclass(frozen=True, slots=True)
class Sample:
    """One published message: robot time of publication [ns], topic, type, CDR bytes, offered QoS, node id."""

    stamp_ns: int
    topic: str
    type_name: str
    cdr: bytes
    qos: Qos
    node: int

    def message(self) -> Any:
        """Return the message itself."""
        from course_lib.ros.messages import deserialize, message_class  # they need numpy

        return deserialize(self.cdr, message_class(self.type_name))


@dataclass(frozen=True, slots=True)
class NodeInfo:
    """A node of the graph; its id is its start order."""

    id: int
    name: str
    namespace: str

    @property
    def full_name(self) -> str:
        """The name with the namespace."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


@dataclass(frozen=True, slots=True)
class EndpointInfo:
    """A publisher or a subscription of the graph; also on the two topics of a service."""

    id: int
    kind: Literal["pub", "sub"]
    node: int
    topic: str
    type_name: str
    qos: Qos

    @property
    def service(self) -> tuple[str, str] | None:
        """The name and the type of the service whose requests or responses travel here; None for a topic."""
        for prefix, suffix in SERVICE_TOPICS:
            if self.topic.startswith(f"{prefix}/"):
                name = self.topic[len(prefix) : len(self.topic) - len(suffix)]
                return name, self.type_name.rsplit("_", 1)[0]
        return None

    @property
    def is_service(self) -> bool:
        """True if a service answers here: it receives the requests."""
        return self.kind == "sub" and self.topic.startswith(f"{SERVICE_TOPICS[0][0]}/")

    @property
    def is_client(self) -> bool:
        """True if a client calls a service from here: it sends the requests."""
        return self.kind == "pub" and self.topic.startswith(f"{SERVICE_TOPICS[0][0]}/")


@dataclass(slots=True)
class Publisher:
    """A publisher's endpoint, with what it keeps for late subscriptions (TRANSIENT_LOCAL)."""

    info: EndpointInfo
    kept: deque[Sample] = field(default_factory=deque)


@dataclass(slots=True)
class Subscription:
    """A subscription's endpoint; `entity` is its place among its node's entities."""

    info: EndpointInfo
    entity: int
    on_message: OnMessage


class Topics:
    """The publishers and subscriptions of one run, and their matching."""

    def __init__(self) -> None:
        self.publishers: dict[int, Publisher] = {}
        self.subscriptions: dict[int, Subscription] = {}
        self._publishers_of: dict[str, list[Publisher]] = {}  # by topic
        self._subscriptions_of: dict[str, list[Subscription]] = {}
        self._receivers: dict[int, list[Subscription]] = {}  # by publisher, until an endpoint comes or goes

    def endpoints(self) -> list[EndpointInfo]:
        """List all endpoints in the order of their making."""
        infos = [p.info for p in self.publishers.values()] + [s.info for s in self.subscriptions.values()]
        return sorted(infos, key=lambda info: info.id)

    def endpoints_on(self, topic: str) -> list[EndpointInfo]:
        """List the endpoints of a topic in the order of their making."""
        near = (*self._publishers_of.get(topic, ()), *self._subscriptions_of.get(topic, ()))
        return sorted((end.info for end in near), key=lambda info: info.id)

    def add_publisher(self, info: EndpointInfo) -> None:
        """Add a publisher; the samples that it keeps are bounded by its history."""
        depth = info.qos.depth if info.qos.history == "keep_last" else None
        self._receivers.clear()
        publisher = self.publishers[info.id] = Publisher(info, deque(maxlen=depth))
        self._publishers_of.setdefault(info.topic, []).append(publisher)

    def add_subscription(self, subscription: Subscription) -> list[Sample]:
        """Add a subscription; returns the kept samples that it gets as a late joiner, oldest first."""
        info = subscription.info
        self._receivers.clear()
        self.subscriptions[info.id] = subscription
        self._subscriptions_of.setdefault(info.topic, []).append(subscription)
        if info.qos.durability != "transient_local":
            return []
        near = self._publishers_of.get(info.topic, ())
        kept = [sample for p in near if matches(p.info, info) for sample in p.kept]
        return sorted(kept, key=lambda sample: sample.stamp_ns)

    def remove(self, endpoint: int) -> None:
        """Remove an endpoint; unknown ones are already gone."""
        self._receivers.clear()
        publisher = self.publishers.pop(endpoint, None)
        if publisher is not None:
            self._publishers_of[publisher.info.topic].remove(publisher)
        subscription = self.subscriptions.pop(endpoint, None)
        if subscription is not None:
            self._subscriptions_of[subscription.info.topic].remove(subscription)

    def listening(self, topic: str, type_name: str) -> list[Subscription]:
        """List the subscriptions of a topic and type, whatever their QoS."""
        return [s for s in self._subscriptions_of.get(topic, ()) if s.info.type_name == type_name]

    def receivers(self, publisher: EndpointInfo) -> list[Subscription]:
        """List the subscriptions that a publisher's sample reaches."""
        found = self._receivers.get(publisher.id)
        if found is None:
            near = self._subscriptions_of.get(publisher.topic, ())
            found = self._receivers[publisher.id] = [s for s in near if matches(publisher, s.info)]
        return found


def matches(publisher: EndpointInfo, subscription: EndpointInfo) -> bool:
    """Return whether samples flow: same topic, same type, compatible QoS."""
    return (
        publisher.topic == subscription.topic
        and publisher.type_name == subscription.type_name
        and incompatible(publisher.qos, subscription.qos) is None
    )
