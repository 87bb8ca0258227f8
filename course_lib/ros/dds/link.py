"""The link over DDS: one participant in the domain of a robot, and the entities of the kit in it.

The thread that receives, which may be the graph's, only queues actions and fills inboxes; see
`course_lib.ros.robot.link`.
"""

import contextlib
import errno
import itertools
import struct
from _queue import SimpleQueue
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import ParamSpec

from course_lib.ros.dds import names
from course_lib.ros.dds.endpoints import Reader, ReceivedSample, Writer
from course_lib.ros.dds.names import DdsEntity, NodeEndpoints
from course_lib.ros.dds.participant import Participant, resolve
from course_lib.ros.dds.wire import PARTICIPANT_ENTITY, PREFIX_SIZE, Endpoint, RequestId, related_request
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages.hashes import is_known, type_hash
from course_lib.ros.robot.link import (
    Action,
    Actions,
    EntityKind,
    OnEntity,
    OnPacket,
    OnReply,
    OnRequest,
    Packet,
    Report,
)
from course_lib.ros.time import wall

P = ParamSpec("P")
# Limit on calls without a reply, and on requests and replies that wait for a match.
MAX_OPEN = 1000
# Time that a request or a reply waits for its receiver to be matched [s].
MATCH_SECONDS = 5.0
SERVICE_QOS = Qos()
# Number of incomplete messages after which a topic is reported.
INCOMPLETE_MESSAGES = 5
# Time after which a robot that has not answered is reported [s].
SILENT_SECONDS = 3.0


class DdsDeclaration:
    """The endpoints of one entity, which `withdraw` removes."""

    def __init__(self, *removals: Callable[[], None]) -> None:
        self._removals = removals

    def withdraw(self) -> None:
        """Remove the entity from the network."""
        removals, self._removals = self._removals, ()
        for remove in removals:
            remove()


class DdsPublisher:
    """A publisher of the kit on the network."""

    def __init__(self, link: "DdsLink", entity: DdsEntity) -> None:
        self._link, self.topic = link, entity.topic
        self._writer = link.add_writer(entity, *names.topic_names(entity.topic, entity.type_name), entity.qos)
        guid = self._writer.endpoint.guid
        self._listing = DdsDeclaration(partial(link.set_owner, entity, guid, is_owned=False))
        self._declaration = DdsDeclaration(partial(link.participant.remove, self._writer.endpoint))
        self._is_declared = True

    def put(self, cdr: bytes) -> None:
        """Publish a message; may be called from any thread."""
        if self._is_declared:
            self._link.participant.write(self._writer, cdr)

    def is_matched(self) -> bool:
        """Return whether a message would reach a subscription now."""
        return bool(self._writer.readers)

    def hide(self) -> None:
        """Leave the graph of the network, while messages can still be published."""
        self._listing.withdraw()

    def withdraw(self) -> None:
        """Remove the publisher from the network."""
        self._is_declared = False
        self.hide()
        self._declaration.withdraw()


