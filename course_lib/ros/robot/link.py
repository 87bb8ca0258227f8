"""The interface between a robot graph and the network, implemented by links over Zenoh and DDS.

A link runs its own threads. They must not access the graph, which belongs to the kernel's thread,
and must not use `threading` or `time`, which robot time replaces. So a link only puts actions into
a queue (`actions`) and messages into inboxes; the graph processes both when it advances.

The functions at the end of the module write the messages about a link for users: problems between
this kit and the robot, and the next step.
"""

import errno
import re
from _queue import SimpleQueue
from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal

from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages.definitions import is_known, type_hash

HUMBLE_HASH = "TypeHashNotSupported"
MAX_SKEW = 0.5  # [s]
SECONDS_PER_DAY, DAYS_PER_YEAR = 86_400, 365.25
SIMULATED_TIME = (
    "The robot publishes /clock: its time is simulated. Set use_sim_time to true here as well, or "
    "stamps and tf do not fit: -p use_sim_time:=true after --ros-args, Viewer(use_sim_time=True)."
)
STOP_IS_DUE = (
    "The link is down, and the robot may still move: it receives a stop command when the link is back."
)
NO_STOP = "The link is down: the robot has not received a stop command. If it moves, use its emergency stop."
# Limit on latched messages of a publisher or a subscription with history KEEP_ALL.
KEEP_ALL_DEPTH = 1000
EntityKind = Literal["node", "publisher", "subscription", "server", "client"]
Action = Callable[[], None]
Actions = SimpleQueue[Action]
# Prints a line for the user.
Report = Callable[[str], None]
OnPacket = Callable[["Packet"], None]
# Called with an entity, and False if it was removed.
OnEntity = Callable[["Entity", bool], None]
# Called with None if the call received no reply.
OnReply = Callable[[bytes | None], None]
SendReply = Callable[[bytes], None]
OnRequest = Callable[[bytes, SendReply], None]


def latched_depth(qos: Qos) -> int:
    """Return how many messages a publisher keeps, or a subscription requests, for late joiners."""
    return (qos.limit or KEEP_ALL_DEPTH) if qos.is_latched else 0


@dataclass(frozen=True, slots=True)
class Packet:
    """A message received from the network.

    Args:
        cdr: The message with its encapsulation header.
        sequence: Sequence number, counted by its publisher.
        source_ns: Time of publication by the sender's clock, [ns] since 1970.
        gid: GID of its publisher.
        received_ns: Time of reception by this computer's clock, [ns] since 1970.
    """

    cdr: bytes
    sequence: int
    source_ns: int
    gid: bytes
    received_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Entity(ABC):
    """A node on the network, or an endpoint of a node. A link adds its identifiers there.

    Args:
        kind: The kind of entity.
        namespace: The namespace of the entity's node.
        node: The name of the entity's node.
        topic: The fully qualified name of the topic or service; empty for a node.
        type_name: The type, like `std_msgs/msg/String`; for a service without `_Request`.
        type_hash: The hash of the type, like `RIHS01_…`.
        qos: The QoS. Policies that the network does not transmit have their defaults.
    """

    kind: EntityKind
    namespace: str
    node: str
    topic: str = ""
    type_name: str = ""
    type_hash: str = ""
    qos: Qos = field(default_factory=Qos)

    @property
    def key(self) -> Hashable:
        """The key that identifies the entity among all entities of the network."""
        return self.node_key, self.gid

    @property
    @abstractmethod
    def node_key(self) -> Hashable:
        """The key that identifies the entity's node."""

    @property
    @abstractmethod
    def gid(self) -> bytes:
        """The GID of an endpoint; a publisher's is in its packets."""


class Declaration:
    """An entity of the kit on the network.

    Args:
        removals: Functions that remove it from the network.
    """

    def __init__(self, *removals: Callable[[], object]) -> None:
        self._removals = removals

    def withdraw(self) -> None:
        """Remove the entity from the network. Further calls have no effect."""
        removals, self._removals = self._removals, ()
        for remove in removals:
            remove()


class NetworkPublisher(Declaration, ABC):
    """A publisher of the kit on the network. All methods may be called from any thread.

    Args:
        topic: The topic on which it publishes.
        listing: Its entry in the network's graph.
        removals: Functions that remove it from the network.
    """

    def __init__(self, topic: str, listing: Declaration, *removals: Callable[[], object]) -> None:
        super().__init__(listing.withdraw, *removals)
        self.topic, self._listing = topic, listing

    @abstractmethod
    def put(self, cdr: bytes) -> None:
        """Publish a message."""

    @abstractmethod
    def is_matched(self) -> bool:
        """Return whether a message would reach a subscription now."""

    def hide(self) -> None:
        """Leave the network's graph, but keep the ability to publish a stop command."""
        self._listing.withdraw()


