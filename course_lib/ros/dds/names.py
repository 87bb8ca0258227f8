"""The conventions of ROS 2 on DDS: names of topics and types, type hashes, and the nodes of endpoints."""

import re
import struct
from dataclasses import dataclass, field

from course_lib.ros.dds.wire import Endpoint
from course_lib.ros.graph.topics import Qos
from course_lib.ros.robot.link import EntityKind

DISCOVERY_TOPIC = "ros_discovery_info"
DISCOVERY_TYPE = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"
DISCOVERY_QOS = Qos(depth=1, durability="transient_local")
GID_SIZE = 16  # [B]; 24 in Humble
CDR_LE = b"\0\1\0\0"
# Limit on the length of a list in a discovery message.
MAX_ITEMS = 10_000
TYPE_HASH = re.compile(rb"typehash=(RIHS01_[0-9a-f]{64});")


@dataclass(frozen=True, slots=True)
class DdsEntity:
    """A node or an endpoint on the network.

    Args:
        node_key: GUID of the participant, and the node's full name there.
        gid: GUID of the endpoint; for a node of the kit a number that only the kit uses.
    """

    kind: EntityKind
    node_key: tuple[bytes, str]
    namespace: str
    node: str
    topic: str = ""
    type_name: str = ""
    type_hash: str = ""
    qos: Qos = field(default_factory=Qos)
    gid: bytes = b""

    @property
    def key(self) -> tuple[tuple[bytes, str], bytes]:
        """The key that identifies the entity."""
        return self.node_key, self.gid


@dataclass
class NodeEndpoints:
    """A node in a discovery message, with the GUIDs of its endpoints."""

    namespace: str
    name: str
    readers: list[bytes] = field(default_factory=list)
    writers: list[bytes] = field(default_factory=list)

    @property
    def full_name(self) -> str:
        """The fully qualified name."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


def dds_type(type_name: str) -> str:
    """Return `std_msgs::msg::dds_::String_` for `std_msgs/msg/String`."""
    package, folder, name = type_name.split("/")
    return f"{package}::{folder}::dds_::{name}_"


def ros_type(dds: str) -> str:
    """Return `std_msgs/msg/String` for `std_msgs::msg::dds_::String_`."""
    return dds.replace("::dds_::", "::").replace("::", "/").removesuffix("_")


def topic_names(topic: str, type_name: str) -> tuple[str, str]:
    """Return the DDS names of a topic and its type."""
    return f"rt{topic}", dds_type(type_name)


def request_names(service: DdsEntity) -> tuple[str, str]:
    """Return the DDS names of the topic of a service's requests and their type."""
    return f"rq{service.topic}Request", dds_type(f"{service.type_name}_Request")


def reply_names(service: DdsEntity) -> tuple[str, str]:
    """Return the DDS names of the topic of a service's replies and their type."""
    return f"rr{service.topic}Reply", dds_type(f"{service.type_name}_Response")


def user_data(type_hash: str) -> bytes:
    """Return the user data of an endpoint."""
    return f"typehash={type_hash};".encode()


def read_type_hash(data: bytes) -> str:
    """Return the type hash in an endpoint's user data, or an empty string."""
    match = TYPE_HASH.search(data)
    return match[1].decode() if match else ""


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


class _Cursor:
    """Reads the CDR bytes of a discovery message.

    Raises ValueError or struct.error for malformed bytes.
    """

    def __init__(self, cdr: bytes) -> None:
        self._data, self._at = cdr[4:], 0
        self._order = "<" if cdr[1] & 1 else ">"

    def count(self) -> int:
        self._at += -self._at % 4
        (value,) = struct.unpack_from(f"{self._order}I", self._data, self._at)
        self._at += 4
        return int(value)

    def take(self, size: int) -> bytes:
        if self._at + size > len(self._data):
            raise ValueError("a discovery message that is cut off")
        self._at += size
        return self._data[self._at - size : self._at]

    def string(self) -> str:
        return self.take(self.count()).rstrip(b"\0").decode()

    def length(self) -> int:
        count = self.count()
        if count > MAX_ITEMS:
            raise ValueError(f"a list in a discovery message has {count} elements, more than {MAX_ITEMS}")
        return count

    def gids(self) -> list[bytes]:
        return [self.take(GID_SIZE) for _ in range(self.length())]


def read_discovery(cdr: bytes) -> tuple[bytes, list[NodeEndpoints]]:
    """Decode a discovery message into the participant's GUID and its nodes.

    Raises:
        ValueError, IndexError, struct.error: The message is malformed.
    """
    cursor = _Cursor(cdr)
    participant = cursor.take(GID_SIZE)
    nodes = [
        NodeEndpoints(cursor.string(), cursor.string(), cursor.gids(), cursor.gids())
        for _ in range(cursor.length())
    ]
    return participant, nodes


def write_discovery(participant: bytes, nodes: list[NodeEndpoints]) -> bytes:
    """Encode the discovery message of a participant."""
    out = bytearray(participant)

    def add(count: int, data: bytes) -> None:
        out.extend(bytes(-len(out) % 4) + struct.pack("<I", count) + data)

    add(len(nodes), b"")
    for node in nodes:
        for text in (node.namespace, node.name):
            add(len(text.encode()) + 1, text.encode() + b"\0")
        for gids in (node.readers, node.writers):
            add(len(gids), b"".join(gids))
    return CDR_LE + bytes(out)
