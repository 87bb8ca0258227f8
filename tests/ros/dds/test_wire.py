"""Wire format: written messages are read back, and malformed datagrams are dropped and counted."""

import contextlib
import itertools
import random
import sys
from collections.abc import Iterable, Iterator
from types import FrameType
from typing import Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.errors import CourseError
from course_lib.ros.dds import link, wire
from course_lib.ros.dds import participant as participants
from course_lib.ros.dds.endpoints import Change, Reader, ReceivedSample, Writer
from course_lib.ros.dds.link import NodeEndpoints
from course_lib.ros.dds.participant import Participant
from course_lib.ros.dds.wire import Endpoint, Locator, ParameterList, Pid, RequestId
from course_lib.ros.graph.topics import Qos
from course_lib.ros.time import wall
from tests.patience import PATIENCE

PREFIX, OTHER = b"\x7f\x7f" + bytes(10), b"\x01\x0f" + bytes(10)
GUID = OTHER + b"\0\0\1\x03"
CDR_LE = b"\0\1\0\0"
QOS = st.builds(
    Qos,
    reliability=st.sampled_from(["reliable", "best_effort"]),
    durability=st.sampled_from(["volatile", "transient_local"]),
    deadline_ns=st.none() | st.integers(1, 10**12),
    lifespan_ns=st.none() | st.integers(1, 10**12),
    liveliness=st.sampled_from(["automatic", "manual_by_topic"]),
    lease_ns=st.none() | st.integers(1, 10**12),
)


class Wire:
    """Keeps the datagrams that endpoints send."""

    def __init__(self, prefix: bytes = OTHER) -> None:
        self.sent: list[bytes] = []
        self._prefix = prefix

    def send(self, parts: Iterable[wire.Buffer], locators: object, prefix: bytes = b"") -> None:
        head = wire.PROTOCOL + wire.VENDOR_ID + self._prefix
        self.sent.append(head + b"".join(parts))


@given(st.integers(0, 2**62), st.sets(st.integers(0, 255)))
def test_sequence_number_sets_survive_a_round_trip(base: int, offsets: set[int]) -> None:
    numbers = sorted(base + offset for offset in offsets)
    sink = Wire()
    sink.send(wire.submessage(wire.ACKNACK, 0, wire.number_set(base, numbers)), [])
    (received,) = wire.read_datagram(sink.sent[0], PREFIX)
    assert received.sequence_number(0) == base
    assert received.numbers(8, base) == numbers


@given(QOS, st.text(min_size=1, max_size=50).filter(lambda text: "\0" not in text))
def test_endpoint_descriptions_survive_a_round_trip(qos: Qos, topic: str) -> None:
    endpoint = Endpoint(GUID, topic, "std_msgs::msg::dds_::String_", qos, b"typehash=x;")
    listed = ParameterList.from_payload(
        wire.describe(endpoint, OTHER + wire.PARTICIPANT_ENTITY, ("127.0.0.1", 7410))
    )
    found = listed.qos("writer")
    # It is not transmitted, so no depth may be shown.
    assert found.history == "unknown"
    assert (listed.string(Pid.TOPIC), listed.octets(Pid.USER_DATA)) == (topic, b"typehash=x;")
    assert listed.locators(Pid.UNICAST) == (("127.0.0.1", 7410),)
    assert (found.reliability, found.durability, found.liveliness) == (
        qos.reliability,
        qos.durability,
        qos.liveliness,
    )
    # A duration is a binary fraction of a second on the wire.
    for given_ns, read_ns in (
        (qos.deadline_ns, found.deadline_ns),
        (qos.lifespan_ns, found.lifespan_ns),
        (qos.lease_ns, found.lease_ns),
    ):
        assert (given_ns is None) == (read_ns is None)
        assert given_ns is None or read_ns is None or abs(given_ns - read_ns) <= 1


