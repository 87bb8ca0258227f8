"""A participant of a DDS domain: sockets, discovery (SPDP and SEDP), and the thread that receives.

The participants of a robot are contacted by unicast, on the ports that the RTPS specification
assigns to the first participants of a computer. So neither multicast nor any setting on the robot
is needed.

The thread must neither import modules (a deadlock with the import lock) nor use `threading` or
`time`, which robot time replaces while a program runs. It uses `_thread` and the wall clock.

A thread of the program that waits for messages receives by itself (`receive_for`), because to be
woken by another thread takes longer than the message. Ctrl+C may interrupt it at any line. Then the
participant's thread processes the datagram once more, so processing must be repeatable: a change is
reported before it is recorded.
"""

import _thread
import contextlib
import itertools
import os
import select
import socket
import struct
from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

from course_lib.errors import CourseError
from course_lib.ros.dds import wire
from course_lib.ros.dds.endpoints import OnSample, Reader, ReceivedSample, Writer, data_submessage
from course_lib.ros.dds.wire import PREFIX_SIZE, Buffer, Endpoint, Kind, Locator, ParameterList, Pid
from course_lib.ros.graph.topics import Qos, find_incompatible_policy
from course_lib.ros.robot.addresses import common_bits, resolve, socket_towards
from course_lib.ros.time import wall

PORT_BASE, PORTS_PER_DOMAIN, FIRST_UNICAST = 7400, 250, 10
# Number of participants on the robot that are contacted.
ASKED_PARTICIPANTS = 40
PORT_ATTEMPTS = 120
ANNOUNCE_SECONDS, EAGER_SECONDS, HEARTBEAT_SECONDS = 2.0, 0.1, 0.1
# A participant that has just started misses the first announcements.
EAGER_ANNOUNCEMENTS = 10
LEASE_SECONDS = 20.0
# Time without a datagram after which the remote participants are requested to answer [s].
ASK_SECONDS = 2.0
# Waiting time for acknowledgements at the end, and interval between checks [s].
LINGER_SECONDS, POLL_SECONDS = 1.0, 0.01
# Limits on remote participants and endpoints. Further ones are ignored.
MAX_PARTICIPANTS, MAX_ENDPOINTS = 500, 20_000
# Time without a waiting thread of the program after which the participant's thread receives [s].
HANDOVER_SECONDS = 0.005
# Limit on datagrams read in one go before timers are checked.
MAX_DATAGRAMS = 64
SOCKET_BUFFER = 2**23  # [B]
DISCOVERY_QOS = Qos(history="keep_all", durability="transient_local")
# Errors that malformed datagrams raise.
MALFORMED = (struct.error, IndexError, ValueError, MemoryError)
# Entities of the writer and the reader that transmit the descriptions of writers and of readers.
SEDP: Mapping[Kind, tuple[bytes, bytes]] = {
    "writer": (wire.PUBLICATIONS_WRITER, wire.PUBLICATIONS_READER),
    "reader": (wire.SUBSCRIPTIONS_WRITER, wire.SUBSCRIPTIONS_READER),
}

# Called with an endpoint, and False if it was removed.
OnEndpoint = Callable[[Endpoint, bool], None]
Own = TypeVar("Own", Writer, Reader)


@dataclass
class RemoteParticipant:
    """A remote participant.

    Args:
        host: Its present address.
        locators: The locators of endpoints that have none of their own.
        lease_end: Wall time at which it counts as absent if nothing is received [s].
    """

    host: str
    locators: tuple[Locator, ...]
    lease_end: float


