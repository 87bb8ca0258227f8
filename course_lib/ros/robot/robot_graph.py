"""The graph of a kit that is linked to a robot: its time is the wall clock, and it lists the robot's nodes.

Nodes, displays and tools use it like any other graph. `RobotGraph` adds the network to it:

- The link reports each remote node and endpoint as an `Entity`. `RemoteEntities` adds it to the
  graph, so `nodes()`, `endpoints()` and matching treat it like the kit's own.
- Publishers, subscriptions and services of the kit are declared on the network when they are added,
  if `Permissions` allow it. A message received from the network is delivered to the subscriptions
  of its topic, and to taps.
- A robot sends only subscribed topics. Displays and recordings are not nodes, so a hidden node
  subscribes to the topics that they need (`_follow_taps`).

The link works in threads of its own, which must not touch the graph. They queue actions, and
`advance` runs them in the thread that holds the time lock, together with the due events.
"""

import heapq
import itertools
from _queue import Empty
from _thread import LockType, allocate_lock
from collections import Counter, deque
from collections.abc import Callable, Hashable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from course_lib.errors import format_count
from course_lib.ros.graph.graph import Graph, ignore
from course_lib.ros.graph.topics import (
    CLOCK,
    SERVICE_HEADER,
    EndpointInfo,
    OnMessage,
    Publisher,
    Qos,
    Sample,
    Topics,
    find_incompatible_policy,
    service_topics,
)
from course_lib.ros.messages.definitions import is_known
from course_lib.ros.messages.interface_files import SERVICE_PARTS
from course_lib.ros.robot.link import (
    NO_STOP,
    SIMULATED_TIME,
    STOP_IS_DUE,
    Actions,
    Declaration,
    Entity,
    Link,
    NetworkClient,
    Packet,
    Report,
    SendReply,
    clock_warning,
    latched_depth,
    no_answer_message,
    qos_warning,
    second_driver_warning,
    type_warning,
)
from course_lib.ros.robot.sending import BlockedTraffic, OutgoingTraffic, Permissions
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
# Limit on publishers of a topic whose sequence numbers are remembered.
MAX_PUBLISHERS = 1000

OnTopicPacket = Callable[["TopicSubscription", Packet], None]


@dataclass(eq=False, repr=False)
class Traffic:
    """Statistics of a topic: its rate and its lost messages."""

    received: int = 0
    # Lost messages, counted by gaps in sequence numbers.
    lost: int = 0
    # (time of reception [ns], size [bytes]) of recent messages.
    _recent: deque[tuple[int, int]] = field(default_factory=partial(deque, maxlen=WINDOW))
    # Time from publication to reception of recent messages [ns].
    _lags_ns: deque[int] = field(default_factory=partial(deque, maxlen=WINDOW))
    # Last sequence number by GID.
    _last_sequence: dict[bytes, int] = field(default_factory=dict)

    def add(self, packet: Packet) -> None:
        """Count a message."""
        last = self._last_sequence.get(packet.gid, packet.sequence)
        self.lost += max(0, packet.sequence - last - 1)
        self._last_sequence[packet.gid] = max(last, packet.sequence)
        if len(self._last_sequence) > MAX_PUBLISHERS:
            del self._last_sequence[next(iter(self._last_sequence))]
        self.received += 1
        self._recent.append((packet.received_ns, len(packet.cdr)))
        self._lags_ns.append(packet.received_ns - packet.source_ns)

    def reset_sequences(self) -> None:
        """Restart the detection of gaps: messages sent while a link is down do not count as lost."""
        self._last_sequence.clear()

    @property
    def lag_ns(self) -> int | None:
        """The shortest time from publication to reception [ns]: transport plus clock offset."""
        return min(tuple(self._lags_ns), default=None)

    def rates(self) -> tuple[float, float]:
        """Return messages and bytes per second over the last few seconds."""
        since = wall.time_ns() - RECENT_NS
        recent = [(at, size) for at, size in tuple(self._recent) if at >= since]
        if len(recent) < 2:
            return 0.0, 0.0
        seconds = max(recent[-1][0] - recent[0][0], 1) * 1e-9
        return (len(recent) - 1) / seconds, sum(size for _, size in recent[1:]) / seconds