class NetworkClient(Declaration, ABC):
    """A service client of the kit on the network."""

    @abstractmethod
    def call(self, cdr: bytes, on_reply: OnReply) -> None:
        """Send a request. `on_reply` is queued with the reply, or with None if there is none."""


class Link(ABC):
    """A connection to a robot.

    `peer` describes the other side, "router" or "robot". `is_qos_enforced` states whether the
    network itself separates publishers and subscriptions with incompatible QoS, as DDS does and
    Zenoh does not.
    """

    peer: str
    is_qos_enforced: bool

    def __init__(self, address: str, domain: int) -> None:
        self.address, self.domain = address, domain
        self.actions: Actions = SimpleQueue()

    @property
    @abstractmethod
    def is_open(self) -> bool:
        """True until `close`."""

    @abstractmethod
    def is_up(self) -> bool:
        """Return whether the robot's side can be reached now."""

    def silent_seconds(self) -> float:
        """Return for how long the robot has not answered [s]; 0 if the link itself notices its loss."""
        return 0.0

    @abstractmethod
    def close(self) -> None:
        """Close the connection. Further calls have no effect."""

    def enqueue(self, action: Callable[..., None], *args: object) -> None:
        """Queue an action, which the graph's thread runs. May be called from any thread."""
        self.actions.put(partial(action, *args))

    def next_action(self, seconds: float) -> Action:
        """Return the next action of the queue, or wait at most `seconds` for one.

        Raises:
            Empty: There is none.
        """
        return self.actions.get(timeout=seconds) if seconds > 0 else self.actions.get_nowait()

    @abstractmethod
    def watch(self, on_entity: OnEntity, report: Report) -> None:
        """Queue a call for each remote entity that joins or leaves.

        `report` prints lines for the user.
        """

    @abstractmethod
    def no_nodes_message(self) -> str:
        """Return a message for a domain in which no node was found."""

    def network_topic(self, topic: str) -> str:
        """Return the topic on which messages of a topic leave this kit, by default the topic itself."""
        return topic

    def on_send(self, topic: str) -> None:  # noqa: B027  only a gateway needs it
        """Record that a message on a topic has been sent, for links through a gateway."""

    @abstractmethod
    def status_rows(self) -> list[tuple[str, object]]:
        """Return rows of `ros2 doctor` about this kind of link."""

    @abstractmethod
    def warnings(self) -> Iterable[tuple[str, str]]:
        """Yield (key, message) for each problem of this kind of link. Each key is reported once."""

    # The link itself creates the entities of the kit, which the graph only passes back to it.
    @abstractmethod
    def node(self, name: str, namespace: str) -> Any:
        """Return a node of the kit that is not announced yet."""

    def endpoint(
        self, node: Any, kind: EntityKind, topic: str, type_name: str, qos: Qos, known_hash: str = ""
    ) -> Any:
        """Return an endpoint of one of the kit's nodes. It is not announced yet.

        `known_hash` is the hash of its type, if the definition may be missing on this computer.
        """
        known_hash = known_hash or type_hash(type_name)
        return replace(node, kind=kind, topic=topic, type_name=type_name, type_hash=known_hash, qos=qos)

    @abstractmethod
    def announce(self, entity: Any) -> Declaration:
        """Announce a node, or a subscription that shares an inbox."""

    @abstractmethod
    def publisher(self, entity: Any) -> NetworkPublisher:
        """Declare a publisher."""

    @abstractmethod
    def subscriber(
        self, topic: str, type_name: str, qos: Qos, latched_count: int, on_packet: OnPacket
    ) -> Declaration:
        """Subscribe to a topic and request the last `latched_count` messages of latched publishers.

        `on_packet` is called with each message in the link's threads.
        """

    @abstractmethod
    def service(self, entity: Any, on_request: OnRequest) -> Declaration:
        """Offer a service. `on_request(cdr, send_reply)` is queued for each request."""

    @abstractmethod
    def client(self, entity: Any) -> NetworkClient:
        """Declare a service client."""


