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

FRAGMENT_SIZE = 60_000  # [B]
# Number of a heartbeat or a request, by which its receiver recognizes repetitions.
COUNT = struct.Struct("<I")
# Messages that a writer with history KEEP_ALL keeps.
KEEP_ALL_DEPTH = 10_000
# Number of times that a reader requests a writer's first heartbeat.
FIRST_REQUESTS = 20
# Limit on messages of a writer that arrived out of order.
MAX_PENDING = 256
# Limit on messages of a writer whose fragments are incomplete.
MAX_PARTIAL = 8
# Limit on the bytes of all incomplete messages of a reader.
MAX_PARTIAL_BYTES = 2 * wire.MAX_MESSAGE
# Number of consecutive signs that a remote writer has restarted with the same GUID.
RESTART_SIGNS = 3
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

    def send(
        self, submessages: Iterable[Buffer], locators: Iterable[Locator], destination: bytes = b""
    ) -> None:
        """Send submessages, which may be in parts, addressed to one participant or to all."""


class Change(NamedTuple):
    """A message that a writer has sent."""

    data: bytes
    inline_qos: bytes
    at_ns: int


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
        return self.endpoint.is_reliable and remote.endpoint.is_reliable

    def _send_to(self, remote: Endpoint, kind: int, flags: int, body: bytes) -> None:
        """Send a submessage that begins with the entities of its reader and its writer."""
        own, other = self.endpoint.guid[PREFIX_SIZE:], remote.guid[PREFIX_SIZE:]
        entities = own + other if self.endpoint.kind == "reader" else other + own
        submessage = wire.submessage(kind, flags, entities, body)
        self._sender.send(submessage, remote.locators, remote.guid[:PREFIX_SIZE])