@dataclass(eq=False, repr=False)
class Inbox:
    """The pending messages of a topic. When it is full, the oldest message is dropped.

    Args:
        actions: The queue of the graph, with one action for each pending message.
        on_packet: Called with each message in the graph's thread.
    """

    actions: Actions
    on_packet: Callable[[Packet], None]
    traffic: Traffic = field(default_factory=Traffic)
    dropped: int = 0
    _pending: deque[Packet] = field(default_factory=deque)
    _bytes: int = 0
    _mutex: LockType = field(default_factory=allocate_lock)

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
            self.actions.put(self._process_one)

    def _process_one(self) -> None:
        with self._mutex:
            packet = self._pending.popleft() if self._pending else None
            self._bytes -= len(packet.cdr) if packet else 0
        if packet is not None:
            self.on_packet(packet)


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

    def status_row(self) -> tuple[str, object]:
        """Return the topic and its rate as a row of `ros2 doctor`."""
        traffic = self.inbox.traffic
        if self.latched_count:
            return self.topic, f"latched, {format_count(traffic.received, 'message')} received"
        per_second, size = traffic.rates()
        lost, dropped = traffic.lost, self.inbox.dropped
        notes = f", {lost} lost on the way" * bool(lost) + f", {dropped} dropped here: busy" * bool(dropped)
        return self.topic, f"{per_second:.1f} Hz, {size / 1e6:.3f} MB/s{notes}"

    def warning(self) -> str:
        """Return a message if the link is too slow for the topic, else ""."""
        traffic = self.inbox.traffic
        sent = traffic.received + traffic.lost
        if sent < MIN_MESSAGES or traffic.lost < MAX_LOST * sent:
            return ""
        per_second, size = traffic.rates()
        return (
            f"{self.topic}: {traffic.lost / sent:.0%} of the messages are lost on the way, "
            f"{per_second:.1f} Hz and {size / 1e6:.1f} MB/s arrive. The link is too slow for it: "
            "use a compressed topic, a smaller image or a lower rate."
        )


@dataclass(eq=False, repr=False)
class TopicSubscriptions:
    """The subscriptions of the kit on the network.

    Over Zenoh, the endpoints of a topic and type share one subscription. A network that enforces
    QoS needs one for each endpoint: the QoS determines what it receives, and late-joining endpoints
    get latched messages from the robot.

    Args:
        link: Declares the subscriptions.
        on_message: Called with each message in the graph's thread.
    """

    link: Link
    on_message: OnTopicPacket
    _by_key: dict[tuple[str, str, int], TopicSubscription] = field(default_factory=dict)

    def __iter__(self) -> Iterator[TopicSubscription]:
        return iter(tuple(self._by_key.values()))

    def add(self, endpoint: int, topic: str, type_name: str, qos: Qos) -> None:
        """Subscribe an endpoint of the kit to a topic."""
        latched_count = latched_depth(qos)
        key = topic, type_name, endpoint if self.link.is_qos_enforced else 0
        subscription = self._by_key.get(key)
        if subscription is not None and latched_count <= subscription.latched_count:
            subscription.users.add(endpoint)
            return
        if subscription is None:
            subscription = TopicSubscription(topic, type_name, latched_count)
            subscription.inbox = Inbox(self.link.actions, partial(self.on_message, subscription))
        else:
            # The shared subscription is replaced by one that requests more latched messages.
            subscription.declaration.withdraw()
            subscription.latched_count = latched_count
        on_packet = subscription.inbox.put
        subscription.declaration = self.link.subscriber(topic, type_name, qos, latched_count, on_packet)
        subscription.users.add(endpoint)
        self._by_key[key] = subscription

    def remove(self, endpoint: int) -> None:
        """Unsubscribe an endpoint. A topic without endpoints is no longer transmitted."""
        for key, subscription in tuple(self._by_key.items()):
            subscription.users.discard(endpoint)
            if not subscription.users:
                subscription.declaration.withdraw()
                del self._by_key[key]

    def status_rows(self) -> list[tuple[str, object]]:
        """Return each topic's row of `ros2 doctor`: of its subscription with the most messages."""
        rows: dict[str, tuple[str, object]] = {}
        for subscription in sorted(self, key=lambda subscription: subscription.inbox.traffic.received):
            rows[subscription.topic] = subscription.status_row()
        return [rows[topic] for topic in sorted(rows)]

    def close(self) -> None:
        """Withdraw all subscriptions."""
        for subscription in self:
            subscription.declaration.withdraw()
        self._by_key.clear()