def test_services_of_cyclone_dds_are_not_matched_but_its_topics_are() -> None:
    joined, matched = list[str](), list[bool]()
    own = Participant(99, "127.0.0.1", lambda endpoint, has_joined: joined.append(endpoint.topic))
    for vendor, topic in (
        (wire.FAST_DDS, "rq/aRequest"),
        (wire.CYCLONE_DDS, "rq/aRequest"),
        (wire.CYCLONE_DDS, "rt/a"),
    ):
        guid = vendor + bytes(11) + topic[:2].encode() + b"\x04"
        writer = own.add_writer(topic, "t", Qos())
        participant = guid[:12] + wire.PARTICIPANT_ENTITY
        described = wire.describe(Endpoint(guid, topic, "t", Qos()), participant, ("127.0.0.1", 1))
        own._update_endpoint(ReceivedSample(described, guid, 1, 0, None, False, b""))
        matched.append(guid in writer.matched)
    own.close()
    assert (matched, joined) == ([True, False, True], ["rq/aRequest", "rt/a"])


@pytest.mark.parametrize(("kind", "reliability"), [("writer", "reliable"), ("reader", "best_effort")])
def test_missing_reliability_uses_the_dds_default(kind: wire.Kind, reliability: str) -> None:
    empty = ParameterList.from_payload(wire.PL_CDR_LE + wire.parameter_list())
    assert empty.qos(kind).reliability == reliability


@given(
    st.dictionaries(
        st.tuples(st.just("/ns"), st.text("abc_", min_size=1, max_size=9)),
        st.lists(st.binary(min_size=16, max_size=16), max_size=6),
        max_size=4,
    )
)
def test_participant_nodes_survive_a_round_trip(nodes: NodeEndpoints) -> None:
    participant = OTHER + wire.PARTICIPANT_ENTITY
    # A message lists the readers of a node first.
    expected = {name: sorted(guids, key=wire.kind_of) for name, guids in nodes.items()}
    assert link.read_discovery(link.write_discovery(participant, nodes)) == (participant, expected)


def datagrams() -> list[bytes]:
    """Return datagrams of every kind that endpoints send."""
    sink = Wire()
    writer = Writer(sink, Endpoint(GUID, "rt/a", "t", Qos(durability="transient_local")))
    here: tuple[Locator, ...] = (("127.0.0.1", 1),)
    remote = Endpoint(PREFIX + b"\0\0\1\x04", "rt/a", "t", Qos(durability="transient_local"), locators=here)
    writer.match(remote)
    writer.write(b"\0\1\0\0hello", wire.related_request(RequestId(GUID, 3)))
    writer.write(bytes(100_000))
    writer.on_acknack(remote.guid, 1, [1, 2], is_final=False)
    writer.on_acknack(remote.guid, 0, [], is_final=False)
    reader = Reader(sink, Endpoint(GUID[:15] + b"\x04", "rt/a", "t", Qos()), lambda sample: None)
    source = Endpoint(PREFIX + b"\0\0\1\x03", "rt/a", "t", Qos(), locators=here)
    reader.match(source)
    reader.on_heartbeat(source.guid, 1, 5, 1, is_final=False)
    return sink.sent


@pytest.fixture(scope="module")
def participant() -> Iterator[Participant]:
    """Return a participant with the endpoints that `datagrams` refer to."""
    made = Participant(99, "127.0.0.1", lambda endpoint, has_joined: None)
    qos = Qos(durability="transient_local")
    reader = made.add_reader("rt/a", "t", qos, lambda sample: None)
    reader.match(Endpoint(GUID, "rt/a", "t", qos))
    writer = made.add_writer("rt/a", "t", qos)
    writer.match(Endpoint(GUID[:15] + b"\x04", "rt/a", "t", qos))
    yield made
    made.close()


class Recording(Participant):
    """A participant that stores its datagrams."""

    sent: list[bytes]

    def send(self, parts: Iterable[wire.Buffer], locators: Iterable[Locator], prefix: bytes = b"") -> None:
        kept = [bytes(part) for part in parts]
        info = wire.submessage(wire.INFO_DST, 0, prefix) if prefix else ()
        self.sent.append(b"".join((wire.PROTOCOL, wire.VENDOR_ID, self.prefix, *info, *kept)))
        super().send(kept, locators, prefix)


