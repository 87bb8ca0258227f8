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
from course_lib.ros.dds.endpoints import Change, MatchedWriter, OnSample, Reader, ReceivedSample, Writer
from course_lib.ros.dds.wire import PREFIX_SIZE, Buffer, Endpoint, Kind, Locator, ParameterList, Pid
from course_lib.ros.graph.topics import Qos, find_incompatible_policy
from course_lib.ros.robot.addresses import bind_udp, common_bits, resolve, socket_towards
from course_lib.ros.time import wall

PORT_BASE, PORTS_PER_DOMAIN, FIRST_UNICAST = 7400, 250, 10
# Number of participants on the robot that are contacted.
ASKED_PARTICIPANTS = 40
PORT_ATTEMPTS = 120
ANNOUNCE_SECONDS, EAGER_SECONDS, HEARTBEAT_SECONDS = 2.0, 0.1, 0.1
# A participant that has just started misses the first announcements.
EAGER_ANNOUNCEMENTS = 10
LEASE_SECONDS = 20.0
# Period in which the state of a remote participant's discovery is checked [s].
CHECK_SECONDS = LEASE_SECONDS / 2
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
# Size of a datagram after which the thread that sends yields the processor [B].
LARGE_DATAGRAM = 2**14
DISCOVERY_QOS = Qos(history="keep_all", durability="transient_local")
# Errors that malformed datagrams raise.
MALFORMED = (struct.error, IndexError, ValueError, MemoryError)
# Entities of the writer and the reader that transmit the descriptions of writers and of readers.
SEDP: Mapping[Kind, tuple[bytes, bytes]] = {
    "writer": (wire.PUBLICATIONS_WRITER, wire.PUBLICATIONS_READER),
    "reader": (wire.SUBSCRIPTIONS_WRITER, wire.SUBSCRIPTIONS_READER),
}

Own = TypeVar("Own", Writer, Reader)


@dataclass
class RemoteParticipant:
    """A remote participant.

    Args:
        host: Its present address.
        locators: The locators of endpoints that have none of their own.
        lease_end: Wall time at which it counts as absent if nothing is received [s].
        check_at: Wall time of the next check of its discovery [s].
        is_suspect: Whether malformed datagrams have come in its name since the last check.
    """

    host: str
    locators: tuple[Locator, ...]
    lease_end: float
    check_at: float
    is_suspect: bool = False