# Client id in the header of requests received over the link.
REMOTE_CLIENT = -1
# Limit on remote requests without a response.
MAX_OPEN = 1000

# Called with the topic, the type, and the header with the CDR bytes.
Deliver = Callable[[str, str, bytes], None]


@dataclass(eq=False, repr=False)
class Services:
    """The service clients and servers of the kit that are on the network.

    Args:
        link: Declares them.
        deliver: Delivers data to the subscriptions of a topic in the graph.
    """

    link: Link
    deliver: Deliver
    # Clients by the endpoint that publishes their requests.
    _clients: dict[int, NetworkClient] = field(default_factory=dict)
    # Servers by the endpoint that receives their requests.
    _servers: dict[int, Declaration] = field(default_factory=dict)
    # Functions that reply to the requests of the network, by request number.
    _pending_replies: dict[int, SendReply] = field(default_factory=dict)
    _request_numbers: Iterator[int] = field(default_factory=itertools.count)

    def add(self, node: Any, info: EndpointInfo) -> None:
        """Declare the client or server of the endpoint that publishes or receives requests."""
        name, type_name = info.service or ("", "")
        if info.is_client:
            entity = self.link.endpoint(node, "client", name, type_name, info.qos)
            self._clients[info.id] = self.link.client(entity)
        else:
            entity = self.link.endpoint(node, "server", name, type_name, info.qos)
            self._servers[info.id] = self.link.service(entity, partial(self._on_request, info))

    def remove(self, endpoint: int) -> None:
        """Withdraw the client or server of an endpoint if there is one."""
        declaration = self._clients.pop(endpoint, None) or self._servers.pop(endpoint, None)
        if declaration is not None:
            declaration.withdraw()

    def call(self, info: EndpointInfo, data: bytes) -> bool:
        """Send a request of a client. Return False if the client is not on the network."""
        client = self._clients.get(info.id)
        if client is None:
            return False
        name, type_name = info.service or ("", "")
        header, cdr = data[: SERVICE_HEADER.size], data[SERVICE_HEADER.size :]

        def on_reply(reply: bytes | None) -> None:
            if reply is not None:
                _, replies = service_topics(name, type_name)
                self.deliver(*replies, header + reply)

        client.call(cdr, on_reply)
        return True

    def send_response(self, data: bytes) -> None:
        """Send a response over the link if its request was received from there."""
        client, number = SERVICE_HEADER.unpack_from(data)
        send_reply = self._pending_replies.pop(number, None) if client == REMOTE_CLIENT else None
        if send_reply is not None:
            send_reply(data[SERVICE_HEADER.size :])

    def _on_request(self, info: EndpointInfo, cdr: bytes, send_reply: SendReply) -> None:
        number = next(self._request_numbers)
        self._pending_replies[number] = send_reply
        if len(self._pending_replies) > MAX_OPEN:
            # The oldest client receives no reply, which Zenoh reports to it when `send_reply` is
            # released.
            del self._pending_replies[next(iter(self._pending_replies))]
        self.deliver(info.topic, info.type_name, SERVICE_HEADER.pack(REMOTE_CLIENT, number) + cdr)


# Limit on the depth of remote endpoints, because the kit keeps or requests so many latched messages.
MAX_DEPTH = 10_000
# Limit on departed publishers whose latched messages are kept.
MAX_LATCHED = 100


