"""The link over DDS: one participant in the domain of a robot, and the entities of the kit in it.

The thread that receives, which may be the graph's, only queues actions and fills inboxes; see
`course_lib.ros.robot.link`.
"""

import contextlib
import re
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.dds.endpoints import OnSample, ReceivedSample
from course_lib.ros.dds.participant import Participant
from course_lib.ros.dds.wire import (
    CYCLONE_DDS,
    PARTICIPANT_ENTITY,
    PREFIX_SIZE,
    Endpoint,
    RequestId,
    kind_of,
    related_request,
)
from course_lib.ros.graph.topics import Qos, dds_type, ros_type, service_topics
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.messages.definitions import is_known, type_hash
from course_lib.ros.robot.link import (
    CYCLONE_SERVICES,
    Action,
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
    incomplete_message,
    moved_message,
    silence_message,
)
from course_lib.ros.time import wall

# Limit on calls without a reply, and on requests and replies that wait for a match.
MAX_OPEN = 1000
# Time that a request or a reply waits for its receiver to be matched [s].
MATCH_SECONDS = 5.0
SERVICE_QOS = Qos()
# Number of incomplete messages after which a topic is reported.
INCOMPLETE_MESSAGES = 5
# Time after which a robot that has not answered is reported [s].
SILENT_SECONDS = 3.0
DISCOVERY_MESSAGE, NODE_INFO, GID = (
    f"rmw_dds_common/msg/{name}" for name in ("ParticipantEntitiesInfo", "NodeEntitiesInfo", "Gid")
)
# Topic, type and QoS of the messages that list a participant's nodes and their endpoints.
DISCOVERY = ("ros_discovery_info", dds_type(DISCOVERY_MESSAGE), Qos(depth=1, durability="transient_local"))
# Endpoint GUIDs by node, which is a pair of namespace and name.
NodeEndpoints = dict[tuple[str, str], list[bytes]]
TYPE_HASH = re.compile(rb"typehash=(RIHS01_[0-9a-f]{64});")


@dataclass(frozen=True, slots=True, kw_only=True)
class DdsEntity(Entity):
    """A node or an endpoint on the network.

    Args:
        node_key: GUID of the participant, and the node's namespace and name.
        gid: GUID of a remote endpoint.
    """

    node_key: tuple[bytes, str, str]
    gid: bytes = b""


def dds_node(participant: bytes, namespace: str, name: str) -> DdsEntity:
    """Return a node of a participant, given by its GUID."""
    return DdsEntity(kind="node", node_key=(participant, namespace, name), namespace=namespace, node=name)


def dds_names(topic: str, type_name: str) -> tuple[str, str]:
    """Return the DDS names of a topic, which may be a service's request or reply topic, and its type."""
    return f"rt{topic}" if topic.startswith("/") else topic, dds_type(type_name)


def user_data(type_hash: str) -> bytes:
    """Return the user data of an endpoint."""
    return f"typehash={type_hash};".encode()


def read_names(endpoint: Endpoint) -> tuple[EntityKind, str, str] | None:
    """Return kind, name and type of a topic or service endpoint, None for other endpoints.

    The reply endpoints of a service are left out, because its request endpoints already represent
    it.
    """
    is_writer = endpoint.kind == "writer"
    if endpoint.topic.startswith("rt/"):
        return "publisher" if is_writer else "subscription", endpoint.topic[2:], ros_type(endpoint.type_name)
    if endpoint.topic.startswith("rq/") and endpoint.topic.endswith("Request"):
        service = endpoint.topic[2 : -len("Request")]
        return "client" if is_writer else "server", service, ros_type(endpoint.type_name)[: -len("_Request")]
    return None


def read_discovery(cdr: bytes) -> tuple[bytes, NodeEndpoints]:
    """Decode a discovery message into the participant's GUID and its nodes.

    Raises:
        CourseError: The message is malformed.
    """
    message: Any = deserialize(cdr, message_class(DISCOVERY_MESSAGE))
    nodes: NodeEndpoints = {}
    for info in message.node_entities_info_seq:
        guids = nodes.setdefault((info.node_namespace, info.node_name), [])
        guids.extend(bytes(gid.data) for gid in (*info.reader_gid_seq, *info.writer_gid_seq))
    return bytes(message.gid.data), nodes


