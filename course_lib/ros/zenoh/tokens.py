"""The wire format of rmw_zenoh_cpp (Jazzy, 0.2.4 and newer): keys, tokens, QoS, attachments and GIDs."""

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, cast

from course_lib.ros.graph.topics import Qos, dds_type, ros_type
from course_lib.ros.robot.link import EntityKind

ADMIN = "@ros2_lv"  # the first part of every liveliness token
# The depth that an empty field, or a depth of 0, stands for.
DEFAULT_DEPTH = 42
DEFAULT_QOS = Qos()
INFINITE = (9_223_372_036, 854_775_807)  # RMW_DURATION_INFINITE, [s] and [ns]
# Number of parts of a token. Rolling appends a 14th part to an endpoint's token.
NODE_PARTS, ENDPOINT_PARTS = 9, 13
ATTACHMENT = struct.Struct("<qqB16s")  # sequence number, time [ns since 1970], length of the GID, GID
GID_BYTES = 16

Code = Literal["NN", "MP", "MS", "SS", "SC"]
KINDS: Mapping[Code, EntityKind] = {
    "NN": "node",
    "MP": "publisher",
    "MS": "subscription",
    "SS": "server",
    "SC": "client",
}
CODES = {kind: code for code, kind in KINDS.items()}

# Values of the enumerations in rmw/types.h.
_RELIABILITY = {"reliable": "1", "best_effort": "2"}
_DURABILITY = {"volatile": "2", "transient_local": "1"}
_HISTORY = {"keep_last": "1", "keep_all": "2"}
_LIVELINESS = {"automatic": "1", "manual_by_topic": "3"}


@dataclass(frozen=True, slots=True)
class ZenohEntity:
    """A node or endpoint, as its liveliness token describes it.

    Args:
        zid: Zenoh ID of its session, as `str(session.zid())`.
        node_id: ID of its node; a session counts IDs from 0.
        topic: Fully qualified name of the topic or service.
        type_name: Type like `std_msgs/msg/String`; for a service without `_Request`.
        type_hash: Hash like `RIHS01_…`.
    """

    domain: int
    zid: str
    node_id: int
    id: int
    code: Code
    namespace: str
    node: str
    topic: str = ""
    type_name: str = ""
    type_hash: str = ""
    qos: Qos = DEFAULT_QOS
    enclave: str = "/"

    @property
    def kind(self) -> EntityKind:
        """The kind of entity."""
        return KINDS[self.code]

    @property
    def key(self) -> str:
        """The key that identifies the entity: its token."""
        return self.token

    @property
    def node_key(self) -> tuple[str, int]:
        """The key that identifies the entity's node."""
        return self.zid, self.node_id

    @property
    def token(self) -> str:
        """The key expression of its liveliness token."""
        parts = [ADMIN, str(self.domain), self.zid, str(self.node_id), str(self.id), self.code]
        parts += [_mangle(self.enclave), _mangle(self.namespace), self.node]
        if self.code != "NN":
            parts += [_mangle(self.topic), dds_type(self.type_name), self.type_hash, encode_qos(self.qos)]
        return "/".join(parts)

    @property
    def key_expr(self) -> str:
        """The key expression of its messages, requests and replies."""
        return key_expr_of(self.domain, self.topic, self.type_name, self.type_hash)

    @property
    def gid(self) -> bytes:
        """XXH3-128 of the token, low half first, each half little endian."""
        # xxhash belongs to the extra `robot`, so it is imported on first use.
        import xxhash

        return xxhash.xxh3_128(self.token.encode()).intdigest().to_bytes(GID_BYTES, "little")


def key_expr_of(domain: int, topic: str, type_name: str, type_hash: str) -> str:
    """Return the key expression of a topic or service."""
    return f"{domain}/{topic.strip('/')}/{dds_type(type_name)}/{type_hash}"


