"""Names on the wire of rmw_zenoh_cpp (Jazzy, 0.2.4 and newer): keys, tokens, QoS, attachments and GIDs."""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, cast, get_args

from course_lib.ros.qos import Qos

ADMIN = "@ros2_lv"  # the first part of every liveliness token
DEFAULT_DEPTH = 42  # an empty depth, and what a depth of 0 becomes
DEFAULT_QOS = Qos()
INFINITE = (9_223_372_036, 854_775_807)  # RMW_DURATION_INFINITE, [s] and [ns]
NODE_PARTS, ENDPOINT_PARTS = 9, 13  # of a token; Rolling appends a 14th
ATTACHMENT = struct.Struct("<qqB16s")  # sequence number, time [ns since 1970], length of the GID, GID
GID_BYTES = 16

Kind = Literal["NN", "MP", "MS", "SS", "SC"]  # node, publisher, subscription, service server, service client

# rmw/types.h, by value
_RELIABILITY = {"reliable": "1", "best_effort": "2"}
_DURABILITY = {"volatile": "2", "transient_local": "1"}
_HISTORY = {"keep_last": "1", "keep_all": "2"}
_LIVELINESS = {"automatic": "1", "manual_by_topic": "3"}


@dataclass(frozen=True, slots=True)
class Entity:
    """One liveliness token: a node, or an endpoint of one.

    Args:
        zid: Of its session, as `str(session.zid())`.
        node_id: Of its node; ids are counted by session, from 0.
        topic: With its namespace; the name of a service.
        type_name: Like `std_msgs/msg/String`; a service's without `_Request`.
        type_hash: Like `RIHS01_…`.
    """

    domain: int
    zid: str
    node_id: int
    id: int
    kind: Kind
    namespace: str
    node: str
    topic: str = ""
    type_name: str = ""
    type_hash: str = ""
    qos: Qos = DEFAULT_QOS
    enclave: str = "/"

    @property
    def token(self) -> str:
        """The key of its liveliness token."""
        parts = [ADMIN, str(self.domain), self.zid, str(self.node_id), str(self.id), self.kind]
        parts += [_mangled(self.enclave), _mangled(self.namespace), self.node]
        if self.kind != "NN":
            parts += [_mangled(self.topic), dds_name(self.type_name), self.type_hash, qos_text(self.qos)]
        return "/".join(parts)

    @property
    def key(self) -> str:
        """The key on which its messages, requests and replies travel."""
        return key_of(self.domain, self.topic, self.type_name, self.type_hash)

    @property
    def gid(self) -> bytes:
        """XXH3-128 of the token, its low half first, each half little endian."""
        import xxhash  # of the extra `robot`

        return xxhash.xxh3_128(self.token.encode()).intdigest().to_bytes(GID_BYTES, "little")


def key_of(domain: int, topic: str, type_name: str, type_hash: str) -> str:
    """Return the key of a topic or a service."""
    return f"{domain}/{topic.strip('/')}/{dds_name(type_name)}/{type_hash}"


def read_token(key: str) -> Entity | None:
    """Return the entity of a token; None for keys that are not a token of ROS."""
    parts = key.split("/")
    if len(parts) < NODE_PARTS or parts[0] != ADMIN or parts[5] not in get_args(Kind):
        return None
    kind = cast("Kind", parts[5])
    try:
        numbers = int(parts[1]), parts[2], int(parts[3]), int(parts[4])
        if kind == "NN":
            return Entity(*numbers, kind, _demangled(parts[7]), parts[8], enclave=_demangled(parts[6]))
        topic, type_name, type_hash, qos = parts[9:ENDPOINT_PARTS]
        return Entity(
            *numbers,
            kind,
            _demangled(parts[7]),
            parts[8],
            _demangled(topic),
            ros_name(type_name),
            type_hash,
            read_qos(qos),
            _demangled(parts[6]),
        )
    except ValueError:  # not a number, or too few parts
        return None


def qos_text(qos: Qos) -> str:
    """Write a QoS; what equals the default is left out: `2::,5:,:,:,,` is best effort with depth 5."""
    depth = "" if qos.depth in (0, DEFAULT_DEPTH) else str(qos.depth)
    parts = (
        _coded(_RELIABILITY, qos.reliability),
        _coded(_DURABILITY, qos.durability),
        f"{_coded(_HISTORY, qos.history)},{depth}",
        _span_text(qos.deadline_ns),
        _span_text(qos.lifespan_ns),
        f"{_coded(_LIVELINESS, qos.liveliness)},{_span_text(qos.lease_ns)}",
    )
    return ":".join(parts)


def read_qos(text: str) -> Qos:
    """Read a QoS; raises a ValueError for other texts."""
    reliability, durability, kept, deadline, lifespan, alive = text.split(":")
    history, depth = kept.split(",")
    liveliness, lease = alive.split(",", 1)
    return Qos(
        history=cast('Literal["keep_last", "keep_all"]', _decoded(_HISTORY, history)),
        depth=int(depth or DEFAULT_DEPTH),
        reliability=cast('Literal["reliable", "best_effort"]', _decoded(_RELIABILITY, reliability)),
        durability=cast('Literal["volatile", "transient_local"]', _decoded(_DURABILITY, durability)),
        deadline_ns=_read_span(deadline),
        lifespan_ns=_read_span(lifespan),
        liveliness=cast('Literal["automatic", "manual_by_topic"]', _decoded(_LIVELINESS, liveliness)),
        lease_ns=_read_span(lease),
    )


def attachment(sequence: int, gid: bytes, source_ns: int) -> bytes:
    """Return what goes with a message, a request or a reply; sequences begin with 1."""
    return ATTACHMENT.pack(sequence, source_ns, GID_BYTES, gid)


def read_attachment(data: bytes) -> tuple[int, int, bytes]:
    """Return sequence number, time [ns] and GID; a ValueError for others, as rmw_zenoh before 0.2.4 sent."""
    if len(data) != ATTACHMENT.size or data[16] != GID_BYTES:
        raise ValueError(f"an attachment of {len(data)} bytes instead of {ATTACHMENT.size}")
    sequence, source_ns, _, gid = ATTACHMENT.unpack(data)
    return sequence, source_ns, gid


def dds_name(type_name: str) -> str:
    """Return `std_msgs::msg::dds_::String_` for `std_msgs/msg/String`."""
    package, folder, name = type_name.split("/")
    return f"{package}::{folder}::dds_::{name}_"


def ros_name(dds: str) -> str:
    """Return `std_msgs/msg/String` for `std_msgs::msg::dds_::String_`."""
    return dds.replace("::dds_::", "::").replace("::", "/").removesuffix("_")


def _mangled(name: str) -> str:
    return name.replace("/", "%") or "%"


def _demangled(name: str) -> str:
    return name.replace("%", "/")


def _coded(codes: Mapping[str, str], value: str) -> str:
    return "" if value == next(iter(codes)) else codes[value]  # the first is the default


def _decoded(codes: Mapping[str, str], text: str) -> str:
    """Return the policy of a code; values that the kit does not know are those of the default."""
    return {code: value for value, code in codes.items()}.get(text, next(iter(codes)))


def _span_text(duration_ns: int | None) -> str:
    span = INFINITE if duration_ns is None else divmod(duration_ns, 10**9)
    return ",".join("" if part == most else str(part) for part, most in zip(span, INFINITE, strict=True))


def _read_span(text: str) -> int | None:
    seconds, rest = (int(part or most) for part, most in zip(text.split(","), INFINITE, strict=True))
    return None if (seconds, rest) == INFINITE else seconds * 10**9 + rest
