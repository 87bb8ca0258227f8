"""The link over Zenoh: one session with a robot's router, and the entities of the kit in it.

Zenoh calls handlers in its own threads. A handler only puts an action into the queue or a message
into an inbox; see `course_lib.ros.robot.link`. Keys, tokens, QoS, attachments and GIDs have the
wire format of rmw_zenoh_cpp (Jazzy, 0.2.4 and newer).
"""

import _thread
import itertools
import json
import re
import ssl
import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Literal, cast

import zenoh
from zenoh import ext
from zenoh.handlers import Callback

from course_lib.errors import CourseError, format_count
from course_lib.ros.graph.topics import Qos, dds_type, ros_type
from course_lib.ros.messages.definitions import type_hash
from course_lib.ros.robot.link import (
    Declaration,
    Entity,
    EntityKind,
    Link,
    NetworkClient,
    NetworkPublisher,
    OnEntity,
    OnPacket,
    OnReply,
    OnRequest,
    Packet,
    Report,
    latched_depth,
)
from course_lib.ros.time import wall

ROBOT = "robot"  # user name of a robot that connects to the gateway
# Namespace of the topics that students send, as in /students/ann/cmd_vel.
STUDENTS = "students"
# @course/ann/<zid> is the liveliness token of a connected kit. Students' names have no capital
# letters, so @course/GATEWAY is available for the gateway's token.
PRESENCE = "@course"
GATEWAY = f"{PRESENCE}/GATEWAY"
# Stands for no driver, or no topics, in the gateway's token.
NONE = "-"


@dataclass(frozen=True)
class Login:
    """The user of a link. An empty name means that no login is needed."""

    name: str = ""
    token: str = ""

    def settings(self, address: str) -> dict[str, Any]:
        """Return Zenoh's settings: the login and, for TLS, the certificates that this computer trusts."""
        settings: dict[str, Any] = {}
        if self.name:
            settings["transport/auth/usrpwd"] = {"user": self.name, "password": self.token}
        # The environment variable SSL_CERT_FILE overrides the default.
        certificates = ssl.get_default_verify_paths().cafile
        if address.startswith("tls/") and certificates:
            settings["transport/link/tls"] = {"root_ca_certificate": certificates}
        return settings

    def network_topic(self, topic: str) -> str:
        """Return the topic on which this user's messages are sent; for students, in their namespace."""
        namespace = f"/{STUDENTS}/{self.name}"
        if self.name in ("", ROBOT) or topic.startswith(f"{namespace}/"):
            return topic
        return namespace + topic

    def presence_key(self, zid: str) -> str:
        """Return the key of the token that announces this user to a gateway; "" without a login."""
        return f"{PRESENCE}/{self.name}/{zid}" if self.name else ""


NO_LOGIN = Login()


def gateway_key(driver: str, topics: Iterable[str]) -> str:
    """Return the key of the token with the driver and the topics forwarded to the robot."""
    return f"{GATEWAY}/{driver or NONE}/{','.join(topics).replace('/', '%') or NONE}"


def read_gateway_key(key: str) -> tuple[str, list[str]]:
    """Return the driver ("" if there is none) and the topics in the key of a gateway's token."""
    driver, topics = key.removeprefix(f"{GATEWAY}/").split("/")
    names = [] if topics == NONE else topics.replace("%", "/").split(",")
    return driver if driver != NONE else "", [f"/{name.removeprefix('/')}" for name in names]


def split_login(address: str) -> tuple[str, Login]:
    """Split an address into the address without the login, and the login."""
    match = re.fullmatch(r"(\w+/)(\w+):([\w-]+)@(.+)", address)
    return (match[1] + match[4], Login(match[2], match[3])) if match else (address, NO_LOGIN)


