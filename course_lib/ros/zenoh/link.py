"""The link over Zenoh: one session with a robot's router, and the entities of the kit in it.

Zenoh calls handlers in its own threads. A handler only puts an action into the queue or a message
into an inbox; see `course_lib.ros.robot.link`.
"""

import itertools
from _queue import SimpleQueue
from collections.abc import Iterable, Mapping
from functools import partial
from typing import Any

import zenoh
from zenoh import ext

from course_lib.errors import format_count
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages.hashes import type_hash
from course_lib.ros.robot.link import (
    Actions,
    Declaration,
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
from course_lib.ros.zenoh.session import (
    CALL_SECONDS,
    GATEWAY,
    DriverLock,
    Handlers,
    open_session,
    read_gateway_key,
    split_login,
)
from course_lib.ros.zenoh.tokens import (
    ADMIN,
    CODES,
    ZenohEntity,
    decode_attachment,
    encode_attachment,
    key_expr_of,
    read_token,
)

# Timeout of the query for other domains.
QUERY_SECONDS = 1.0
# Heartbeat period of publishers that keep messages for late-joining subscriptions.
HEARTBEAT = 0.5


class ZenohPublisher(NetworkPublisher):
    """A publisher of the kit on the network."""

    def __init__(
        self, link: "ZenohLink", entity: ZenohEntity, publisher: Any, probe: Any, token: Any
    ) -> None:
        super().__init__(self.hide, partial(link.undeclare, publisher, probe))
        self._link, self._publisher, self._probe, self._gid = link, publisher, probe, entity.gid
        self.topic = entity.topic
        self._token = Declaration(partial(link.undeclare, token))
        self._sequence = itertools.count(1)

    def is_matched(self) -> bool:
        """Return whether a message would reach a subscription now."""
        # Zenoh's matching status outlives the loss of the router, so the link is checked as well.
        return self._link.is_up() and bool(self._removals) and bool(self._probe.matching_status.matching)

    def hide(self) -> None:
        """Leave the graph of the network, but remain able to publish."""
        self._token.withdraw()

    def put(self, cdr: bytes, source_ns: int = 0) -> None:
        """Publish a message; may be called from any thread.

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
        actions, replies = self._link.actions, itertools.count()

        def on_zenoh_reply(reply: zenoh.Reply) -> None:
            if reply.ok is not None and next(replies) == 0:
                actions.put(partial(on_reply, bytes(reply.ok.payload)))

        def on_end() -> None:
            if next(replies) == 0:
                actions.put(partial(on_reply, None))

        attachment = encode_attachment(next(self._sequence), self._gid, wall.time_ns())
        handler = self._link.handlers.direct(on_zenoh_reply, on_end)
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
        self.address, self._login = split_login(address)
        self.domain = domain
        self.actions: Actions = SimpleQueue()
        self.handlers = Handlers()
        self._driver_lock: DriverLock | None = None
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
            self._session.close()  # type: ignore[no-untyped-call]
        self.handlers.wait()

    def watch(self, on_entity: OnEntity, report: Report) -> None:
        """Queue a call for each entity of the domain that joins or leaves.

        Follow the driver at a gateway.
        """

        def on_token(sample: zenoh.Sample) -> None:
            entity = read_token(str(sample.key_expr))
            if entity is not None and entity.zid != self._zid:
                self.actions.put(partial(on_entity, entity, sample.kind == zenoh.SampleKind.PUT))

        def on_driver(sample: zenoh.Sample) -> None:
            if sample.kind == zenoh.SampleKind.PUT:
                self.actions.put(partial(lock.change, *read_gateway_key(str(sample.key_expr))))

        liveliness = self._session.liveliness()
        tokens = f"{ADMIN}/{self.domain}/**"
        liveliness.declare_subscriber(tokens, self.handlers.direct(on_token), history=True)
        if self._login.name:
            lock = self._driver_lock = DriverLock(self._login, report)
            liveliness.declare_subscriber(f"{GATEWAY}/*/*", self.handlers.direct(on_driver), history=True)

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

    def on_sent(self, topic: str) -> None:
        """Report that a gateway does not forward a topic because this student is not the driver."""
        if self._driver_lock is not None:
            self._driver_lock.on_sent(topic)

    def status_rows(self) -> list[tuple[str, object]]:
        """Return the driver at a gateway as a row of `ros2 doctor`."""
        return [] if self._driver_lock is None else self._driver_lock.status_rows()

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
        return ZenohEntity(self.domain, self._zid, number, number, "NN", namespace, name)

    def endpoint(
        self, node: ZenohEntity, kind: EntityKind, topic: str, type_name: str, qos: Qos, known_hash: str = ""
    ) -> ZenohEntity:
        """Return an endpoint of a node of the kit that is not announced yet."""
        ids = (self.domain, self._zid, node.id, next(self._ids))
        names = (node.namespace, node.node, topic, type_name, known_hash or type_hash(type_name))
        return ZenohEntity(*ids, CODES[kind], *names, qos)

    def announce(self, entity: ZenohEntity) -> Declaration:
        """Announce a node, or a subscription that shares an inbox."""
        return Declaration(partial(self.undeclare, self._declare_token(entity)))

    def publisher(self, entity: ZenohEntity) -> ZenohPublisher:
        """Declare a publisher.

        As in rmw_zenoh, it drops messages on a full link unless it keeps all.
        """
        qos = entity.qos
        is_reliable, is_latched = qos.reliability == "reliable", qos.durability == "transient_local"
        blocks = is_reliable and qos.history == "keep_all"
        publisher = ext.declare_advanced_publisher(
            self._session,
            entity.key_expr,
            congestion_control=zenoh.CongestionControl.BLOCK if blocks else zenoh.CongestionControl.DROP,
            reliability=zenoh.Reliability.RELIABLE if is_reliable else zenoh.Reliability.BEST_EFFORT,
            allowed_destination=zenoh.Locality.REMOTE,
            cache=ext.CacheConfig(max_samples=latched_depth(qos)) if is_latched else None,
            sample_miss_detection=(
                ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT)
                if is_latched and is_reliable
                else None
            ),
            publisher_detection=is_latched or None,
        )
        # Advanced publishers have no matching status, so an ordinary publisher provides it.
        probe = self._session.declare_publisher(entity.key_expr, allowed_destination=zenoh.Locality.REMOTE)
        return ZenohPublisher(self, entity, publisher, probe, self._declare_token(entity))

    def subscriber(
        self, topic: str, type_name: str, qos: Qos, latched_count: int, on_packet: OnPacket
    ) -> Declaration:
        """Subscribe to a topic, and request the last `latched_count` messages of latched publishers."""
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
            self.handlers.direct(partial(self._on_sample, on_packet)),
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

            self.actions.put(partial(on_request, bytes(query.payload or b""), send_reply))

        handler = self.handlers.direct(on_query)
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
