"""The check whether two profiles of quality of service match, with the texts of ROS."""

from collections.abc import Iterator
from enum import Enum
from typing import Any

# (policy, publisher's value, subscription's value, text)
_CLASHES = (
    ("reliability", "BEST_EFFORT", "RELIABLE", "Best effort publisher and reliable subscription"),
    ("durability", "VOLATILE", "TRANSIENT_LOCAL", "Volatile publisher and transient local subscription"),
    (
        "liveliness", "AUTOMATIC", "MANUAL_BY_TOPIC",
        "Publisher's liveliness is automatic and subscription's is manual by topic",
    ),
)  # fmt: skip
_DOUBTS = (
    (
        "reliability", "SYSTEM_DEFAULT", "RELIABLE",
        "Reliable subscription, but publisher is system default",
    ),
    (
        "reliability", "BEST_EFFORT", "SYSTEM_DEFAULT",
        "Best effort publisher, but subscription is system default",
    ),
    (
        "durability", "SYSTEM_DEFAULT", "TRANSIENT_LOCAL",
        "Transient local subscription, but publisher is system default",
    ),
    (
        "durability", "VOLATILE", "SYSTEM_DEFAULT",
        "Volatile publisher, but subscription is system default",
    ),
    (
        "liveliness", "AUTOMATIC", "SYSTEM_DEFAULT",
        "Publisher's liveliness is automatic, but subscription's is system default",
    ),
    (
        "liveliness", "SYSTEM_DEFAULT", "MANUAL_BY_TOPIC",
        "Subscription's liveliness is manual by topic, but publisher's is system default",
    ),
)  # fmt: skip
# policy -> the time that is compared behind it: name, text without one, text of a shorter one
_TIMES = {
    "durability": (
        "deadline",
        "Subscription has a deadline, but publisher does not",
        "Subscription deadline is less than publisher deadline",
    ),
    "liveliness": (
        "liveliness_lease_duration",
        "Subscription has a liveliness lease duration, but publisher does not",
        "Subscription liveliness lease duration is less than publisher",
    ),
}


class QoSCompatibility(Enum):
    """The chance that a publisher reaches a subscription; at a warning, a default decides."""

    OK = 0
    WARNING = 1
    ERROR = 2


def qos_check_compatible(publisher_qos: Any, subscription_qos: Any) -> tuple[QoSCompatibility, str]:
    """Return whether two QoSProfiles match, and why not."""
    errors = list(_errors(publisher_qos, subscription_qos))
    if errors:
        return QoSCompatibility.ERROR, "".join(f"ERROR: {text};" for text in errors)
    doubts = [text for *case, text in _DOUBTS if _is(case, publisher_qos, subscription_qos)]
    level = QoSCompatibility.WARNING if doubts else QoSCompatibility.OK
    return level, "".join(f"WARNING: {text};" for text in doubts)


def _errors(publisher: Any, subscription: Any) -> Iterator[str]:
    for *case, text in _CLASHES:
        if _is(case, publisher, subscription):
            yield text
        if case[0] in _TIMES:
            name, missing, shorter = _TIMES[case[0]]
            offered, requested = (getattr(qos, name).nanoseconds for qos in (publisher, subscription))
            if requested and not offered:
                yield missing
            elif requested and requested < offered:
                yield shorter


def _is(case: list[str], publisher: Any, subscription: Any) -> bool:
    policy, offered, requested = case
    return (getattr(publisher, policy).name, getattr(subscription, policy).name) == (offered, requested)