@dataclass(eq=False, repr=False)
class DriverReport:
    """Reports the student's topics that a gateway does not forward, once for each driver.

    The arguments are the student's login and a function that prints a line.
    """

    _login: Login
    _report: Callable[[str], None]
    # None: not known yet; "": there is no driver.
    _driver: str | None = None
    # The topics that the gateway forwards.
    _topics: Sequence[str] = ()
    # Whether a sent topic was reported as not forwarded, by topic.
    _reported: dict[str, bool] = field(default_factory=dict)

    def change(self, driver: str, topics: Sequence[str]) -> None:
        """Set the driver and the topics that the gateway forwards."""
        has_changed = driver != self._driver
        self._driver, self._topics = driver, topics
        for topic in tuple(self._reported) if has_changed else ():
            self._explain(topic)

    def on_send(self, topic: str) -> None:
        """Record that a message on a topic has been sent."""
        if topic not in self._reported:
            self._reported[topic] = False
            self._explain(topic)

    def status_rows(self) -> list[tuple[str, object]]:
        """Return the driver as a row of `ros2 doctor`. Without a gateway, return no row."""
        if self._driver is None:
            return []
        return [("driver", "you" if self._driver == self._login.name else self._driver or "nobody")]

    def _explain(self, topic: str) -> None:
        network_topic = self._login.network_topic(topic)
        if self._driver is None or network_topic == topic:
            return
        if topic not in self._topics:
            if not self._reported[topic]:
                self._report(
                    f"The gateway does not pass {topic} on to the robot: others hear it as {network_topic}."
                )
            self._reported[topic] = True
        elif self._driver != self._login.name:
            self._report(
                f"{self._driver or 'Nobody'} drives: your {topic} is not passed on to the robot. "
                "The instructor chooses the driver."
            )
            self._reported[topic] = True
        elif self._reported[topic]:
            self._report(f"You drive now: your {topic} goes to the robot.")
            self._reported[topic] = False


OPEN_SECONDS = 3.0  # [s] timeout of a router's answer
CALL_SECONDS = 600.0  # [s] timeout of a service call, as in rmw_zenoh
# Intervals between attempts to connect.
RETRY = {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 2}
# Timeout of running handlers at the end, and the polling period.
END_SECONDS, POLL_SECONDS = 2.0, 0.005


@dataclass(eq=False, repr=False)
class Handlers:
    """Handlers that are called by Zenoh's own threads and counted until each has been dropped.

    Handlers in Python threads would keep the interpreter alive while a session is open, and such a
    thread would belong to the program, whose `Thread.start` robot time replaces. But if the
    interpreter exits while a thread of Zenoh runs a handler, the process aborts. So `wait` has to
    be called after closing a session.
    """

    alive_count: int = 0
    _mutex: _thread.LockType = field(default_factory=_thread.allocate_lock)

    def wrap(
        self,
        function: Callable[[Any], None],
        on_end: Callable[[], None] | None = None,
    ) -> "Callback[Any]":
        """Return a handler for `function`. `on_end` is called after the last call."""
        with self._mutex:
            self.alive_count += 1

        def on_drop() -> None:
            if on_end is not None:
                on_end()
            with self._mutex:
                self.alive_count -= 1

        return Callback(function, on_drop, indirect=False)

    def wait(self, seconds: float = END_SECONDS) -> None:
        """Wait until all handlers have been dropped, at most `seconds`."""
        deadline = wall.monotonic() + seconds
        while self.alive_count and wall.monotonic() < deadline:
            wall.sleep(POLL_SECONDS)


def open_session(address: str, login: Login = NO_LOGIN) -> zenoh.Session:
    """Open a session in client mode, because a robot's router does not route between peers.

    Raises:
        CourseError: No router answers, or the address is invalid.
    """
    settings = {
        "mode": "client",
        "connect/endpoints": [address],
        "connect/timeout_ms": round(OPEN_SECONDS * 1000),
        "connect/retry": RETRY,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "listen/endpoints": [],
        # The caches of latched topics require time stamps.
        "timestamping/enabled": True,
        "queries_default_timeout": round(CALL_SECONDS * 1000),
        "transport/shared_memory/enabled": False,
        **login.settings(address),
    }
    config = zenoh.Config()
    try:
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
    except zenoh.ZError as error:
        raise CourseError(f"{address!r} is not an address: write it like tcp/192.168.1.5:7447.") from error
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        if login.name:
            raise CourseError(
                f"No gateway at {address} accepts the login of {login.name}. Does `course router` "
                "run there, is the token complete, is this the right network?"
            ) from error
        raise CourseError(
            f"No Zenoh router answers at {address}. Does `ros2 run rmw_zenoh_cpp rmw_zenohd` run on "
            "the robot, is its port open, is this the right network? A robot without Zenoh has an "
            "address like dds/192.168.1.5."
        ) from error


