"""Conversion of QoS to and from rosbags' form."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from course_lib.ros.qos import Qos

if TYPE_CHECKING:
    from rosbags.interfaces import Qos as BagQos
    from rosbags.interfaces import QosTime

_INFINITE = 2**63 - 1  # [ns], rmw's infinite duration, for which 0 also stands
_SECOND = 10**9  # [ns]


def to_bag(qos: Qos) -> "BagQos":
    """Convert QoS to rosbags' form."""
    from rosbags import interfaces

    return interfaces.Qos(
        interfaces.QosHistory[qos.history.upper()],
        qos.depth,
        interfaces.QosReliability[qos.reliability.upper()],
        interfaces.QosDurability[qos.durability.upper()],
        _to_time(qos.deadline_ns),
        _to_time(qos.lifespan_ns),
        interfaces.QosLiveliness[qos.liveliness.upper()],
        _to_time(qos.lease_ns),
        avoid_ros_namespace_conventions=False,
    )


def from_bag(profiles: Sequence["BagQos"]) -> Qos:
    """Return the QoS of a topic's first publisher: a bag does not store the publisher of a message.

    System defaults become ROS's defaults.
    """
    if not profiles:
        return Qos()
    qos = profiles[0]
    return Qos(
        history="keep_all" if qos.history.name == "KEEP_ALL" else "keep_last",
        depth=qos.depth,
        reliability="best_effort" if qos.reliability.name == "BEST_EFFORT" else "reliable",
        durability="transient_local" if qos.durability.name == "TRANSIENT_LOCAL" else "volatile",
        deadline_ns=_from_time(qos.deadline),
        lifespan_ns=_from_time(qos.lifespan),
        liveliness="manual_by_topic" if qos.liveliness.name == "MANUAL_BY_TOPIC" else "automatic",
        lease_ns=_from_time(qos.liveliness_lease_duration),
    )


def _to_time(duration_ns: int | None) -> "QosTime":
    from rosbags.interfaces import QosTime

    return QosTime(*divmod(_INFINITE if duration_ns is None else duration_ns, _SECOND))


def _from_time(time: Any) -> int | None:
    duration_ns = time.sec * _SECOND + time.nsec
    return None if duration_ns in (0, _INFINITE) else int(duration_ns)