class Participant:
    """A participant of a domain, with its own thread.

    Args:
        domain: ROS_DOMAIN_ID.
        host: Address or name of the robot.
        on_endpoint: Called with each remote endpoint that joins or leaves, in the thread that
            receives.

    Raises:
        CourseError: No port is free, the host is unknown, or no network leads to it.
    """

    def __init__(self, domain: int, host: str, on_endpoint: OnEndpoint) -> None:
        self.domain, self._host, self._on_endpoint = domain, host, on_endpoint
        peer = resolve(host)
        self.prefix = wire.VENDOR_ID + os.urandom(PREFIX_SIZE - len(wire.VENDOR_ID))
        self.guid = self.prefix + wire.PARTICIPANT_ENTITY
        self.lock = _thread.RLock()
        # Malformed datagrams by the kind of error.
        self.dropped = Counter[str]()
        # Number of datagrams received from others.
        self.datagrams = 0
        # Wall time of the last datagram of a known participant [s].
        self._heard_at = 0.0
        base = PORT_BASE + PORTS_PER_DOMAIN * domain + FIRST_UNICAST
        self._probe, self._probe_error = socket_towards(peer, base), 0
        self._address = self._probe.getsockname()[0]
        # A datagram without submessages only probes whether the first participant's port is open.
        self._probe.send(wire.PROTOCOL + wire.VENDOR_ID + self.prefix)
        self._socket = self._bind(base)
        self._own_locator: Locator = (self._address, self._socket.getsockname()[1])
        # The given address of the robot, and the address from which it sends now.
        self._peer = self.current_peer = peer
        self._entities = itertools.count(1)
        # Own endpoints by entity id.
        self._own: dict[bytes, Writer | Reader] = {}
        # Own writers that announce endpoints.
        self._announcers: dict[Kind, Writer] = {}
        # Remote participants by GUID prefix.
        self._remotes: dict[bytes, RemoteParticipant] = {}
        # Remote endpoints by GUID.
        self._endpoints: dict[bytes, Endpoint] = {}
        self._announcements = itertools.count(1)
        self._eager = EAGER_ANNOUNCEMENTS
        # Held by the thread that receives.
        self._receiving = _thread.allocate_lock()
        # Wall time until which a thread of the program receives [s].
        self._covered_until = 0.0
        # Datagrams whose processing was interrupted, and their senders' addresses.
        self._interrupted: deque[tuple[bytes, str]] = deque(maxlen=MAX_DATAGRAMS)
        for kind, (writer, reader) in SEDP.items():
            announcer = Writer(self, Endpoint(self.prefix + writer, "", "", DISCOVERY_QOS))
            self._own[writer] = self._announcers[kind] = announcer
            endpoint = Endpoint(self.prefix + reader, "", "", DISCOVERY_QOS)
            self._own[reader] = Reader(self, endpoint, self._on_sedp)
        self.is_open = True
        self._ended = _thread.allocate_lock()
        self._ended.acquire()
        _thread.start_new_thread(self._run, ())

    def peer_error(self) -> int:
        """Return the error number with which the robot's computer or network rejects datagrams, or 0."""
        with self.lock:
            if self.is_open and not self._probe_error:
                self._probe_error = self._probe.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        return self._probe_error

    def has_peers(self) -> bool:
        """Return whether a remote participant is present now."""
        return bool(self._remotes)

    def silent_seconds(self) -> float:
        """Return for how long no remote participant has sent anything [s]; 0 if none is present."""
        with self.lock:
            return wall.monotonic() - self._heard_at if self._remotes else 0.0

    def add_writer(self, topic: str, type_name: str, qos: Qos, user_data: bytes = b"") -> Writer:
        """Create a writer and announce it."""
        guid = self._new_guid(wire.USER_WRITER)
        return self._add(Writer(self, Endpoint(guid, topic, type_name, qos, user_data)))

    def add_reader(
        self, topic: str, type_name: str, qos: Qos, on_sample: OnSample, user_data: bytes = b""
    ) -> Reader:
        """Create a reader and announce it. `on_sample` is called in the thread that receives."""
        guid = self._new_guid(wire.USER_READER)
        return self._add(Reader(self, Endpoint(guid, topic, type_name, qos, user_data), on_sample))

    def _new_guid(self, kind: int) -> bytes:
        return self.prefix + next(self._entities).to_bytes(3, "big") + bytes([kind])

    def _add(self, own: Own) -> Own:
        endpoint = own.endpoint
        with self.lock:
            self._own[endpoint.guid[PREFIX_SIZE:]] = own
            description = wire.describe(endpoint, self.guid, self._own_locator)
            self._announcers[endpoint.kind].write(description, b"", wall.time_ns())
            for remote in tuple(self._endpoints.values()):
                _match(own, remote)
        return own

    def incomplete_topics(self) -> list[tuple[str, int, int]]:
        """Return (topic, number, size [B]) of the incomplete messages, if most messages of a topic are."""
        with self.lock:
            return [
                (reader.endpoint.topic, reader.incomplete, reader.incomplete_size)
                for reader in self._own.values()
                if isinstance(reader, Reader) and reader.incomplete > reader.complete
            ]

    def write(self, writer: Writer, data: bytes, inline_qos: bytes = b"") -> int:
        """Publish a message and return its sequence number. May be called from any thread."""
        with self.lock:
            return writer.write(data, inline_qos, wall.time_ns()) if self.is_open else 0

    def remove(self, endpoint: Endpoint) -> None:
        """Remove a writer or a reader from the network."""
        with self.lock:
            self._own.pop(endpoint.guid[PREFIX_SIZE:], None)
            if self.is_open:
                disposal = wire.disposal(Pid.ENDPOINT, endpoint.guid)
                self._announcers[endpoint.kind].write(*disposal, wall.time_ns())

    def close(self) -> None:
        """Leave the domain as soon as reliable messages have been acknowledged.

        Further calls have no effect.
        """
        deadline = wall.monotonic() + LINGER_SECONDS
        while self.is_open and wall.monotonic() < deadline:
            with self.lock:
                writers = [own for own in self._own.values() if isinstance(own, Writer)]
                if not any(writer.unacknowledged_readers() for writer in writers):
                    break
            wall.sleep(POLL_SECONDS)
        with self.lock:
            if not self.is_open:
                return
            data, inline_qos = wire.disposal(Pid.PARTICIPANT, self.guid)
            self._send_spdp(self._ports_of_robot(), data, inline_qos)
            self.is_open = False
        # The thread may be ending at this moment, so the waits have a timeout.
        self._ended.acquire(timeout=1.0)
        self._receiving.acquire(timeout=1.0)
        self._socket.close()
        self._probe.close()

    def send(
        self, submessages: Iterable[Buffer], locators: Iterable[Locator], destination: bytes = b""
    ) -> None:
        """Send submessages to addresses, for one participant or for all participants there."""
        info = wire.submessage(wire.INFO_DST, 0, destination) if destination else ()
        datagram = b"".join((wire.PROTOCOL, wire.VENDOR_ID, self.prefix, *info, *submessages))
        for address in locators:
            # If the buffer is full or an address unreachable, the datagram is lost, and the
            # protocol resends it.
            with contextlib.suppress(OSError):
                self._socket.sendto(datagram, address)

    # Discovery of participants.

    def _ports_of_robot(self) -> list[Locator]:
        """Return the addresses of the participants that may run on the robot."""
        base = PORT_BASE + PORTS_PER_DOMAIN * self.domain + FIRST_UNICAST
        hosts = dict.fromkeys((self._peer, self.current_peer))
        return [(host, base + 2 * i) for host in hosts for i in range(ASKED_PARTICIPANTS)]

    def _announce(self, locators: Iterable[Locator]) -> None:
        here = wire.locator(self._own_locator)
        data = wire.PL_CDR_LE + wire.parameter_list(
            (Pid.VERSION, wire.PROTOCOL[4:]),
            (Pid.VENDOR, wire.VENDOR_ID),
            (Pid.DOMAIN, struct.pack("<I", self.domain)),
            (Pid.PARTICIPANT, self.guid),
            (Pid.METATRAFFIC, here),
            (Pid.DEFAULT_UNICAST, here),
            (Pid.LEASE, wire.duration(round(LEASE_SECONDS * 1e9))),
            (Pid.BUILTIN, struct.pack("<I", wire.BUILTIN_ENDPOINTS)),
            (Pid.NAME, wire.string("/")),
            (Pid.USER_DATA, wire.octets(b"enclave=/;")),
        )
        self._send_spdp(locators, data)

    def _send_spdp(self, locators: Iterable[Locator], data: bytes, inline_qos: bytes = b"") -> None:
        writer = self.prefix + wire.SPDP_WRITER
        body = data_submessage(writer, next(self._announcements), data, inline_qos, wire.SPDP_READER)
        self.send((wire.timestamp(wall.time_ns()), *body), locators)

    def _on_spdp(self, sample: ReceivedSample, sender: str) -> None:
        """Process the announcement or departure of a participant, from the address `sender`."""
        if sample.is_disposed:
            guid = sample.key or ParameterList.from_payload(sample.data).first(Pid.PARTICIPANT)
            self._remove_participant(guid[:PREFIX_SIZE])
            return
        parameters = ParameterList.from_payload(sample.data)
        prefix = (parameters.first(Pid.PARTICIPANT) or sample.writer)[:PREFIX_SIZE]
        if prefix == self.prefix or parameters.number(Pid.DOMAIN, self.domain) != self.domain:
            return
        lease_ns = parameters.duration(Pid.LEASE, default=round(LEASE_SECONDS * 1e9))
        lease_end = wall.monotonic() + (1e9 if lease_ns is None else lease_ns * 1e-9)
        locators = parameters.locators(Pid.METATRAFFIC)
        host = self._choose_host(locators, sender)
        remote = self._remotes.get(prefix)
        if remote is not None:
            self._move(prefix, remote, host)
            remote.lease_end = lease_end
        elif len(self._remotes) >= MAX_PARTICIPANTS:
            self.dropped["too many participants"] += 1
        else:
            self._answer(prefix, _locators_at(host, locators))
            default_locators = parameters.locators(Pid.DEFAULT_UNICAST) or locators
            endpoint_locators = _locators_at(host, default_locators)
            self._remotes[prefix] = RemoteParticipant(host, endpoint_locators, lease_end)

    def _answer(self, prefix: bytes, locators: tuple[Locator, ...]) -> None:
        """Announce this participant to another one, and exchange endpoints with it."""
        self._announce(locators)
        self._eager = EAGER_ANNOUNCEMENTS
        for pair in SEDP.values():
            for own, remote in (pair, pair[::-1]):
                endpoint = Endpoint(prefix + remote, "", "", DISCOVERY_QOS, locators=locators)
                self._own[own].match(endpoint)

    def _choose_host(self, locators: tuple[Locator, ...], sender: str) -> str:
        """Choose one address of a remote participant.

        A robot often has several networks, of which only one is this participant's: a TurtleBot 4
        also announces the address of its internal network. A robot whose address has changed still
        announces the old one.
        """
        hosts = [host for host, _ in locators]
        if sender not in ("", self._peer, *hosts):
            return sender

        def fitness(host: str) -> tuple[bool, int]:
            return host == self._peer, common_bits(host, self._address)

        return max(hosts or [self._peer], key=fitness)

    def _move(self, prefix: bytes, remote: RemoteParticipant, host: str) -> None:
        """Send to a participant at its present address."""
        if remote.host == host:
            return
        # Its endpoints keep their state, so that no message is lost or delivered twice.
        for matched in [one for own in self._own.values() for one in own.matched.values()]:
            if matched.endpoint.guid[:PREFIX_SIZE] == prefix:
                locators = _locators_at(host, matched.endpoint.locators)
                matched.endpoint = replace(matched.endpoint, locators=locators)
        remote.locators = _locators_at(host, remote.locators)
        if remote.host == self.current_peer:
            self.current_peer = host
        remote.host = host

    def _remove_participant(self, prefix: bytes) -> None:
        """Remove a participant and its endpoints."""
        if prefix not in self._remotes:
            return
        builtin = [prefix + entity for pair in SEDP.values() for entity in pair]
        for guid in [guid for guid in self._endpoints if guid[:PREFIX_SIZE] == prefix] + builtin:
            self._remove_endpoint(guid)
        del self._remotes[prefix]

    # Discovery of endpoints.

    def _on_sedp(self, sample: ReceivedSample) -> None:
        """Process the announcement or departure of an endpoint, unless it is malformed."""
        try:
            self._update_endpoint(sample)
        except MALFORMED as error:
            self.dropped[type(error).__name__] += 1

    def _update_endpoint(self, sample: ReceivedSample) -> None:
        if sample.is_disposed:
            guid = sample.key or ParameterList.from_payload(sample.data).first(Pid.ENDPOINT)
            self._remove_endpoint(guid)
            return
        parameters = ParameterList.from_payload(sample.data)
        guid = parameters.first(Pid.ENDPOINT)
        if len(guid) != 16:
            raise ValueError("an endpoint without a GUID")
        if guid not in self._endpoints and len(self._endpoints) >= MAX_ENDPOINTS:
            self.dropped["too many endpoints"] += 1
            return
        remote = self._remotes.get(guid[:PREFIX_SIZE])
        host, default_locators = (remote.host, remote.locators) if remote else (self._peer, ())
        endpoint = Endpoint(
            guid,
            parameters.string(Pid.TOPIC),
            parameters.string(Pid.TYPE),
            parameters.qos(wire.kind_of(guid)),
            parameters.octets(Pid.USER_DATA),
            _locators_at(host, parameters.locators(Pid.UNICAST)) or default_locators,
            # An empty sequence of partitions has the length 0.
            has_partition=parameters.number(Pid.PARTITION, 0) > 0,
        )
        if guid not in self._endpoints:
            self._on_endpoint(endpoint, True)
            self._endpoints[guid] = endpoint
        for own in tuple(self._own.values()):
            _match(own, endpoint)

    def _remove_endpoint(self, guid: bytes) -> None:
        for own in self._own.values():
            own.matched.pop(guid, None)
        if guid in self._endpoints:
            self._on_endpoint(self._endpoints[guid], False)
            del self._endpoints[guid]

    # Receiving.

    def _bind(self, base: int) -> socket.socket:
        """Return a socket on the first free unicast port of the domain."""
        for i in range(PORT_ATTEMPTS):
            udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            udp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, SOCKET_BUFFER)
            udp.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BUFFER)
            udp.setblocking(False)
            try:
                udp.bind((self._address, base + 2 * i))
                return udp
            except OSError:
                udp.close()
        raise CourseError(
            f"No UDP port from {base} to {base + 2 * PORT_ATTEMPTS - 2} is free on "
            f"{self._address}: end other ROS programs on this computer, or choose another domain."
        )

    def _run(self) -> None:
        try:
            self._loop()
        finally:
            self._ended.release()

    def _loop(self) -> None:
        next_announcement = next_heartbeat = 0.0
        while self.is_open:
            now = wall.monotonic()
            if now >= next_announcement or self._eager == EAGER_ANNOUNCEMENTS:
                next_announcement = now + (EAGER_SECONDS if self._eager else ANNOUNCE_SECONDS)
                self._eager = max(0, self._eager - 1)
                if not (self._remotes or self._eager):
                    self._resolve_again()
                with self.lock:
                    self._announce(self._ports_of_robot())
                    for prefix, remote in tuple(self._remotes.items()):
                        if remote.lease_end < now:
                            self._remove_participant(prefix)
            if now >= next_heartbeat:
                next_heartbeat = now + HEARTBEAT_SECONDS
                with self.lock:
                    for own in self._own.values():
                        own.tick()
                    if self.silent_seconds() > ASK_SECONDS:
                        # An idle robot announces itself only every few seconds.
                        self._announcers["writer"].request_acknowledgements()
            with self.lock:
                while self._interrupted:
                    self.receive(*self._interrupted.popleft())
            now = wall.monotonic()
            wait = max(0.0, min(next_announcement, next_heartbeat) - now)
            if now < self._covered_until:
                wall.sleep(min(wait, self._covered_until - now))
            else:
                with self._receiving:
                    self._receive_all(wait)

    def _resolve_again(self) -> None:
        """Resolve the name of a missing robot again, because its address may have changed."""
        with contextlib.suppress(CourseError):
            peer = resolve(self._host)
            if peer != self._peer:
                self._peer = self.current_peer = peer

    def receive_for(self, seconds: float) -> bool:
        """Receive in the calling thread until a datagram has arrived, at most for `seconds`.

        Return False immediately if the participant's thread is receiving. It stops after the next
        datagram.
        """
        self._covered_until = wall.monotonic() + seconds + HANDOVER_SECONDS
        if not self._receiving.acquire(blocking=False):
            return False
        try:
            if self.is_open:
                self._receive_all(seconds)
        finally:
            self._receiving.release()
            self._covered_until = wall.monotonic() + HANDOVER_SECONDS
        return True

    def _receive_all(self, seconds: float) -> None:
        """Process the datagrams that have arrived, or wait at most for `seconds` for the first."""
        if not select.select([self._socket], [], [], seconds)[0]:
            return
        for _ in range(MAX_DATAGRAMS):
            try:
                data, (host, _) = self._socket.recvfrom(2**16)
            except OSError:
                # Nothing more to read, or, on Windows, an earlier datagram had no receiver.
                return
            self.receive(data, host)

    def receive(self, data: bytes, host: str = "") -> None:
        """Process a datagram that `host` has sent. A malformed datagram is dropped and counted."""
        # The participant receives its own announcement if the robot runs on this computer.
        sender = data[wire.HEADER_SIZE - PREFIX_SIZE : wire.HEADER_SIZE]
        self.datagrams += sender != self.prefix
        try:
            with self.lock:
                if self.is_open:
                    self._process(data, host)
                    if sender in self._remotes:
                        self._heard_at = wall.monotonic()
        except MALFORMED as error:
            self.dropped[type(error).__name__] += 1
        except KeyboardInterrupt:
            self._interrupted.append((data, host))
            raise

    def _process(self, data: bytes, host: str) -> None:
        for received in wire.read_datagram(data, self.prefix):
            if not received.is_for or received.source == self.prefix:
                continue
            if received.kind in (wire.DATA, wire.DATA_FRAG):
                self._on_data(received, host)
            elif received.kind in (wire.ACKNACK, wire.NACK_FRAG):
                self._on_nack(received)
            elif received.kind in (wire.HEARTBEAT, wire.GAP):
                self._on_writer_state(received)

    def _on_data(self, received: wire.Submessage, host: str) -> None:
        body, order = received.body, received.order
        reader_entity, writer_entity = bytes(body[4:8]), bytes(body[8:12])
        number = wire.read_sequence_number(body, 12, order)
        begin = 4 + struct.unpack_from(f"{order}H", body, 2)[0]
        related, is_disposed, key = None, False, b""
        if received.flags & 0x02:
            inline = ParameterList(body, order, begin)
            begin, key = inline.end, inline.first(Pid.KEY_HASH)
            is_disposed = bool(inline.first(Pid.STATUS, bytes(4))[3] & wire.DISPOSED[3])
            identity = inline.first(Pid.RELATED) or inline.first(Pid.RELATED_OLD)
            if identity:
                related = wire.RequestId(identity[:16], wire.read_sequence_number(identity, 16, order))
        payload = bytes(body[begin:]) if received.kind == wire.DATA else b""
        writer, source_ns = received.source + writer_entity, received.stamp_ns
        sample = ReceivedSample(payload, writer, number, source_ns, related, is_disposed, key)
        if writer_entity == wire.SPDP_WRITER:
            self._on_spdp(sample, host)
        for reader in self._readers_of(reader_entity, sample.writer):
            if received.kind == wire.DATA:
                reader.on_data(sample)
            else:
                first, count, fragment_size, size = struct.unpack_from(f"{order}IHHI", body, 20)
                reader.on_fragment(sample, first, count, fragment_size, size, body[begin:])

    def _on_nack(self, received: wire.Submessage) -> None:
        """Process a remote reader's report of missing messages."""
        body, order = received.body, received.order
        reader, writer = received.source + body[:4], self._own.get(bytes(body[4:8]))
        if not isinstance(writer, Writer):
            return
        number = wire.read_sequence_number(body, 8, order)
        if received.kind == wire.ACKNACK:
            missing = wire.read_bitmap(body, 16, number, order)
            writer.on_acknack(reader, number, missing, is_final=bool(received.flags & 0x02))
        else:
            (base,) = struct.unpack_from(f"{order}I", body, 16)
            writer.on_nack_frag(reader, number, wire.read_bitmap(body, 20, base, order))

    def _on_writer_state(self, received: wire.Submessage) -> None:
        """Process a remote writer's heartbeat, or its gap of messages that it no longer has."""
        body, order = received.body, received.order
        writer = received.source + body[4:8]
        first, second = (wire.read_sequence_number(body, at, order) for at in (8, 16))
        for reader in self._readers_of(bytes(body[:4]), writer):
            if received.kind == wire.HEARTBEAT:
                (count,) = struct.unpack_from(f"{order}i", body, 24)
                reader.on_heartbeat(writer, first, second, count, is_final=bool(received.flags & 0x02))
            else:
                reader.on_gap(writer, first, second, wire.read_bitmap(body, 24, second, order))

    def _readers_of(self, entity: bytes, writer: bytes) -> list[Reader]:
        """Return the readers to which a submessage of a remote writer is addressed."""
        if entity == wire.UNKNOWN_ENTITY:
            own_endpoints = self._own.values()
            return [own for own in own_endpoints if writer in own.matched and isinstance(own, Reader)]
        own = self._own.get(entity)
        return [own] if isinstance(own, Reader) and writer in own.matched else []


def _locators_at(host: str, locators: tuple[Locator, ...]) -> tuple[Locator, ...]:
    """Return the locator at a host.

    If none is announced there, the first one's port at that host.
    """
    if not locators:
        return ()
    return (next((locator for locator in locators if locator[0] == host), (host, locators[0][1])),)


def _match(own: Writer | Reader, remote: Endpoint) -> None:
    """Match two endpoints if DDS connects them."""
    is_writer = own.endpoint.kind == "writer"
    writer, reader = (own.endpoint, remote) if is_writer else (remote, own.endpoint)
    if (
        (writer.kind, reader.kind) == ("writer", "reader")
        and writer.topic
        and (writer.topic, writer.type_name) == (reader.topic, reader.type_name)
        and not (writer.has_partition or reader.has_partition)
        and find_incompatible_policy(writer.qos, reader.qos) is None
    ):
        own.match(remote)