ADMIN = "@ros2_lv"  # the first part of every liveliness token
# The depth for an empty field or a depth of 0.
DEFAULT_DEPTH = 42
INFINITE = (9_223_372_036, 854_775_807)  # RMW_DURATION_INFINITE, [s] and [ns]
# Names of nodes, namespaces, topics and services, each part after the first with a slash.
NAME = re.compile(r"/?[A-Za-z0-9_]+(/[A-Za-z0-9_]+)*")
# Number of parts of a token. Rolling appends a 14th part to an endpoint's token.
NODE_PARTS, ENDPOINT_PARTS = 9, 13
ATTACHMENT = struct.Struct("<qqB16s")  # sequence number, time [ns since 1970], length of the GID, GID
GID_BYTES = 16

# Kinds of entities by their codes in tokens.
KINDS: Mapping[str, EntityKind] = {
    "NN": "node",
    "MP": "publisher",
    "MS": "subscription",
    "SS": "server",
    "SC": "client",
}
CODES = {kind: code for code, kind in KINDS.items()}

# Values of the enumerations in rmw/types.h.
_RELIABILITY = {"reliable": "1", "best_effort": "2"}
_DURABILITY = {"volatile": "2", "transient_local": "1"}
_HISTORY = {"keep_last": "1", "keep_all": "2"}
_LIVELINESS = {"automatic": "1", "manual_by_topic": "3"}


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohEntity(Entity):
    """A node or endpoint, as its liveliness token describes it.

    Args:
        domain: ROS_DOMAIN_ID.
        zid: Zenoh ID of its session, as `str(session.zid())`.
        node_id: ID of its node; a session counts IDs from 0.
        id: Its own ID.
        enclave: The enclave of its node.
    """

    domain: int
    zid: str
    node_id: int
    id: int
    enclave: str = "/"

    @property
    def key(self) -> str:
        """The key that identifies the entity: its token."""
        return self.token

    @property
    def node_key(self) -> tuple[str, int]:
        """The key that identifies the entity's node."""
        return self.zid, self.node_id

    @property
    def token(self) -> str:
        """The key expression of the entity's liveliness token."""
        parts = [ADMIN, str(self.domain), self.zid, str(self.node_id), str(self.id), CODES[self.kind]]
        parts += [_mangle(self.enclave), _mangle(self.namespace), self.node]
        if self.kind != "node":
            parts += [_mangle(self.topic), dds_type(self.type_name), self.type_hash, encode_qos(self.qos)]
        return "/".join(parts)

    @property
    def key_expr(self) -> str:
        """The key expression of its messages, requests and replies."""
        return key_expr_of(self.domain, self.topic, self.type_name, self.type_hash)

    @property
    def gid(self) -> bytes:
        """XXH3-128 of the token, low half first, each half little endian."""
        # xxhash belongs to the extra `robot`, so it is imported on first use.
        import xxhash

        return xxhash.xxh3_128(self.token.encode()).intdigest().to_bytes(GID_BYTES, "little")


def key_expr_of(domain: int, topic: str, type_name: str, type_hash: str) -> str:
    """Return the key expression of a topic or service."""
    return f"{domain}/{topic.strip('/')}/{dds_type(type_name)}/{type_hash}"


