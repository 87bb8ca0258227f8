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
from collections.abc import Callable, Iterable
from dataclasses import replace

from course_lib.errors import CourseError
from course_lib.ros.dds.endpoints import (
    MatchedReader,
    MatchedWriter,
    Reader,
    ReceivedSample,
    Writer,
    data_submessage,
)
from course_lib.ros.dds.wire import (
    ACKNACK,
    BUILTIN_ENDPOINTS,
    DATA,
    DATA_FRAG,
    DISPOSED,
    GAP,
    HEADER_SIZE,
    HEARTBEAT,
    INFO_DST,
    NACK_FRAG,
    PARTICIPANT_ENTITY,
    PL_CDR_LE,
    PREFIX_SIZE,
    PROTOCOL,
    PUBLICATIONS_READER,
    PUBLICATIONS_WRITER,
    SPDP_READER,
    SPDP_WRITER,
    SUBSCRIPTIONS_READER,
    SUBSCRIPTIONS_WRITER,
    UNKNOWN_ENTITY,
    USER_READER,
    USER_WRITER,
    VENDOR_ID,
    Buffer,
    Endpoint,
    Locator,
    ParameterList,
    Pid,
    RequestId,
    Submessage,
    describe,
    disposal,
    duration,
    locator,
    octets,
    parameter_list,
    read_bitmap,
    read_datagram,
    read_parameters,
    read_sequence_number,
    string,
    submessage,
    timestamp,
)
from course_lib.ros.graph.topics import Qos, find_incompatible_policy
from course_lib.ros.time import wall

PORT_BASE, PORTS_PER_DOMAIN, FIRST_UNICAST = 7400, 250, 10
# Number of participants on the robot that are contacted.
ASKED_PARTICIPANTS = 40
PORT_ATTEMPTS = 120
ANNOUNCE_SECONDS, EAGER_SECONDS, HEARTBEAT_SECONDS = 2.0, 0.1, 0.1
# A participant that has just started misses the first announcements.
EAGER_ANNOUNCEMENTS = 10
LEASE_SECONDS = 20.0
# Time without a datagram after which the remote participants are asked for an answer [s].
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
SEDP = (
    (PUBLICATIONS_WRITER, PUBLICATIONS_READER),
    (SUBSCRIPTIONS_WRITER, SUBSCRIPTIONS_READER),
)

# Called with an endpoint, and False if it was removed.
OnEndpoint = Callable[[Endpoint, bool], None]


def resolve(host: str) -> str:
    """Return the IPv4 address of a host.

    Raises:
        CourseError: The name is unknown.
    """
    try:
        return socket.gethostbyname(host)
    except OSError as error:
        raise CourseError(
            f"There is no computer {host!r} in this network ({error.strerror or error}): write the "
            "robot's address like dds/192.168.1.5."
        ) from error


def common_bits(address: str, other: str) -> int:
    """Return the number of leading bits that two IPv4 addresses have in common."""
    first, second = (int.from_bytes(socket.inet_aton(text), "big") for text in (address, other))
    return 32 - (first ^ second).bit_length()


def socket_towards(host: str, port: int) -> socket.socket:
    """Return a socket that is connected to a port, which notices if nothing listens there.

    Raises:
        CourseError: No network leads to the host.
    """
    probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        probe.connect((host, port))
    except OSError as error:
        probe.close()
        raise CourseError(
            f"No network of this computer leads to {host} ({error.strerror or error}). Is it the "
            "robot's address, and are both in the same network?"
        ) from error
    return probe


