"""Quality of service, as the middleware sees it."""

from dataclasses import dataclass
from typing import Literal

_INFINITE = 2**63 - 1  # [ns]


@dataclass(frozen=True, slots=True)
class Qos:
    """The QoS that a publisher offers or a subscription requests; durations in [ns], None means infinite."""

    history: Literal["keep_last", "keep_all"] = "keep_last"
    depth: int = 10
    reliability: Literal["reliable", "best_effort"] = "reliable"
    durability: Literal["volatile", "transient_local"] = "volatile"
    deadline_ns: int | None = None
    lifespan_ns: int | None = None
    liveliness: Literal["automatic", "manual_by_topic"] = "automatic"
    lease_ns: int | None = None

    def row(self) -> tuple[str | int | None, ...]:
        """Return the policies in their order; `dataclasses.astuple` takes 20 times as long, for copies."""
        return (
            self.history, self.depth, self.reliability, self.durability,
            self.deadline_ns, self.lifespan_ns, self.liveliness, self.lease_ns,
        )  # fmt: skip


def incompatible(offered: Qos, requested: Qos) -> str | None:
    """Name the policy, as DDS does, that keeps a publisher and a subscription apart; None if they match."""
    if offered.reliability == "best_effort" and requested.reliability == "reliable":
        return "RELIABILITY"
    if offered.durability == "volatile" and requested.durability == "transient_local":
        return "DURABILITY"
    if (offered.deadline_ns or _INFINITE) > (requested.deadline_ns or _INFINITE):
        return "DEADLINE"
    if offered.liveliness == "automatic" and requested.liveliness == "manual_by_topic":
        return "LIVELINESS"
    if (offered.lease_ns or _INFINITE) > (requested.lease_ns or _INFINITE):
        return "LIVELINESS"
    return None