def read_token(key: str) -> ZenohEntity | None:
    """Return the entity that a token describes, or None for other keys."""
    parts = key.split("/")
    if len(parts) < NODE_PARTS or parts[0] != ADMIN or parts[5] not in KINDS:
        return None
    try:
        entity = ZenohEntity(
            kind=KINDS[parts[5]],
            domain=int(parts[1]),
            zid=parts[2],
            node_id=int(parts[3]),
            id=int(parts[4]),
            enclave=_demangle(parts[6]),
            namespace=_demangle(parts[7]),
            node=parts[8],
        )
        names = [entity.node] if entity.namespace == "/" else [entity.node, entity.namespace]
        if entity.kind != "node":
            topic, dds_name, type_hash, qos = parts[9:ENDPOINT_PARTS]
            topic, type_name = _demangle(topic), ros_type(dds_name)
            names += [topic, type_name]
            # Splitting the type raises a ValueError unless it has three parts.
            dds_type(type_name)
            entity = replace(
                entity, topic=topic, type_name=type_name, type_hash=type_hash, qos=decode_qos(qos)
            )
    except ValueError:
        # A part is missing, not a number or impossible. Anyone in the network can declare tokens.
        return None
    return entity if all(map(NAME.fullmatch, names)) else None


def encode_qos(qos: Qos) -> str:
    """Encode a QoS. Default values are omitted: `2::,5:,:,:,,` is best effort with depth 5."""
    depth = "" if qos.depth in (0, DEFAULT_DEPTH) else str(qos.depth)
    parts = (
        _encode_policy(_RELIABILITY, qos.reliability),
        _encode_policy(_DURABILITY, qos.durability),
        f"{_encode_policy(_HISTORY, qos.history)},{depth}",
        _encode_span(qos.deadline_ns),
        _encode_span(qos.lifespan_ns),
        f"{_encode_policy(_LIVELINESS, qos.liveliness)},{_encode_span(qos.lease_ns)}",
    )
    return ":".join(parts)


def decode_qos(text: str) -> Qos:
    """Decode a QoS.

    Raises:
        ValueError: The string is not an encoded QoS.
    """
    reliability, durability, history_policy, deadline, lifespan, liveliness_policy = text.split(":")
    history, depth_text = history_policy.split(",")
    depth = int(depth_text or DEFAULT_DEPTH)
    if depth < 0:
        raise ValueError(f"the depth {depth}")
    liveliness, lease = liveliness_policy.split(",", 1)
    return Qos(
        history=cast('Literal["keep_last", "keep_all"]', _decode_policy(_HISTORY, history)),
        depth=depth,
        reliability=cast('Literal["reliable", "best_effort"]', _decode_policy(_RELIABILITY, reliability)),
        durability=cast('Literal["volatile", "transient_local"]', _decode_policy(_DURABILITY, durability)),
        deadline_ns=_decode_span(deadline),
        lifespan_ns=_decode_span(lifespan),
        liveliness=cast('Literal["automatic", "manual_by_topic"]', _decode_policy(_LIVELINESS, liveliness)),
        lease_ns=_decode_span(lease),
    )


def encode_attachment(sequence: int, gid: bytes, source_ns: int) -> bytes:
    """Return the attachment of a message, request or reply. Sequence numbers start at 1."""
    return ATTACHMENT.pack(sequence, source_ns, GID_BYTES, gid)


def decode_attachment(data: bytes) -> tuple[int, int, bytes]:
    """Decode an attachment into sequence number, time [ns] and GID.

    Raises:
        ValueError: The attachment has another format, like that of rmw_zenoh before 0.2.4.
    """
    if len(data) != ATTACHMENT.size or data[16] != GID_BYTES:
        raise ValueError(f"the attachment has {len(data)} bytes instead of {ATTACHMENT.size}")
    sequence, source_ns, _, gid = ATTACHMENT.unpack(data)
    return sequence, source_ns, gid


def _mangle(name: str) -> str:
    return name.replace("/", "%") or "%"


def _demangle(name: str) -> str:
    return name.replace("%", "/")


def _encode_policy(codes: Mapping[str, str], value: str) -> str:
    # The first code of each table is rmw_zenoh's default. It also stands for an unknown history.
    return "" if value in (next(iter(codes)), "unknown") else codes[value]


def _decode_policy(codes: Mapping[str, str], text: str) -> str:
    """Return the policy value of a code. An unknown code becomes the default."""
    return {code: value for value, code in codes.items()}.get(text, next(iter(codes)))


