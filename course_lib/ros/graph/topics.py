"""A run's publishers and subscriptions, their QoS, and their matching by topic, type and QoS."""

import re
import struct
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar

TYPE_HASH = re.compile(r"RIHS01_[0-9a-f]{64}")
_INFINITE = 2**63 - 1  # [ns]


def dds_type(type_name: str) -> str:
    """Return `std_msgs::msg::dds_::String_` for `std_msgs/msg/String`."""
    package, folder, name = type_name.split("/")
    return f"{package}::{folder}::dds_::{name}_"


def ros_type(dds: str) -> str:
    """Return `std_msgs/msg/String` for `std_msgs::msg::dds_::String_`."""
    return dds.replace("::dds_::", "::").replace("::", "/").removesuffix("_")


@dataclass(frozen=True, slots=True)
class Qos:
    """The QoS that a publisher offers or a subscription requests.

    Durations in [ns], None is infinite. The history of a robot's endpoint is unknown over DDS,
    which does not transmit it.
    """

    history: Literal["keep_last", "keep_all", "unknown"] = "keep_last"
    depth: int = 10
    reliability: Literal["reliable", "best_effort"] = "reliable"
    durability: Literal["volatile", "transient_local"] = "volatile"
    deadline_ns: int | None = None
    lifespan_ns: int | None = None
    liveliness: Literal["automatic", "manual_by_topic"] = "automatic"
    lease_ns: int | None = None

    @property
    def is_reliable(self) -> bool:
        """Whether the reliability is RELIABLE."""
        return self.reliability == "reliable"

    @property
    def is_latched(self) -> bool:
        """Whether the durability is TRANSIENT_LOCAL."""
        return self.durability == "transient_local"

    @property
    def limit(self) -> int | None:
        """The number of messages that an endpoint keeps; None with history KEEP_ALL."""
        return None if self.history == "keep_all" else max(1, self.depth)

    def row(self) -> tuple[str | int | None, ...]:
        """Return the policies in the order of the fields.

        Because `dataclasses.astuple` makes copies, it would take 20 times as long.
        """
        return (
            self.history, self.depth, self.reliability, self.durability,
            self.deadline_ns, self.lifespan_ns, self.liveliness, self.lease_ns,
        )  # fmt: skip


def find_incompatible_policy(offered: Qos, requested: Qos) -> str | None:
    """Return a requested policy that the publisher does not offer, named as in DDS, or None.

    Of several policies, return the one that Fast DDS reports last: the policy with the highest
    number in DDS.
    """
    if requested.is_reliable and not offered.is_reliable:
        return "RELIABILITY"
    if offered.liveliness == "automatic" and requested.liveliness == "manual_by_topic":
        return "LIVELINESS"
    if (offered.lease_ns or _INFINITE) > (requested.lease_ns or _INFINITE):
        return "LIVELINESS"
    if (offered.deadline_ns or _INFINITE) > (requested.deadline_ns or _INFINITE):
        return "DEADLINE"
    if requested.is_latched and not offered.is_latched:
        return "DURABILITY"
    return None


OnMessage = Callable[[bytes, int, int], None]  # (cdr, source_ns, received_ns)
# Topics that every node publishes.
OWN_TOPICS = ("/rosout", "/parameter_events")
# Prefix and suffix of a service's request and reply topics, as in DDS.
SERVICE_TOPICS = (("rq", "Request"), ("rr", "Reply"))
# Precedes the CDR bytes of a request or response: the client's endpoint id and the request number.
SERVICE_HEADER = struct.Struct("<qq")


def service_topics(name: str, type_name: str) -> tuple[tuple[str, str], tuple[str, str]]:
    """Return topic and type of a service's requests, and topic and type of its replies."""
    requests, replies = (f"{prefix}{name}{suffix}" for prefix, suffix in SERVICE_TOPICS)
    return (requests, f"{type_name}_Request"), (replies, f"{type_name}_Response")