def write_discovery(participant: bytes, nodes: NodeEndpoints) -> bytes:
    """Encode the discovery message of a participant."""
    message_type, node_type, gid_type = map(message_class, (DISCOVERY_MESSAGE, NODE_INFO, GID))

    def gid(guid: bytes) -> Any:
        return gid_type(data=np.frombuffer(guid, np.uint8))

    message: Any = message_type(gid=gid(participant))
    for (namespace, name), guids in nodes.items():
        info: Any = node_type(node_namespace=namespace, node_name=name)
        for guid in guids:
            (info.reader_gid_seq if kind_of(guid) == "reader" else info.writer_gid_seq).append(gid(guid))
        message.node_entities_info_seq.append(info)
    return serialize(message)


class DdsPublisher(NetworkPublisher):
    """A publisher of the kit on the network."""

    def __init__(self, link: "DdsLink", entity: DdsEntity) -> None:
        self._participant, names = link.participant, dds_names(entity.topic, entity.type_name)
        self._writer = self._participant.add_writer(*names, entity.qos, user_data(entity.type_hash))
        listing = link.list_endpoint(entity, self._writer.endpoint.guid)
        super().__init__(entity.topic, listing, partial(self._participant.remove, self._writer.endpoint))

    def put(self, cdr: bytes) -> None:
        """Publish a message; may be called from any thread."""
        if self._removals:
            self._participant.write(self._writer, cdr)

    def is_matched(self) -> bool:
        """Return whether a message would reach a subscription now."""
        return bool(self._writer.matched)


class ServiceEndpoints(Declaration):
    """The writer and the reader of a service client or server.

    Both are volatile: a message is lost if its receiver does not know the sender yet. So requests
    and replies wait until both sides have been matched.
    """

    def __init__(self, link: "DdsLink", entity: DdsEntity, on_sample: OnSample) -> None:
        self._participant, self._enqueue = link.participant, link.enqueue
        # Messages that wait: the end of the wait [s], the test of the match, and the function that
        # sends the message.
        self._waiting: deque[tuple[float, Callable[[], bool], Callable[[], object]]] = deque(maxlen=MAX_OPEN)
        topics, data = service_topics(entity.topic, entity.type_name), user_data(entity.type_hash)
        sent, received = topics if entity.kind == "client" else reversed(topics)
        with self._participant.lock:
            self._writer = self._participant.add_writer(*dds_names(*sent), SERVICE_QOS, data)
            self._reader = self._participant.add_reader(*dds_names(*received), SERVICE_QOS, on_sample, data)
        self._writer.on_matched = self._reader.on_matched = self._send_waiting
        endpoints = (self._reader.endpoint, self._writer.endpoint)
        listings = [link.list_endpoint(entity, endpoint.guid).withdraw for endpoint in endpoints]
        super().__init__(*listings, *[partial(self._participant.remove, endpoint) for endpoint in endpoints])

    def _send_when(self, is_matched: Callable[[], bool], send: Callable[[], object]) -> None:
        with self._participant.lock:
            self._waiting.append((wall.monotonic() + MATCH_SECONDS, is_matched, send))
            self._send_waiting()

    def _send_waiting(self) -> None:
        now = wall.monotonic()
        waiting, self._waiting = self._waiting, deque(maxlen=MAX_OPEN)
        for end, is_matched, send in waiting:
            if now < end and is_matched():
                send()
            elif now < end:
                self._waiting.append((end, is_matched, send))


class DdsClient(ServiceEndpoints, NetworkClient):
    """A service client of the kit on the network."""

    def __init__(self, link: "DdsLink", entity: DdsEntity) -> None:
        self._open: dict[int, OnReply] = {}
        super().__init__(link, entity, self._on_reply)

    def is_matched(self) -> bool:
        """Return whether a request would reach a server now, and its reply this client."""
        with self._participant.lock:
            servers = {guid[:PREFIX_SIZE] for guid in self._writer.matched}
            writers = [writer for writer in self._reader.matched.values() if not writer.requests]
            return any(writer.endpoint.guid[:PREFIX_SIZE] in servers for writer in writers)

    def call(self, cdr: bytes, on_reply: OnReply) -> None:
        """Send a request. `on_reply` is queued when its reply arrives."""

        def send() -> None:
            # The server sends its reply to the reader that is given here.
            related = related_request(RequestId(self._reader.endpoint.guid, 0))
            self._open[self._participant.write(self._writer, cdr, related)] = on_reply
            if len(self._open) > MAX_OPEN:
                del self._open[next(iter(self._open))]

        self._send_when(self.is_matched, send)

    def _on_reply(self, sample: ReceivedSample) -> None:
        """Queue a reply if it belongs to a request of this client.

        All clients of a service receive all replies.
        """
        request, own = sample.related, (self._reader.endpoint.guid, self._writer.endpoint.guid)
        if request is not None and request.guid in own and request.sequence in self._open:
            self._enqueue(self._open.pop(request.sequence), sample.data)


