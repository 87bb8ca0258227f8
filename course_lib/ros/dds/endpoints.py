"""Writers and readers of RTPS: matching, resending, ordering and fragments.

A reliable writer keeps its last messages and resends those that a reader reports as missing
(ACKNACK). A reliable reader delivers each writer's messages once and in order; heartbeats show it
which messages it lacks. All methods are called under the participant's lock.
"""

import itertools
import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from io import BytesIO
from typing import Generic, NamedTuple, Protocol, TypeVar

from course_lib.ros.dds import wire
from course_lib.ros.dds.wire import PREFIX_SIZE, Buffer, Endpoint, Locator, RequestId, sequence_number
from course_lib.ros.time import wall

FRAGMENT_SIZE = 60_000  # [B]
# Messages that a writer with history KEEP_ALL keeps.
KEEP_ALL_LIMIT = 10_000
# Number of times that a reader requests a writer's first heartbeat.
FIRST_REQUESTS = 20
# Limit on messages of a writer that arrived out of order.
MAX_PENDING = 256
# Limit on messages of a writer whose fragments are incomplete.
MAX_PARTIAL = 8
# Limit on the bytes of all incomplete messages of a reader.
MAX_PARTIAL_BYTES = 2 * wire.MAX_MESSAGE
# Number of consecutive signs that the numbers of a remote writer are lower than the expected ones,
# and the time between the first and the last of them [s].
RESTART_SIGNS, RESTART_SECONDS = 3, 0.25
# Memory of the number of a missing fragment [B].
FRAGMENT_OVERHEAD = 100


class ReceivedSample(NamedTuple):
    """A received message.

    Args:
        data: The message with its encapsulation header.
        writer: GUID of its writer.
        source_ns: Source time, [ns] since 1970.
        related: The request that a reply belongs to.
        is_disposed: Whether it removes an instance, which discovery uses for endpoints that leave.
        key: The GUID of that endpoint or participant, if it is not in `data`.
    """

    data: bytes
    writer: bytes
    sequence: int
    source_ns: int
    related: RequestId | None = None
    is_disposed: bool = False
    key: bytes = b""


OnSample = Callable[[ReceivedSample], None]


class Sender(Protocol):
    """The interface for sending datagrams, which the participant implements."""

    def send(self, parts: Iterable[Buffer], locators: Iterable[Locator], prefix: bytes = b"") -> None:
        """Send submessages, given in parts, addressed to one participant or to all."""


