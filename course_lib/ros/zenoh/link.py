"""One session of Zenoh with a robot's router: the kit's declarations, and messages from there.

Zenoh calls back in threads of its own. Such a callback only puts something into the queue `arrived`.
"""

import itertools
from _queue import SimpleQueue
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import zenoh
from zenoh import ext

from course_lib.ros import wall
from course_lib.ros.messages.hashes import type_hash
from course_lib.ros.qos import Qos
from course_lib.ros.zenoh.inbox import Actions, Inbox, Packet
from course_lib.ros.zenoh.login import GATEWAY, parted, read_gateway_key
from course_lib.ros.zenoh.session import CALL_SECONDS, Handlers, open_session
from course_lib.ros.zenoh.tokens import ADMIN, Entity, Kind, attachment, key_of, read_attachment, read_token

LOOK_SECONDS = 1.0  # [s] for a question about other domains
HEARTBEAT = 0.5  # [s] of publishers that keep messages for late subscriptions

OnEntity = Callable[[Entity, bool], None]  # the flag says whether it has come or gone
OnReply = Callable[[bytes | None], None]  # None: nobody answered
Answer = Callable[[bytes], None]
OnRequest = Callable[[bytes, Answer], None]


class Declared:
    """The declarations of one entity, which `withdraw` ends."""

    def __init__(self, link: "RobotLink", *parts: Any) -> None:
        self._link, self._parts = link, parts

    def withdraw(self) -> None:
        """Remove it from the network."""
        parts, self._parts = self._parts, ()
        for part in parts if self._link.is_open else ():
            part.undeclare()


class Outlet(Declared):
    """A publisher on the network."""

    def __init__(self, link: "RobotLink", entity: Entity, publisher: Any, probe: Any, token: Any) -> None:
        super().__init__(link, publisher, probe)
        self._publisher, self._probe, self._gid = publisher, probe, entity.gid
        self.topic = entity.topic
        self._shown = Declared(link, token)
        self._sequence = itertools.count(1)

    def is_heard(self) -> bool:
        """Return whether a message would reach a subscription now; Zenoh's matching outlives a router."""
        return self._link.is_up() and bool(self._parts) and bool(self._probe.matching_status.matching)

    def hide(self) -> None:
        """Leave the lists of the network, though messages still go out."""
        self._shown.withdraw()

    def withdraw(self) -> None:
        """Remove it from the network."""
        self.hide()
        super().withdraw()

    def put(self, cdr: bytes) -> None:
        """Publish a message; from any thread."""
        if self._link.is_open and self._parts:
            extra = attachment(next(self._sequence), self._gid, wall.time_ns())
            self._publisher.put(cdr, attachment=extra)