class DdsServer(ServiceEndpoints):
    """A service of the kit on the network."""

    def __init__(self, link: "DdsLink", entity: DdsEntity, on_request: OnRequest) -> None:
        self._serve = on_request
        super().__init__(link, entity, self._on_request)

    def _on_request(self, sample: ReceivedSample) -> None:
        # Fast DDS sends the reader that waits for the reply; otherwise the writer identifies the
        # client.
        client = sample.related.guid if sample.related else sample.writer
        related = related_request(RequestId(client, sample.sequence))

        def is_matched() -> bool:
            return kind_of(client) == "writer" or client in self._writer.matched

        def send_reply(cdr: bytes) -> None:
            send = partial(self._participant.write, self._writer, cdr, related)
            self._send_when(is_matched, send)

        self._enqueue(self._serve, sample.data, send_reply)


class DdsLink(Link):
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
        super().__init__(f"dds/{host}", domain)
        self._started, self._is_silence_reported = wall.monotonic(), False
        self._own_nodes: NodeEndpoints = {}
        # The newest GUID by topic and type.
        self._own_readers: dict[tuple[str, str], bytes] = {}
        self._on_entity: OnEntity = lambda entity, has_joined: None
        # Remote endpoints by GUID.
        self._endpoints: dict[bytes, Endpoint] = {}
        # The node of each remote endpoint, by its GUID.
        self._owners: dict[bytes, DdsEntity] = {}
        # Remote nodes by participant, namespace and name.
        self._nodes: dict[bytes, dict[tuple[str, str], DdsEntity]] = {}
        # Remote endpoints that the graph contains.
        self._listed: dict[bytes, DdsEntity] = {}
        self.participant = Participant(domain, host, partial(self.enqueue, self._on_endpoint))
        # The robot's address at the start.
        self._first_peer = self.participant.current_peer
        self._discovery = self.participant.add_writer(*DISCOVERY)
        self.participant.add_reader(*DISCOVERY, partial(self.enqueue, self._on_discovery))

    @property
    def is_open(self) -> bool:
        """True until `close`."""
        return self.participant.is_open

    def is_up(self) -> bool:
        """Return whether a participant of the robot is present now."""
        return self.is_open and bool(self.participant.remotes)

    def silent_seconds(self) -> float:
        """Return how long no participant of the robot has answered [s]; 0 if none is present."""
        return self.participant.silent_seconds()

    def close(self) -> None:
        """Leave the domain; further calls do nothing."""
        self.participant.close()

    def next_action(self, seconds: float) -> Action:
        """Return the queue's next action; the calling thread itself receives while it waits."""
        deadline = wall.monotonic() + seconds
        while seconds > 0 and self.actions.empty() and self.participant.receive_for(seconds):
            seconds = deadline - wall.monotonic()
        return super().next_action(seconds)

    def watch(self, on_entity: OnEntity, report: Report) -> None:
        """Queue a callback for each remote entity that joins or leaves."""
        self._on_entity = on_entity

    def no_nodes_message(self) -> str:
        """Return a message for a domain without nodes. Nodes in other domains use other ports."""
        if self.participant.datagrams:
            return f"There are no nodes in domain {self.domain} yet."
        self._is_silence_reported = True
        return silence_message(self.address, self.domain, self.participant.peer_error())

    def status_rows(self) -> list[tuple[str, object]]:
        """Return the malformed datagrams as a row of `ros2 doctor`."""
        dropped = sum(self.participant.dropped.values())
        return [("malformed datagrams", dropped)] if dropped else []

    def warnings(self) -> Iterable[tuple[str, str]]:
        """Yield a line if no participant answers, and for each topic with mostly incomplete messages."""
        is_silent = not self.participant.datagrams and wall.monotonic() - self._started > SILENT_SECONDS
        if is_silent and not self._is_silence_reported:
            yield "silent", self.no_nodes_message()
        if any(prefix.startswith(CYCLONE_DDS) for prefix in tuple(self.participant.remotes)):
            yield "cyclone", CYCLONE_SERVICES
        host = self.participant.current_peer
        if host != self._first_peer:
            yield f"moved {host}", moved_message(self.address, host)
        for reader in self.participant.readers():
            topic, count = reader.endpoint.topic.removeprefix("rt"), reader.incomplete
            if count >= INCOMPLETE_MESSAGES and count > reader.complete:
                yield f"incomplete {topic}", incomplete_message(topic, count, reader.incomplete_size)

    def node(self, name: str, namespace: str) -> DdsEntity:
        """Return a node of the kit that is not announced yet."""
        return dds_node(self.participant.guid, namespace, name)

    def announce(self, entity: DdsEntity) -> Declaration:
        """Announce a node, or a subscription that shares a reader."""
        if entity.kind == "subscription":
            return self.list_endpoint(entity, self._own_readers[entity.topic, entity.type_name])
        name = (entity.namespace, entity.node)
        self._own_nodes[name] = []
        self._publish_discovery()
        return Declaration(partial(self._own_nodes.pop, name, None), self._publish_discovery)

    def publisher(self, entity: DdsEntity) -> DdsPublisher:
        """Declare a publisher."""
        return DdsPublisher(self, entity)

    def subscriber(
        self, topic: str, type_name: str, qos: Qos, latched_count: int, on_packet: OnPacket
    ) -> Declaration:
        """Subscribe to a topic. DDS itself requests the messages of latched publishers."""

        def on_sample(sample: ReceivedSample) -> None:
            on_packet(Packet(sample.data, sample.sequence, sample.source_ns, sample.writer, wall.time_ns()))

        # A gateway also forwards topics whose types are unknown on its computer.
        data = user_data(type_hash(type_name)) if is_known(type_name) else b""
        reader = self.participant.add_reader(*dds_names(topic, type_name), qos, on_sample, data)
        self._own_readers[topic, type_name] = reader.endpoint.guid
        return Declaration(partial(self.participant.remove, reader.endpoint))

    def service(self, entity: DdsEntity, on_request: OnRequest) -> DdsServer:
        """Offer a service; `on_request(cdr, send_reply)` is queued for each request."""
        return DdsServer(self, entity, on_request)

    def client(self, entity: DdsEntity) -> DdsClient:
        """Declare a service client."""
        return DdsClient(self, entity)

    def list_endpoint(self, entity: DdsEntity, guid: bytes) -> Declaration:
        """Announce that an endpoint belongs to a node of the kit."""
        guids = self._own_nodes.get((entity.namespace, entity.node), [])
        guids.append(guid)
        self._publish_discovery()
        return Declaration(partial(guids.remove, guid), self._publish_discovery)

    def _publish_discovery(self) -> None:
        self.participant.write(self._discovery, write_discovery(self.participant.guid, self._own_nodes))

    # The following methods run in the graph's thread and handle remote entities.

    def _on_discovery(self, sample: ReceivedSample) -> None:
        """Process the list of nodes of a participant."""
        with contextlib.suppress(CourseError):
            participant, nodes = read_discovery(sample.data)
            before = self._nodes.get(participant, {})
            now = {name: before.get(name) or dds_node(participant, *name) for name in nodes}
            self._nodes[participant] = now
            for name, node in now.items():
                if name not in before:
                    self._on_entity(node, True)
                for guid in nodes[name]:
                    self._owners[guid] = node
                    self._list(guid)
            for name in before.keys() - nodes.keys():
                self._on_entity(before[name], False)

    def _on_endpoint(self, endpoint: Endpoint, has_joined: bool) -> None:
        """Process a remote endpoint that has joined or left."""
        if has_joined:
            self._endpoints[endpoint.guid] = endpoint
            self._list(endpoint.guid)
            return
        self._endpoints.pop(endpoint.guid, None)
        self._owners.pop(endpoint.guid, None)
        if (entity := self._listed.pop(endpoint.guid, None)) is not None:
            self._on_entity(entity, False)
        if endpoint.topic == DISCOVERY[0] and endpoint.kind == "writer":
            # The participant has no nodes left without this writer.
            for node in self._nodes.pop(endpoint.guid[:PREFIX_SIZE] + PARTICIPANT_ENTITY, {}).values():
                self._on_entity(node, False)

    def _list(self, guid: bytes) -> None:
        """Add a remote endpoint to the graph as soon as its description and its node are known."""
        endpoint, node = self._endpoints.get(guid), self._owners.get(guid)
        ros_names = read_names(endpoint) if endpoint is not None else None
        if endpoint is None or node is None or ros_names is None or guid in self._listed:
            return
        kind, topic, type_name = ros_names
        remote_hash = b"".join(TYPE_HASH.findall(endpoint.user_data)[:1]).decode()
        if kind in ("server", "client") and is_known(type_name):
            # DDS transmits the hash of the request, from which the service's own hash cannot be
            # derived.
            remote_hash = type_hash(type_name)
        entity = replace(node, kind=kind, gid=guid, topic=topic, type_name=type_name)
        self._listed[guid] = replace(entity, type_hash=remote_hash, qos=endpoint.qos)
        self._on_entity(self._listed[guid], True)