def read_token(key: str) -> ZenohEntity | None:
    """Return the entity that a token describes, or None for other keys."""
    parts = key.split("/")
    if len(parts) < NODE_PARTS or parts[0] != ADMIN or parts[5] not in KINDS:
        return None
    code = cast("Code", parts[5])
    try:
        numbers = int(parts[1]), parts[2], int(parts[3]), int(parts[4])
        if code == "NN":
            return ZenohEntity(*numbers, code, _demangle(parts[7]), parts[8], enclave=_demangle(parts[6]))
        topic, type_name, type_hash, qos = parts[9:ENDPOINT_PARTS]
        return ZenohEntity(
            *numbers,
            code,
            _demangle(parts[7]),
            parts[8],
            _demangle(topic),
            ros_type(type_name),
            type_hash,
            decode_qos(qos),
            _demangle(parts[6]),
        )
    except ValueError:
        # A part is missing or not a number.
        return None


def encode_qos(qos: Qos) -> str:
    """Encode a QoS. Default values are omitted: `2::,5:,:,:,,` is best effort with depth 5."""
    depth = "" if qos.depth in (0, DEFAULT_DEPTH) else str(qos.depth)
    parts = (
        _encode_policy(_RELIABILITY, qos.reliability),
        _encode_policy(_DURABILITY, qos.durability),
        f"{_encode_policy(_HISTORY, qos.history)},{depth}",
        _encode_span(qos.deadline_ns),
        _encode_span(qos.lifespan_ns),
        f"{_encode_policy(_LIVELINESS, qos.liveliness)},{_encode_span(qos.lease_ns)}",
    )
    return ":".join(parts)


def decode_qos(text: str) -> Qos:
    """Decode a QoS.

    Raises:
        ValueError: The string is not an encoded QoS.
    """
    reliability, durability, history_policy, deadline, lifespan, liveliness_policy = text.split(":")
    history, depth = history_policy.split(",")
    liveliness, lease = liveliness_policy.split(",", 1)
    return Qos(
        history=cast('Literal["keep_last", "keep_all"]', _decode_policy(_HISTORY, history)),
        depth=int(depth or DEFAULT_DEPTH),
        reliability=cast('Literal["reliable", "best_effort"]', _decode_policy(_RELIABILITY, reliability)),
        durability=cast('Literal["volatile", "transient_local"]', _decode_policy(_DURABILITY, durability)),
        deadline_ns=_decode_span(deadline),
        lifespan_ns=_decode_span(lifespan),
        liveliness=cast('Literal["automatic", "manual_by_topic"]', _decode_policy(_LIVELINESS, liveliness)),
        lease_ns=_decode_span(lease),
    )


def encode_attachment(sequence: int, gid: bytes, source_ns: int) -> bytes:
    """Return the attachment of a message, request or reply. Sequence numbers start at 1."""
    return ATTACHMENT.pack(sequence, source_ns, GID_BYTES, gid)


def decode_attachment(data: bytes) -> tuple[int, int, bytes]:
    """Decode an attachment into sequence number, time [ns] and GID.

    Raises:
        ValueError: The attachment has another format, like that of rmw_zenoh before 0.2.4.
    """
    if len(data) != ATTACHMENT.size or data[16] != GID_BYTES:
        raise ValueError(f"the attachment has {len(data)} bytes instead of {ATTACHMENT.size}")
    sequence, source_ns, _, gid = ATTACHMENT.unpack(data)
    return sequence, source_ns, gid


def _mangle(name: str) -> str:
    return name.replace("/", "%") or "%"


def _demangle(name: str) -> str:
    return name.replace("%", "/")


def _encode_policy(codes: Mapping[str, str], value: str) -> str:
    # The first code of each table is rmw_zenoh's default. It also stands for an unknown history.
    return "" if value in (next(iter(codes)), "unknown") else codes[value]


def _decode_policy(codes: Mapping[str, str], text: str) -> str:
    """Return the policy value of a code. An unknown code becomes the default."""
    return {code: value for value, code in codes.items()}.get(text, next(iter(codes)))


def _encode_span(duration_ns: int | None) -> str:
    span = INFINITE if duration_ns is None else divmod(duration_ns, 10**9)
    return ",".join(
        "" if value == infinite else str(value) for value, infinite in zip(span, INFINITE, strict=True)
    )


def _decode_span(text: str) -> int | None:
    seconds, nanoseconds = (
        int(value or infinite) for value, infinite in zip(text.split(","), INFINITE, strict=True)
    )
    return None if (seconds, nanoseconds) == INFINITE else seconds * 10**9 + nanoseconds
