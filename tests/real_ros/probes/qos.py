# mypy: disable-error-code="import-not-found, untyped-decorator"
"""Pairs of profiles of quality of service, and the policies that events name."""

from collections.abc import Callable
from typing import Any

import rclpy
from probing import lines, main, probe
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
    qos_profile_sensor_data,
    qos_profile_services_default,
    qos_profile_system_default,
)
from std_msgs.msg import String

PROFILES = {
    "plain": QoSProfile(depth=1),
    "best_effort": QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
    "reliability_system": QoSProfile(depth=1, reliability=ReliabilityPolicy.SYSTEM_DEFAULT),
    "reliability_unknown": QoSProfile(depth=1, reliability=ReliabilityPolicy.UNKNOWN),
    "transient_local": QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
    "durability_system": QoSProfile(depth=1, durability=DurabilityPolicy.SYSTEM_DEFAULT),
    "durability_unknown": QoSProfile(depth=1, durability=DurabilityPolicy.UNKNOWN),
    "automatic": QoSProfile(depth=1, liveliness=LivelinessPolicy.AUTOMATIC),
    "manual": QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC),
    "liveliness_unknown": QoSProfile(depth=1, liveliness=LivelinessPolicy.UNKNOWN),
    "deadline": QoSProfile(depth=1, deadline=Duration(seconds=1)),
    "sensor_data": qos_profile_sensor_data,
    "services": qos_profile_services_default,
    "system": qos_profile_system_default,
}


def _pair(offered: QoSProfile, requested: QoSProfile) -> Callable[[], object]:
    def run() -> object:
        level, reason = qos_check_compatible(offered, requested)
        return level.name, reason

    return run


for _ours, _offered in PROFILES.items():
    lines(_ours, **{theirs: _pair(_offered, requested) for theirs, requested in PROFILES.items()})


def policies_of_event(offered: QoSProfile, requested: QoSProfile) -> list[str]:
    """Return the policy of each event of a subscription about an incompatible publisher."""
    node, found = rclpy.create_node("n"), list[Any]()
    events = SubscriptionEventCallbacks(incompatible_qos=found.append)
    node.create_publisher(String, "t", offered)
    node.create_subscription(String, "t", print, requested, event_callbacks=events)
    for _ in range(20):
        rclpy.spin_once(node, timeout_sec=0.05)
    return [str(info.last_policy_kind) for info in found]


@probe
def policy_of_an_event() -> list[str]:
    return policies_of_event(PROFILES["plain"], PROFILES["transient_local"])


_LATCHED = DurabilityPolicy.TRANSIENT_LOCAL
_MANUAL = LivelinessPolicy.MANUAL_BY_TOPIC


@probe
def policy_of_durability_and_deadline() -> list[str]:
    requested = QoSProfile(depth=1, durability=_LATCHED, deadline=Duration(seconds=1))
    return policies_of_event(PROFILES["plain"], requested)


@probe
def policy_of_deadline_and_liveliness() -> list[str]:
    requested = QoSProfile(depth=1, liveliness=_MANUAL, deadline=Duration(seconds=1))
    return policies_of_event(PROFILES["plain"], requested)


@probe
def policy_of_all_policies() -> list[str]:
    requested = QoSProfile(depth=1, durability=_LATCHED, liveliness=_MANUAL, deadline=Duration(seconds=1))
    return policies_of_event(PROFILES["best_effort"], requested)


if __name__ == "__main__":
    main()