@dataclass(eq=False, repr=False)
class RemoteEntities:
    """The entities of other kits and of the robot in the graph.

    They are added with the methods of `Graph`, because the methods of `RobotGraph` would announce
    them again.

    Args:
        graph: The graph that lists them.
        topics: The graph's topics.
        on_added: Called with each endpoint that joins.
    """

    graph: Graph
    topics: Topics
    on_added: Callable[[Entity], None]
    # Service servers by service name.
    servers: Counter[str] = field(default_factory=Counter)
    _nodes: dict[Hashable, int] = field(default_factory=dict)
    _endpoints: dict[Hashable, int] = field(default_factory=dict)
    # Endpoint ids by GID.
    _publishers: dict[bytes, int] = field(default_factory=dict)
    # Latched samples of departed publishers by GID.
    _latched_of_departed: dict[bytes, list[Sample]] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self._nodes)

    def on_change(self, entity: Entity, has_joined: bool) -> None:
        """Add or remove an entity. Entities may be reported in any order."""
        if not has_joined:
            self._remove(entity)
        elif entity.kind == "node":
            self._ensure_node(entity)
        elif entity.key not in self._endpoints:
            endpoint = self._endpoints[entity.key] = self._add(entity, self._ensure_node(entity))
            listed = self.topics.publishers.get(endpoint) or self.topics.subscriptions[endpoint]
            listed.info = replace(listed.info, remote_gid=entity.gid, remote_type_hash=entity.type_hash)
            self.on_added(entity)
            self._notify(listed.info, has_joined=True)

    def publisher(self, gid: bytes) -> Publisher | None:
        """Return the publisher with a GID, or None if it is unknown."""
        return self.topics.publishers.get(self._publishers.get(gid, -1))

    def publisher_infos(self) -> list[EndpointInfo]:
        """List the remote publishers."""
        publishers = (self.topics.publishers.get(endpoint) for endpoint in self._publishers.values())
        return [publisher.info for publisher in publishers if publisher is not None]

    def _ensure_node(self, entity: Entity) -> int:
        """Return the node of an entity. It is added if its endpoint is reported first."""
        if entity.node_key not in self._nodes:
            self._nodes[entity.node_key] = Graph.add_node(self.graph, entity.node, entity.namespace)
        return self._nodes[entity.node_key]

    def _add(self, entity: Entity, node: int) -> int:
        topic, type_name = entity.topic, entity.type_name
        qos = replace(entity.qos, depth=min(entity.qos.depth, MAX_DEPTH))
        if entity.kind == "publisher":
            endpoint = Graph.add_publisher(self.graph, node, topic, type_name, qos)
            self._publishers[entity.gid] = endpoint
            latched = self._latched_of_departed.pop(entity.gid, ())
            self.topics.publishers[endpoint].latched.extend(latched)
            return endpoint
        if entity.kind in ("server", "client"):
            (topic, type_name), _ = service_topics(topic, type_name)
            qos = Qos()
        if entity.kind == "client":
            return Graph.add_publisher(self.graph, node, topic, type_name, qos)
        self.servers[entity.topic] += entity.kind == "server"
        return Graph.add_subscription(self.graph, node, 0, topic, type_name, qos, ignore)

    def _remove(self, entity: Entity) -> None:
        if entity.kind == "node":
            node = self._nodes.pop(entity.node_key, None)
            for gid in tuple(self._publishers):
                self._keep_latched_samples(gid, node)
            if node is not None:
                for info in self.topics.endpoints():
                    if info.node == node:
                        self._notify(info, has_joined=False)
                Graph.remove_node(self.graph, node)
        elif (endpoint := self._endpoints.pop(entity.key, None)) is not None:
            self.servers[entity.topic] -= entity.kind == "server"
            if entity.kind == "publisher":
                self._keep_latched_samples(entity.gid, None)
                self._publishers.pop(entity.gid, None)
            known = self.topics.publishers.get(endpoint) or self.topics.subscriptions.get(endpoint)
            if known is not None:
                self._notify(known.info, has_joined=False)
            Graph.remove_endpoint(self.graph, endpoint)

    def _notify(self, info: EndpointInfo, *, has_joined: bool) -> None:
        for listener in self.graph.remote_listeners:
            listener(self.graph, info, has_joined)

    def _keep_latched_samples(self, gid: bytes, node: int | None) -> None:
        """Keep the latched messages of a leaving publisher: the link may only be interrupted."""
        publisher = self.publisher(gid)
        if publisher is not None and publisher.latched and node in (None, publisher.info.node):
            self._latched_of_departed[gid] = list(publisher.latched)
        while len(self._latched_of_departed) > MAX_LATCHED:
            del self._latched_of_departed[next(iter(self._latched_of_departed))]


