"""Subscriptions on the network, which exist only while a part of the kit subscribes to their topic."""

from _thread import allocate_lock
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial

from course_lib.errors import format_count
from course_lib.ros.graph.topics import Qos
from course_lib.ros.robot.link import Actions, Declaration, Link, Packet, latched_depth
from course_lib.ros.time import wall

# Limits on pending messages per topic.
MAX_MESSAGES, MAX_BYTES = 1000, 64 * 2**20
# Number of messages over which rates are computed.
WINDOW = 200
RECENT_NS = 5 * 10**9  # [ns]
# The fraction of lost messages above which a link is reported as too slow.
MAX_LOST = 0.2
# Number of messages before the fraction of lost messages is evaluated.
MIN_MESSAGES = 50

OnMessage = Callable[["TopicSubscription", Packet], None]


class Traffic:
    """Statistics of a topic: its rate and its lost messages."""

    def __init__(self) -> None:
        self.received = 0
        # Lost messages, counted by gaps in sequence numbers.
        self.lost = 0
        # (time of reception [ns], size [bytes]) of recent messages.
        self._recent: deque[tuple[int, int]] = deque(maxlen=WINDOW)
        # Time from publication to reception of recent messages [ns].
        self._lags: deque[int] = deque(maxlen=WINDOW)
        # Last sequence number by GID.
        self._last_sequence: dict[bytes, int] = {}

    def add(self, packet: Packet) -> None:
        """Count a message."""
        last = self._last_sequence.get(packet.gid, packet.sequence)
        self.lost += max(0, packet.sequence - last - 1)
        self._last_sequence[packet.gid] = max(last, packet.sequence)
        self.received += 1
        self._recent.append((packet.received_ns, len(packet.cdr)))
        self._lags.append(packet.received_ns - packet.source_ns)

    def reset_sequences(self) -> None:
        """Restart the detection of gaps, because messages sent while a link is down do not count as lost."""
        self._last_sequence.clear()

    @property
    def lag_ns(self) -> int | None:
        """The shortest time from publication to reception [ns]: transport time plus clock offset."""
        return min(tuple(self._lags), default=None)

    def rates(self) -> tuple[float, float]:
        """Return messages and bytes per second over the last few seconds."""
        since = wall.time_ns() - RECENT_NS
        recent = [(at, size) for at, size in tuple(self._recent) if at >= since]
        if len(recent) < 2:
            return 0.0, 0.0
        seconds = max(recent[-1][0] - recent[0][0], 1) * 1e-9
        return (len(recent) - 1) / seconds, sum(size for _, size in recent[1:]) / seconds


class Inbox:
    """The pending messages of a topic. When it is full, the oldest message is dropped.

    Args:
        actions: The queue of the graph, with one action for each pending message.
        on_packet: Called with each message in the graph's thread.
    """

    def __init__(self, actions: Actions, on_packet: Callable[[Packet], None]) -> None:
        self.traffic = Traffic()
        self.dropped = 0
        self._actions, self._on_packet = actions, on_packet
        self._pending: deque[Packet] = deque()
        self._bytes = 0
        self._mutex = allocate_lock()

    def put(self, packet: Packet) -> None:
        """Add a message. Called from the link's threads."""
        self.traffic.add(packet)
        with self._mutex:
            self._pending.append(packet)
            self._bytes += len(packet.cdr)
            is_full = len(self._pending) > MAX_MESSAGES or (
                self._bytes > MAX_BYTES and len(self._pending) > 1
            )
            if is_full:
                self._bytes -= len(self._pending.popleft().cdr)
                self.dropped += 1
        if not is_full:
            self._actions.put(self._process_one)

    def _process_one(self) -> None:
        with self._mutex:
            packet = self._pending.popleft() if self._pending else None
            self._bytes -= len(packet.cdr) if packet else 0
        if packet is not None:
            self._on_packet(packet)


