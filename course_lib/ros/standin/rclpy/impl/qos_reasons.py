"""The reasons that `qos_check_compatible` gives, with ROS's texts (rmw_dds_common/src/qos.cpp)."""

from dataclasses import dataclass
from typing import Literal

from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSPolicyEnum,
    QoSProfile,
    ReliabilityPolicy,
)


@dataclass(frozen=True)
class _Ordered:
    """A policy of which the publisher must not offer less than the subscription requests."""

    name: Literal["reliability", "durability", "liveliness"]
    weak: QoSPolicyEnum
    strict: QoSPolicyEnum
    error: str
    both_unknown: str
    publisher_unknown: str
    subscription_unknown: str


_ORDERED = (
    _Ordered(
        "reliability",
        ReliabilityPolicy.BEST_EFFORT,
        ReliabilityPolicy.RELIABLE,
        "Best effort publisher and reliable subscription",
        "Publisher reliability is {} and subscription reliability is {}",
        "Reliable subscription, but publisher is {}",
        "Best effort publisher, but subscription is {}",
    ),
    _Ordered(
        "durability",
        DurabilityPolicy.VOLATILE,
        DurabilityPolicy.TRANSIENT_LOCAL,
        "Volatile publisher and transient local subscription",
        "Publisher durabilty is {} and subscription durability is {}",  # spelt as in ROS
        "Transient local subscription, but publisher is {}",
        "Volatile publisher, but subscription is {}",
    ),
    _Ordered(
        "liveliness",
        LivelinessPolicy.AUTOMATIC,
        LivelinessPolicy.MANUAL_BY_TOPIC,
        "Publisher's liveliness is automatic and subscription's is manual by topic",
        "Publisher liveliness is {} and subscription liveliness is {}",
        "Subscription's liveliness is manual by topic, but publisher's is {}",
        "Publisher's liveliness is automatic, but subscription's is {}",
    ),
)


def errors(publisher: QoSProfile, subscription: QoSProfile) -> str:
    """List what surely keeps the two apart; empty if nothing does."""
    found: dict[str, str] = {
        rule.name: rule.error
        for rule in _ORDERED
        if getattr(publisher, rule.name) == rule.weak and getattr(subscription, rule.name) == rule.strict
    }
    offered_ns, wanted_ns = publisher.deadline.nanoseconds, subscription.deadline.nanoseconds
    if wanted_ns and not offered_ns:
        found["deadline"] = "Subscription has a deadline, but publisher does not"
    elif wanted_ns and wanted_ns < offered_ns:
        found["deadline"] = "Subscription deadline is less than publisher deadline"
    offered_ns = publisher.liveliness_lease_duration.nanoseconds
    wanted_ns = subscription.liveliness_lease_duration.nanoseconds
    if wanted_ns and not offered_ns:
        found["lease"] = "Subscription has a liveliness lease duration, but publisher does not"
    elif wanted_ns and wanted_ns < offered_ns:
        found["lease"] = "Subscription liveliness lease duration is less than publisher"
    order = ("reliability", "durability", "deadline", "liveliness", "lease")
    return "".join(f"ERROR: {found[name]};" for name in order if name in found)


def warnings_(publisher: QoSProfile, subscription: QoSProfile) -> str:
    """List what may keep the two apart, because a policy is left to the system."""
    reasons = (
        _warning(rule, getattr(publisher, rule.name), getattr(subscription, rule.name)) for rule in _ORDERED
    )
    return "".join(f"WARNING: {reason};" for reason in reasons if reason)


def _warning(rule: _Ordered, offered: QoSPolicyEnum, requested: QoSPolicyEnum) -> str | None:
    offered_unknown, requested_unknown = _is_unknown(offered), _is_unknown(requested)
    if offered_unknown and requested_unknown:
        return rule.both_unknown.format(offered.short_key, requested.short_key)
    if offered_unknown and requested == rule.strict:
        return rule.publisher_unknown.format(offered.short_key)
    if offered == rule.weak and requested_unknown:
        return rule.subscription_unknown.format(requested.short_key)
    return None


def _is_unknown(policy: QoSPolicyEnum) -> bool:
    return policy.name in ("SYSTEM_DEFAULT", "UNKNOWN")