def exchanged_datagrams() -> list[bytes]:
    """Return the datagrams of two participants that discover each other and exchange two messages."""
    Recording.sent, received = [], list[ReceivedSample]()
    one, other = (Recording(98, "127.0.0.1", lambda endpoint, has_joined: None) for _ in range(2))
    writer = one.add_writer("rt/a", "t", Qos(durability="transient_local"), b"typehash=RIHS01_00;")
    other.add_reader("rt/a", "t", Qos(durability="transient_local"), received.append)
    one.write(writer, CDR_LE + b"hello")
    one.write(writer, bytes(100_000))
    deadline = wall.monotonic() + PATIENCE
    while len(received) < 2 and wall.monotonic() < deadline:
        wall.sleep(0.01)
    one.close()
    other.close()
    assert len(received) == 2
    return Recording.sent


@pytest.mark.slow
def test_hundred_thousand_mutated_datagrams_raise_nothing_and_keep_no_memory(
    participant: Participant,
) -> None:
    originals, random_numbers = [*datagrams(), *exchanged_datagrams()], random.Random(0)
    received, slowest = participant.datagrams, 0.0
    for _ in range(100_000):
        mutated = bytearray(random_numbers.choice(originals))
        for _ in range(random_numbers.randint(1, 8)):
            mutated[random_numbers.randrange(len(mutated))] = random_numbers.randrange(256)
        if random_numbers.random() < 0.3:
            del mutated[random_numbers.randrange(len(mutated) + 1) :]
        began = wall.monotonic()
        participant.receive(bytes(mutated))
        slowest = max(slowest, wall.monotonic() - began)
    assert participant.datagrams == received + 100_000
    # About a third is malformed; the others differ in values that any program may send.
    assert participant.dropped.total() > 20_000
    assert slowest < PATIENCE
    # A mutated prefix is another participant, whose announcement must be complete.
    assert len(participant.remotes) < 200


class Interruption:
    """Raises KeyboardInterrupt at one line of the processing of a datagram, as Ctrl+C does."""

    def __init__(self, line: int) -> None:
        self.lines_left = line

    def __enter__(self) -> None:
        sys.settrace(self._on_call)

    def __exit__(self, *_: object) -> None:
        sys.settrace(None)

    def _on_call(self, frame: FrameType, event: str, _: object) -> Any:
        is_called_by_it = frame.f_back is not None and frame.f_back.f_trace is not None
        return self._on_line if is_called_by_it or frame.f_code.co_name == "_process" else None

    def _on_line(self, frame: FrameType, event: str, _: object) -> Any:
        self.lines_left -= event == "line"
        if self.lines_left == 0:
            raise KeyboardInterrupt
        return self._on_line


def test_datagram_whose_processing_is_interrupted_at_any_line_is_processed_again() -> None:
    reported, received = list[tuple[bytes, bool]](), list[bytes]()
    local = Participant(99, "127.0.0.1", lambda endpoint, joins: reported.append((endpoint.guid, joins)))
    local.add_reader("rt/chatter", "t", Qos(), lambda sample: received.append(sample.data))
    line, was_interrupted = 0, True
    while was_interrupted:
        line += 1
        was_interrupted = False
        remote = b"\x01\x0f" + line.to_bytes(10, "big")
        guid, text = remote + b"\0\0\1\x03", CDR_LE + b"%04d" % line
        reported.clear()
        received.clear()
        for datagram in life_of_a_writer(remote, local.prefix, text):
            try:
                with Interruption(line):
                    local.receive(datagram)
            except KeyboardInterrupt:
                was_interrupted = True
                # The participant's thread may have processed it already.
                with local.lock, contextlib.suppress(IndexError):
                    local.receive(*local._interrupted.popleft())
        with local.lock:
            # Other programs of this computer may be in the same domain.
            own = [report for report in dict.fromkeys(reported) if report[0] == guid]
            assert own == [(guid, True), (guid, False)], line
            assert list(dict.fromkeys(received)) == [text], line
            assert remote not in local.remotes
    assert line > 100
    local.close()