@dataclass(frozen=True, slots=True)
class Sample:
    """A published message.

    Its fields are the robot time of publication [ns], the topic, the type, the CDR bytes, the
    offered QoS and the id of the node.
    """

    stamp_ns: int
    topic: str
    type_name: str
    cdr: bytes
    qos: Qos
    node: int

    def message(self) -> Any:
        """Return the deserialized message."""
        # Imported late, because messages need numpy.
        from course_lib.ros.messages import deserialize, message_class

        return deserialize(self.cdr, message_class(self.type_name))


@dataclass(frozen=True, slots=True)
class NodeInfo:
    """A node of the graph. Its id is its position in the start order."""

    id: int
    name: str
    namespace: str

    @property
    def full_name(self) -> str:
        """The fully qualified name."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


@dataclass(frozen=True, slots=True)
class EndpointInfo:
    """A publisher or subscription of the graph, on a topic or on one of a service's two topics."""

    id: int
    kind: Literal["pub", "sub"]
    node: int
    topic: str
    type_name: str
    qos: Qos
    # GID and type hash of a robot's endpoint, as discovery transmits them.
    remote_gid: bytes = b""
    remote_type_hash: str = ""

    @property
    def gid(self) -> bytes:
        """The GID, 16 bytes. For an endpoint of the kit it contains the id."""
        return self.remote_gid or self.id.to_bytes(16, "big")

    def type_hash(self) -> str | None:
        """Return the type's hash; None if the robot transmits none or the type is unknown here."""
        # Imported late, because computing hashes loads all type definitions.
        from course_lib.ros.messages.definitions import is_known, type_hash

        if self.remote_gid:
            return self.remote_type_hash if TYPE_HASH.fullmatch(self.remote_type_hash) else None
        return type_hash(self.type_name) if is_known(self.type_name) else None

    @property
    def service(self) -> tuple[str, str] | None:
        """The name and type of the service that uses this topic, or None."""
        for prefix, suffix in SERVICE_TOPICS:
            if self.topic.startswith(f"{prefix}/"):
                name = self.topic[len(prefix) : len(self.topic) - len(suffix)]
                return name, self.type_name.rsplit("_", 1)[0]
        return None

    @property
    def is_service(self) -> bool:
        """True for the endpoint with which a service receives requests."""
        return self.kind == "sub" and self.topic.startswith(f"{SERVICE_TOPICS[0][0]}/")

    @property
    def is_client(self) -> bool:
        """True for the endpoint through which a client sends requests."""
        return self.kind == "pub" and self.topic.startswith(f"{SERVICE_TOPICS[0][0]}/")


@dataclass(slots=True)
class Publisher:
    """A publisher's endpoint, with the samples that it keeps for late-joining subscriptions."""

    info: EndpointInfo
    latched: deque[Sample] = field(default_factory=deque)


@dataclass(slots=True)
class Subscription:
    """A subscription's endpoint. `entity` is its number within its node."""

    info: EndpointInfo
    entity: int
    on_message: OnMessage


Endpoint = TypeVar("Endpoint", Publisher, Subscription)


