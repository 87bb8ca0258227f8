"""RTPS 2.3 on the wire: datagrams, submessages, parameter lists and sequence numbers.

The numbers are from the DDSI-RTPS specification, version 2.3. Written bytes are little endian; read
bytes may have either byte order. Malformed bytes raise a ValueError or a struct.error, which the
participant counts; no other exception leaves these functions, and no size that a datagram claims is
trusted.
"""

import socket
import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, Literal, NamedTuple, Self

from course_lib.ros.graph.topics import Qos

Buffer = bytes | memoryview
Locator = tuple[str, int]  # IPv4 address and port

PROTOCOL = b"RTPS\x02\x03"
VENDOR_ID = b"\x7f\x7f"  # not assigned to a vendor
# Vendor IDs, with which the GUIDs of endpoints begin.
FAST_DDS, CYCLONE_DDS = b"\x01\x0f", b"\x01\x10"
HEADER_SIZE = 20  # [B]
# Size of the part of a GUID that identifies the participant; the other 4 bytes are the entity.
PREFIX_SIZE = 12
# Limit on the numbers in one set.
MAX_SET = 256
MAX_MESSAGE = 64 * 2**20  # [B]
# Limit on sequence numbers: no writer reaches it, and sums of numbers can be encoded.
MAX_SEQUENCE = 2**62

# Submessages
PAD, ACKNACK, HEARTBEAT, GAP, INFO_TS, INFO_SRC, INFO_DST = 0x01, 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0E
NACK_FRAG, DATA, DATA_FRAG = 0x12, 0x15, 0x16
# Flag of an ACKNACK or a HEARTBEAT that needs no answer.
FINAL = 0x02

# Entities
UNKNOWN_ENTITY, PARTICIPANT_ENTITY = b"\0\0\0\0", b"\0\0\1\xc1"
SPDP_WRITER, SPDP_READER = b"\0\1\0\xc2", b"\0\1\0\xc7"
PUBLICATIONS_WRITER, PUBLICATIONS_READER = b"\0\0\3\xc2", b"\0\0\3\xc7"
SUBSCRIPTIONS_WRITER, SUBSCRIPTIONS_READER = b"\0\0\4\xc2", b"\0\0\4\xc7"
BUILTIN_ENDPOINTS = 0x3F  # SPDP and SEDP, both directions
USER_WRITER, USER_READER = 0x03, 0x04  # last byte of the entities of ROS, which have no keys

# kind, flags and length of a submessage; for INFO_TS also seconds and fraction.
SUBMESSAGE, TIMESTAMP = struct.Struct("<BBH"), struct.Struct("<BBHII")
PL_CDR_LE = b"\0\3\0\0"
DISPOSED = b"\0\0\0\3"  # status of an instance that was disposed and unregistered
INFINITE = (0x7FFFFFFF, 0xFFFFFFFF)
INFINITE_NS = 2**31 * 10**9
Kind = Literal["writer", "reader"]


class Pid(IntEnum):
    """The ids of parameters."""

    SENTINEL = 0x01
    LEASE = 0x02
    TOPIC = 0x05
    TYPE = 0x07
    DOMAIN = 0x0F
    VERSION = 0x15
    VENDOR = 0x16
    RELIABILITY = 0x1A
    LIVELINESS = 0x1B
    DURABILITY = 0x1D
    DEADLINE = 0x23
    PARTITION = 0x29
    LIFESPAN = 0x2B
    USER_DATA = 0x2C
    UNICAST = 0x2F
    DEFAULT_UNICAST = 0x31
    METATRAFFIC = 0x32
    PARTICIPANT = 0x50
    BUILTIN = 0x58
    ENDPOINT = 0x5A
    NAME = 0x62
    KEY_HASH = 0x70
    STATUS = 0x71
    REPRESENTATION = 0x73
    RELATED = 0x83
    RELATED_OLD = 0x800F