def test_robot_whose_address_changes_receives_messages_at_its_new_address() -> None:
    local = Participant(99, "127.0.0.1", lambda endpoint, has_joined: None)
    sent: list[tuple[bytes, Locator]] = []

    def send(parts: Iterable[wire.Buffer], locators: Iterable[Locator], prefix: bytes = b"") -> None:
        sent.extend((b"".join(parts), address) for address in locators)

    local.send = send  # type: ignore[method-assign]  # records the addresses
    writer = local.add_writer("rt/cmd", "t", Qos())
    here, guid = ("127.0.0.1", 9), OTHER + b"\0\0\1\x04"
    joins, *_ = life_of_a_writer(OTHER, local.prefix, b"")
    sink = Wire()
    subscriptions = Writer(sink, Endpoint(OTHER + wire.SUBSCRIPTIONS_WRITER, "", "", Qos()))
    subscriptions.match(Endpoint(local.prefix + wire.SUBSCRIPTIONS_READER, "", "", Qos(), locators=(here,)))
    description = wire.describe(Endpoint(guid, "rt/cmd", "t", Qos()), OTHER + wire.PARTICIPANT_ENTITY, here)
    subscriptions.write(description)
    for datagram in (joins, *sink.sent):
        local.receive(datagram, "127.0.0.1")
    # It announces the same address from new ones. At first it had the address that the link was
    # given.
    for host in ("127.0.0.8", "127.0.0.9", "127.0.0.1"):
        local.receive(joins, host)
        sent.clear()
        local.write(writer, b"go")
        assert [address for data, address in sent if b"go" in data] == [(host, 9)]
        assert local.current_peer == host
    local.close()


def life_of_a_writer(remote: bytes, local: bytes, text: bytes) -> list[bytes]:
    """Return datagrams of a participant that joins, publishes a message on /chatter and leaves."""
    sink, here = Wire(remote), ("127.0.0.1", 9)
    participant, guid = remote + wire.PARTICIPANT_ENTITY, remote + b"\0\0\1\x03"

    def matched_writer(guid: bytes, reader: bytes) -> Writer:
        writer = Writer(sink, Endpoint(guid, "", "", Qos()))
        writer.match(Endpoint(local + reader, "", "", Qos(), locators=(here,)))
        return writer

    def announce(data: bytes, inline_qos: bytes = b"") -> None:
        spdp = remote + wire.SPDP_WRITER
        sink.send(Change(1, data, inline_qos, 5).encode(spdp, wire.SPDP_READER), [])

    announce(
        wire.PL_CDR_LE
        + wire.parameter_list((Pid.PARTICIPANT, participant), (Pid.METATRAFFIC, wire.locator(here)))
    )
    publications = matched_writer(remote + wire.PUBLICATIONS_WRITER, wire.PUBLICATIONS_READER)
    publications.write(wire.describe(Endpoint(guid, "rt/chatter", "t", Qos()), participant, here))
    writer = matched_writer(guid, b"\0\0\1\x04")
    writer.write(text)
    publications.write(*wire.disposal(Pid.ENDPOINT, guid))
    announce(*wire.disposal(Pid.PARTICIPANT, participant))
    return sink.sent


def test_repeated_heartbeats_are_acknowledged_once_for_all_messages_until_then() -> None:
    sink, received = Wire(), list[int]()
    local = Endpoint(PREFIX + b"\0\0\1\x04", "rt/a", "t", Qos())
    reader = Reader(sink, local, lambda sample: received.append(sample.sequence))
    reader.match(Endpoint(GUID, "rt/a", "t", Qos()))
    reader.on_heartbeat(GUID, 1, 0, 1, is_final=False)
    reader.tick()
    sink.sent.clear()
    for number in (1, 2, 3):
        reader.on_data(ReceivedSample(b"", GUID, number, 0))
        # A robot sends a heartbeat over each of its network devices.
        for _ in range(2):
            reader.on_heartbeat(GUID, 1, number, 1 + number, is_final=False)
    reader.tick()
    reader.tick()
    assert (received, sink.sent) == ([1, 2, 3], [acknowledgement(4, [], sink.sent)])
    # A missing message is requested without a delay, and once for a repeated heartbeat.
    for _ in range(2):
        reader.on_heartbeat(GUID, 1, 4, 5, is_final=False)
    assert sink.sent[1:] == [acknowledgement(4, [4], sink.sent[1:])]