@dataclass
class TopicSubscription:
    """A subscription on the network, which serves endpoints of the kit.

    Args:
        latched_count: The number of messages that it requests from latched publishers.
        users: The endpoints of the kit that it serves.
    """

    topic: str
    type_name: str
    latched_count: int
    users: set[int] = field(default_factory=set)
    inbox: Inbox = field(init=False)
    declaration: Declaration = field(init=False)

    @property
    def traffic(self) -> Traffic:
        """The statistics of the topic."""
        return self.inbox.traffic

    def status_row(self) -> tuple[str, object]:
        """Return the topic and its rate as a row of `ros2 doctor`."""
        if self.latched_count:
            return self.topic, f"latched, {format_count(self.traffic.received, 'message')} received"
        per_second, size = self.traffic.rates()
        lost, dropped = self.traffic.lost, self.inbox.dropped
        notes = f", {lost} lost on the way" * bool(lost) + f", {dropped} dropped here: busy" * bool(dropped)
        return self.topic, f"{per_second:.1f} Hz, {size / 1e6:.3f} MB/s{notes}"

    def warning(self) -> str:
        """Return a message if the link is too slow for the topic, else ""."""
        traffic = self.traffic
        sent = traffic.received + traffic.lost
        if sent < MIN_MESSAGES or traffic.lost < MAX_LOST * sent:
            return ""
        per_second, size = traffic.rates()
        return (
            f"{self.topic}: {traffic.lost / sent:.0%} of the messages are lost on the way, "
            f"{per_second:.1f} Hz and {size / 1e6:.1f} MB/s arrive. The link is too slow for it: "
            "use a compressed topic, a smaller image or a lower rate."
        )


class TopicSubscriptions:
    """The subscriptions of the kit on the network.

    Over Zenoh, the endpoints of a topic and type share one subscription. A network that enforces
    QoS needs one for each endpoint: the QoS determines what it receives, and late-joining endpoints
    get latched messages from the robot.

    Args:
        link: Declares the subscriptions.
        on_message: Called with each message in the graph's thread.
    """

    def __init__(self, link: Link, on_message: OnMessage) -> None:
        self._link, self._on_message = link, on_message
        self._by_key: dict[tuple[str, str, int], TopicSubscription] = {}

    def __iter__(self) -> Iterator[TopicSubscription]:
        return iter(tuple(self._by_key.values()))

    def add(self, endpoint: int, topic: str, type_name: str, qos: Qos) -> None:
        """Subscribe an endpoint of the kit to a topic."""
        latched_count = latched_depth(qos)
        key = topic, type_name, endpoint if self._link.is_qos_enforced else 0
        subscription = self._by_key.get(key)
        if subscription is not None and latched_count <= subscription.latched_count:
            subscription.users.add(endpoint)
            return
        if subscription is None:
            subscription = self._by_key[key] = TopicSubscription(topic, type_name, latched_count)
            subscription.inbox = Inbox(self._link.actions, partial(self._on_message, subscription))
        else:
            # The shared subscription is replaced by one that requests more latched messages.
            subscription.declaration.withdraw()
            subscription.latched_count = latched_count
        on_packet = subscription.inbox.put
        subscription.declaration = self._link.subscriber(topic, type_name, qos, latched_count, on_packet)
        subscription.users.add(endpoint)

    def remove(self, endpoint: int) -> None:
        """Unsubscribe an endpoint. A topic without endpoints is no longer transmitted."""
        for key, subscription in tuple(self._by_key.items()):
            subscription.users.discard(endpoint)
            if not subscription.users:
                subscription.declaration.withdraw()
                del self._by_key[key]

    def status_rows(self) -> list[tuple[str, object]]:
        """Return each topic's row of `ros2 doctor`: the row of its subscription with the most messages."""
        rows: dict[str, tuple[str, object]] = {}
        for subscription in sorted(self, key=lambda subscription: subscription.traffic.received):
            rows[subscription.topic] = subscription.status_row()
        return [rows[topic] for topic in sorted(rows)]

    def close(self) -> None:
        """Withdraw all subscriptions."""
        for subscription in self:
            subscription.declaration.withdraw()
        self._by_key.clear()