def type_warning(entity: Entity) -> str:
    """Return a message if the kit cannot read an entity's messages, else ""."""
    if entity.type_hash == HUMBLE_HASH:
        return (
            "The robot runs ROS 2 Humble, whose messages Jazzy does not receive over Zenoh. "
            "Install Jazzy on the robot, with ros-jazzy-rmw-zenoh-cpp."
        )
    # Humble and Cyclone DDS transmit no hash.
    if not entity.type_hash or not is_known(entity.type_name):
        return ""
    if entity.type_hash == type_hash(entity.type_name):
        return ""
    return (
        f"The robot has another definition of {entity.type_name} than this kit, so {entity.topic} "
        "stays silent. If the package is yours, copy its interface file from the robot. If it is "
        "ROS's, the robot needs ROS 2 Jazzy."
    )


def qos_warning(topic: str, policy: str, publisher: str, subscriber: str, *, is_enforced: bool) -> str:
    """Return a message about a publisher and a subscription with incompatible QoS."""
    line = (
        f"{topic}: the publisher of {publisher} and the subscription of {subscriber} have "
        f"incompatible QoS ({policy})."
    )
    if is_enforced:
        return f"{line} DDS does not connect them, so no message arrives. Give both the same {policy}."
    return f"{line} Zenoh delivers all the same; on a robot with DDS the topic would be silent."


def second_driver_warning(topic: str, node: str) -> str:
    """Return a message about another node that publishes velocity commands."""
    return (
        f"{topic}: {node} can drive the robot as well, and the robot obeys the newest command of "
        "either. Let only one of them publish."
    )


def clock_warning(skew: float) -> str:
    """Return a message if the robot's clock is `skew` [s] ahead of this computer, else ""."""
    if abs(skew) < MAX_SKEW:
        return ""
    days = abs(skew) / SECONDS_PER_DAY
    # A computer without a clock battery starts years ago if it has no internet.
    if days >= 2 * DAYS_PER_YEAR:
        offset = f"{days / DAYS_PER_YEAR:.0f} years"
    elif days >= 2:
        offset = f"{days:.0f} days"
    else:
        offset = f"{abs(skew):.1f} s"
    return (
        f"The robot's clock is {offset} {'ahead of' if skew > 0 else 'behind'} this computer's: "
        "stamps and tf do not fit together. Set both by NTP (timedatectl)."
    )


def no_answer_message(link: Link) -> str:
    """Return a message about a robot that does not answer."""
    seconds = link.silent_seconds()
    return f"{link.address} has not answered " + (f"for {seconds:.0f} s." if seconds else "yet.")


def silence_message(address: str, domain: int, error: int) -> str:
    """Return a message for a robot from which nothing is received.

    Args:
        address: The robot, like `dds/192.168.1.5`.
        domain: ROS_DOMAIN_ID.
        error: The error number with which datagrams to it are rejected, or 0.
    """
    start = f"Nothing comes from {address} in domain {domain}."
    if error == errno.ECONNREFUSED:
        return (
            f"{start} The computer is there, but no ROS 2 program has opened a port of this "
            "domain: start one, or pass its ROS_DOMAIN_ID, like domain=42 (in a terminal --domain "
            "42). A firewall that rejects UDP looks the same."
        )
    return (
        f"{start} Is the robot on, does a ROS 2 program run there in this domain (ROS_DOMAIN_ID), "
        "and are both in the same network? Firewalls and WSL2 often let no UDP in. A robot with a "
        "Fast DDS discovery server, or with ROS_AUTOMATIC_DISCOVERY_RANGE=OFF, does not answer. A "
        "link over Zenoh (tcp/HOST:7447) needs only an outgoing TCP connection."
    )


CYCLONE_SERVICES = (
    "The robot uses Cyclone DDS: its topics are linked, but not its services, parameters and actions. "
    "To call them, start its nodes with RMW_IMPLEMENTATION=rmw_fastrtps_cpp, and connect again."
)


def moved_message(address: str, host: str) -> str:
    """Return a message for a robot that was linked at `address` and now sends from `host`."""
    # An address that is a name instead of a number is still valid.
    has_number = re.fullmatch(r"dds/[\d.]+", address) is not None
    return (
        f"The robot {address} now has the address {host}, and the link follows it."
        + f" Next time connect to dds/{host}." * has_number
    )


def incomplete_message(topic: str, count: int, size: int) -> str:
    """Return a message for a topic of which `count` messages of `size` bytes arrived in part."""
    return (
        f"{topic}: {count} messages of {size / 1e6:.1f} MB have arrived only in part, more than "
        "whole ones. They are too large for this network: use a compressed topic, a smaller image "
        "or a reliable publisher."
    )
