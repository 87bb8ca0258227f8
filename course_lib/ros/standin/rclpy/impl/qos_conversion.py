"""Between a QoSProfile and the QoS that the graph works with."""

from collections.abc import Sequence
from typing import Literal

from course_lib.ros.qos import Qos
from rclpy.duration import Duration, Infinite
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)


def to_qos(profile: QoSProfile, kind: Literal["pub", "sub"], partners: Sequence[Qos]) -> Qos:
    """Resolve a profile to what an endpoint really offers or requests.

    Args:
        profile: The profile as given; what it leaves to the system becomes what DDS has by default.
        kind: Whether the endpoint is a publisher or a subscription.
        partners: What is there on the topic already: BEST_AVAILABLE asks for no more than these offer.
    """
    is_publisher = kind == "pub"
    reliable = {
        ReliabilityPolicy.RELIABLE: True,
        ReliabilityPolicy.BEST_EFFORT: False,
        ReliabilityPolicy.BEST_AVAILABLE: is_publisher or all(q.reliability == "reliable" for q in partners),
    }.get(profile.reliability, is_publisher)
    latched = {
        DurabilityPolicy.TRANSIENT_LOCAL: True,
        DurabilityPolicy.BEST_AVAILABLE: is_publisher
        or (bool(partners) and all(q.durability == "transient_local" for q in partners)),
    }.get(profile.durability, False)
    manual = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    return Qos(
        history="keep_all" if profile.history == HistoryPolicy.KEEP_ALL else "keep_last",
        depth=profile.depth or 1,
        reliability="reliable" if reliable else "best_effort",
        durability="transient_local" if latched else "volatile",
        deadline_ns=_limit(profile.deadline),
        lifespan_ns=_limit(profile.lifespan),
        liveliness="manual_by_topic" if manual else "automatic",
        lease_ns=_limit(profile.liveliness_lease_duration),
    )


def to_profile(qos: Qos) -> QoSProfile:
    """Return the profile of an endpoint of the graph, as ROS reports it."""
    return QoSProfile(
        history=HistoryPolicy[qos.history.upper()],
        depth=qos.depth,
        reliability=ReliabilityPolicy[qos.reliability.upper()],
        durability=DurabilityPolicy[qos.durability.upper()],
        lifespan=_duration(qos.lifespan_ns),
        deadline=_duration(qos.deadline_ns),
        liveliness=LivelinessPolicy[qos.liveliness.upper()],
        liveliness_lease_duration=_duration(qos.lease_ns),
    )


def _limit(duration: Duration) -> int | None:
    """Return a limit in [ns]; unspecified (zero) and infinite (or one less: best available) are none."""
    return duration.nanoseconds if 0 < duration.nanoseconds < Infinite.nanoseconds - 1 else None


def _duration(limit_ns: int | None) -> Duration:
    return Infinite if limit_ns is None else Duration(nanoseconds=limit_ns)
