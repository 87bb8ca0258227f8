"""QoS profiles to what the graph works with, and back."""

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


def to_qos(profile: QoSProfile, kind: Literal["pub", "sub"]) -> Qos:
    """Resolve what a profile leaves to the system to what DDS has by default for such an endpoint."""
    reliability = profile.reliability or (
        ReliabilityPolicy.RELIABLE if kind == "pub" else ReliabilityPolicy.BEST_EFFORT
    )
    latched = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    manual = profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC
    return Qos(
        history="keep_all" if profile.history == HistoryPolicy.KEEP_ALL else "keep_last",
        depth=profile.depth or 1,
        reliability="reliable" if reliability == ReliabilityPolicy.RELIABLE else "best_effort",
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
    """Return a limit in [ns]; unspecified (zero) and infinite are none."""
    return duration.nanoseconds if 0 < duration.nanoseconds < Infinite.nanoseconds else None


def _duration(limit_ns: int | None) -> Duration:
    return Infinite if limit_ns is None else Duration(nanoseconds=limit_ns)