def _encode_span(duration_ns: int | None) -> str:
    span = INFINITE if duration_ns is None else divmod(duration_ns, 10**9)
    return ",".join(
        "" if value == infinite else str(value) for value, infinite in zip(span, INFINITE, strict=True)
    )


def _decode_span(text: str) -> int | None:
    seconds, nanoseconds = (
        int(value or infinite) for value, infinite in zip(text.split(","), INFINITE, strict=True)
    )
    if not (0 <= seconds <= INFINITE[0] and 0 <= nanoseconds < 10**9):
        raise ValueError(f"the duration {text}")
    return None if (seconds, nanoseconds) == INFINITE else seconds * 10**9 + nanoseconds


# Timeout of the query for other domains.
QUERY_SECONDS = 1.0
# Heartbeat period of publishers that keep messages for late-joining subscriptions.
HEARTBEAT = 0.5


class ZenohPublisher(NetworkPublisher):
    """A publisher of the kit on the network."""

    def __init__(
        self, link: "ZenohLink", entity: ZenohEntity, publisher: Any, probe: Any, token: Any
    ) -> None:
        listing = Declaration(partial(link.undeclare, token))
        super().__init__(entity.topic, listing, partial(link.undeclare, publisher, probe))
        self._link, self._publisher, self._probe, self._gid = link, publisher, probe, entity.gid
        self._sequence = itertools.count(1)

    def is_matched(self) -> bool:
        """Return whether a message would reach a subscription now."""
        # Zenoh's matching status outlives the loss of the router, so the link is checked as well.
        return self._link.is_up() and bool(self._removals) and bool(self._probe.matching_status.matching)

    def put(self, cdr: bytes, source_ns: int = 0) -> None:
        """Publish a message. Any thread may call this.

        The source time is by default the current time.
        """
        if self._link.is_open and self._removals:
            attachment = encode_attachment(next(self._sequence), self._gid, source_ns or wall.time_ns())
            self._publisher.put(cdr, attachment=attachment)


class ZenohClient(NetworkClient):
    """A service client of the kit on the network."""

    def __init__(self, link: "ZenohLink", entity: ZenohEntity, querier: Any, token: Any) -> None:
        super().__init__(partial(link.undeclare, token, querier))
        self._link, self._querier, self._gid = link, querier, entity.gid
        self._sequence = itertools.count(1)

    def call(self, cdr: bytes, on_reply: OnReply) -> None:
        """Send a request.

        `on_reply` is queued with the first reply, or with None if there is none.
        """
        enqueue, replies = self._link.enqueue, itertools.count()

        def on_zenoh_reply(reply: zenoh.Reply) -> None:
            if reply.ok is not None and next(replies) == 0:
                enqueue(on_reply, bytes(reply.ok.payload))

        def on_end() -> None:
            if next(replies) == 0:
                enqueue(on_reply, None)

        attachment = encode_attachment(next(self._sequence), self._gid, wall.time_ns())
        handler = self._link.handlers.wrap(on_zenoh_reply, on_end)
        self._querier.get(handler, payload=cdr, attachment=attachment)