class Writer(OwnEndpoint[MatchedReader]):
    """A writer of this participant."""

    def __init__(self, sender: Sender, endpoint: Endpoint) -> None:
        super().__init__(sender, endpoint)
        # Sequence number of the last message.
        self.last = 0
        self._history: dict[int, Change] = {}
        qos = endpoint.qos
        self._depth = KEEP_ALL_DEPTH if qos.history == "keep_all" else max(1, qos.depth)

    def write(self, data: bytes, inline_qos: bytes, at_ns: int) -> int:
        """Send a message to all matched readers; return its sequence number."""
        self.last += 1
        change = Change(data, inline_qos, at_ns)
        if self.endpoint.is_reliable or self.endpoint.is_latched:
            self._history[self.last] = change
            if len(self._history) > self._depth:
                del self._history[next(iter(self._history))]
        # Readers at one address, of which a participant has only one, share a datagram.
        addresses = {address for reader in self.matched.values() for address in reader.endpoint.locators}
        if addresses:
            self._send(self.last, change, addresses, with_heartbeat=self.endpoint.is_reliable)
        return self.last

    def match(self, endpoint: Endpoint) -> None:
        """Add a remote reader."""
        if endpoint.guid in self.matched:
            return
        gets_history = self.endpoint.is_latched and endpoint.is_latched
        first = next(iter(self._history), self.last + 1) if gets_history else self.last + 1
        reader = self.matched[endpoint.guid] = MatchedReader(endpoint, first, first - 1)
        if self._is_reliable(reader):
            self._send_heartbeat(reader)
        self.on_matched()

    def on_acknack(self, guid: bytes, base: int, missing: list[int], *, is_final: bool) -> None:
        """Process a reader's report of received messages, and resend the missing ones."""
        reader = self.matched.get(guid)
        if reader is None:
            return
        # It is lower than before if the reader has restarted with the same GUID. A late report makes
        # no difference, because the next heartbeat is answered with the present number.
        reader.acknowledged = min(base - 1, self.last)
        lost: list[int] = []
        for number in missing:
            if number >= reader.first and number in self._history:
                locators = reader.endpoint.locators
                self._send(number, self._history[number], locators, guid[PREFIX_SIZE:])
            elif number <= self.last:
                lost.append(number)
        if lost:
            base = lost[0] + 1
            body = sequence_number(lost[0]) + sequence_number(base) + wire.number_bitmap(base, lost[1:])
            self._send_to(reader.endpoint, wire.GAP, 0, body)
        if not is_final:
            self._send_heartbeat(reader)

    def on_nack_frag(self, guid: bytes, number: int, fragments: list[int]) -> None:
        """Resend fragments of a message."""
        reader, change = self.matched.get(guid), self._history.get(number)
        if reader is None or change is None or number < reader.first:
            return
        for fragment in fragments:
            if 1 <= fragment <= -(-len(change.data) // FRAGMENT_SIZE):
                parts = self._data(number, change, guid[PREFIX_SIZE:], fragment)
                self._sender.send(parts, reader.endpoint.locators)

    def tick(self) -> None:
        """Send a heartbeat to reliable readers that have not acknowledged everything."""
        for reader in self.unacknowledged_readers():
            self._send_heartbeat(reader)

    def request_acknowledgements(self) -> None:
        """Send a heartbeat that every reader has to answer."""
        for reader in self.matched.values():
            self._send_heartbeat(reader)

    def unacknowledged_readers(self) -> list[MatchedReader]:
        """Return the reliable readers that have not received everything."""
        readers = self.matched.values()
        return [one for one in readers if self._is_reliable(one) and one.acknowledged < self.last]

    def _send_heartbeat(self, reader: MatchedReader) -> None:
        first = max(reader.first, next(iter(self._history), self.last + 1))
        self._send_to(reader.endpoint, wire.HEARTBEAT, 0, self._heartbeat_body(first))

    def _heartbeat_body(self, first: int) -> bytes:
        return sequence_number(first) + sequence_number(self.last) + COUNT.pack(next(self._counts))

    def _send(
        self,
        number: int,
        change: Change,
        locators: Iterable[Locator],
        entity: bytes = wire.UNKNOWN_ENTITY,
        *,
        with_heartbeat: bool = False,
    ) -> None:
        count = -(-len(change.data) // FRAGMENT_SIZE)
        for fragment in range(1, count):
            self._sender.send(self._data(number, change, entity, fragment), locators)
        parts = self._data(number, change, entity, count if count > 1 else 0)
        if with_heartbeat:
            entities = wire.UNKNOWN_ENTITY + self.endpoint.guid[PREFIX_SIZE:]
            body = self._heartbeat_body(next(iter(self._history), number))
            parts += wire.submessage(wire.HEARTBEAT, 0, entities, body)
        self._sender.send(parts, locators)

    def _data(self, number: int, change: Change, entity: bytes, fragment: int) -> list[Buffer]:
        data = data_submessage(self.endpoint.guid, number, change.data, change.inline_qos, entity, fragment)
        return [wire.timestamp(change.at_ns), *data]


def data_submessage(
    writer: bytes,
    number: int,
    data: bytes,
    inline_qos: bytes = b"",
    entity: bytes = wire.UNKNOWN_ENTITY,
    fragment: int = 0,
) -> tuple[Buffer, ...]:
    """Encode a DATA submessage, or the DATA_FRAG submessage of a fragment, counted from 1."""
    flags = 0x02 if inline_qos else 0
    # 16 or 28 bytes lie between the field itself and the inline QoS.
    head = struct.pack("<HH", 0, 28 if fragment else 16) + entity + writer[PREFIX_SIZE:]
    head += sequence_number(number)
    if not fragment:
        return wire.submessage(wire.DATA, flags | 0x04, head, inline_qos, data)
    head += struct.pack("<IHHI", fragment, 1, FRAGMENT_SIZE, len(data))
    part = memoryview(data)[(fragment - 1) * FRAGMENT_SIZE : fragment * FRAGMENT_SIZE]
    return wire.submessage(wire.DATA_FRAG, flags, head, inline_qos, part)


class PartialMessage:
    """A message whose fragments are being received.

    Args:
        size: Size of the message, [bytes].
        fragment_size: Size of each fragment except the last, [bytes].
    """

    def __init__(self, size: int, fragment_size: int) -> None:
        self._size, self._fragment_size = size, fragment_size
        # Numbers of the fragments that have not arrived, counted from 1.
        self.missing = set(range(1, -(-size // fragment_size) + 1))
        # Limit on the memory that it needs, [bytes].
        self.memory = size + len(self.missing) * FRAGMENT_OVERHEAD
        # It grows with the fragments, and returns its bytes without a copy.
        self._data = BytesIO()

    def add(self, first: int, count: int, payload: memoryview) -> None:
        """Add consecutive fragments."""
        begin = (first - 1) * self._fragment_size
        size = min(count * self._fragment_size, self._size - begin)
        if begin < 0 or not 0 < size <= len(payload):
            raise ValueError("a fragment outside of its message")
        self._data.seek(begin)
        self._data.write(payload[:size])
        self.missing.difference_update(range(first, first + count))

    def data(self) -> bytes:
        """Return the complete message."""
        return self._data.getvalue()


@dataclass
class MatchedWriter:
    """A remote writer of a reader.

    Args:
        due: Sequence number of the next message to deliver; None before the first is known, which
            only a heartbeat tells a reliable reader.
        pending: Messages that arrived early, by number; None stands for a message that was skipped.
        requests: How many more times the reader requests a first heartbeat.
        last_heartbeat: Count of the last heartbeat. A robot may send each one over several ways.
        is_ack_due: Whether a heartbeat waits for its acknowledgement.
        signs: How many heartbeats or messages in a row were from long before `due`, each with a
            larger count or number than the one before, `last_sign`.
    """

    endpoint: Endpoint
    due: int | None = None
    pending: dict[int, ReceivedSample | None] = field(default_factory=dict)
    partial: dict[int, PartialMessage] = field(default_factory=dict)
    requests: int = FIRST_REQUESTS
    last_heartbeat: int | None = None
    is_ack_due: bool = False
    signs: int = 0
    last_sign: int = 0

    @property
    def has_answered(self) -> bool:
        """Whether the writer has matched the reader as well, or has not answered in time."""
        return self.requests == 0

    def has_restarted(self, number: int, sign: int) -> bool:
        """Return whether the writer numbers its messages from 1 again, and forget its former numbers.

        Embedded devices keep their GUID when they restart. Late datagrams are from before `due` as
        well, but not from long before, and newer ones are between them.

        Args:
            number: The number of the newest message that a datagram tells of.
            sign: The number that grows from one datagram to the next.
        """
        if self.due is None or number >= self.due - 1:
            self.signs = 0
        elif number < self.due // 2 and (self.signs == 0 or sign > self.last_sign):
            self.signs, self.last_sign = self.signs + 1, sign
        if self.signs < RESTART_SIGNS:
            return False
        self.due, self.signs = None, 0
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
        qos = endpoint.qos
        # Number of latched messages that a late joiner receives; None is all of them.
        self._latched_depth = max(1, qos.depth) if qos.history == "keep_last" else None
        # Number of dropped messages whose fragments did not all arrive, and the size of the newest
        # [B].
        self.incomplete, self.incomplete_size = 0, 0
        # Number of complete messages.
        self.complete = 0

    def match(self, endpoint: Endpoint) -> None:
        """Add a remote writer. `on_matched` is called when it has answered."""
        if endpoint.guid in self.matched:
            return
        writer = self.matched[endpoint.guid] = MatchedWriter(endpoint)
        if self._is_reliable(writer):
            takes_all = self.endpoint.is_latched and self._latched_depth is None
            writer.due = 1 if takes_all else None
            writer.requests -= 1
            self._request_heartbeat(writer, 1)

    def tick(self) -> None:
        """Send acknowledgements, and request the first heartbeats that have not arrived yet."""
        for writer in self.matched.values():
            if writer.is_ack_due:
                self._send_acknack(writer, writer.due or 1, [], is_final=True)
            if writer.requests and self._is_reliable(writer):
                writer.requests -= 1
                self._request_heartbeat(writer, writer.due or 1)
                if writer.has_answered:
                    self.on_matched()

    def on_data(self, sample: ReceivedSample) -> None:
        """Deliver a message, or keep it until its predecessors have arrived."""
        writer = self.matched.get(sample.writer)
        if writer is None:
            return
        self.complete += 1
        if not self._is_reliable(writer):
            writer.has_restarted(sample.sequence, sample.sequence)
        due = writer.due or 0
        if sample.sequence < due or sample.sequence in writer.pending:
            return
        if not self._is_reliable(writer):
            self._on_sample(sample)
            writer.due = sample.sequence + 1
        elif len(writer.pending) < MAX_PENDING or sample.sequence == due:
            writer.pending[sample.sequence] = sample
            self._deliver(writer)

    def on_fragment(
        self,
        sample: ReceivedSample,
        first: int,
        count: int,
        fragment_size: int,
        size: int,
        payload: memoryview,
    ) -> None:
        """Collect fragments of a message; `sample` describes it without its data."""
        writer, number = self.matched.get(sample.writer), sample.sequence
        if writer is None or number in writer.pending:
            return
        if not self._is_reliable(writer):
            writer.has_restarted(number, number)
        if writer.due is not None and number < writer.due:
            return
        if not (fragment_size > 0 and 0 < size <= wire.MAX_MESSAGE and size // fragment_size < 2**16):
            raise ValueError("a fragmented message with an impossible size")
        if number not in writer.partial:
            partial = PartialMessage(size, fragment_size)
            self.incomplete_size = size
            self._free_memory(writer, partial.memory)
            writer.partial[number] = partial
        partial = writer.partial[number]
        partial.add(first, count, payload)
        if not partial.missing:
            del writer.partial[number]
            self.on_data(sample._replace(data=partial.data()))

    def _free_memory(self, writer: MatchedWriter, size: int) -> None:
        """Drop the oldest incomplete messages, of this writer first, to keep memory bounded."""
        while len(writer.partial) >= MAX_PARTIAL:
            del writer.partial[min(writer.partial)]
            self.incomplete += 1
        for other in (writer, *self.matched.values()):
            used = sum(
                message.memory for matched in self.matched.values() for message in matched.partial.values()
            )
            if used + size <= MAX_PARTIAL_BYTES:
                return
            self.incomplete += len(other.partial)
            other.partial.clear()

    def on_heartbeat(self, guid: bytes, first: int, last: int, count: int, *, is_final: bool) -> None:
        """Process a heartbeat, and request the missing messages that the writer still has.

        If none is missing, the acknowledgement is sent with the next tick, for all messages until
        then.
        """
        writer = self.matched.get(guid)
        if writer is None or not self._is_reliable(writer) or count == writer.last_heartbeat:
            return
        writer.last_heartbeat = count
        if not writer.has_restarted(last, count) and writer.signs:
            # A writer that has not restarted answers with the number of a newer message.
            self._request_heartbeat(writer, 1)
            return
        was_open, writer.requests = writer.requests > 0, 0
        if writer.due is None and self.endpoint.is_latched and self._latched_depth is not None:
            # As in Fast DDS, a late joiner keeps only the newest messages, even if the writer has
            # more.
            first = max(first, last - self._latched_depth + 1)
        if writer.due is None or first > writer.due:
            # The writer no longer keeps the messages before `first`. It skips messages from before
            # the match by a GAP.
            writer.skip_to(first)
        due = self._deliver(writer)
        end = min(last, due + wire.MAX_SET - 1) + 1
        missing = [number for number in range(due, end) if number not in writer.pending]
        for number in [number for number in missing if number in writer.partial]:
            self._request_fragments(writer, number)
        whole = [number for number in missing if number not in writer.partial]
        writer.is_ack_due = not is_final
        if missing:
            self._send_acknack(writer, due, whole, is_final=True)
        if was_open:
            self.on_matched()

    def on_gap(self, guid: bytes, first: int, base: int, others: list[int]) -> None:
        """Skip messages that will not arrive: [first, base) and `others`."""
        writer = self.matched.get(guid)
        if writer is None or writer.due is None:
            return
        if first <= writer.due < base:
            writer.skip_to(base)
        for number in others:
            if number >= writer.due and len(writer.pending) < MAX_PENDING:
                writer.pending.setdefault(number, None)
        self._deliver(writer)

    def _deliver(self, writer: MatchedWriter) -> int:
        """Deliver the messages that are due. Return the number of the next one."""
        if writer.due is None:
            return 0
        due = writer.due
        while due in writer.pending:
            sample = writer.pending[due]
            if sample is not None:
                self._on_sample(sample)
            writer.partial.pop(due, None)
            del writer.pending[due]
            due = writer.due = due + 1
        return due

    def _request_heartbeat(self, writer: MatchedWriter, base: int) -> None:
        """Request a heartbeat from a writer, acknowledging all messages before `base`.

        Fast DDS answers immediately only to base 0, otherwise after up to 3 s. Cyclone DDS rejects
        base 0.
        """
        is_fast_dds = writer.endpoint.guid[:2] == wire.FAST_DDS
        self._send_acknack(writer, 0 if is_fast_dds else base, [], is_final=False)

    def _request_fragments(self, writer: MatchedWriter, number: int) -> None:
        missing = writer.partial[number].missing
        first = min(missing)
        fragments = [fragment for fragment in missing if fragment < first + wire.MAX_SET]
        body = sequence_number(number) + struct.pack("<I", first) + wire.number_bitmap(first, fragments)
        self._send_to(writer.endpoint, wire.NACK_FRAG, 0, body + COUNT.pack(next(self._counts)))

    def _send_acknack(self, writer: MatchedWriter, base: int, missing: list[int], *, is_final: bool) -> None:
        writer.is_ack_due = False
        body = sequence_number(base) + wire.number_bitmap(base, missing) + COUNT.pack(next(self._counts))
        self._send_to(writer.endpoint, wire.ACKNACK, 0x02 if is_final else 0, body)
