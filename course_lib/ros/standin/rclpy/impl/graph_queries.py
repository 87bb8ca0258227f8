"""Graph queries in rclpy's data types: topics, services, actions, endpoints and their QoS."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, ClassVar, Literal

from course_lib.ros.graph.graph import EndpointInfo, NodeInfo
from course_lib.ros.graph.topics import Qos
from rclpy.duration import Duration, Infinite
from rclpy.exceptions import NameValidationException
from rclpy.impl import names
from rclpy.impl.implementation_singleton import NodeNameNonExistentError, RCLError
from rclpy.impl.node_handle import NodeHandle
from rclpy.qos import (
    POLICIES,
    DeadlineBestAvailable,
    DurabilityPolicy,
    HistoryPolicy,
    QoSPresetProfiles,
    QoSProfile,
)

NamesAndTypes = list[tuple[str, list[str]]]
# Values that BEST_AVAILABLE resolves to, the strongest one first.
_BEST = {
    "reliability": ("reliable", "best_effort"),
    "durability": ("transient_local", "volatile"),
    "liveliness": ("manual_by_topic", "automatic"),
}
# Each action has such a topic, by which it is recognized.
_TOPIC, _TYPE = "/_action/feedback", "_FeedbackMessage"


class TopicEndpointTypeEnum(IntEnum):
    """The kinds of endpoints."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


# Hashes can be changed, so they are not hashable themselves.
@dataclass(repr=False)
class TypeHash:
    """The hash of a type: the version of the algorithm, and 32 bytes."""

    _TYPE_HASH_SIZE: ClassVar = 32
    version: int = -1
    value: bytes = bytes(_TYPE_HASH_SIZE)

    def __setattr__(self, name: str, value: object) -> None:
        if not isinstance(value, {"version": int, "value": bytes}.get(name, object)):
            raise AssertionError
        super().__setattr__(name, value)

    def __str__(self) -> str:
        is_valid = self.version > 0 and len(self.value) == self._TYPE_HASH_SIZE
        return f"RIHS{self.version:02}_{self.value.hex()}" if is_valid else "INVALID"


# rclpy defines it in a module of this name.
TypeHash.__module__ = "rclpy.type_hash"

# The attributes of TopicEndpointInfo, with functions that return their defaults.
_DEFAULTS: dict[str, Callable[[], object]] = {
    "node_name": str,
    "node_namespace": str,
    "topic_type": str,
    "topic_type_hash": TypeHash,
    "endpoint_type": lambda: TopicEndpointTypeEnum.INVALID,
    "endpoint_gid": list,
    "qos_profile": lambda: QoSPresetProfiles.UNKNOWN.value,
}


class TopicEndpointInfo:
    """A publisher or a subscription on a topic."""

    node_name: str
    node_namespace: str
    topic_type: str
    topic_type_hash: TypeHash
    endpoint_type: TopicEndpointTypeEnum
    endpoint_gid: list[int]
    qos_profile: QoSProfile

    def __init__(self, **kwargs: Any) -> None:
        if not _DEFAULTS.keys() >= kwargs.keys():
            raise AssertionError(f"Invalid arguments passed to constructor: {kwargs.keys()!r}")
        for name, make_default in _DEFAULTS.items():
            setattr(self, name, kwargs[name] if name in kwargs else make_default())

    def __setattr__(self, name: str, value: object) -> None:
        if name == "endpoint_type" and isinstance(value, int):
            value = TopicEndpointTypeEnum(value)
        if name in _DEFAULTS and not isinstance(value, type(_DEFAULTS[name]())):
            raise AssertionError
        super().__setattr__(name, value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, TopicEndpointInfo) and vars(self) == vars(other)

    __hash__ = None  # type: ignore[assignment]  # infos can be changed

    def __str__(self) -> str:
        qos = self.qos_profile
        depth = f" ({qos.depth})" if qos.history is HistoryPolicy.KEEP_LAST else ""
        rows = {
            "Node name": self.node_name,
            "Node namespace": self.node_namespace,
            "Topic type": self.topic_type,
            "Topic type hash": self.topic_type_hash,
            "Endpoint type": self.endpoint_type.name,
            "GID": ".".join(format(byte, "02x") for byte in self.endpoint_gid),
        }
        policies = {
            "Reliability": qos.reliability.name,
            "History (Depth)": f"{qos.history.name}{depth}",
            "Durability": qos.durability.name,
            "Lifespan": qos.lifespan,
            "Deadline": qos.deadline,
            "Liveliness": qos.liveliness.name,
            "Liveliness lease duration": qos.liveliness_lease_duration,
        }
        lines = [f"{name}: {value}" for name, value in rows.items()]
        return "\n".join(
            [*lines, "QoS profile:", *(f"  {name}: {value}" for name, value in policies.items())]
        )