def acknowledgement(base: int, missing: list[int], sent: list[bytes]) -> bytes:
    """Return the datagram of an acknowledgement, with the count of the sent one."""
    body = b"\0\0\1\x04" + GUID[12:] + wire.number_set(base, missing)
    head = wire.PROTOCOL + wire.VENDOR_ID + OTHER
    return head + b"".join(wire.submessage(wire.ACKNACK, 0x02, body + sent[0][-4:]))


@given(st.binary(max_size=200))
def test_arbitrary_discovery_message_raises_only_course_errors(cdr: bytes) -> None:
    with contextlib.suppress(CourseError):
        link.read_discovery(cdr)


def fragment(reader: Reader, size: int, fragment_size: int, first: int = 1, number: int = 1) -> None:
    sample = ReceivedSample(b"", GUID, number, 0)
    payload = memoryview(bytes(min(size, fragment_size)))
    reader.on_fragments(sample, payload, first, 1, fragment_size, size)


@pytest.fixture
def reader() -> Reader:
    made = Reader(Wire(), Endpoint(PREFIX + b"\0\0\1\x04", "rt/a", "t", Qos()), lambda sample: None)
    made.match(Endpoint(GUID, "rt/a", "t", Qos()))
    return made


@pytest.mark.parametrize(
    ("size", "fragment_size", "first"),
    [(2**31, 60_000, 1), (2**26, 1, 1), (0, 10, 1), (100, 0, 1), (1000, 100, 50), (1000, 100, 0), (2, 2, 2)],
)
def test_impossible_fragments_are_rejected(reader: Reader, size: int, fragment_size: int, first: int) -> None:
    with pytest.raises(ValueError, match="fragment"):
        fragment(reader, size, fragment_size, first)


def test_incomplete_messages_use_a_bounded_amount_of_memory(reader: Reader) -> None:
    for number in range(1, 200):
        fragment(reader, wire.MAX_MESSAGE, 60_000, number=number)
    partial = [one for writer in reader.matched.values() for one in writer.partial.values()]
    assert 0 < sum(one.memory for one in partial) <= 2 * wire.MAX_MESSAGE


def test_message_is_assembled_from_fragments_in_any_order_and_grouping() -> None:
    received = list[bytes]()
    reader = Reader(
        Wire(),
        Endpoint(PREFIX + b"\0\0\1\x04", "rt/a", "t", Qos(reliability="best_effort")),
        lambda sample: received.append(sample.data),
    )
    reader.match(Endpoint(GUID, "rt/a", "t", Qos()))
    message = bytes(range(64))
    sample = ReceivedSample(b"", GUID, 1, 0)
    # Fragments of 10 bytes, of which a submessage may have several, with padding to a multiple of
    # 4.
    for first, count in ((7, 1), (2, 1), (3, 3), (3, 1), (6, 1), (1, 1)):
        begin = 10 * (first - 1)
        payload = message[begin : begin + 10 * count]
        padded = memoryview(payload + bytes(-len(payload) % 4))
        reader.on_fragments(sample, padded, first, count, 10, 64)
    assert received == [message]


def test_small_fragment_does_not_keep_its_datagram_in_memory(reader: Reader) -> None:
    datagram = bytes(60_000)
    reader.on_fragments(ReceivedSample(b"", GUID, 1, 0), memoryview(datagram)[:100], 1, 1, 100, 1000)
    before = sys.getrefcount(datagram)
    del reader.matched[GUID].partial[1]
    assert sys.getrefcount(datagram) == before


def test_truncated_fragment_is_rejected(reader: Reader) -> None:
    with pytest.raises(ValueError, match="fragment"):
        reader.on_fragments(ReceivedSample(b"", GUID, 1, 0), memoryview(bytes(99)), 1, 1, 100, 1000)