@dataclass(eq=False, repr=False)
class Topics:
    """The publishers and subscriptions of one run, and their matching."""

    publishers: dict[int, Publisher] = field(default_factory=dict)
    subscriptions: dict[int, Subscription] = field(default_factory=dict)
    # Publishers by topic.
    _publishers_by_topic: dict[str, list[Publisher]] = field(default_factory=dict)
    _subscriptions_by_topic: dict[str, list[Subscription]] = field(default_factory=dict)
    # Matching subscriptions by publisher id. Cleared whenever an endpoint is added or removed.
    _receivers: dict[int, list[Subscription]] = field(default_factory=dict)

    def endpoints(self) -> list[EndpointInfo]:
        """List all endpoints, sorted by creation."""
        infos = [p.info for p in self.publishers.values()] + [s.info for s in self.subscriptions.values()]
        return sorted(infos, key=lambda info: info.id)

    def endpoints_on(self, topic: str) -> list[EndpointInfo]:
        """List the endpoints of a topic, sorted by creation."""
        endpoints = (*self._publishers_by_topic.get(topic, ()), *self._subscriptions_by_topic.get(topic, ()))
        return sorted((endpoint.info for endpoint in endpoints), key=lambda info: info.id)

    def add_publisher(self, info: EndpointInfo) -> None:
        """Add a publisher. Its history depth limits the samples that it keeps."""
        depth = None if info.qos.history == "keep_all" else info.qos.depth
        self._receivers.clear()
        publisher = self.publishers[info.id] = Publisher(info, deque(maxlen=depth))
        self._publishers_by_topic.setdefault(info.topic, []).append(publisher)

    def add_subscription(self, subscription: Subscription) -> list[Sample]:
        """Add a subscription.

        Return the latched samples that it receives as a late joiner, oldest first.
        """
        info = subscription.info
        self._receivers.clear()
        self.subscriptions[info.id] = subscription
        self._subscriptions_by_topic.setdefault(info.topic, []).append(subscription)
        if not info.qos.is_latched:
            return []
        publishers = self._publishers_by_topic.get(info.topic, ())
        samples = [sample for p in publishers if matches(p.info, info) for sample in p.latched]
        return sorted(samples, key=lambda sample: sample.stamp_ns)

    def remove(self, endpoint: int) -> None:
        """Remove an endpoint.

        An unknown id is ignored, because its endpoint was already removed.
        """
        self._receivers.clear()
        publisher = self.publishers.pop(endpoint, None)
        if publisher is not None:
            _remove_from(self._publishers_by_topic, publisher.info.topic, publisher)
        subscription = self.subscriptions.pop(endpoint, None)
        if subscription is not None:
            _remove_from(self._subscriptions_by_topic, subscription.info.topic, subscription)

    def subscriptions_of_type(self, topic: str, type_name: str) -> list[Subscription]:
        """List the subscriptions with this topic and type, regardless of their QoS."""
        return [s for s in self._subscriptions_by_topic.get(topic, ()) if s.info.type_name == type_name]

    def receivers(self, publisher: EndpointInfo) -> list[Subscription]:
        """List the subscriptions that receive a publisher's samples."""
        receivers = self._receivers.get(publisher.id)
        if receivers is None:
            subscriptions = self._subscriptions_by_topic.get(publisher.topic, ())
            receivers = self._receivers[publisher.id] = [
                s for s in subscriptions if matches(publisher, s.info)
            ]
        return receivers


def _remove_from(by_topic: dict[str, list[Endpoint]], topic: str, endpoint: Endpoint) -> None:
    """Remove an endpoint from its topic. A topic without endpoints is removed, too."""
    by_topic[topic].remove(endpoint)
    if not by_topic[topic]:
        del by_topic[topic]


def matches(publisher: EndpointInfo, subscription: EndpointInfo) -> bool:
    """Return whether samples are delivered: same topic, same type, compatible QoS."""
    return (
        publisher.topic == subscription.topic
        and publisher.type_name == subscription.type_name
        and find_incompatible_policy(publisher.qos, subscription.qos) is None
    )


CLOCK = ("/clock", "rosgraph_msgs/msg/Clock")
CLOCK_QOS = Qos(depth=1, reliability="best_effort")


def tick(time_ns: int) -> Sample:
    """Create a sample on /clock that belongs to no node."""
    # Imported late, because messages need numpy.
    from course_lib.ros.messages import message_class, serialize

    seconds, nanoseconds = divmod(time_ns, 10**9)
    time = message_class("builtin_interfaces/msg/Time")(sec=seconds, nanosec=nanoseconds)
    return Sample(time_ns, *CLOCK, serialize(message_class(CLOCK[1])(clock=time)), CLOCK_QOS, node=0)


def read_tick(sample: Sample) -> int | None:
    """Return the time [ns] in a sample on /clock, or None for any other sample."""
    if (sample.topic, sample.type_name) != CLOCK:
        return None
    time: Any = sample.message().clock
    return int(time.sec * 10**9 + time.nanosec)