class DdsClient(DdsDeclaration):
    """A service client of the kit on the network.

    Both endpoints of a service are volatile: a request is lost if the server's reader does not know
    the client's writer, and so is a reply if the server's writer does not know the client's reader.
    So requests wait until a server has been matched with both.
    """

    def __init__(self, link: "DdsLink", entity: DdsEntity) -> None:
        self._participant, self._actions = link.participant, link.actions
        self._open: dict[int, OnReply] = {}
        # Requests that wait, with the end of the wait [s].
        self._waiting: deque[tuple[float, bytes, OnReply]] = deque(maxlen=MAX_OPEN)
        self._replies = link.add_reader(entity, *names.reply_names(entity), SERVICE_QOS, self._on_reply)
        self._requests = link.add_writer(entity, *names.request_names(entity), SERVICE_QOS)
        self._requests.on_matched = self._replies.on_matched = self._send_waiting
        super().__init__(*link.removals(entity, self._replies.endpoint, self._requests.endpoint))

    def is_matched(self) -> bool:
        """Return whether a request would reach a server now, and its reply this client."""
        with self._participant.lock:
            servers = {guid[:PREFIX_SIZE] for guid in self._requests.readers}
            return any(
                guid[:PREFIX_SIZE] in servers and writer.has_answered
                for guid, writer in self._replies.writers.items()
            )

    def call(self, cdr: bytes, on_reply: OnReply) -> None:
        """Send a request. `on_reply` is queued when its reply arrives."""
        with self._participant.lock:
            self._waiting.append((wall.monotonic() + MATCH_SECONDS, cdr, on_reply))
            self._send_waiting()

    def _send_waiting(self) -> None:
        while self._waiting and self.is_matched():
            end, cdr, on_reply = self._waiting.popleft()
            if wall.monotonic() < end:
                # The server sends its reply to the reader that is named here.
                related = related_request(RequestId(self._replies.endpoint.guid, 0))
                self._open[self._participant.write(self._requests, cdr, related)] = on_reply
                if len(self._open) > MAX_OPEN:
                    del self._open[next(iter(self._open))]

    def _on_reply(self, sample: ReceivedSample) -> None:
        """Queue a reply if it belongs to a request of this client.

        All clients of a service receive all replies.
        """
        if sample.related is None:
            return
        own = (self._replies.endpoint.guid, self._requests.endpoint.guid)
        if sample.related.guid in own and sample.related.sequence in self._open:
            on_reply = self._open.pop(sample.related.sequence)
            self._actions.put(partial(on_reply, sample.data))


class DdsServer(DdsDeclaration):
    """A service of the kit on the network.

    A reply waits until the client's reader has been matched.
    """

    def __init__(self, link: "DdsLink", entity: DdsEntity, on_request: OnRequest) -> None:
        self._participant, self._actions, self._serve = link.participant, link.actions, on_request
        # Replies that wait, with the client and the end of the wait [s].
        self._waiting: deque[tuple[float, RequestId, bytes]] = deque(maxlen=MAX_OPEN)
        self._replies = link.add_writer(entity, *names.reply_names(entity), SERVICE_QOS)
        self._replies.on_matched = self._send_waiting
        requests = link.add_reader(entity, *names.request_names(entity), SERVICE_QOS, self._on_request)
        super().__init__(*link.removals(entity, requests.endpoint, self._replies.endpoint))

    def _on_request(self, sample: ReceivedSample) -> None:
        # Fast DDS sends the reader that waits for the reply; otherwise the writer identifies the
        # client.
        client = sample.related.guid if sample.related else sample.writer
        send_reply = partial(self._send_reply, RequestId(client, sample.sequence))
        self._actions.put(partial(self._serve, sample.data, send_reply))

    def _send_reply(self, request: RequestId, cdr: bytes) -> None:
        with self._participant.lock:
            self._waiting.append((wall.monotonic() + MATCH_SECONDS, request, cdr))
            self._send_waiting()

    def _send_waiting(self) -> None:
        waiting, self._waiting = self._waiting, deque(maxlen=MAX_OPEN)
        for end, request, cdr in waiting:
            is_reader = Endpoint(request.guid, "", "").kind == "reader"
            if not is_reader or request.guid in self._replies.readers:
                self._participant.write(self._replies, cdr, related_request(request))
            elif wall.monotonic() < end:
                self._waiting.append((end, request, cdr))