def describe(info: EndpointInfo, nodes: Iterable[NodeInfo]) -> TopicEndpointInfo:
    """Return rclpy's description of an endpoint. `nodes` are the nodes of the graph."""
    node = next(node for node in nodes if node.id == info.node)
    kind = TopicEndpointTypeEnum.PUBLISHER if info.kind == "pub" else TopicEndpointTypeEnum.SUBSCRIPTION
    profile = to_profile(info.qos)
    # Fast DDS does not transmit how many samples an endpoint keeps.
    profile.history, profile.depth = HistoryPolicy.UNKNOWN, 0
    # A string like RIHS01_…, or None.
    hash_text = info.type_hash()
    version, _, value = (hash_text or "").removeprefix("RIHS").partition("_")
    return TopicEndpointInfo(
        node_name=node.name,
        node_namespace=node.namespace,
        topic_type=info.type_name,
        topic_type_hash=TypeHash(int(version), bytes.fromhex(value)) if hash_text else TypeHash(),
        endpoint_type=kind,
        endpoint_gid=list(info.gid),
        qos_profile=profile,
    )


def endpoints_on(
    node: NodeHandle,
    topic_name: str,
    kind: Literal["pub", "sub"],
) -> list[EndpointInfo]:
    """List the publishers or subscriptions on a topic, whose name is resolved for a node."""
    full = names.expand_topic_name(topic_name, node.name, node.namespace)
    names.validate_full_topic_name(full)
    full = node.arguments.remap(full, node.name, node.namespace, "topic")
    return [info for info in node.graph.endpoints_on(full) if info.kind == kind]


def service_endpoints(node: NodeHandle, service_name: str, failed: str) -> list[EndpointInfo]:
    """List the endpoints of a service, whose name is resolved for a node."""
    full = names.expand_topic_name(service_name, node.name, node.namespace)
    names.validate_full_topic_name(full, is_service=True)
    full = node.arguments.remap(full, node.name, node.namespace, "service")
    infos = node.require(failed).graph.endpoints()
    return [info for info in infos if info.service is not None and info.service[0] == full]


def endpoints_of(asking: NodeHandle, name: str, namespace: str, kind: str) -> list[EndpointInfo]:
    """List the endpoints of a node. Raise an RCLError if there is no such node."""
    if not isinstance(name, str) or not isinstance(namespace, str):
        raise TypeError(f"rclpy_get_{kind}_names_and_types_by_node(): incompatible function arguments.")
    namespace = namespace or "/"
    try:
        names.validate_node_name(name)
        names.validate_namespace(namespace)
    except NameValidationException as error:
        result = 2 if name else 1
        failed = f"failed to get {kind} names and types: {error.error_msg}, result: {result}"
        raise RCLError(failed) from None
    graph = asking.graph
    node_ids = [node.id for node in graph.nodes() if (node.name, node.namespace) == (name, namespace)]
    if not node_ids:
        raise NodeNameNonExistentError(
            f"cannot get {kind} names and types for nonexistent node: error not set"
        )
    return [info for info in graph.endpoints() if info.node == node_ids[0]]