class RobotLink:
    """The session, and the entities of the kit in it.

    Args:
        address: Of the router, like `tcp/192.168.1.5:7447`; of a gateway with a login.
        domain: ROS_DOMAIN_ID.

    Raises:
        CourseError: No router answers there, or the address is not one.
    """

    def __init__(self, address: str, domain: int = 0) -> None:
        self.address, self.login = parted(address)  # what is printed has no token
        self.domain = domain
        self.arrived: Actions = SimpleQueue()
        self.handlers = Handlers()
        self.old_attachments = 0  # messages of an rmw_zenoh before 0.2.4
        self._session = open_session(self.address, self.login)
        self._zid = str(self._session.zid())
        presence = self.login.presence(self._zid)
        self._presence = self._session.liveliness().declare_token(presence) if presence else None
        self._ids = itertools.count()

    @property
    def is_open(self) -> bool:
        """True until it is closed."""
        return not self._session.is_closed()

    def is_up(self) -> bool:
        """Return whether the router is there now; Zenoh connects again by itself."""
        return self.is_open and bool(self._session.info.routers_zid())

    def close(self) -> None:
        """End the session; calling it again changes nothing."""
        if self.is_open:
            self._session.close()  # type: ignore[no-untyped-call]  # zenoh does not annotate it
        self.handlers.wait()

    def node(self, name: str, namespace: str) -> Entity:
        """Return a node of the kit, not announced yet."""
        number = next(self._ids)
        return Entity(self.domain, self._zid, number, number, "NN", namespace, name)

    def endpoint(self, node: Entity, kind: Kind, topic: str, type_name: str, qos: Qos) -> Entity:
        """Return an endpoint of one of its nodes, not announced yet."""
        place, where = (node.namespace, node.node), (self.domain, self._zid, node.id, next(self._ids))
        return Entity(*where, kind, *place, topic, type_name, type_hash(type_name), qos)

    def is_own(self, entity: Entity) -> bool:
        """Return whether an entity is the kit's."""
        return entity.zid == self._zid

    def announce(self, entity: Entity) -> Declared:
        """Announce a node, or a subscription that shares an inbox."""
        return Declared(self, self._token(entity))

    def watch(self, on_entity: OnEntity) -> None:
        """Put calls with all entities of the domain into the queue, as they come and go."""

        def seen(sample: zenoh.Sample) -> None:
            entity = read_token(str(sample.key_expr))
            if entity is not None and not self.is_own(entity):
                self.arrived.put(partial(on_entity, entity, sample.kind == zenoh.SampleKind.PUT))

        self._session.liveliness().declare_subscriber(
            f"{ADMIN}/{self.domain}/**", self.handlers.direct(seen), history=True
        )

    def watch_gateway(self, on_driver: Callable[[str, list[str]], None]) -> None:
        """Put calls with the driver and the driver's topics into the queue, now and at each change."""

        def seen(sample: zenoh.Sample) -> None:
            if sample.kind == zenoh.SampleKind.PUT:
                self.arrived.put(partial(on_driver, *read_gateway_key(str(sample.key_expr))))

        self._session.liveliness().declare_subscriber(
            f"{GATEWAY}/*/*", self.handlers.direct(seen), history=True
        )

    def domains(self) -> list[int]:
        """List the domains that have nodes."""
        replies = self._session.liveliness().get(f"{ADMIN}/*/**", timeout=LOOK_SECONDS)
        found = (read_token(str(reply.ok.key_expr)) for reply in replies if reply.ok is not None)
        return sorted({entity.domain for entity in found if entity is not None})

    def publisher(self, entity: Entity) -> Outlet:
        """Declare a publisher; as in rmw_zenoh it drops what the link cannot take, unless it keeps all."""
        qos = entity.qos
        reliable, keeps = qos.reliability == "reliable", qos.durability == "transient_local"
        blocks = reliable and qos.history == "keep_all"
        heartbeat = (
            ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT)
            if keeps and reliable
            else None
        )
        publisher = ext.declare_advanced_publisher(
            self._session,
            entity.key,
            congestion_control=zenoh.CongestionControl.BLOCK if blocks else zenoh.CongestionControl.DROP,
            reliability=zenoh.Reliability.RELIABLE if reliable else zenoh.Reliability.BEST_EFFORT,
            allowed_destination=zenoh.Locality.REMOTE,
            cache=ext.CacheConfig(max_samples=qos.depth) if keeps else None,
            sample_miss_detection=heartbeat,
            publisher_detection=keeps or None,
        )
        remote = (
            zenoh.Locality.REMOTE
        )  # an advanced publisher does not know who listens, an ordinary one does
        probe = self._session.declare_publisher(entity.key, allowed_destination=remote)
        return Outlet(self, entity, publisher, probe, self._token(entity))

    def subscriber(self, topic: str, type_name: str, inbox: Inbox, kept: int) -> Declared:
        """Subscribe to a topic, and ask late publishers for so many messages that they keep; 0: for none."""
        settings: Mapping[str, Any] = {}
        if kept:
            settings = {
                "subscriber_detection": True,
                "history": ext.HistoryConfig(detect_late_publishers=True, max_samples=kept),
                "recovery": ext.RecoveryConfig(periodic_queries=None, heartbeat=True),
            }
        subscriber = ext.declare_advanced_subscriber(
            self._session,
            key_of(self.domain, topic, type_name, type_hash(type_name)),
            self.handlers.direct(partial(self._heard, inbox)),
            allowed_origin=zenoh.Locality.REMOTE,
            **settings,
        )
        return Declared(self, subscriber)

    def service(self, entity: Entity, on_request: OnRequest) -> Declared:
        """Serve: `on_request(cdr, answer)` is put into the queue for each request."""

        def asked(query: zenoh.Query) -> None:
            try:
                sequence, _, gid = read_attachment(bytes(query.attachment or b""))
            except ValueError:
                with query:  # an end without a reply
                    return

            def answer(cdr: bytes) -> None:
                with query:  # its end tells the client that no more replies come
                    extra = attachment(sequence, gid, wall.time_ns())
                    query.reply(entity.key, cdr, attachment=extra)

            self.arrived.put(partial(on_request, bytes(query.payload or b""), answer))

        queryable = self._session.declare_queryable(entity.key, self.handlers.direct(asked), complete=True)
        return Declared(self, self._token(entity), queryable)

    def client(self, entity: Entity) -> "Asker":
        """Declare a service client."""
        querier = self._session.declare_querier(
            entity.key,
            target=zenoh.QueryTarget.ALL_COMPLETE,
            consolidation=zenoh.ConsolidationMode.NONE,
            timeout=CALL_SECONDS,
        )
        return Asker(self, entity, querier, self._token(entity))

    def _token(self, entity: Entity) -> Any:
        return self._session.liveliness().declare_token(entity.token)

    def _heard(self, inbox: Inbox, sample: zenoh.Sample) -> None:
        if sample.attachment is None:  # not from ROS
            return
        try:
            arrival = read_attachment(bytes(sample.attachment))
        except ValueError:
            self.old_attachments += 1
            return
        inbox.put(Packet(bytes(sample.payload), *arrival, wall.time_ns()))


class Asker(Declared):
    """A service client on the network."""

    def __init__(self, link: RobotLink, entity: Entity, querier: Any, token: Any) -> None:
        super().__init__(link, token, querier)
        self._querier, self._gid = querier, entity.gid
        self._sequence = itertools.count(1)

    def ask(self, cdr: bytes, on_reply: OnReply) -> None:
        """Send a request; `on_reply` is put into the queue with the first reply, or None if there is none."""
        arrived, came = self._link.arrived, itertools.count()

        def replied(reply: zenoh.Reply) -> None:
            if reply.ok is not None and next(came) == 0:
                arrived.put(partial(on_reply, bytes(reply.ok.payload)))

        def over() -> None:
            if next(came) == 0:
                arrived.put(partial(on_reply, None))

        extra = attachment(next(self._sequence), self._gid, wall.time_ns())
        self._querier.get(self._link.handlers.direct(replied, over), payload=cdr, attachment=extra)