class DdsLink:
    """A participant in the domain of a robot, which is found by unicast.

    Args:
        host: Address or name of the robot.
        domain: ROS_DOMAIN_ID.

    Raises:
        CourseError: The host is unknown, no network leads to it, or no port is free.
    """

    peer = "robot"
    is_qos_enforced = True

    def __init__(self, host: str, domain: int = 0) -> None:
        self.address, self.domain = f"dds/{host}", domain
        self.actions: Actions = SimpleQueue()
        self._started, self._is_silence_reported = wall.monotonic(), False
        self._node_numbers = itertools.count(1)
        self._own_nodes: dict[tuple[bytes, str], NodeEndpoints] = {}
        # The newest GUID by topic and type.
        self._own_readers: dict[tuple[str, str], bytes] = {}
        self._on_entity: OnEntity | None = None
        # Remote endpoints by GUID.
        self._endpoints: dict[bytes, Endpoint] = {}
        # The node of each remote endpoint, by its GUID.
        self._owners: dict[bytes, DdsEntity] = {}
        # Remote nodes by participant and full name.
        self._nodes: dict[bytes, dict[str, DdsEntity]] = {}
        # Remote endpoints that the graph contains.
        self._listed: dict[bytes, DdsEntity] = {}
        self._host = resolve(host)
        self.participant = Participant(domain, self._host, self._enqueue(self._on_endpoint))
        topic, type_name, qos = names.DISCOVERY_TOPIC, names.DISCOVERY_TYPE, names.DISCOVERY_QOS
        self._discovery = self.participant.add_writer(topic, type_name, qos)
        self.participant.add_reader(topic, type_name, qos, self._enqueue(self._on_discovery))

    @property
    def is_open(self) -> bool:
        """True until `close`."""
        return self.participant.is_open

    def is_up(self) -> bool:
        """Return whether a participant of the robot is present now."""
        return self.is_open and self.participant.has_peers()

    def silent_seconds(self) -> float:
        """Return for how long no participant of the robot has answered [s]; 0 if none is present."""
        return self.participant.silent_seconds()

    def close(self) -> None:
        """Leave the domain; further calls do nothing."""
        self.participant.close()

    def next_action(self, seconds: float) -> Action:
        """Return the next action of the queue; the calling thread itself receives while it waits."""
        deadline = wall.monotonic() + seconds
        while seconds > 0 and self.actions.empty() and self.participant.receive_for(seconds):
            seconds = deadline - wall.monotonic()
        return self.actions.get(timeout=seconds) if seconds > 0 else self.actions.get_nowait()

    def watch(self, on_entity: OnEntity, report: Report) -> None:
        """Queue a callback for each remote entity that joins or leaves."""
        self._on_entity = on_entity

    def no_nodes_message(self) -> str:
        """Return a message for a domain without nodes. Nodes of other domains use other ports."""
        if self.participant.datagrams:
            return f"There are no nodes in domain {self.domain} yet."
        self._is_silence_reported = True
        return silence_message(self.address, self.domain, self.participant.peer_error())

    def network_topic(self, topic: str) -> str:
        """Return the topic itself."""
        return topic

    def on_sent(self, topic: str) -> None:
        """Do nothing: DDS has no gateway."""

    def status_rows(self) -> list[tuple[str, object]]:
        """Return the malformed datagrams as a row of `ros2 doctor`."""
        dropped = sum(self.participant.dropped.values())
        return [("malformed datagrams", dropped)] if dropped else []

    def warnings(self) -> Iterable[tuple[str, str]]:
        """Yield a line if nothing answers, and for each topic whose messages mostly arrive in part."""
        is_silent = not self.participant.datagrams and wall.monotonic() - self._started > SILENT_SECONDS
        if is_silent and not self._is_silence_reported:
            yield "silent", self.no_nodes_message()
        host = self.participant.current_peer
        if host != self._host:
            yield f"moved {host}", moved_message(self.address, host)
        for topic, count, size in self.participant.incomplete_topics():
            if count >= INCOMPLETE_MESSAGES:
                yield f"incomplete {topic}", incomplete_message(topic.removeprefix("rt"), count, size)

    def node(self, name: str, namespace: str) -> DdsEntity:
        """Return a node of the kit that is not announced yet."""
        gid = self.participant.prefix + next(self._node_numbers).to_bytes(4, "big")
        key = (self.participant.guid, NodeEndpoints(namespace, name).full_name)
        return DdsEntity("node", key, namespace, name, gid=gid)

    def endpoint(
        self,
        node: DdsEntity,
        kind: EntityKind,
        topic: str,
        type_name: str,
        qos: Qos,
        known_hash: str = "",
    ) -> DdsEntity:
        """Return an endpoint of a node of the kit that is not announced yet."""
        names_of_it = (node.namespace, node.node, topic, type_name, known_hash or type_hash(type_name))
        return DdsEntity(kind, node.node_key, *names_of_it, qos)

    def announce(self, entity: DdsEntity) -> DdsDeclaration:
        """Announce a node, or a subscription that shares a reader."""
        if entity.kind == "node":
            self._own_nodes[entity.node_key] = NodeEndpoints(entity.namespace, entity.node)
            self._publish_discovery()
            return DdsDeclaration(partial(self._remove_node, entity))
        guid = self._own_readers[entity.topic, entity.type_name]
        self.set_owner(entity, guid)
        return DdsDeclaration(partial(self.set_owner, entity, guid, is_owned=False))

    def publisher(self, entity: DdsEntity) -> DdsPublisher:
        """Declare a publisher."""
        return DdsPublisher(self, entity)

    def subscriber(
        self, topic: str, type_name: str, qos: Qos, latched_count: int, on_packet: OnPacket
    ) -> DdsDeclaration:
        """Subscribe to a topic. DDS itself requests the messages of latched publishers."""

        def on_sample(sample: ReceivedSample) -> None:
            on_packet(Packet(sample.data, sample.sequence, sample.source_ns, sample.writer, wall.time_ns()))

        # A gateway passes types on that are not known on its computer.
        data = names.user_data(type_hash(type_name)) if is_known(type_name) else b""
        reader = self.participant.add_reader(*names.topic_names(topic, type_name), qos, on_sample, data)
        self._own_readers[topic, type_name] = reader.endpoint.guid
        return DdsDeclaration(partial(self.participant.remove, reader.endpoint))

    def service(self, entity: DdsEntity, on_request: OnRequest) -> DdsServer:
        """Offer a service; `on_request(cdr, send_reply)` is queued for each request."""
        return DdsServer(self, entity, on_request)

    def client(self, entity: DdsEntity) -> DdsClient:
        """Declare a service client."""
        return DdsClient(self, entity)

    def add_writer(self, entity: DdsEntity, topic: str, type_name: str, qos: Qos) -> Writer:
        """Create a writer that belongs to a node of the kit."""
        data = names.user_data(entity.type_hash)
        writer = self.participant.add_writer(topic, type_name, qos, data)
        self.set_owner(entity, writer.endpoint.guid)
        return writer

    def add_reader(
        self,
        entity: DdsEntity,
        topic: str,
        type_name: str,
        qos: Qos,
        on_sample: Callable[[ReceivedSample], None],
    ) -> Reader:
        """Create a reader that belongs to a node of the kit."""
        data = names.user_data(entity.type_hash)
        reader = self.participant.add_reader(topic, type_name, qos, on_sample, data)
        self.set_owner(entity, reader.endpoint.guid)
        return reader

    def removals(self, entity: DdsEntity, *endpoints: Endpoint) -> Iterator[Callable[[], None]]:
        """Yield functions that remove endpoints of a node of the kit from the network."""
        for endpoint in endpoints:
            yield partial(self.set_owner, entity, endpoint.guid, is_owned=False)
            yield partial(self.participant.remove, endpoint)

    def set_owner(self, entity: DdsEntity, guid: bytes, *, is_owned: bool = True) -> None:
        """Announce that an endpoint belongs, or no longer belongs, to a node of the kit."""
        node = self._own_nodes.get(entity.node_key)
        if node is None:
            return
        guids = node.writers if Endpoint(guid, "", "").kind == "writer" else node.readers
        if is_owned:
            guids.append(guid)
        elif guid in guids:
            guids.remove(guid)
        self._publish_discovery()

    def _remove_node(self, entity: DdsEntity) -> None:
        self._own_nodes.pop(entity.node_key, None)
        self._publish_discovery()

    def _publish_discovery(self) -> None:
        data = names.write_discovery(self.participant.guid, list(self._own_nodes.values()))
        self.participant.write(self._discovery, data)

    # The following methods run in the graph's thread and handle remote entities.

    def _enqueue(self, action: Callable[P, None]) -> Callable[P, None]:
        """Return a function that queues the action, to be called in the thread that receives."""

        def queue(*args: P.args, **kwargs: P.kwargs) -> None:
            self.actions.put(partial(action, *args, **kwargs))

        return queue

    def _change(self, entity: DdsEntity, *, has_joined: bool) -> None:
        if self._on_entity is not None:
            self._on_entity(entity, has_joined)

    def _on_discovery(self, sample: ReceivedSample) -> None:
        """Process the list of nodes of a participant."""
        with contextlib.suppress(ValueError, IndexError, struct.error):
            participant, infos = names.read_discovery(sample.data)
            if participant[:PREFIX_SIZE] == self.participant.prefix:
                return
            before, now = self._nodes.get(participant, {}), dict[str, DdsEntity]()
            for info in infos:
                key = (participant, info.full_name)
                node = before.get(info.full_name) or DdsEntity("node", key, info.namespace, info.name)
                now[info.full_name] = node
                if info.full_name not in before:
                    self._change(node, has_joined=True)
                for guid in info.readers + info.writers:
                    self._owners[guid] = node
                    self._list(guid)
            self._nodes[participant] = now
            for full_name in before.keys() - now.keys():
                self._change(before[full_name], has_joined=False)

    def _on_endpoint(self, endpoint: Endpoint, has_joined: bool) -> None:
        """Process a remote endpoint that has joined or left."""
        if has_joined:
            self._endpoints[endpoint.guid] = endpoint
            self._list(endpoint.guid)
            return
        self._endpoints.pop(endpoint.guid, None)
        self._owners.pop(endpoint.guid, None)
        entity = self._listed.pop(endpoint.guid, None)
        if entity is not None:
            self._change(entity, has_joined=False)
        if endpoint.topic == names.DISCOVERY_TOPIC and endpoint.kind == "writer":
            # The participant has no nodes left without this writer.
            for node in self._nodes.pop(endpoint.guid[:PREFIX_SIZE] + PARTICIPANT_ENTITY, {}).values():
                self._change(node, has_joined=False)

    def _list(self, guid: bytes) -> None:
        """Add a remote endpoint to the graph as soon as its description and its node are known."""
        endpoint, node = self._endpoints.get(guid), self._owners.get(guid)
        ros_names = names.read_names(endpoint) if endpoint is not None else None
        if endpoint is None or node is None or ros_names is None or guid in self._listed:
            return
        kind, topic, type_name = ros_names
        remote_hash = names.read_type_hash(endpoint.user_data)
        if kind in ("server", "client") and is_known(type_name):
            # DDS transmits the hash of the request, from which the service's own hash cannot be
            # derived.
            remote_hash = type_hash(type_name)
        entity = DdsEntity(
            kind, node.node_key, node.namespace, node.node, topic, type_name, remote_hash, endpoint.qos, guid
        )
        self._listed[guid] = entity
        self._change(entity, has_joined=True)


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
            "domain: start one, or pass its domain (ROS_DOMAIN_ID on the robot, --domain here). A "
            "firewall that rejects UDP looks the same."
        )
    return (
        f"{start} Is the robot on, does a ROS 2 program run there in this domain (ROS_DOMAIN_ID), "
        "and are both in the same network? Firewalls and WSL2 often let no UDP in. A robot with a "
        "Fast DDS discovery server, or with ROS_AUTOMATIC_DISCOVERY_RANGE=OFF, does not answer. A "
        "link over Zenoh (tcp/HOST:7447) needs only an outgoing TCP connection."
    )


def moved_message(address: str, host: str) -> str:
    """Return a message for a robot that sends from a new address."""
    return (
        f"The robot {address} now has the address {host}, and the link follows it. Next time "
        f"connect to dds/{host}."
    )


def incomplete_message(topic: str, count: int, size: int) -> str:
    """Return a message for a topic whose messages of so many bytes mostly arrive in part."""
    return (
        f"{topic}: {count} messages of {size / 1e6:.1f} MB have arrived only in part, more than "
        "whole ones. They are too large for this network: use a compressed topic, a smaller image "
        "or a reliable publisher."
    )