class Participant:
    """A participant of a domain, with its own thread.

    Args:
        domain: ROS_DOMAIN_ID.
        host: Address or name of the robot.
        on_endpoint: Called with each remote endpoint and whether it joins or leaves, in the thread
            that receives.

    Raises:
        CourseError: No port is free, the host is unknown, or no network leads to it.
    """

    def __init__(self, domain: int, host: str, on_endpoint: Callable[[Endpoint, bool], None]) -> None:
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
        self._last_received_at = 0.0
        first_port = PORT_BASE + PORTS_PER_DOMAIN * domain + FIRST_UNICAST
        # The ports that participants on one computer use.
        self._ports = range(first_port, first_port + 2 * PORT_ATTEMPTS, 2)
        self._probe, self._probe_error = socket_towards(peer, first_port), 0
        # A datagram without submessages only probes whether the first participant's port is open.
        self._probe.send(wire.PROTOCOL + wire.VENDOR_ID + self.prefix)
        self._socket = bind_udp(self._probe.getsockname()[0], self._ports, SOCKET_BUFFER)
        self._own_locator: Locator = self._socket.getsockname()
        # The given address of the robot, and the address from which it sends now.
        self._peer = self.current_peer = peer
        self._entities = itertools.count(1)
        # Own endpoints by entity id.
        self._own_endpoints: dict[bytes, Writer | Reader] = {}
        # The own readers of each remote writer whose messages are addressed to all readers; cleared
        # before endpoints are matched or removed.
        self._readers_by_writer: dict[bytes, list[Reader]] = {}
        # Own writers that announce endpoints.
        self._announcers: dict[Kind, Writer] = {}
        # Remote participants that are present now, by GUID prefix.
        self.remotes: dict[bytes, RemoteParticipant] = {}
        # Remote endpoints by GUID.
        self._endpoints: dict[bytes, Endpoint] = {}
        self._announcements = itertools.count(1)
        self._eager_count = EAGER_ANNOUNCEMENTS
        # Held by the thread that receives.
        self._receiving = _thread.allocate_lock()
        # Wall time until which a thread of the program receives [s].
        self._covered_end = 0.0
        # Datagrams whose processing was interrupted, and their senders' addresses.
        self._interrupted: deque[tuple[bytes, str]] = deque(maxlen=MAX_DATAGRAMS)
        for kind, pair in SEDP.items():
            writer, reader = (Endpoint(self.prefix + entity, "", "", DISCOVERY_QOS) for entity in pair)
            self._announcers[kind] = announcer = Writer(self, writer)
            self._own_endpoints |= {pair[0]: announcer, pair[1]: Reader(self, reader, self._on_sedp)}
        self.is_open = True
        _thread.start_new_thread(self._run, ())

    def peer_error(self) -> int:
        """Return the error number with which the robot's computer or network rejects datagrams, or 0."""
        with self.lock:
            if self.is_open and not self._probe_error:
                self._probe_error = self._probe.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        return self._probe_error

    def silent_seconds(self) -> float:
        """Return for how long no remote participant has sent anything [s]; 0 if none is present."""
        with self.lock:
            return wall.monotonic() - self._last_received_at if self.remotes else 0.0

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
            self._readers_by_writer.clear()
            self._own_endpoints[endpoint.guid[PREFIX_SIZE:]] = own
            description = wire.describe(endpoint, self.guid, self._own_locator)
            self._announcers[endpoint.kind].write(description)
            for remote in tuple(self._endpoints.values()):
                _match(own, remote)
        return own

    def readers(self) -> list[Reader]:
        """Return the readers of this participant."""
        with self.lock:
            return [own for own in self._own_endpoints.values() if isinstance(own, Reader)]

    def write(self, writer: Writer, data: bytes, inline_qos: bytes = b"") -> int:
        """Publish a message and return its sequence number. May be called from any thread."""
        with self.lock:
            return writer.write(data, inline_qos) if self.is_open else 0

    def remove(self, endpoint: Endpoint) -> None:
        """Remove a writer or a reader from the network."""
        with self.lock:
            self._readers_by_writer.clear()
            self._own_endpoints.pop(endpoint.guid[PREFIX_SIZE:], None)
            if self.is_open:
                self._announcers[endpoint.kind].write(*wire.disposal(Pid.ENDPOINT, endpoint.guid))

    def close(self) -> None:
        """Leave the domain as soon as reliable messages have been acknowledged.

        Further calls have no effect.
        """
        deadline = wall.monotonic() + LINGER_SECONDS
        while self.is_open and wall.monotonic() < deadline:
            with self.lock:
                writers = [own for own in self._own_endpoints.values() if isinstance(own, Writer)]
                if not any(writer.unacknowledged_readers() for writer in writers):
                    break
            wall.sleep(POLL_SECONDS)
        with self.lock:
            if not self.is_open:
                return
            self._send_spdp(self._ports_of_robot(), *wire.disposal(Pid.PARTICIPANT, self.guid))
            self.is_open = False
        # A thread that waits for a datagram releases the lock, unless this call has interrupted it.
        is_unused = self._receiving.acquire(timeout=1.0)
        self._socket.close()
        self._probe.close()
        if is_unused:
            self._receiving.release()

    def send(self, parts: Iterable[Buffer], locators: Iterable[Locator], prefix: bytes = b"") -> None:
        """Send submessages, given in parts, to one participant or to all at the locators."""
        info = wire.submessage(wire.INFO_DST, 0, prefix) if prefix else ()
        datagram = b"".join((wire.PROTOCOL, wire.VENDOR_ID, self.prefix, *info, *parts))
        for address in locators if self.is_open else ():
            # If the buffer is full or an address unreachable, the datagram is lost, and the
            # protocol resends it.
            with contextlib.suppress(OSError):
                self._socket.sendto(datagram, address)
            if len(datagram) > LARGE_DATAGRAM:
                # Linux keeps about four large datagrams for a receiver on the same computer, and
                # drops further ones. A busy computer lets it run only if this thread yields.
                wall.sleep(0.0)

    # Discovery of participants.

    def _ports_of_robot(self) -> list[Locator]:
        """Return the addresses of the participants that may run on the robot."""
        hosts = dict.fromkeys((self._peer, self.current_peer))
        return [(host, port) for host in hosts for port in self._ports[:ASKED_PARTICIPANTS]]

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
        change = Change(next(self._announcements), data, inline_qos, wall.time_ns())
        self.send(change.encode(self.prefix + wire.SPDP_WRITER, wire.SPDP_READER), locators)

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
        host = self._choose_host([host for host, _ in locators], sender)
        builtin = _locators_at(host, locators)
        defaults = _locators_at(host, parameters.locators(Pid.DEFAULT_UNICAST) or locators)
        now, remote = wall.monotonic(), self.remotes.get(prefix)
        if remote is not None:
            self._move(prefix, remote, host)
        else:
            if len(self.remotes) >= MAX_PARTICIPANTS:
                raise ValueError("too many participants")
            self._announce(builtin)
            self._eager_count = EAGER_ANNOUNCEMENTS
            remote = RemoteParticipant(host, defaults, lease_end, now + CHECK_SECONDS)
        remote.lease_end, remote.locators = lease_end, defaults
        self._match_discovery(prefix, remote, builtin)
        self.remotes[prefix] = remote

    def _match_discovery(
        self, prefix: bytes, remote: RemoteParticipant, locators: tuple[Locator, ...]
    ) -> None:
        """Match the endpoints by which this and a remote participant announce endpoints.

        DDS does not authenticate datagrams. One in the name of the remote participant can remove
        its endpoints, or make it appear that messages have been received. So the newest message is
        requested now and then, and all of them after malformed datagrams.
        """
        is_due = wall.monotonic() >= remote.check_at
        self._readers_by_writer.clear()
        for writer, reader in SEDP.values():
            for entity, other in ((writer, reader), (reader, writer)):
                endpoint = Endpoint(prefix + other, "", "", DISCOVERY_QOS, locators=locators)
                own = self._own_endpoints[entity]
                matched = own.matched.get(endpoint.guid)
                if matched is None or (is_due and remote.is_suspect):
                    own.match(endpoint)
                    continue
                matched.endpoint = endpoint
                if is_due and isinstance(matched, MatchedWriter):
                    matched.requests = 1
        if is_due:
            remote.check_at, remote.is_suspect = wall.monotonic() + CHECK_SECONDS, False

    def _choose_host(self, hosts: list[str], sender: str) -> str:
        """Choose one address of a remote participant.

        A robot often has several networks, of which only one is this participant's: a TurtleBot 4
        also announces the address of its internal network. A robot whose address has changed still
        announces the old one.
        """
        if sender not in ("", self._peer, *hosts):
            return sender
        if self._peer in hosts or not hosts:
            return self._peer
        return max(hosts, key=lambda host: common_bits(host, self._own_locator[0]))

    def _move(self, prefix: bytes, remote: RemoteParticipant, host: str) -> None:
        """Send to a participant at its present address."""
        if remote.host == host:
            return
        # The participant's endpoints keep their state, so that no message is lost or delivered twice.
        for matched in [matched for own in self._own_endpoints.values() for matched in own.matched.values()]:
            if matched.endpoint.guid[:PREFIX_SIZE] == prefix:
                locators = _locators_at(host, matched.endpoint.locators)
                matched.endpoint = replace(matched.endpoint, locators=locators)
        remote.locators = _locators_at(host, remote.locators)
        if remote.host == self.current_peer:
            self.current_peer = host
        remote.host = host

    def _remove_participant(self, prefix: bytes) -> None:
        """Remove a participant and its endpoints."""
        builtin = [prefix + entity for pair in SEDP.values() for entity in pair]
        for guid in [guid for guid in self._endpoints if guid[:PREFIX_SIZE] == prefix] + builtin:
            self._remove_endpoint(guid)
        self.remotes.pop(prefix, None)

    # Discovery of endpoints.

    def _on_sedp(self, sample: ReceivedSample) -> None:
        """Process the announcement or departure of an endpoint, unless it is malformed."""
        try:
            self._update_endpoint(sample)
        except MALFORMED as error:
            self._drop(error, sample.writer[:PREFIX_SIZE])

    def _drop(self, error: Exception, sender: bytes) -> None:
        """Count a malformed datagram."""
        self.dropped[type(error).__name__] += 1
        if (remote := self.remotes.get(sender)) is not None:
            remote.is_suspect = True

    def _update_endpoint(self, sample: ReceivedSample) -> None:
        if sample.is_disposed:
            guid = sample.key or ParameterList.from_payload(sample.data).first(Pid.ENDPOINT)
            self._remove_endpoint(guid)
            return
        parameters = ParameterList.from_payload(sample.data)
        guid = parameters.first(Pid.ENDPOINT)[:16]
        if guid not in self._endpoints and len(self._endpoints) >= MAX_ENDPOINTS:
            raise ValueError("too many endpoints")
        remote = self.remotes.get(guid[:PREFIX_SIZE])
        host, default_locators = (remote.host, remote.locators) if remote else (self._peer, ())
        topic, type_name = parameters.string(Pid.TOPIC), parameters.string(Pid.TYPE)
        # Cyclone DDS has a header in requests and replies, which neither side would understand.
        if guid.startswith(wire.CYCLONE_DDS) and topic.startswith(("rq/", "rr/")):
            return
        qos, user_data = parameters.qos(wire.kind_of(guid)), parameters.octets(Pid.USER_DATA)
        locators = _locators_at(host, parameters.locators(Pid.UNICAST)) or default_locators
        # An empty sequence of partitions has the length 0.
        has_partition = parameters.number(Pid.PARTITION, 0) > 0
        endpoint = Endpoint(guid, topic, type_name, qos, user_data, locators, has_partition)
        known = self._endpoints.get(guid)
        if known is not None and replace(known, locators=locators) != endpoint:
            self._remove_endpoint(guid)
        if guid not in self._endpoints:
            self._on_endpoint(endpoint, True)
        self._endpoints[guid] = endpoint
        self._readers_by_writer.clear()
        for own in tuple(self._own_endpoints.values()):
            if (matched := own.matched.get(guid)) is not None:
                matched.endpoint = endpoint
            _match(own, endpoint)

    def _remove_endpoint(self, guid: bytes) -> None:
        self._readers_by_writer.clear()
        for own in self._own_endpoints.values():
            own.matched.pop(guid, None)
        if guid in self._endpoints:
            self._on_endpoint(self._endpoints[guid], False)
            del self._endpoints[guid]

    # Receiving.

    def _run(self) -> None:
        next_announcement = next_heartbeat = 0.0
        while self.is_open:
            now = wall.monotonic()
            if now >= next_announcement or self._eager_count == EAGER_ANNOUNCEMENTS:
                next_announcement = now + (EAGER_SECONDS if self._eager_count else ANNOUNCE_SECONDS)
                self._eager_count = max(0, self._eager_count - 1)
                if not (self.remotes or self._eager_count):
                    # The address of a missing robot's name may have changed.
                    with contextlib.suppress(CourseError):
                        peer = resolve(self._host)
                        if peer != self._peer:
                            self._peer = self.current_peer = peer
                with self.lock:
                    self._announce(self._ports_of_robot())
                    for prefix, remote in tuple(self.remotes.items()):
                        if remote.lease_end < now:
                            self._remove_participant(prefix)
            with self.lock:
                if now >= next_heartbeat:
                    next_heartbeat = now + HEARTBEAT_SECONDS
                    for own in self._own_endpoints.values():
                        own.tick()
                    if self.silent_seconds() > ASK_SECONDS:
                        # An idle robot announces itself only every few seconds.
                        for reader in self._announcers["writer"].matched.values():
                            self._announcers["writer"].send_heartbeat(reader)
                while self._interrupted:
                    self.receive(*self._interrupted.popleft())
            now = wall.monotonic()
            wait = max(0.0, min(next_announcement, next_heartbeat) - now)
            if now < self._covered_end:
                wall.sleep(min(wait, self._covered_end - now))
            else:
                with self._receiving:
                    self._receive_all(wait)

    def receive_for(self, seconds: float) -> bool:
        """Receive in the calling thread until a datagram has arrived, at most for `seconds`.

        Return False immediately if the participant's thread is receiving. It stops after the next
        datagram.
        """
        self._covered_end = wall.monotonic() + seconds + HANDOVER_SECONDS
        if not self._receiving.acquire(blocking=False):
            return False
        try:
            self._receive_all(seconds)
        finally:
            self._receiving.release()
            self._covered_end = wall.monotonic() + HANDOVER_SECONDS
        return True

    def _receive_all(self, seconds: float) -> None:
        """Process the datagrams that have arrived, or wait at most for `seconds` for the first."""
        if not (self.is_open and select.select([self._socket], [], [], seconds)[0]):
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
                    if sender in self.remotes:
                        self._last_received_at = wall.monotonic()
        except MALFORMED as error:
            self._drop(error, sender)
        except KeyboardInterrupt:
            self._interrupted.append((data, host))
            raise

    def _process(self, data: bytes, host: str) -> None:
        for received in wire.read_datagram(data, self.prefix):
            if received.kind in (wire.DATA, wire.DATA_FRAG):
                self._on_data(received, host)
            elif received.kind in (wire.ACKNACK, wire.NACK_FRAG, wire.HEARTBEAT, wire.GAP):
                self._on_state(received)

    def _on_data(self, received: wire.Submessage, host: str) -> None:
        """Process a message, or fragments of one, that `host` has sent."""
        body, order = received.body, received.order
        offset, reader_entity, writer_entity = received.unpack("H4s4s", 2)
        begin, related, is_disposed, key = 4 + offset, None, False, b""
        if received.flags & 0x02:
            inline = ParameterList(body, order, begin)
            begin, key = inline.end, inline.first(Pid.KEY_HASH)
            is_disposed = bool(inline.first(Pid.STATUS, bytes(4))[3] & wire.DISPOSED[3])
            identity = inline.first(Pid.RELATED) or inline.first(Pid.RELATED_OLD)
            if identity:
                related = wire.RequestId(identity[:16], wire.read_sequence_number(identity, 16, order))
        data = bytes(body[begin:]) if received.kind == wire.DATA else b""
        writer, number = received.source + writer_entity, received.sequence_number(12)
        sample = ReceivedSample(data, writer, number, received.stamp_ns, related, is_disposed, key)
        if writer_entity == wire.SPDP_WRITER:
            self._on_spdp(sample, host)
        for reader in self._readers_of(reader_entity, writer):
            if received.kind == wire.DATA:
                reader.on_data(sample)
            else:
                reader.on_fragments(sample, body[begin:], *received.unpack("IHHI", 20))

    def _on_state(self, received: wire.Submessage) -> None:
        """Process a remote reader's acknowledgement, or a remote writer's heartbeat or gap."""
        kind, source, (reader, writer) = received.kind, received.source, received.unpack("4s4s", 0)
        number, is_final = received.sequence_number(8), bool(received.flags & wire.FINAL)
        if kind in (wire.HEARTBEAT, wire.GAP):
            end, guid = received.sequence_number(16), source + writer
            if number > end + 1:
                raise ValueError("a range that ends before it begins")
            for own in self._readers_of(reader, guid):
                if kind == wire.HEARTBEAT:
                    count = received.unpack("i", 24)
                    own.on_heartbeat(guid, number, end, *count, is_final=is_final)
                else:
                    own.on_gap(guid, number, end, received.numbers(24, end))
        elif isinstance(addressed := self._own_endpoints.get(writer), Writer):
            if kind == wire.ACKNACK:
                addressed.on_acknack(source + reader, number, received.numbers(16, number), is_final=is_final)
            else:
                (base,) = received.unpack("I", 16)
                addressed.on_nack_frag(source + reader, number, received.numbers(20, base))

    def _readers_of(self, entity: bytes, writer: bytes) -> list[Reader]:
        """Return the readers to which a submessage of a remote writer is addressed."""
        if entity == wire.UNKNOWN_ENTITY:
            readers = self._readers_by_writer.get(writer)
            if readers is None:
                readers = [own for own in self.readers() if writer in own.matched]
                # Unknown writers are not remembered, because their number has no limit.
                if readers:
                    self._readers_by_writer[writer] = readers
            return readers
        own = self._own_endpoints.get(entity)
        return [own] if isinstance(own, Reader) and writer in own.matched else []


def _locators_at(host: str, locators: tuple[Locator, ...]) -> tuple[Locator, ...]:
    """Return the locator at a host.

    If none is announced there, the first one's port at that host.
    """
    there = tuple(locator for locator in locators if locator[0] == host)
    return (there or tuple((host, port) for _, port in locators))[:1]


def _match(own: Writer | Reader, remote: Endpoint) -> None:
    """Match two endpoints if DDS connects them and they have not been matched yet."""
    topic, ends = own.endpoint.topic, {own.endpoint.kind: own.endpoint, remote.kind: remote}
    if len(ends) < 2 or not topic or remote.has_partition or remote.guid in own.matched:
        return
    if (topic, own.endpoint.type_name) != (remote.topic, remote.type_name):
        return
    if find_incompatible_policy(ends["writer"].qos, ends["reader"].qos) is None:
        own.match(remote)