class Participant:
    """A participant of a domain, with its own thread.

    Args:
        domain: ROS_DOMAIN_ID.
        peer: IPv4 address of the robot.
        on_endpoint: Called with each remote endpoint that joins or leaves, in the thread that
            receives.

    Raises:
        CourseError: No port is free, or no network leads to the robot.
    """

    def __init__(self, domain: int, peer: str, on_endpoint: OnEndpoint) -> None:
        self.domain, self._on_endpoint = domain, on_endpoint
        self.prefix = VENDOR_ID + os.urandom(PREFIX_SIZE - len(VENDOR_ID))
        self.guid = self.prefix + PARTICIPANT_ENTITY
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
        self._probe.send(PROTOCOL + VENDOR_ID + self.prefix)
        self._socket = self._bind(base)
        self._own_locator: Locator = (self._address, self._socket.getsockname()[1])
        # The given address of the robot, and the address from which it sends now.
        self._peer = self.current_peer = peer
        self._entities = itertools.count(1)
        # Own writers by entity id.
        self._writers: dict[bytes, Writer] = {}
        self._readers: dict[bytes, Reader] = {}
        # End of the lease in wall time [s], by the GUID prefix of a remote participant.
        self._leases: dict[bytes, float] = {}
        # Its present address, and the locators of endpoints that have none of their own.
        self._hosts: dict[bytes, str] = {}
        self._default_locators: dict[bytes, tuple[Locator, ...]] = {}
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
        for writer, reader in SEDP:
            self._writers[writer] = Writer(self, Endpoint(self.prefix + writer, "", "", DISCOVERY_QOS))
            endpoint = Endpoint(self.prefix + reader, "", "", DISCOVERY_QOS)
            self._readers[reader] = Reader(self, endpoint, self._on_sedp)
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
        return bool(self._leases)

    def silent_seconds(self) -> float:
        """Return for how long no remote participant has sent anything [s]; 0 if none is present."""
        with self.lock:
            return wall.monotonic() - self._heard_at if self._leases else 0.0

    def add_writer(self, topic: str, type_name: str, qos: Qos, user_data: bytes = b"") -> Writer:
        """Create a writer and announce it."""
        with self.lock:
            endpoint = self._new_endpoint(USER_WRITER, topic, type_name, qos, user_data)
            writer = self._writers[endpoint.guid[PREFIX_SIZE:]] = Writer(self, endpoint)
            self._announce_endpoint(endpoint)
            for remote in tuple(self._endpoints.values()):
                if remote.kind == "reader" and _is_match(writer.endpoint, remote):
                    writer.match(remote)
            return writer

    def add_reader(
        self,
        topic: str,
        type_name: str,
        qos: Qos,
        on_sample: Callable[[ReceivedSample], None],
        user_data: bytes = b"",
    ) -> Reader:
        """Create a reader and announce it. `on_sample` is called in the thread that receives."""
        with self.lock:
            endpoint = self._new_endpoint(USER_READER, topic, type_name, qos, user_data)
            reader = self._readers[endpoint.guid[PREFIX_SIZE:]] = Reader(self, endpoint, on_sample)
            self._announce_endpoint(endpoint)
            for remote in tuple(self._endpoints.values()):
                if remote.kind == "writer" and _is_match(remote, reader.endpoint):
                    reader.match(remote)
            return reader

    def incomplete_topics(self) -> list[tuple[str, int, int]]:
        """Return topic, number and size [B] of messages that arrived in part, where these are most."""
        with self.lock:
            return [
                (reader.endpoint.topic, reader.incomplete, reader.incomplete_size)
                for reader in self._readers.values()
                if reader.incomplete > reader.complete
            ]

    def write(self, writer: Writer, data: bytes, inline_qos: bytes = b"") -> int:
        """Publish a message and return its sequence number. May be called from any thread."""
        with self.lock:
            return writer.write(data, inline_qos, wall.time_ns()) if self.is_open else 0

    def remove(self, endpoint: Endpoint) -> None:
        """Remove a writer or a reader from the network."""
        with self.lock:
            self._writers.pop(endpoint.guid[PREFIX_SIZE:], None)
            self._readers.pop(endpoint.guid[PREFIX_SIZE:], None)
            announcer = PUBLICATIONS_WRITER if endpoint.kind == "writer" else SUBSCRIPTIONS_WRITER
            if self.is_open:
                self._writers[announcer].write(*disposal(Pid.ENDPOINT, endpoint.guid), wall.time_ns())

    def close(self) -> None:
        """Leave the domain as soon as reliable messages have been acknowledged.

        Further calls have no effect.
        """
        deadline = wall.monotonic() + LINGER_SECONDS
        while self.is_open and wall.monotonic() < deadline and not self._is_acknowledged():
            wall.sleep(POLL_SECONDS)
        with self.lock:
            if not self.is_open:
                return
            data, inline_qos = disposal(Pid.PARTICIPANT, self.guid)
            self._send_spdp(self._ports_of_robot(), data, inline_qos)
            self.is_open = False
        # The thread may be ending at this moment, so the waits have a timeout.
        self._ended.acquire(timeout=1.0)
        self._receiving.acquire(timeout=1.0)
        self._socket.close()
        self._probe.close()

    def _is_acknowledged(self) -> bool:
        with self.lock:
            return all(writer.is_acknowledged() for writer in self._writers.values())

    def send(
        self, submessages: Iterable[Buffer], locators: Iterable[Locator], destination: bytes = b""
    ) -> None:
        """Send submessages to addresses, for one participant or for all participants there."""
        info = submessage(INFO_DST, 0, destination) if destination else b""
        datagram = b"".join((PROTOCOL, VENDOR_ID, self.prefix, info, *submessages))
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
        here = locator(self._own_locator)
        data = PL_CDR_LE + parameter_list(
            (Pid.VERSION, PROTOCOL[4:]),
            (Pid.VENDOR, VENDOR_ID),
            (Pid.DOMAIN, struct.pack("<I", self.domain)),
            (Pid.PARTICIPANT, self.guid),
            (Pid.METATRAFFIC, here),
            (Pid.DEFAULT_UNICAST, here),
            (Pid.LEASE, duration(round(LEASE_SECONDS * 1e9))),
            (Pid.BUILTIN, struct.pack("<I", BUILTIN_ENDPOINTS)),
            (Pid.NAME, string("/")),
            (Pid.USER_DATA, octets(b"enclave=/;")),
        )
        self._send_spdp(locators, data)

    def _send_spdp(self, locators: Iterable[Locator], data: bytes, inline_qos: bytes = b"") -> None:
        writer = self.prefix + SPDP_WRITER
        body = data_submessage(writer, next(self._announcements), data, inline_qos, SPDP_READER)
        self.send((timestamp(wall.time_ns()), *body), locators)

    def _on_spdp(
        self,
        payload: bytes,
        source: bytes,
        key: bytes,
        sender: str,
        *,
        is_disposed: bool,
    ) -> None:
        """Process the announcement or departure of a participant, from the address `sender`."""
        if is_disposed:
            self._remove_participant(
                key[:PREFIX_SIZE] or ParameterList(payload).first(Pid.PARTICIPANT)[:PREFIX_SIZE]
            )
            return
        parameters = ParameterList(payload)
        prefix = parameters.first(Pid.PARTICIPANT)[:PREFIX_SIZE] or source
        if prefix == self.prefix or parameters.number(Pid.DOMAIN, self.domain) != self.domain:
            return
        lease_ns = parameters.duration(Pid.LEASE, default=round(LEASE_SECONDS * 1e9))
        is_new = prefix not in self._leases
        if is_new and len(self._leases) >= MAX_PARTICIPANTS:
            self.dropped["too many participants"] += 1
            return
        locators = parameters.locators(Pid.METATRAFFIC)
        host = self._choose_host(locators, sender)
        if is_new:
            default_locators = parameters.locators(Pid.DEFAULT_UNICAST) or locators
            self._default_locators[prefix] = _locators_at(host, default_locators)
            self._add_participant(prefix, _locators_at(host, locators))
        self._update_host(prefix, host)
        self._leases[prefix] = wall.monotonic() + (1e9 if lease_ns is None else lease_ns * 1e-9)

    def _add_participant(self, prefix: bytes, locators: tuple[Locator, ...]) -> None:
        """Answer a participant, and exchange endpoints with it."""
        self._announce(locators)
        self._eager = EAGER_ANNOUNCEMENTS
        for writer, reader in SEDP:
            remote_reader = Endpoint(prefix + reader, "", "", DISCOVERY_QOS, locators=locators)
            remote_writer = Endpoint(prefix + writer, "", "", DISCOVERY_QOS, locators=locators)
            self._writers[writer].match(remote_reader)
            self._readers[reader].match(remote_writer)

    def _choose_host(self, locators: tuple[Locator, ...], sender: str) -> str:
        """Choose one address of a remote participant.

        A robot often has several networks, of which only one is this participant's: a TurtleBot 4
        also announces the address of its internal network. A robot whose address has changed still
        announces the old one.
        """
        hosts = [host for host, _ in locators]
        if sender not in ("", self._peer, *hosts):
            return sender
        return max(
            hosts or [self._peer], key=lambda host: (host == self._peer, common_bits(host, self._address))
        )

    def _update_host(self, prefix: bytes, host: str) -> None:
        """Send to a participant at its present address."""
        if self._hosts.get(prefix, host) != host:
            # Its endpoints keep their state, so that no message is lost or delivered twice.
            matched: list[MatchedReader | MatchedWriter] = []
            for writer in self._writers.values():
                matched.extend(writer.readers.values())
            for reader in self._readers.values():
                matched.extend(reader.writers.values())
            for remote in matched:
                if remote.endpoint.guid[:PREFIX_SIZE] == prefix:
                    locators = _locators_at(host, remote.endpoint.locators)
                    remote.endpoint = replace(remote.endpoint, locators=locators)
            self._default_locators[prefix] = _locators_at(host, self._default_locators[prefix])
            if self._hosts[prefix] == self.current_peer:
                self.current_peer = host
        self._hosts[prefix] = host

    def _remove_participant(self, prefix: bytes) -> None:
        """Remove a participant and its endpoints."""
        if prefix not in self._leases:
            return
        builtin = [prefix + entity for pair in SEDP for entity in pair]
        for guid in [guid for guid in self._endpoints if guid[:PREFIX_SIZE] == prefix] + builtin:
            self._remove_endpoint(guid)
        self._hosts.pop(prefix, None)
        self._default_locators.pop(prefix, None)
        self._leases.pop(prefix, None)

    # Discovery of endpoints.

    def _new_endpoint(
        self,
        kind: int,
        topic: str,
        type_name: str,
        qos: Qos,
        user_data: bytes,
    ) -> Endpoint:
        guid = self.prefix + next(self._entities).to_bytes(3, "big") + bytes([kind])
        return Endpoint(guid, topic, type_name, qos, user_data)

    def _announce_endpoint(self, endpoint: Endpoint) -> None:
        announcer = PUBLICATIONS_WRITER if endpoint.kind == "writer" else SUBSCRIPTIONS_WRITER
        data = describe(endpoint, self.guid, self._own_locator)
        self._writers[announcer].write(data, b"", wall.time_ns())

    def _on_sedp(self, sample: ReceivedSample) -> None:
        """Process the announcement or departure of an endpoint, unless it is malformed."""
        try:
            self._update_endpoint(sample)
        except MALFORMED as error:
            self.dropped[type(error).__name__] += 1

    def _update_endpoint(self, sample: ReceivedSample) -> None:
        parameters = ParameterList(sample.data)
        guid = parameters.first(Pid.ENDPOINT) or parameters.first(Pid.KEY_HASH)
        if len(guid) != 16:
            raise ValueError("an endpoint without a GUID")
        if sample.is_disposed:
            self._remove_endpoint(guid)
            return
        if guid not in self._endpoints and len(self._endpoints) >= MAX_ENDPOINTS:
            self.dropped["too many endpoints"] += 1
            return
        host = self._hosts.get(guid[:PREFIX_SIZE], self._peer)
        own_locators = _locators_at(host, parameters.locators(Pid.UNICAST))
        endpoint = Endpoint(
            guid,
            parameters.string(Pid.TOPIC),
            parameters.string(Pid.TYPE),
            parameters.qos("writer" if guid[15] & 0x0F in (2, 3) else "reader"),
            parameters.octets(Pid.USER_DATA),
            own_locators or self._default_locators.get(guid[:PREFIX_SIZE], ()),
            # An empty sequence of partitions has the length 0.
            has_partition=parameters.number(Pid.PARTITION, 0) > 0,
        )
        if guid not in self._endpoints:
            self._on_endpoint(endpoint, True)
            self._endpoints[guid] = endpoint
        if endpoint.kind == "writer":
            for reader in tuple(self._readers.values()):
                if _is_match(endpoint, reader.endpoint):
                    reader.match(endpoint)
        else:
            for writer in tuple(self._writers.values()):
                if _is_match(writer.endpoint, endpoint):
                    writer.match(endpoint)

    def _remove_endpoint(self, guid: bytes) -> None:
        for writer in self._writers.values():
            writer.readers.pop(guid, None)
        for reader in self._readers.values():
            reader.writers.pop(guid, None)
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
                with self.lock:
                    self._announce(self._ports_of_robot())
                    for prefix in [prefix for prefix, end in self._leases.items() if end < now]:
                        self._remove_participant(prefix)
            if now >= next_heartbeat:
                next_heartbeat = now + HEARTBEAT_SECONDS
                with self.lock:
                    for writer in self._writers.values():
                        writer.tick()
                    for reader in self._readers.values():
                        reader.tick()
                    if self.silent_seconds() > ASK_SECONDS:
                        # An idle robot announces itself only every few seconds.
                        self._writers[PUBLICATIONS_WRITER].request_acknowledgements()
            while self._interrupted:
                self.receive(*self._interrupted.popleft())
            now = wall.monotonic()
            wait = max(0.0, min(next_announcement, next_heartbeat) - now)
            if now < self._covered_until:
                wall.sleep(min(wait, self._covered_until - now))
            else:
                with self._receiving:
                    self._receive_all(wait)

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
        self.datagrams += data[HEADER_SIZE - PREFIX_SIZE : HEADER_SIZE] != self.prefix
        try:
            with self.lock:
                if self.is_open:
                    self._process(data, host)
                    if data[HEADER_SIZE - PREFIX_SIZE : HEADER_SIZE] in self._leases:
                        self._heard_at = wall.monotonic()
        except MALFORMED as error:
            self.dropped[type(error).__name__] += 1
        except KeyboardInterrupt:
            self._interrupted.append((data, host))
            raise

    def _process(self, data: bytes, host: str) -> None:
        for received in read_datagram(data, self.prefix):
            if not received.is_for or received.source == self.prefix:
                continue
            if received.kind in (DATA, DATA_FRAG):
                self._on_data(received, host)
            elif received.kind in (ACKNACK, NACK_FRAG):
                self._on_nack(received)
            elif received.kind in (HEARTBEAT, GAP):
                self._on_writer_state(received)

    def _on_data(self, received: Submessage, host: str) -> None:
        body, order = received.body, received.order
        reader_entity, writer_entity = bytes(body[4:8]), bytes(body[8:12])
        number = read_sequence_number(body, 12, order)
        begin = 4 + struct.unpack_from(f"{order}H", body, 2)[0]
        related, status, key = None, 0, b""
        if received.flags & 0x02:
            inline, begin = read_parameters(body, order, begin)
            for pid, value in inline:
                if pid in (Pid.RELATED, Pid.RELATED_OLD):
                    related = RequestId(value[:16], read_sequence_number(value, 16, order))
                elif pid == Pid.STATUS:
                    status = value[3]
                elif pid == Pid.KEY_HASH:
                    key = value
        is_disposed = bool(status & DISPOSED[3])
        if writer_entity == SPDP_WRITER:
            self._on_spdp(bytes(body[begin:]), received.source, key, host, is_disposed=is_disposed)
            return
        payload = b""
        if received.kind == DATA:
            payload = (
                bytes(body[begin:])
                if received.flags & 0x0C
                else PL_CDR_LE + parameter_list((Pid.KEY_HASH, key))
            )
        sample = ReceivedSample(
            payload, received.source + writer_entity, number, received.stamp_ns, related, is_disposed
        )
        for reader in self._readers_of(reader_entity, sample.writer):
            if received.kind == DATA:
                reader.on_data(sample)
            else:
                first, count, fragment_size, size = struct.unpack_from(f"{order}IHHI", body, 20)
                reader.on_fragment(sample, first, count, fragment_size, size, body[begin:])

    def _on_nack(self, received: Submessage) -> None:
        """Process a remote reader's report of missing messages."""
        body, order = received.body, received.order
        reader, writer = received.source + body[:4], self._writers.get(bytes(body[4:8]))
        if writer is None:
            return
        number = read_sequence_number(body, 8, order)
        if received.kind == ACKNACK:
            missing = read_bitmap(body, 16, number, order)
            writer.on_acknack(reader, number, missing, is_final=bool(received.flags & 0x02))
        else:
            (base,) = struct.unpack_from(f"{order}I", body, 16)
            writer.on_nack_frag(reader, number, read_bitmap(body, 20, base, order))

    def _on_writer_state(self, received: Submessage) -> None:
        """Process a remote writer's heartbeat, or its gap of messages that it no longer has."""
        body, order = received.body, received.order
        writer = received.source + body[4:8]
        first, second = (read_sequence_number(body, at, order) for at in (8, 16))
        for reader in self._readers_of(bytes(body[:4]), writer):
            if received.kind == HEARTBEAT:
                (count,) = struct.unpack_from(f"{order}i", body, 24)
                reader.on_heartbeat(writer, first, second, count, is_final=bool(received.flags & 0x02))
            else:
                reader.on_gap(writer, first, second, read_bitmap(body, 24, second, order))

    def _readers_of(self, entity: bytes, writer: bytes) -> list[Reader]:
        """Return the readers to which a submessage of a remote writer is addressed."""
        if entity == UNKNOWN_ENTITY:
            return [reader for reader in self._readers.values() if writer in reader.writers]
        reader = self._readers.get(entity)
        return [] if reader is None or writer not in reader.writers else [reader]


def _locators_at(host: str, locators: tuple[Locator, ...]) -> tuple[Locator, ...]:
    """Return the locator at a host.

    If none is announced there, the first one's port at that host.
    """
    if not locators:
        return ()
    return (next((locator for locator in locators if locator[0] == host), (host, locators[0][1])),)


def _is_match(writer: Endpoint, reader: Endpoint) -> bool:
    """Return whether DDS connects two endpoints."""
    return (
        bool(writer.topic)
        and (writer.topic, writer.type_name) == (reader.topic, reader.type_name)
        and not (writer.has_partition or reader.has_partition)
        and find_incompatible_policy(writer.qos, reader.qos) is None
    )