NO_SKEW = "not measured: no topic is received yet"
CLOCK_TOPIC = CLOCK[0]
# Time that a program or view has to subscribe to the robot's clock [s].
CLOCK_SECONDS = 2.0
# Limit on a wait, so that an interrupt is noticed soon [s].
MAX_WAIT = 0.02
# Time that Python's exit waits for a lost link. A restarting kernel is killed after 5 s.
EXIT_SECONDS = 3.0
# Interval between checks of the link and of the topics that taps need.
POLL_NS = 200_000_000
# Time without an answer after which the robot is reported as silent [s].
SILENT_SECONDS = 5.0
# The node that subscribes for displays and recordings. ROS hides names that begin with an
# underscore.
TAP_NODE = "_course_lib"
# Limit on actions that run before a due event.
MAX_ACTIONS = 100


@dataclass(frozen=True)
class OwnNode:
    """A node of the kit: the link's entity, of which endpoints are made, and its declaration."""

    entity: Any
    declaration: Declaration


class RobotGraph(Graph):
    """A graph whose time is the wall clock. It never runs out of events while the link is open.

    Args:
        link: The connection to the robot, which the graph closes.
        allowed: Permissions for sending and calling.
        report: Prints a line about the link.
        notebook: Whether it is a kernel's graph.
    """

    keeps_wall_time = True

    def __init__(self, link: Link, allowed: Permissions, report: Report, *, notebook: bool = False) -> None:
        super().__init__(start_ns=wall.time_ns(), delay_ns=0, notebook=notebook)
        self.link, self.is_qos_enforced = link, link.is_qos_enforced
        self.blocked = BlockedTraffic(report, notebook=notebook)
        self._allowed, self._report = allowed, report
        self._reported = set[str]()
        self._own_nodes: dict[int, OwnNode] = {}
        # Subscriptions of the kit by endpoint.
        self._announced: dict[int, Declaration] = {}
        self._subscriptions = TopicSubscriptions(link, self._on_message)
        self._sending = OutgoingTraffic()
        self._services = Services(link, self._on_service_data)
        self._remote = RemoteEntities(self, self._topics, self._on_new_entity)
        # Endpoints of TAP_NODE by topic and type.
        self._tap_endpoints: dict[tuple[str, str], int] = {}
        self._tap_node: int | None = None
        self._polled_ns = 0
        self._is_up = link.is_up()
        # Wall time at which the robot's clock was discovered [s]; None before.
        self._clock_found_at: float | None = None
        # Wall time at which the link was lost [s]; None if it never was.
        self._down_since: float | None = None
        self._is_silent = False
        link.watch(self._remote.on_change, report)

    @property
    def now_ns(self) -> int:
        """Robot time, [ns]: the wall clock, but never decreasing."""
        return self._now_ns if self.ended else max(self._now_ns, wall.time_ns())

    def advance(self) -> bool:
        """Run the queued actions and the due event, or wait a moment for either."""
        due_ns = self.next_due_ns()
        if self.end_ns is not None and self.now_ns >= self.end_ns and (due_ns or self.end_ns) >= self.end_ns:
            self.ended = True
        if self.ended:
            return False
        remaining = MAX_WAIT if due_ns is None else (due_ns - self.now_ns) * 1e-9
        try:
            # Messages that arrive faster than they are delivered wait in their inboxes, which are
            # bounded.
            is_behind = remaining <= 0 and self.pending > MAX_ACTIONS
            if not is_behind:
                self._run_actions(min(max(remaining, 0.0), MAX_WAIT))
            self._poll()
            self._advance_to(self.now_ns)
            due_ns = self.next_due_ns()
            if due_ns is not None and due_ns <= self._now_ns:
                heapq.heappop(self._events)[4].action()
        except KeyboardInterrupt:
            self._sending.stop()
            raise
        return True

    def add_node(self, name: str, namespace: str) -> int:
        """Add a node and announce it."""
        node = super().add_node(name, namespace)
        entity = self.link.node(name, namespace)
        self._own_nodes[node] = OwnNode(entity, self.link.announce(entity))
        return node

    def remove_node(self, node: int) -> None:
        """Remove a node and its endpoints."""
        for info in self._topics.endpoints():
            if info.node == node:
                self.remove_endpoint(info.id)
        super().remove_node(node)
        if node in self._own_nodes:
            self._own_nodes.pop(node).declaration.withdraw()

    def add_publisher(self, node: int, topic: str, type_name: str, qos: Qos) -> int:
        """Add a publisher. It is on the network if its topic may be sent."""
        endpoint = super().add_publisher(node, topic, type_name, qos)
        info = self._topics.publishers[endpoint].info
        own_node = self._own_nodes[node].entity
        if info.service is None:
            if self._allowed.is_topic_allowed(topic):
                network_topic = self.link.network_topic(topic)
                entity = self.link.endpoint(own_node, "publisher", network_topic, type_name, qos)
                self._sending.add(endpoint, type_name, self.link.publisher(entity))
                self._check_qos(topic)
                self._check_drivers(topic)
        elif info.is_client and self._allowed.is_service_allowed(info.service[0]):
            self._services.add(own_node, info)
        return endpoint

    def add_subscription(
        self, node: int, entity: int, topic: str, type_name: str, qos: Qos, on_message: OnMessage
    ) -> int:
        """Add a subscription. From now on the robot sends the topic."""
        endpoint = super().add_subscription(node, entity, topic, type_name, qos, on_message)
        info, own_node = self._topics.subscriptions[endpoint].info, self._own_nodes[node].entity
        if info.service is None:
            # Subscribe before announcing, because a peer that sees the announcement may publish
            # immediately.
            self._subscriptions.add(endpoint, topic, type_name, qos)
            announced = self.link.endpoint(own_node, "subscription", topic, type_name, qos)
            self._announced[endpoint] = self.link.announce(announced)
            self._check_qos(topic)
        elif info.is_service and self._allowed.is_service_allowed(info.service[0]):
            self._services.add(own_node, info)
        elif info.is_service:
            self.blocked.add_service(*info.service)
        return endpoint

    def remove_endpoint(self, endpoint: int) -> None:
        """Remove an endpoint from the graph and from the network."""
        super().remove_endpoint(endpoint)
        self._sending.remove(endpoint)
        self._services.remove(endpoint)
        self._subscriptions.remove(endpoint)
        if endpoint in self._announced:
            self._announced.pop(endpoint).withdraw()

    def incompatible_policy(self, publisher: EndpointInfo, subscription: EndpointInfo) -> str | None:
        """Return the QoS policy that makes a pair incompatible.

        Over Zenoh, QoS does not separate pairs.
        """
        if self._is_over_link(publisher, subscription) and not self.link.is_qos_enforced:
            return None
        return super().incompatible_policy(publisher, subscription)

    def publish(self, endpoint: int, cdr: bytes) -> None:
        """Publish in this graph and, if allowed, on the network."""
        super().publish(endpoint, cdr)
        info = self._topics.publishers[endpoint].info
        if info.service is None:
            if self._sending.put(endpoint, cdr):
                self.link.on_send(info.topic)
            else:
                self.blocked.add(info.topic, "--send")
        elif not info.is_client:
            self._services.send_response(cdr)
        elif self._remote.servers[info.service[0]] > 0 and not self._services.call(info, cdr):
            self.blocked.add(info.service[0], "--call")

    def link_report(self) -> list[tuple[str, object]]:
        """Return the state of the link: address, permissions, clocks and rates of topics."""
        blocked_counts = [f"{count} on {name}" for name, count in sorted(self.blocked.counts.items())]
        skew = self._clock_skew()
        if self._is_up and self._is_silent:
            state = f"no answer for {self.link.silent_seconds():.0f} s"
        elif self._is_up:
            state = "connected"
        else:
            state = "no answer yet" if self._down_since is None else "lost"
        return [
            (self.link.peer, f"{self.link.address}, {state}"),
            ("domain", self.link.domain),
            ("nodes", len(self._remote)),
            *self._allowed.status_rows(),
            *self.link.status_rows(),
            ("not sent", ", ".join(blocked_counts) or "nothing"),
            ("robot's clock", NO_SKEW if skew is None else f"{skew:+.3f} s from this computer's"),
            *self._subscriptions.status_rows(),
        ]

    def link_error(self) -> str:
        """Return why nothing is received from the robot, or "" if the link works."""
        if not self._is_up and self._down_since is not None:
            return f"The link to {self.link.address} is lost."
        return no_answer_message(self.link) if self._is_silent or not self._is_up else ""

    def take_blocked_calls(self) -> list[str]:
        """Return the services whose calls have been blocked since the last call."""
        calls, self.blocked.calls = self.blocked.calls, []
        return calls

    def close(self) -> None:
        """Stop the robot and close the link as soon as the robot has received the stop."""
        self._subscriptions.close()
        self._sending.close(self.link.close)
        if self.link.is_open:
            self._report_once("stop", STOP_IS_DUE)

    def close_at_exit(self) -> None:
        """Close when Python exits.

        Wait briefly for a lost link if the robot still needs a stop command.
        """
        self.close()
        deadline = wall.monotonic() + EXIT_SECONDS
        while self.link.is_open and wall.monotonic() < deadline:
            wall.sleep(MAX_WAIT)
        if self.link.is_open:
            self._report(NO_STOP)
            self.link.close()

    def _run_actions(self, seconds: float) -> None:
        """Run the actions that the link has queued. Wait at most `seconds` for the first."""
        try:
            action = self.link.next_action(seconds)
            for _ in range(MAX_ACTIONS):
                action()
                action = self.link.actions.get_nowait()
            action()
        except Empty:
            return

    def _on_message(self, receiver: TopicSubscription, packet: Packet) -> None:
        """Deliver a message received by the link to the endpoints of its subscription."""
        topic, type_name = receiver.topic, receiver.type_name
        publisher = self._remote.publisher(packet.gid)
        qos, node = (publisher.info.qos, publisher.info.node) if publisher else (Qos(), 0)
        sample = Sample(self.now_ns, topic, type_name, packet.cdr, qos, node)
        is_shared = not self.link.is_qos_enforced
        if publisher is not None and qos.is_latched and is_shared:
            publisher.latched.append(sample)
        # If several subscriptions receive the message, taps receive it from their own subscription
        # only.
        if is_shared or self._tap_endpoints.get((topic, type_name)) in receiver.users:
            self._notify_taps(sample)
        for subscription in self._topics.subscriptions_of_type(topic, type_name):
            if subscription.info.id in receiver.users:
                self._deliver(sample, subscription)

    def _on_service_data(self, topic: str, type_name: str, data: bytes) -> None:
        sample = Sample(self.now_ns, topic, type_name, data, Qos(), 0)
        for subscription in self._topics.subscriptions_of_type(topic, type_name):
            self._deliver(sample, subscription)

    def _on_new_entity(self, entity: Entity) -> None:
        self._report_once(entity.type_name, type_warning(entity))
        if entity.kind == "publisher":
            if entity.topic == CLOCK_TOPIC and self._clock_found_at is None:
                self._clock_found_at = wall.monotonic()
            # Poll immediately, so that taps miss as few of the first messages as possible.
            self._polled_ns = 0
            self._check_drivers(entity.topic)
        if entity.kind in ("publisher", "subscription"):
            self._check_qos(entity.topic)

    def _check_qos(self, topic: str) -> None:
        """Warn about pairs over the link whose types differ or whose QoS is incompatible."""
        infos = self._topics.endpoints_on(topic)
        for publisher in (info for info in infos if info.kind == "pub"):
            for subscription in (info for info in infos if info.kind == "sub"):
                if not self._is_over_link(publisher, subscription):
                    continue
                nodes = [self._nodes[info.node].full_name for info in (publisher, subscription)]
                if publisher.type_name != subscription.type_name:
                    sent, expected = publisher.type_name, subscription.type_name
                    line = (
                        f"{topic}: {nodes[0]} publishes {sent}, and {nodes[1]} subscribes to "
                        f"{expected}, so no message arrives. Use the robot's type."
                    )
                    self._report_once(f"type {topic} {sent} {expected}", line)
                    continue
                policy = find_incompatible_policy(publisher.qos, subscription.qos)
                if policy is None:
                    continue
                line = qos_warning(topic, policy, *nodes, is_enforced=self.link.is_qos_enforced)
                # Each node of the kit is reported once, even if the robot's node restarts.
                own_node = nodes[subscription.node in self._own_nodes]
                self._report_once(f"qos {topic} {policy} {own_node}", line)

    def _check_drivers(self, topic: str) -> None:
        """Warn about remote nodes that drive the robot on a topic on which this kit drives it."""
        if not self._sending.drives_on(topic):
            return
        for publisher in self._remote.publisher_infos():
            if publisher.topic == topic:
                node = self._nodes[publisher.node].full_name
                self._report_once(f"driver {topic} {node}", second_driver_warning(topic, node))

    def _is_over_link(self, publisher: EndpointInfo, subscription: EndpointInfo) -> bool:
        return (publisher.node in self._own_nodes) != (subscription.node in self._own_nodes)

    def _poll(self) -> None:
        """Every POLL_NS, subscribe to the topics that taps need and report problems of the link."""
        if self.now_ns - self._polled_ns < POLL_NS or not self.link.is_open:
            return
        self._polled_ns = self.now_ns
        self._follow_taps()
        self._watch_link()
        self._check_simulated_time()
        for key, line in self.link.warnings():
            self._report_once(key, line)
        self._report_once("clock", clock_warning(self._clock_skew() or 0.0))
        for subscription in self._subscriptions:
            self._report_once(f"slow {subscription.topic}", subscription.warning())

    def _check_simulated_time(self) -> None:
        """Warn about the simulated time of the robot, unless a node or view follows /clock soon."""
        if self._clock_found_at is None or wall.monotonic() - self._clock_found_at < CLOCK_SECONDS:
            return
        own_nodes = self._own_nodes.keys() - {self._tap_node}
        subscriptions = (info for info in self._topics.endpoints_on(CLOCK_TOPIC) if info.kind == "sub")
        is_followed = any(info.node in own_nodes for info in subscriptions) or any(
            tap.select_topics is not None and CLOCK_TOPIC in tap.select_topics() for tap in self._taps
        )
        if not is_followed:
            self._report_once(CLOCK_TOPIC, SIMULATED_TIME)

    def _follow_taps(self) -> None:
        """Subscribe to the topics that displays and recordings need, with the offered QoS."""
        offered_qos = {(info.topic, info.type_name): info.qos for info in self._remote.publisher_infos()}
        selectors = [tap.select_topics for tap in self._taps]
        names = {name for select_topics in selectors if select_topics is not None for name in select_topics()}
        needs_all = None in selectors
        topics = {
            (topic, type_name)
            for topic, type_name in offered_qos
            if (needs_all or topic in names) and is_known(type_name) and not type_name.endswith(SERVICE_PARTS)
        }
        for removed_topic in self._tap_endpoints.keys() - topics:
            self.remove_endpoint(self._tap_endpoints.pop(removed_topic))
        if topics and self._tap_node is None:
            self._tap_node = self.add_node(TAP_NODE, "/")
        for key in sorted(topics - self._tap_endpoints.keys()):
            node = self._tap_node or 0
            self._tap_endpoints[key] = self.add_subscription(node, 0, *key, offered_qos[key], ignore)

    def _watch_link(self) -> None:
        """Report when the link is lost or restored, and when the robot stops answering."""
        is_up, address = self.link.is_up(), self.link.address
        if self._is_up and not is_up:
            self._down_since = wall.monotonic()
            self._report(
                f"The link to {address} is lost. It comes back by itself when the {self.link.peer} "
                "is at this address again."
            )
            for subscription in self._subscriptions:
                subscription.inbox.traffic.reset_sequences()
        elif is_up and not self._is_up and self._down_since is not None:
            self._report(f"The link to {address} is back after {wall.monotonic() - self._down_since:.1f} s.")
        was_silent, self._is_silent = self._is_silent, self.link.silent_seconds() > SILENT_SECONDS
        if self._is_silent and not was_silent:
            self._report(no_answer_message(self.link))
        self._is_up = is_up

    def _clock_skew(self) -> float | None:
        """Return the offset of the robot's clock from this computer's clock [s], minus the transport time.

        Latched topics are ignored, because their messages are old when they arrive.
        """
        lags = [s.inbox.traffic.lag_ns for s in self._subscriptions if not s.latched_count]
        measured_lags = [lag for lag in lags if lag is not None]
        return -min(measured_lags) * 1e-9 if measured_lags else None

    def _report_once(self, key: str, line: str) -> None:
        if line and key not in self._reported:
            self._reported.add(key)
            self._report(line)