class Submessage(NamedTuple):
    """One submessage of a datagram.

    Args:
        body: Its bytes in the datagram, which are kept as long as the view.
        source: GUID prefix of the sender.
        stamp_ns: Source time, [ns] since 1970; 0 if none was sent.
    """

    kind: int
    flags: int
    order: Literal["<", ">"]
    body: memoryview
    source: bytes
    stamp_ns: int

    def unpack(self, layout: str, at: int) -> tuple[Any, ...]:
        """Decode the fields at a position."""
        return struct.unpack_from(self.order + layout, self.body, at)

    def sequence_number(self, at: int) -> int:
        """Decode the sequence number at a position."""
        number = read_sequence_number(self.body, at, self.order)
        if not 0 <= number <= MAX_SEQUENCE:
            raise ValueError("an impossible sequence number")
        return number

    def numbers(self, at: int, base: int) -> list[int]:
        """Decode a set of sequence or fragment numbers: a bitmap at `base`."""
        (count,) = self.unpack("I", at)
        if count > MAX_SET:
            raise ValueError(f"a set of {count} numbers")
        words = self.unpack(f"{(count + 31) // 32}I", at + 4)
        return [base + i for i in range(count) if words[i // 32] >> (31 - i % 32) & 1]


class RequestId(NamedTuple):
    """The identity of a service request: GUID of writer or reply reader, and sequence number."""

    guid: bytes
    sequence: int


def kind_of(guid: bytes) -> Kind:
    """Return the kind of the endpoint with a GUID: writer or reader."""
    return "writer" if guid[15] & 0x0F in (2, 3) else "reader"


@dataclass(frozen=True)
class Endpoint:
    """A writer or a reader, as discovery describes it.

    Args:
        guid: Its GUID, 16 bytes.
        topic: DDS name of the topic, like `rt/chatter`.
        type_name: DDS name of the type, like `std_msgs::msg::dds_::String_`.
        locators: The addresses to send to.
        has_partition: Whether it is in a partition, where it cannot match the kit's endpoints.
    """

    guid: bytes
    topic: str
    type_name: str
    qos: Qos = field(default_factory=Qos)
    user_data: bytes = b""
    locators: tuple[Locator, ...] = ()
    has_partition: bool = False

    @property
    def kind(self) -> Kind:
        """The kind of the endpoint: writer or reader."""
        return kind_of(self.guid)


def submessage(kind: int, flags: int, *body: Buffer) -> tuple[Buffer, ...]:
    """Encode a submessage in parts, so that its data is copied only once, into the datagram.

    A submessage of 64 KiB or more must be the last of its datagram; its length field is then 0.
    """
    size = sum(map(len, body))
    padded = size + -size % 4
    return (SUBMESSAGE.pack(kind, flags | 1, padded if padded < 2**16 else 0), *body, bytes(padded - size))


def read_datagram(data: bytes, own_prefix: bytes) -> Iterator[Submessage]:
    """Yield the submessages of a datagram that other participants have sent to this one or to all.

    INFO submessages are not yielded. They set fields of the others.
    """
    if len(data) < HEADER_SIZE or data[:4] != PROTOCOL[:4]:
        raise ValueError("not an RTPS datagram")
    view, source, is_for, stamp_ns, at = memoryview(data), data[8:HEADER_SIZE], True, 0, HEADER_SIZE
    while at + 4 <= len(data):
        kind, flags = data[at], data[at + 1]
        order: Literal["<", ">"] = "<" if flags & 1 else ">"
        (size,) = struct.unpack_from(f"{order}H", data, at + 2)
        # A length of 0 means "up to the end", except in submessages that may be empty.
        end = at + 4 + size if size or kind in (PAD, INFO_TS) else len(data)
        body, at = view[at + 4 : end], end
        if kind == INFO_DST:
            is_for = body[:PREFIX_SIZE] in (own_prefix, bytes(PREFIX_SIZE))
        elif kind == INFO_SRC:
            source = bytes(body[8:HEADER_SIZE])
        elif kind == INFO_TS:
            stamp_ns = 0 if flags & 2 else read_time(body, order)
        elif is_for and source != own_prefix:
            yield Submessage(kind, flags, order, body, source, stamp_ns)


def timestamp(at_ns: int) -> bytes:
    """Encode an INFO_TS submessage with a time, [ns] since 1970."""
    seconds, rest = divmod(at_ns, 10**9)
    return TIMESTAMP.pack(INFO_TS, 1, 8, seconds & 0xFFFFFFFF, rest * 2**32 // 10**9)


def read_time(data: Buffer, order: str, at: int = 0) -> int:
    """Decode a time since 1970 or a duration [ns]."""
    seconds, fraction = struct.unpack_from(f"{order}II", data, at)
    return int(seconds * 10**9 + round(fraction * 1e9 / 2**32))


def sequence_number(value: int) -> bytes:
    """Encode a sequence number."""
    return struct.pack("<iI", value >> 32, value & 0xFFFFFFFF)


def read_sequence_number(data: Buffer, at: int, order: str) -> int:
    """Decode the sequence number at a position."""
    high, low = struct.unpack_from(f"{order}iI", data, at)
    return int(high << 32 | low)


def number_bitmap(base: int, numbers: Sequence[int]) -> bytes:
    """Encode numbers of [base, base + 256) as a bitmap with its length."""
    count = max((number - base + 1 for number in numbers), default=0)
    words = [0] * ((count + 31) // 32)
    for number in numbers:
        words[(number - base) // 32] |= 1 << (31 - (number - base) % 32)
    return struct.pack(f"<I{len(words)}I", count, *words)


def number_set(base: int, numbers: Sequence[int]) -> bytes:
    """Encode sequence numbers of [base, base + 256)."""
    return sequence_number(base) + number_bitmap(base, numbers)


def parameter_list(*parameters: tuple[int, bytes]) -> bytes:
    """Encode a list of parameters (pid, value), with its end."""
    padded = [(pid, value + bytes(-len(value) % 4)) for pid, value in (*parameters, (Pid.SENTINEL, b""))]
    return b"".join(struct.pack("<HH", pid, len(value)) + value for pid, value in padded)


def octets(value: bytes) -> bytes:
    """Encode a sequence of octets."""
    return struct.pack("<I", len(value)) + value


def string(value: str) -> bytes:
    """Encode a string."""
    return octets(value.encode() + b"\0")


def duration(value_ns: int | None) -> bytes:
    """Encode a duration [ns]; None is infinite."""
    if value_ns is None:
        return struct.pack("<iI", *INFINITE)
    seconds, rest = divmod(value_ns, 10**9)
    return struct.pack("<iI", min(seconds, INFINITE[0]), rest * 2**32 // 10**9)


def locator(address: Locator) -> bytes:
    """Encode a UDPv4 locator."""
    return struct.pack("<iI12s4s", 1, address[1], bytes(12), socket.inet_aton(address[0]))


class ParameterList:
    """A received parameter list, which begins at a position and ends at `end`."""

    def __init__(self, data: Buffer, order: str, at: int = 0) -> None:
        self.order = order
        self._values: dict[int, list[bytes]] = {}
        while True:
            pid, size = struct.unpack_from(f"{order}HH", data, at)
            at += 4
            if pid == Pid.SENTINEL:
                break
            self._values.setdefault(pid, []).append(bytes(data[at : at + size]))
            at += size
        self.end = at

    @classmethod
    def from_payload(cls, payload: bytes) -> Self:
        """Read the list of a message, after its encapsulation header of 4 bytes."""
        return cls(payload, "<" if payload[1] & 1 else ">", 4)

    def first(self, pid: int, default: bytes = b"") -> bytes:
        """Return the first value of a parameter."""
        return self._values.get(pid, [default])[0]

    def number(self, pid: int, default: int) -> int:
        """Return an unsigned integer of 32 bits."""
        value = self.first(pid)
        return int(struct.unpack_from(f"{self.order}I", value)[0]) if value else default

    def octets(self, pid: int) -> bytes:
        """Return a sequence of octets."""
        return self.first(pid)[4 : 4 + self.number(pid, 0)]

    def string(self, pid: int) -> str:
        """Return a string."""
        return self.octets(pid).rstrip(b"\0").decode(errors="replace")

    def duration(self, pid: int, at: int = 0, default: int | None = None) -> int | None:
        """Return a duration [ns]; None is infinite."""
        if pid not in self._values:
            return default
        value_ns = read_time(self.first(pid), self.order, at)
        return None if value_ns == INFINITE_NS else value_ns

    def locators(self, pid: int) -> tuple[Locator, ...]:
        """Return the UDPv4 locators. Shared memory, TCP and IPv6 are ignored."""
        layout = struct.Struct(f"{self.order}iI12x4s")
        found = [layout.unpack_from(value) for value in self._values.get(pid, ())]
        return tuple(
            (socket.inet_ntoa(ip), port) for kind, port, ip in found if kind == 1 and 0 < port < 2**16
        )

    def qos(self, kind: Kind) -> Qos:
        """Return the QoS of an endpoint. Absent policies have the defaults of DDS, not ROS.

        DDS does not transmit the history and the depth.
        """
        reliability = self.number(Pid.RELIABILITY, 2 if kind == "writer" else 1)
        return Qos(
            history="unknown",
            reliability="reliable" if reliability == 2 else "best_effort",
            durability="transient_local" if self.number(Pid.DURABILITY, 0) >= 1 else "volatile",
            deadline_ns=self.duration(Pid.DEADLINE),
            lifespan_ns=self.duration(Pid.LIFESPAN),
            liveliness="manual_by_topic" if self.number(Pid.LIVELINESS, 0) == 2 else "automatic",
            lease_ns=self.duration(Pid.LIVELINESS, at=4),
        )


def describe(endpoint: Endpoint, participant: bytes, here: Locator) -> bytes:
    """Encode an endpoint of this participant for discovery."""
    qos = endpoint.qos
    liveliness = 2 if qos.liveliness == "manual_by_topic" else 0
    return PL_CDR_LE + parameter_list(
        (Pid.ENDPOINT, endpoint.guid),
        (Pid.KEY_HASH, endpoint.guid),
        (Pid.PARTICIPANT, participant),
        (Pid.TOPIC, string(endpoint.topic)),
        (Pid.TYPE, string(endpoint.type_name)),
        (Pid.UNICAST, locator(here)),
        (Pid.RELIABILITY, struct.pack("<I", 1 + qos.is_reliable) + duration(10**8)),
        (Pid.DURABILITY, struct.pack("<I", qos.is_latched)),
        (Pid.DEADLINE, duration(qos.deadline_ns)),
        (Pid.LIFESPAN, duration(qos.lifespan_ns)),
        (Pid.LIVELINESS, struct.pack("<I", liveliness) + duration(qos.lease_ns)),
        (Pid.REPRESENTATION, struct.pack("<Ihh", 1, 0, 0)),
        (Pid.USER_DATA, octets(endpoint.user_data)),
    )


def disposal(pid: int, guid: bytes) -> tuple[bytes, bytes]:
    """Return the payload and inline QoS of the message that removes an endpoint or participant."""
    inline_qos = parameter_list((Pid.KEY_HASH, guid), (Pid.STATUS, DISPOSED))
    return PL_CDR_LE + parameter_list((pid, guid)), inline_qos


def related_request(request: RequestId) -> bytes:
    """Encode the inline QoS by which Fast DDS relates a reply to its request."""
    identity = request.guid + sequence_number(request.sequence)
    return parameter_list((Pid.RELATED, identity), (Pid.RELATED_OLD, identity))