def services(endpoints: Iterable[EndpointInfo]) -> NamesAndTypes:
    """List the services for which there are server or client endpoints."""
    return sorted_types(info.service for info in endpoints if info.service is not None)


def sorted_types(pairs: Iterable[tuple[str, str]]) -> NamesAndTypes:
    """Merge (name, type) pairs into one sorted entry per name, with all its types."""
    types: dict[str, set[str]] = {}
    for name, type_name in pairs:
        types.setdefault(name, set()).add(type_name)
    return [(name, sorted(types[name])) for name in sorted(types)]


def actions(endpoints: Iterable[EndpointInfo]) -> NamesAndTypes:
    """List the actions for which there are server or client endpoints."""
    return sorted_types(
        (info.topic.removesuffix(_TOPIC), info.type_name.removesuffix(_TYPE))
        for info in endpoints
        if info.topic.endswith(_TOPIC) and info.type_name.endswith(_TYPE)
    )


def to_qos(profile: QoSProfile, kind: Literal["pub", "sub"], offered: Sequence[Qos] = ()) -> Qos:
    """Convert a QoS profile.

    Policies set to SYSTEM_DEFAULT get the DDS default for this kind of endpoint. For BEST_AVAILABLE,
    a publisher offers the strongest value, and a subscription requests it if all of the topic's
    publishers, whose QoS is `offered`, do so. Later publishers do not change it, as in ROS.
    """
    if not isinstance(profile, QoSProfile):
        raise AttributeError(f"'{type(profile).__name__}' object has no attribute 'get_c_qos_profile'")
    policy_values = {name: getattr(profile, name) for name in POLICIES}
    if profile.depth < 0 or any(value.name == "UNKNOWN" for value in policy_values.values()):
        failed = "publisher: create_publisher() failed setting topic QoS"
        raise RCLError(f"Failed to create {failed if kind == 'pub' else 'subscription: invalid allocator'}")
    if kind == "pub" and policy_values["durability"] is DurabilityPolicy.SYSTEM_DEFAULT:
        # DDS specifies volatile as the default of a writer; Fast DDS uses transient local.
        policy_values["durability"] = DurabilityPolicy.TRANSIENT_LOCAL
    policies: dict[str, Any] = {}
    for name, policy in policy_values.items():
        if policy.name == "BEST_AVAILABLE":
            strongest, weakest = _BEST[name]
            is_offered = all(getattr(one, name) == strongest for one in offered)
            # A publisher with another liveliness would have to assert it.
            is_strong = is_offered if kind == "sub" else name != "liveliness"
            policies[name] = strongest if is_strong else weakest
        elif policy:
            policies[name] = policy.name.lower()
    if kind == "sub":
        policies.setdefault("reliability", "best_effort")
    return Qos(
        depth=profile.depth or 1,
        deadline_ns=_limit_ns(profile.deadline),
        lifespan_ns=_limit_ns(profile.lifespan),
        lease_ns=_limit_ns(profile.liveliness_lease_duration),
        **policies,
    )


def to_profile(qos: Qos) -> QoSProfile:
    """Return the QoS profile of an endpoint as ROS reports it."""
    policies = {name: policy[getattr(qos, name).upper()] for name, policy in POLICIES.items()}
    return QoSProfile(
        depth=qos.depth,
        lifespan=_duration(qos.lifespan_ns),
        deadline=_duration(qos.deadline_ns),
        liveliness_lease_duration=_duration(qos.lease_ns),
        **policies,
    )


def _limit_ns(duration: Duration) -> int | None:
    """Return the duration of a QoS policy in [ns]; None if unspecified (zero) or infinite."""
    return duration.nanoseconds if 0 < duration.nanoseconds < DeadlineBestAvailable.nanoseconds else None


def _duration(limit_ns: int | None) -> Duration:
    return Infinite if limit_ns is None else Duration(nanoseconds=limit_ns)
