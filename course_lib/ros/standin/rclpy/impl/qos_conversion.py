"""QoS profiles to what the graph works with, and back."""

from typing import Any, Literal

from course_lib.ros.qos import Qos
from rclpy.duration import Duration, Infinite
from rclpy.qos import POLICIES, QoSProfile


def to_qos(profile: QoSProfile, kind: Literal["pub", "sub"]) -> Qos:
    """Resolve what a profile leaves to the system to what DDS has by default for such an endpoint."""
    chosen = {name: getattr(profile, name) for name in POLICIES}
    policies: dict[str, Any] = {name: one.name.lower() for name, one in chosen.items() if one}
    if kind == "sub":
        policies.setdefault("reliability", "best_effort")
    return Qos(
        depth=profile.depth or 1,
        deadline_ns=_limit(profile.deadline),
        lifespan_ns=_limit(profile.lifespan),
        lease_ns=_limit(profile.liveliness_lease_duration),
        **policies,
    )


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
    return duration.nanoseconds if 0 < duration.nanoseconds < Infinite.nanoseconds else None


def _duration(limit_ns: int | None) -> Duration:
    return Infinite if limit_ns is None else Duration(nanoseconds=limit_ns)