@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_writer_that_restarts_with_its_guid_is_received_again(
    reliability: Literal["reliable", "best_effort"], monkeypatch: pytest.MonkeyPatch
) -> None:
    received, times = list[int](), itertools.count(0.0, 0.05)
    monkeypatch.setattr(wall, "monotonic", lambda: next(times))
    qos = Qos(reliability=reliability)
    local = Endpoint(PREFIX + b"\0\0\1\x04", "rt/a", "t", qos)
    reader = Reader(Wire(), local, lambda sample: received.append(sample.sequence))
    reader.match(Endpoint(GUID, "rt/a", "t", qos))
    for life, last in ((0, 50), (1, 10), (2, 8)):
        received.clear()
        for number in range(1, last + 1):
            for _ in range(4):
                reader.on_data(ReceivedSample(b"", GUID, number, life))
                reader.on_heartbeat(GUID, 1, number, number, is_final=False)
        # A reliable writer resends what is requested.
        for number in range(1, last + 1) if reliability == "reliable" else ():
            reader.on_data(ReceivedSample(b"", GUID, number, life))
        lost = 0 if reliability == "reliable" or life == 0 else 1
        assert received == list(range(1 + lost, last + 1))


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_late_and_repeated_datagrams_are_not_a_restart(
    reliability: Literal["reliable", "best_effort"], seed: int
) -> None:
    chance, received = random.Random(seed), list[int]()
    qos = Qos(reliability=reliability)
    local = Endpoint(PREFIX + b"\0\0\1\x04", "rt/a", "t", qos)
    reader = Reader(Wire(), local, lambda sample: received.append(sample.sequence))
    reader.match(Endpoint(GUID, "rt/a", "t", qos))
    reader.on_heartbeat(GUID, 1, 0, 0, is_final=False)
    arrivals = [(number + chance.uniform(0, 4), number) for number in range(1, 200) for _ in range(3)]
    for _, number in sorted(arrivals):
        reader.on_data(ReceivedSample(b"", GUID, number, 0))
        reader.on_heartbeat(GUID, 1, number, number, is_final=False)
    assert received == (list(range(1, 200)) if reliability == "reliable" else sorted(set(received)))


FAR = 2**40


