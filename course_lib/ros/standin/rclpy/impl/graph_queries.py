"""The graph in rclpy's words: its topics, services and actions with their types, endpoints and their QoS."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, Literal

from course_lib.ros.graph import EndpointInfo, NodeInfo
from course_lib.ros.qos import Qos
from rclpy.duration import Duration, Infinite
from rclpy.qos import POLICIES, DeadlineBestAvailable, QoSProfile

NamesAndTypes = list[tuple[str, list[str]]]
_FITTING = {  # of BEST_AVAILABLE: offered, requested
    "reliability": ("reliable", "best_effort"),
    "durability": ("transient_local", "volatile"),
    "liveliness": ("automatic", "automatic"),
}
_TOPIC, _TYPE = "/_action/feedback", "_FeedbackMessage"  # each action has such a topic


class TopicEndpointTypeEnum(IntEnum):
    """The kinds of endpoint."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


@dataclass
class TopicEndpointInfo:
    """A publisher or a subscription on a topic."""

    node_name: str
    node_namespace: str
    topic_type: str
    endpoint_type: TopicEndpointTypeEnum
    endpoint_gid: list[int]
    qos_profile: QoSProfile


def describe(info: EndpointInfo, nodes: Iterable[NodeInfo]) -> TopicEndpointInfo:
    """Return the description of an endpoint; `nodes` are those of the graph."""
    node = next(node for node in nodes if node.id == info.node)
    kind = TopicEndpointTypeEnum.PUBLISHER if info.kind == "pub" else TopicEndpointTypeEnum.SUBSCRIPTION
    return TopicEndpointInfo(
        node_name=node.name,
        node_namespace=node.namespace,
        topic_type=info.type_name,
        endpoint_type=kind,
        endpoint_gid=list(info.id.to_bytes(16, "big")),
        qos_profile=to_profile(info.qos),
    )


def services(endpoints: Iterable[EndpointInfo]) -> NamesAndTypes:
    """List the services of which endpoints are servers or clients."""
    return sorted_types(info.service for info in endpoints if info.service is not None)


def sorted_types(pairs: Iterable[tuple[str, str]]) -> NamesAndTypes:
    """Sort (name, type) pairs: each name once, with all its types."""
    types: dict[str, set[str]] = {}
    for name, type_name in pairs:
        types.setdefault(name, set()).add(type_name)
    return [(name, sorted(types[name])) for name in sorted(types)]


def actions(endpoints: Iterable[EndpointInfo]) -> NamesAndTypes:
    """List the actions that endpoints serve or use."""
    return sorted_types(
        (info.topic.removesuffix(_TOPIC), info.type_name.removesuffix(_TYPE))
        for info in endpoints
        if info.topic.endswith(_TOPIC) and info.type_name.endswith(_TYPE)
    )


def to_qos(profile: QoSProfile, kind: Literal["pub", "sub"]) -> Qos:
    """Convert a profile; for values that it leaves to the system, DDS's defaults of such an endpoint hold."""
    chosen = {name: getattr(profile, name) for name in POLICIES}
    policies: dict[str, Any] = {
        name: _best_available(name, kind) if one.name == "BEST_AVAILABLE" else one.name.lower()
        for name, one in chosen.items()
        if one and one.name != "UNKNOWN"
    }
    if kind == "sub":
        policies.setdefault("reliability", "best_effort")
    return Qos(
        depth=profile.depth or 1,
        deadline_ns=_limit(profile.deadline),
        lifespan_ns=_limit(profile.lifespan),
        lease_ns=_limit(profile.liveliness_lease_duration),
        **policies,
    )


def _best_available(policy: str, kind: Literal["pub", "sub"]) -> str:
    """Return the value that fits most partners: what a publisher offers fits all that it is asked for."""
    offered, requested = _FITTING[policy]
    return offered if kind == "pub" else requested


def to_profile(qos: Qos) -> QoSProfile:
    """Return the profile of an endpoint of the graph, as ROS reports it."""
    policies = {name: policy[getattr(qos, name).upper()] for name, policy in POLICIES.items()}
    return QoSProfile(
        depth=qos.depth,
        lifespan=_duration(qos.lifespan_ns),
        deadline=_duration(qos.deadline_ns),
        liveliness_lease_duration=_duration(qos.lease_ns),
        **policies,
    )


def _limit(duration: Duration) -> int | None:
    """Return a limit in [ns]; unspecified (zero) and infinite are none."""
    return duration.nanoseconds if 0 < duration.nanoseconds < DeadlineBestAvailable.nanoseconds else None


def _duration(limit_ns: int | None) -> Duration:
    return Infinite if limit_ns is None else Duration(nanoseconds=limit_ns)
