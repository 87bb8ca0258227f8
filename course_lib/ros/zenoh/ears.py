"""Topics that are subscribed on the network: only while something in the kit listens."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial

from course_lib.errors import counted
from course_lib.ros.qos import Qos
from course_lib.ros.zenoh.inbox import Inbox, Packet, Traffic
from course_lib.ros.zenoh.link import Declared, RobotLink

OnArrival = Callable[[str, str, Packet], None]  # topic, type, message
MAX_LOST, ENOUGH = 0.2, 50  # share of lost messages that is too much, and messages until that is judged


@dataclass
class Ear:
    """One topic that is listened to."""

    topic: str
    inbox: Inbox
    subscriber: Declared
    kept: int  # how many messages it asks late publishers for
    users: set[int] = field(default_factory=set)  # endpoints of the kit

    @property
    def traffic(self) -> Traffic:
        """The counts of the topic."""
        return self.inbox.traffic

    def row(self) -> tuple[str, object]:
        """Return its rate in a row of `ros2 doctor`."""
        if self.kept:
            return self.topic, f"latched, {counted(self.traffic.heard, 'message')} heard"
        per_second, size = self.traffic.rates()
        lost, late = self.traffic.lost, self.inbox.dropped
        notes = f", {lost} lost on the way" * bool(lost) + f", {late} dropped here: busy" * bool(late)
        return self.topic, f"{per_second:.1f} Hz, {size / 1e6:.3f} MB/s{notes}"

    def complaint(self) -> str:
        """Return a line if the link is too slow for the topic, or ""."""
        traffic = self.traffic
        if traffic.heard + traffic.lost < ENOUGH or traffic.share_lost < MAX_LOST:
            return ""
        per_second, size = traffic.rates()
        return (
            f"{self.topic}: {traffic.share_lost:.0%} of the messages are lost on the way, "
            f"{per_second:.1f} Hz and {size / 1e6:.1f} MB/s arrive. The link is too slow for it: use a "
            "compressed topic, a smaller image or a lower rate."
        )


class Ears:
    """The topics that are listened to.

    Args:
        link: Where they are subscribed.
        take: Called with each message, in the graph's thread.
    """

    def __init__(self, link: RobotLink, take: OnArrival) -> None:
        self._link, self._take = link, take
        self._by_name: dict[tuple[str, str], Ear] = {}

    def __iter__(self) -> Iterator[Ear]:
        return iter(tuple(self._by_name.values()))

    def listen(self, endpoint: int, topic: str, type_name: str, qos: Qos) -> None:
        """Listen to a topic for an endpoint."""
        kept = max(1, qos.depth) if qos.durability == "transient_local" else 0
        ear = self._by_name.get((topic, type_name))
        if ear is None:
            inbox = Inbox(self._link.arrived, partial(self._take, topic, type_name))
            subscriber = self._link.subscriber(topic, type_name, inbox, kept)
            ear = self._by_name[topic, type_name] = Ear(topic, inbox, subscriber, kept)
        elif kept > ear.kept:
            ear.subscriber.withdraw()
            ear.subscriber, ear.kept = self._link.subscriber(topic, type_name, ear.inbox, kept), kept
        ear.users.add(endpoint)

    def leave(self, endpoint: int) -> None:
        """End an endpoint's listening; without another one the topic is not sent any more."""
        for name, ear in tuple(self._by_name.items()):
            ear.users.discard(endpoint)
            if not ear.users:
                ear.subscriber.withdraw()
                del self._by_name[name]

    def close(self) -> None:
        """End all listening."""
        for ear in self:
            ear.subscriber.withdraw()
        self._by_name.clear()