class Change(NamedTuple):
    """A message of a writer of this participant."""

    number: int
    data: bytes
    inline_qos: bytes
    at_ns: int

    @property
    def fragments(self) -> range:
        """The message's fragment numbers, counted from 1; only 0 if it is sent as a whole."""
        count = -(-len(self.data) // FRAGMENT_SIZE)
        return range(1, count + 1) if count > 1 else range(1)

    def encode(self, writer: bytes, reader: bytes, fragment: int = 0) -> tuple[Buffer, ...]:
        """Encode a timestamp and the DATA submessage, or the DATA_FRAG submessage of a fragment."""
        # 16 or 28 bytes lie between the length and the inline QoS.
        head = (struct.pack("<HH", 0, 28 if fragment else 16), reader, writer[PREFIX_SIZE:])
        kind, flags, layout, data = wire.DATA, 0x04, b"", memoryview(self.data)
        if fragment:
            kind, flags = wire.DATA_FRAG, 0
            layout = struct.pack("<IHHI", fragment, 1, FRAGMENT_SIZE, len(data))
            data = data[(fragment - 1) * FRAGMENT_SIZE : fragment * FRAGMENT_SIZE]
        flags |= 0x02 if self.inline_qos else 0
        body = (*head, sequence_number(self.number), layout, self.inline_qos, data)
        return (wire.timestamp(self.at_ns), *wire.submessage(kind, flags, *body))


@dataclass
class MatchedReader:
    """A remote reader of a writer.

    Args:
        first: The first message that it may request.
        acknowledged: It has received all messages up to this one.
    """

    endpoint: Endpoint
    first: int
    acknowledged: int


Matched = TypeVar("Matched", "MatchedReader", "MatchedWriter")


class OwnEndpoint(Generic[Matched]):
    """An endpoint of this participant, with the remote endpoints that DDS connects to it.

    Args:
        sender: Sends its datagrams.
        endpoint: Its description.
    """

    def __init__(self, sender: Sender, endpoint: Endpoint) -> None:
        self._sender, self.endpoint = sender, endpoint
        # Remote endpoints by GUID.
        self.matched: dict[bytes, Matched] = {}
        # Called when a remote endpoint has been matched.
        self.on_matched: Callable[[], None] = lambda: None
        self._counts = itertools.count(1)

    def _is_reliable(self, remote: Matched) -> bool:
        return self.endpoint.qos.is_reliable and remote.endpoint.qos.is_reliable

    def _send_to(self, remote: Endpoint, kind: int, *body: bytes, flags: int = 0) -> None:
        """Send a submessage that begins with the entities of its reader and its writer."""
        own, other = self.endpoint.guid[PREFIX_SIZE:], remote.guid[PREFIX_SIZE:]
        entities = (own, other) if self.endpoint.kind == "reader" else (other, own)
        submessage = wire.submessage(kind, flags, *entities, *body)
        self._sender.send(submessage, remote.locators, remote.guid[:PREFIX_SIZE])

    def _count(self) -> bytes:
        """Encode the number of the next heartbeat or request, which identifies repetitions."""
        return struct.pack("<I", next(self._counts))


class Writer(OwnEndpoint[MatchedReader]):
    """A writer of this participant."""

    def __init__(self, sender: Sender, endpoint: Endpoint) -> None:
        super().__init__(sender, endpoint)
        # Sequence number of the last message.
        self.last = 0
        self._history: dict[int, Change] = {}

    @property
    def first(self) -> int:
        """The sequence number of the oldest message that can be resent, or of the next message."""
        return next(iter(self._history), self.last + 1)

    def write(self, data: bytes, inline_qos: bytes = b"") -> int:
        """Send a message to all matched readers; return its sequence number."""
        self.last += 1
        change, qos = Change(self.last, data, inline_qos, wall.time_ns()), self.endpoint.qos
        if qos.is_reliable or qos.is_latched:
            self._history[self.last] = change
            if len(self._history) > (qos.limit or KEEP_ALL_LIMIT):
                del self._history[self.first]
        # Each participant has one address, and all of its readers receive the same datagram.
        addresses = {address for reader in self.matched.values() for address in reader.endpoint.locators}
        if addresses:
            guid = self.endpoint.guid
            *parts, end = [change.encode(guid, wire.UNKNOWN_ENTITY, part) for part in change.fragments]
            if qos.is_reliable:
                body = (wire.UNKNOWN_ENTITY, guid[PREFIX_SIZE:], *self._state(self.first))
                end += wire.submessage(wire.HEARTBEAT, 0, *body)
            for part in (*parts, end):
                self._sender.send(part, addresses)
        return self.last

    def match(self, endpoint: Endpoint) -> None:
        """Add a remote reader."""
        gets_history = self.endpoint.qos.is_latched and endpoint.qos.is_latched
        first = self.first if gets_history else self.last + 1
        reader = self.matched[endpoint.guid] = MatchedReader(endpoint, first, first - 1)
        if self._is_reliable(reader):
            self.send_heartbeat(reader)
        self.on_matched()

    def on_acknack(self, guid: bytes, base: int, missing: list[int], *, is_final: bool) -> None:
        """Process a reader's report of received messages, and resend the missing ones."""
        if (reader := self.matched.get(guid)) is None:
            return
        # The number is lower than before if the reader has restarted with the same GUID. A late
        # report makes no difference, because the next heartbeat is answered with the present number.
        reader.acknowledged = min(base - 1, self.last)
        lost: list[int] = []
        for number in missing:
            if number >= reader.first and number in self._history:
                self._resend(reader, self._history[number], self._history[number].fragments)
            elif number <= self.last:
                lost.append(number)
        if lost:
            numbers = wire.number_set(lost[0] + 1, lost[1:])
            self._send_to(reader.endpoint, wire.GAP, sequence_number(lost[0]), numbers)
        if not is_final:
            self.send_heartbeat(reader)

    def on_nack_frag(self, guid: bytes, number: int, fragments: list[int]) -> None:
        """Resend fragments of a message."""
        reader, change = self.matched.get(guid), self._history.get(number)
        if reader is not None and change is not None and number >= reader.first:
            self._resend(reader, change, [n for n in fragments if n in change.fragments])

    def tick(self) -> None:
        """Send a heartbeat to reliable readers that have not acknowledged everything."""
        for reader in self.unacknowledged_readers():
            self.send_heartbeat(reader)

    def unacknowledged_readers(self) -> list[MatchedReader]:
        """Return the reliable readers that have not received everything."""
        readers = self.matched.values()
        return [r for r in readers if self._is_reliable(r) and r.acknowledged < self.last]

    def send_heartbeat(self, reader: MatchedReader) -> None:
        """Send a heartbeat that the reader has to answer."""
        self._send_to(reader.endpoint, wire.HEARTBEAT, *self._state(max(reader.first, self.first)))

    def _state(self, first: int) -> tuple[bytes, ...]:
        """Encode the part of a heartbeat that describes the messages from `first` on."""
        return sequence_number(first), sequence_number(self.last), self._count()

    def _resend(self, reader: MatchedReader, change: Change, fragments: Iterable[int]) -> None:
        for fragment in fragments:
            data = change.encode(self.endpoint.guid, reader.endpoint.guid[PREFIX_SIZE:], fragment)
            self._sender.send(data, reader.endpoint.locators)


class PartialMessage:
    """A message whose fragments are being received.

    Args:
        size: Size of the message, [bytes].
        fragment_size: Size of each fragment except the last, [bytes].

    Raises:
        ValueError: No message has these sizes.
    """

    def __init__(self, size: int, fragment_size: int) -> None:
        if not (fragment_size > 0 and 0 < size <= wire.MAX_MESSAGE and size // fragment_size < 2**16):
            raise ValueError("a fragmented message with an impossible size")
        self._size, self._fragment_size = size, fragment_size
        # Numbers of the fragments that have not arrived, counted from 1.
        self.missing = set(range(1, -(-size // fragment_size) + 1))
        # An upper bound on the memory of the message [bytes].
        self.memory = size + len(self.missing) * FRAGMENT_OVERHEAD
        # BytesIO grows with the fragments, and returns its bytes without a copy.
        self.data = BytesIO()

    def add(self, first: int, count: int, payload: memoryview) -> None:
        """Add consecutive fragments."""
        begin = (first - 1) * self._fragment_size
        size = min(count * self._fragment_size, self._size - begin)
        if begin < 0 or not 0 < size <= len(payload):
            raise ValueError("a fragment outside of its message")
        self.data.seek(begin)
        self.data.write(payload[:size])
        self.missing.difference_update(range(first, first + count))


@dataclass
class MatchedWriter:
    """A remote writer that is matched with a reader.

    Args:
        due: Sequence number of the next message to deliver; 0 before the first is known. A
            reliable reader learns it from a heartbeat.
        pending: Messages that arrived early, by number; None stands for a message that was skipped.
        requests: How many more times the reader requests a first heartbeat. With 0, the writer has
            matched the reader as well, or has not answered in time.
        last_heartbeat: Count of the last heartbeat. A robot may send each one over several ways.
        is_ack_due: Whether a heartbeat waits for its acknowledgement.
        signs: How many heartbeats or messages in a row were from before `due`.
        first_sign_at: Wall time of the first of them [s].
    """

    endpoint: Endpoint
    due: int = 0
    pending: dict[int, ReceivedSample | None] = field(default_factory=dict)
    partial: dict[int, PartialMessage] = field(default_factory=dict)
    requests: int = FIRST_REQUESTS
    last_heartbeat: int | None = None
    is_ack_due: bool = False
    signs: int = 0
    first_sign_at: float = 0.0

    def has_restarted(self, number: int, limit: int) -> bool:
        """Return whether the writer uses lower numbers than `due`, and forget its former numbers.

        Embedded devices keep their GUID when they restart, and number their messages from 1 again.
        A datagram that somebody else has sent in the writer's name may have increased `due`, too.
        Late datagrams also are from before `due`, but newer ones are between them.

        Args:
            number: The number of the newest message that a datagram reports or contains.
            limit: Numbers below it are a sign.
        """
        now = wall.monotonic()
        if number >= self.due - 1:
            self.signs = 0
        elif number < limit:
            self.signs += 1
            self.first_sign_at = now if self.signs == 1 else self.first_sign_at
        if self.signs < RESTART_SIGNS or now - self.first_sign_at < RESTART_SECONDS:
            return False
        self.due = self.signs = 0
        self.pending.clear()
        self.partial.clear()
        return True

    def skip_to(self, number: int) -> None:
        """Give up the messages before a number."""
        self.due = number
        self.pending = {at: sample for at, sample in self.pending.items() if at >= number}
        self.partial = {at: partial for at, partial in self.partial.items() if at >= number}


class Reader(OwnEndpoint[MatchedWriter]):
    """A reader of this participant.

    Args:
        on_sample: Called with each message, in the thread that receives. It must not raise.
    """

    def __init__(self, sender: Sender, endpoint: Endpoint, on_sample: OnSample) -> None:
        super().__init__(sender, endpoint)
        self._on_sample = on_sample
        # Number of complete messages, number of messages that were dropped because a fragment is
        # missing, and the size of the newest of these [B].
        self.complete = self.incomplete = self.incomplete_size = 0

    def match(self, endpoint: Endpoint) -> None:
        """Add a remote writer. `on_matched` is called when it has answered."""
        qos = self.endpoint.qos
        writer = self.matched[endpoint.guid] = MatchedWriter(endpoint)
        if self._is_reliable(writer):
            writer.due = 1 if qos.is_latched and qos.limit is None else 0
            writer.requests -= 1
            self._request_heartbeat(writer, 1)

    def tick(self) -> None:
        """Send acknowledgements, and request heartbeats where the numbers are uncertain."""
        for writer in self.matched.values():
            if writer.is_ack_due:
                self._send_acknack(writer, [])
            if writer.signs and self._is_reliable(writer):
                # A writer that has not restarted answers with the number of a newer message.
                self._request_heartbeat(writer, 1)
            if writer.requests and self._is_reliable(writer):
                writer.requests -= 1
                self._request_heartbeat(writer, writer.due or 1)
                if not writer.requests:
                    self.on_matched()

    def on_data(self, sample: ReceivedSample) -> None:
        """Deliver a message, or keep it until its predecessors have arrived."""
        if (writer := self._writer_of_new(sample)) is None:
            return
        self.complete += 1
        if not self._is_reliable(writer):
            self._on_sample(sample)
            writer.due = sample.sequence + 1
        elif len(writer.pending) < MAX_PENDING or sample.sequence == writer.due:
            writer.pending[sample.sequence] = sample
            self._deliver(writer)

    def on_fragments(
        self, sample: ReceivedSample, payload: memoryview, first: int, count: int, part_size: int, size: int
    ) -> None:
        """Collect consecutive fragments of a message.

        Args:
            sample: The message without its data.
            payload: The bytes of the fragments.
            first: Number of the first fragment, counted from 1.
            count: Number of fragments in the payload.
            part_size: Size of each fragment of the message except the last [B].
            size: Size of the message [B].
        """
        writer, number = self._writer_of_new(sample), sample.sequence
        if writer is None:
            return
        partial = writer.partial.get(number)
        if partial is None:
            partial = PartialMessage(size, part_size)
            self.incomplete_size = size
            # The oldest incomplete messages, of this writer first, are dropped to limit the memory.
            messages = (message for w in self.matched.values() for message in w.partial.values())
            used = partial.memory + sum(message.memory for message in messages)
            for other in (writer, *self.matched.values()):
                while other.partial and (used > MAX_PARTIAL_BYTES or len(writer.partial) >= MAX_PARTIAL):
                    used -= other.partial.pop(min(other.partial)).memory
                    self.incomplete += 1
            writer.partial[number] = partial
        partial.add(first, count, payload)
        if not partial.missing:
            del writer.partial[number]
            self.on_data(sample._replace(data=partial.data.getvalue()))

    def _writer_of_new(self, sample: ReceivedSample) -> MatchedWriter | None:
        """Return the matched writer of a message, or None for a duplicate or an unknown writer."""
        writer = self.matched.get(sample.writer)
        if writer is None:
            return None
        is_reliable = self._is_reliable(writer)
        if not is_reliable:
            # Late messages are not from long before.
            writer.has_restarted(sample.sequence, writer.due // 2)
        is_new = sample.sequence >= writer.due and sample.sequence not in writer.pending
        # A reliable writer resends messages that are too far ahead. So numbers that it will not
        # reach, sent in its name, use no memory.
        is_far = is_reliable and writer.due and sample.sequence >= writer.due + MAX_PENDING
        return writer if is_new and not is_far else None

    def on_heartbeat(self, guid: bytes, first: int, last: int, count: int, *, is_final: bool) -> None:
        """Process a heartbeat, and request the missing messages that the writer still has.

        If none is missing, the acknowledgement is sent with the next tick, for all messages until
        then.
        """
        writer = self.matched.get(guid)
        if writer is None or not self._is_reliable(writer) or count == writer.last_heartbeat:
            return
        writer.last_heartbeat = count
        if not writer.has_restarted(last, writer.due - 1) and writer.signs:
            return
        was_open, writer.requests = writer.requests > 0, 0
        limit = self.endpoint.qos.limit
        if not writer.due and self.endpoint.qos.is_latched and limit is not None:
            # As in Fast DDS, a late joiner keeps only the newest messages, even if the writer has
            # more.
            first = max(first, last - limit + 1)
        if first > writer.due:
            # The writer no longer keeps the messages before `first`. It skips messages from before
            # the match by a GAP.
            writer.skip_to(first)
        self._deliver(writer)
        end = min(last, writer.due + wire.MAX_SET - 1) + 1
        missing = [number for number in range(writer.due, end) if number not in writer.pending]
        for number in missing:
            if number in writer.partial:
                fragments = writer.partial[number].missing
                base = min(fragments)
                bitmap = wire.number_bitmap(base, [n for n in fragments if n < base + wire.MAX_SET])
                body = (sequence_number(number), struct.pack("<I", base), bitmap, self._count())
                self._send_to(writer.endpoint, wire.NACK_FRAG, *body)
        writer.is_ack_due = not is_final
        if missing:
            whole = [number for number in missing if number not in writer.partial]
            self._send_acknack(writer, whole)
        if was_open:
            self.on_matched()

    def on_gap(self, guid: bytes, first: int, base: int, others: list[int]) -> None:
        """Skip messages that will not arrive: [first, base) and `others`."""
        writer = self.matched.get(guid)
        if writer is None or not writer.due:
            return
        if first <= writer.due < base:
            writer.skip_to(base)
        for number in others:
            if writer.due <= number < writer.due + MAX_PENDING:
                writer.pending.setdefault(number, None)
        self._deliver(writer)

    def _deliver(self, writer: MatchedWriter) -> None:
        """Deliver the messages that are due."""
        while writer.due in writer.pending:
            sample = writer.pending[writer.due]
            if sample is not None:
                self._on_sample(sample)
            writer.partial.pop(writer.due, None)
            del writer.pending[writer.due]
            writer.due += 1

    def _request_heartbeat(self, writer: MatchedWriter, base: int) -> None:
        """Request a heartbeat from a writer, acknowledging all messages before `base`.

        Fast DDS answers immediately only to base 0, otherwise after up to 3 s. Cyclone DDS rejects
        base 0.
        """
        is_fast_dds = writer.endpoint.guid[:2] == wire.FAST_DDS
        numbers = wire.number_set(0 if is_fast_dds else base, [])
        self._send_to(writer.endpoint, wire.ACKNACK, numbers, self._count())

    def _send_acknack(self, writer: MatchedWriter, missing: list[int]) -> None:
        """Acknowledge all messages before the due one, and request the missing ones."""
        writer.is_ack_due = False
        numbers = wire.number_set(writer.due, missing)
        self._send_to(writer.endpoint, wire.ACKNACK, numbers, self._count(), flags=wire.FINAL)