@pytest.mark.parametrize("forged", ["heartbeat", "gap", "message", "future messages"])
def test_reader_recovers_from_numbers_that_its_writer_has_not_reached(
    forged: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    received, times = list[int](), itertools.count(0.0, 0.05)
    monkeypatch.setattr(wall, "monotonic", lambda: next(times))
    reader = Reader(
        Wire(),
        Endpoint(PREFIX + b"\0\0\1\x04", "rt/a", "t", Qos()),
        lambda sample: received.append(sample.sequence),
    )
    reader.match(Endpoint(GUID, "rt/a", "t", Qos()))
    reader.on_heartbeat(GUID, 1, 0, 1, is_final=False)
    if forged == "heartbeat":
        reader.on_heartbeat(GUID, FAR, FAR, 2**31 - 1, is_final=True)
        reader.on_heartbeat(GUID, 1, 1, 2**30, is_final=True)
    elif forged == "gap":
        reader.on_gap(GUID, 1, FAR, [])
    else:
        first = 1 if forged == "message" else FAR
        for number in range(first, first + 300):
            reader.on_data(ReceivedSample(b"", GUID, number, 0))
    received.clear()
    # The writer repeats its heartbeat until it is acknowledged, and resends what is requested.
    for count in range(2, 12):
        reader.on_heartbeat(GUID, 1, 3, count, is_final=False)
    for number in (2, 3, 1):
        reader.on_data(ReceivedSample(b"", GUID, number, 0))
    assert received == [1, 2, 3]


def test_numbers_that_no_writer_reaches_are_malformed(participant: Participant) -> None:
    entities, sink, dropped = b"\0\0\1\x04" + GUID[12:], Wire(), participant.dropped.total()
    largest, count = wire.sequence_number(2**63 - 1), bytes(4)
    sink.send(wire.submessage(wire.HEARTBEAT, 0, entities, largest, largest, count), [])
    sink.send(wire.submessage(wire.GAP, 0, entities, wire.sequence_number(1), largest, count), [])
    sink.send(wire.submessage(wire.ACKNACK, 0, entities, wire.sequence_number(-1), count, count), [])
    sink.send(wire.submessage(wire.GAP, 0, entities, *map(wire.sequence_number, (9, 3)), count), [])
    for datagram in sink.sent:
        participant.receive(datagram)
    assert participant.dropped.total() == dropped + len(sink.sent)


def forge(name: str, remote: Participant) -> list[bytes]:
    """Return datagrams in the name of a participant, as nobody but an attacker sends them."""
    sink, writer = Wire(remote.prefix), remote.prefix + wire.PUBLICATIONS_WRITER
    entities = wire.PUBLICATIONS_READER + wire.PUBLICATIONS_WRITER

    def announce(number: int, data: bytes, inline_qos: bytes = b"") -> None:
        change = Change(number, data, inline_qos, 5)
        sink.send(change.encode(writer, wire.PUBLICATIONS_READER), [])

    def announce_participant(data: bytes, inline_qos: bytes = b"") -> None:
        spdp = remote.prefix + wire.SPDP_WRITER
        sink.send(Change(1, data, inline_qos, 5).encode(spdp, wire.SPDP_READER), [])

    match name:
        case "gap":
            numbers = wire.number_set(FAR, [])
            sink.send(wire.submessage(wire.GAP, 0, entities, wire.sequence_number(1), numbers), [])
        case "heartbeat":
            numbers = wire.sequence_number(FAR) * 2
            sink.send(wire.submessage(wire.HEARTBEAT, 0, entities, numbers, b"\xff\xff\xff\x7f"), [])
        case "announcement":
            # It takes the number of the next one, and describes the same writer.
            there = ("127.0.0.1", 9)
            endpoint = Endpoint(remote.prefix + b"\0\0\2\x03", "rt/other", "t", Qos())
            announce(2, wire.describe(endpoint, remote.guid, there))
        case "removed writer":
            announce(2, *wire.disposal(Pid.ENDPOINT, remote.prefix + b"\0\0\1\x03"))
        case "removed discovery":
            announce(2, *wire.disposal(Pid.ENDPOINT, writer))
        case "wrong port":
            announce_participant(*wire.disposal(Pid.PARTICIPANT, remote.guid))
            place = wire.locator(("127.0.0.1", 9))
            parameters = ((Pid.PARTICIPANT, remote.guid), (Pid.METATRAFFIC, place))
            announce_participant(wire.PL_CDR_LE + wire.parameter_list(*parameters))
    # A datagram that is cut off, as such senders often send.
    sink.sent.append(sink.sent[0][: wire.HEADER_SIZE + 10])
    return sink.sent


@pytest.mark.parametrize(
    "name", ["gap", "heartbeat", "announcement", "removed writer", "removed discovery", "wrong port"]
)
def test_participant_is_received_again_after_datagrams_in_its_name(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(participants, "CHECK_SECONDS", 1.0)
    local, remote = (Participant(98, "127.0.0.1", lambda endpoint, has_joined: None) for _ in range(2))
    received = set[bytes]()

    def listen(topic: str) -> Writer:
        local.add_reader(topic, "t", Qos(), lambda sample: received.add(sample.data))
        return remote.add_writer(topic, "t", Qos())

    def wait_for(*expected: bytes) -> None:
        received.clear()
        deadline = wall.monotonic() + PATIENCE
        while not received.issuperset(expected) and wall.monotonic() < deadline:
            for writer, data in zip(writers, expected, strict=True):
                remote.write(writer, data)
            wall.sleep(0.05)
        assert received.issuperset(expected)

    writers = [listen("rt/old")]
    wait_for(b"\0\1\0\0old ")
    for datagram in forge(name, remote):
        local.receive(datagram)
    writers.append(listen("rt/new"))
    wait_for(b"\0\1\0\0old ", b"\0\1\0\0new ")
    local.close()
    remote.close()


def test_reader_that_restarts_with_its_guid_is_sent_heartbeats_until_it_has_everything() -> None:
    sink, reader = Wire(), Endpoint(PREFIX + b"\0\0\1\x04", "rt/a", "t", Qos(durability="transient_local"))
    writer = Writer(sink, Endpoint(GUID, "rt/a", "t", Qos(durability="transient_local")))
    writer.match(reader)
    writer.write(CDR_LE)
    writer.on_acknack(reader.guid, 2, [], is_final=True)
    assert writer.unacknowledged_readers() == []
    # Its request for the first message is lost, so only the writer can repeat its heartbeat.
    writer.on_acknack(reader.guid, 0, [], is_final=False)
    assert len(writer.unacknowledged_readers()) == 1