class ZenohLink(Link):
    """A session with a robot's router or a gateway.

    Args:
        address: The router, like `tcp/192.168.1.5:7447`; for a gateway with a login.
        domain: ROS_DOMAIN_ID.

    Raises:
        CourseError: No router answers, or the address is malformed.
    """

    peer = "router"
    is_qos_enforced = False

    def __init__(self, address: str, domain: int = 0) -> None:
        # The stored address has no token, because it may be printed.
        stored_address, self._login = split_login(address)
        super().__init__(stored_address, domain)
        self.handlers = Handlers()
        self._driver_report: DriverReport | None = None
        # Number of messages from an rmw_zenoh before 0.2.4.
        self._old_attachments = 0
        self._session = open_session(self.address, self._login)
        self._zid = str(self._session.zid())
        presence_key = self._login.presence_key(self._zid)
        self._presence = self._session.liveliness().declare_token(presence_key) if presence_key else None
        self._ids = itertools.count()

    @property
    def is_open(self) -> bool:
        """True until `close`."""
        return not self._session.is_closed()

    def is_up(self) -> bool:
        """Return whether the router is connected now. Zenoh reconnects automatically."""
        return self.is_open and bool(self._session.info.routers_zid())

    def close(self) -> None:
        """Close the session. Further calls have no effect."""
        if self.is_open:
            # zenoh does not annotate this method.
            self._session.close()
        self.handlers.wait()

    def watch(self, on_entity: OnEntity, report: Report) -> None:
        """Queue a call for each entity of the domain that joins or leaves.

        Follow the driver at a gateway.
        """

        def on_token(sample: zenoh.Sample) -> None:
            entity = read_token(str(sample.key_expr))
            if entity is not None and entity.zid != self._zid:
                self.enqueue(on_entity, entity, sample.kind == zenoh.SampleKind.PUT)

        def on_driver(sample: zenoh.Sample) -> None:
            if sample.kind == zenoh.SampleKind.PUT:
                self.enqueue(driver_report.change, *read_gateway_key(str(sample.key_expr)))

        liveliness = self._session.liveliness()
        tokens = f"{ADMIN}/{self.domain}/**"
        liveliness.declare_subscriber(tokens, self.handlers.wrap(on_token), history=True)
        if self._login.name:
            driver_report = self._driver_report = DriverReport(self._login, report)
            liveliness.declare_subscriber(f"{GATEWAY}/*/*", self.handlers.wrap(on_driver), history=True)

    def domains(self) -> list[int]:
        """List the domains with nodes."""
        replies = self._session.liveliness().get(f"{ADMIN}/*/**", timeout=QUERY_SECONDS)
        entities = (read_token(str(reply.ok.key_expr)) for reply in replies if reply.ok is not None)
        return sorted({entity.domain for entity in entities if entity is not None})

    def no_nodes_message(self) -> str:
        """Return a message for a domain without nodes, which lists the domains with nodes."""
        domains = self.domains()
        if not domains:
            return f"There are no nodes in domain {self.domain} yet."
        names = ", ".join(map(str, domains))
        return (
            f"There are no nodes in domain {self.domain}, but in domain {names}: "
            f"connect with --domain {domains[0]}."
        )

    def network_topic(self, topic: str) -> str:
        """Return the topic on which messages leave this kit: at a gateway, in the student's namespace."""
        return self._login.network_topic(topic)

    def on_send(self, topic: str) -> None:
        """Report that a gateway does not forward a topic because this student is not the driver."""
        if self._driver_report is not None:
            self._driver_report.on_send(topic)

    def status_rows(self) -> list[tuple[str, object]]:
        """Return the driver at a gateway as a row of `ros2 doctor`."""
        return [] if self._driver_report is None else self._driver_report.status_rows()

    def warnings(self) -> Iterable[tuple[str, str]]:
        """Yield a warning if a robot's rmw_zenoh sends attachments that the kit cannot read."""
        if self._old_attachments:
            yield (
                "old rmw",
                f"{format_count(self._old_attachments, 'message')} came in the form of an "
                "rmw_zenoh before 0.2.4, which the kit cannot read. Update "
                "ros-jazzy-rmw-zenoh-cpp on the robot.",
            )

    def node(self, name: str, namespace: str) -> ZenohEntity:
        """Return a node of the kit that is not announced yet."""
        number = next(self._ids)
        return ZenohEntity(
            kind="node",
            domain=self.domain,
            zid=self._zid,
            node_id=number,
            id=number,
            namespace=namespace,
            node=name,
        )

    def endpoint(
        self, node: ZenohEntity, kind: EntityKind, topic: str, type_name: str, qos: Qos, known_hash: str = ""
    ) -> ZenohEntity:
        """Return an endpoint of one of the kit's nodes. It is not announced yet."""
        endpoint: ZenohEntity = super().endpoint(node, kind, topic, type_name, qos, known_hash)
        return replace(endpoint, id=next(self._ids))

    def announce(self, entity: ZenohEntity) -> Declaration:
        """Announce a node, or a subscription that shares an inbox."""
        return Declaration(partial(self.undeclare, self._declare_token(entity)))

    def publisher(self, entity: ZenohEntity) -> ZenohPublisher:
        """Declare a publisher.

        As in rmw_zenoh, it drops messages on a full link unless it keeps all.
        """
        qos = entity.qos
        blocks = qos.is_reliable and qos.history == "keep_all"
        publisher = ext.declare_advanced_publisher(
            self._session,
            entity.key_expr,
            congestion_control=zenoh.CongestionControl.BLOCK if blocks else zenoh.CongestionControl.DROP,
            reliability=zenoh.Reliability.RELIABLE if qos.is_reliable else zenoh.Reliability.BEST_EFFORT,
            allowed_destination=zenoh.Locality.REMOTE,
            cache=ext.CacheConfig(max_samples=latched_depth(qos)) if qos.is_latched else None,
            sample_miss_detection=(
                ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT)
                if qos.is_latched and qos.is_reliable
                else None
            ),
            publisher_detection=qos.is_latched or None,
        )
        # Advanced publishers have no matching status, so an ordinary publisher provides it.
        probe = self._session.declare_publisher(entity.key_expr, allowed_destination=zenoh.Locality.REMOTE)
        return ZenohPublisher(self, entity, publisher, probe, self._declare_token(entity))

    def subscriber(
        self, topic: str, type_name: str, qos: Qos, latched_count: int, on_packet: OnPacket
    ) -> Declaration:
        """Subscribe to a topic and request the last `latched_count` messages of latched publishers."""
        settings: Mapping[str, Any] = {}
        if latched_count:
            settings = {
                "subscriber_detection": True,
                "history": ext.HistoryConfig(detect_late_publishers=True, max_samples=latched_count),
                "recovery": ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
            }
        subscriber = ext.declare_advanced_subscriber(
            self._session,
            key_expr_of(self.domain, topic, type_name, type_hash(type_name)),
            self.handlers.wrap(partial(self._on_sample, on_packet)),
            allowed_origin=zenoh.Locality.REMOTE,
            **settings,
        )
        return Declaration(partial(self.undeclare, subscriber))

    def service(self, entity: ZenohEntity, on_request: OnRequest) -> Declaration:
        """Offer a service. `on_request(cdr, send_reply)` is queued for each request."""

        def on_query(query: zenoh.Query) -> None:
            try:
                sequence, _, gid = decode_attachment(bytes(query.attachment or b""))
            except ValueError:
                # Leaving the context ends the query without a reply.
                with query:
                    return

            def send_reply(cdr: bytes) -> None:
                # Leaving the context indicates to the client that no further replies follow.
                with query:
                    attachment = encode_attachment(sequence, gid, wall.time_ns())
                    query.reply(entity.key_expr, cdr, attachment=attachment)

            self.enqueue(on_request, bytes(query.payload or b""), send_reply)

        handler = self.handlers.wrap(on_query)
        queryable = self._session.declare_queryable(entity.key_expr, handler, complete=True)
        return Declaration(partial(self.undeclare, self._declare_token(entity), queryable))

    def client(self, entity: ZenohEntity) -> ZenohClient:
        """Declare a service client."""
        querier = self._session.declare_querier(
            entity.key_expr,
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=CALL_SECONDS,
        )
        return ZenohClient(self, entity, querier, self._declare_token(entity))

    def undeclare(self, *declarations: Any) -> None:
        """Undeclare an entity of the session, unless the session is closed."""
        for declaration in declarations if self.is_open else ():
            declaration.undeclare()

    def _declare_token(self, entity: ZenohEntity) -> Any:
        return self._session.liveliness().declare_token(entity.token)

    def _on_sample(self, on_packet: OnPacket, sample: zenoh.Sample) -> None:
        if sample.attachment is None:
            # Other Zenoh programs may use the same key; only messages of ROS have an attachment.
            return
        try:
            sequence, source_ns, gid = decode_attachment(bytes(sample.attachment))
        except ValueError:
            self._old_attachments += 1
            return
        on_packet(Packet(bytes(sample.payload), sequence, source_ns, gid, wall.time_ns()))
