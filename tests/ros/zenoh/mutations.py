"""Changes of the structure of what a robot sends over Zenoh: tokens, attachments and payloads."""

import random
import struct
from collections.abc import Sequence
from dataclasses import dataclass, field

import zenoh

from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages.definitions import type_hash
from course_lib.ros.zenoh.link import CODES, ZenohEntity, encode_attachment, key_expr_of

# Numbers at the limits of fields, and names that a key expression may contain.
EDGES = (-(2**63), -(2**31), -1, 0, 1, 2, 255, 2**16, 2**31 - 1, 2**32, 2**63 - 1, 2**64, 10**30)
NAMES = ("%", "%%", "~", ".", "..", "-", "1", "é", " ", "@x", "x" * 2000, "%" * 300, "9" * 5000, "a:b,c")
TYPES = ("x", "::", "a::b::c", "std_msgs::msg::dds_::Nothing_", "..::..::dds_::x_")
GIDS = [bytes(16), b"\xff" * 16]


@dataclass
class Mutations:
    """Sends changed tokens, messages, requests and replies in a session of its own.

    Args:
        draw: The source of the changes.
        session: The session of the sender.
        victim: Zenoh ID of the kit that receives them.
        domain: ROS_DOMAIN_ID.
        messages: Topics, type names and example messages.
        services: Services, type names and example requests.
    """

    draw: random.Random
    session: zenoh.Session
    victim: str
    domain: int
    messages: Sequence[tuple[str, str, bytes]]
    services: Sequence[tuple[str, str, bytes]]
    _tokens: list[zenoh.LivelinessToken] = field(default_factory=list)

    def send(self) -> None:
        """Send one change. A key that Zenoh itself rejects is not sent."""
        try:
            match self.draw.randrange(10):
                case 0 | 1 | 2 | 3:
                    token = self.session.liveliness().declare_token(self.change_token())
                    self._tokens.append(token)
                case 4:
                    topic, type_name, cdr = self.draw.choice(self.services)
                    self.session.get(
                        key_expr_of(self.domain, topic, type_name, type_hash(type_name)),
                        zenoh.handlers.DefaultHandler(),
                        payload=self.change_payload(cdr),
                        attachment=self.change_attachment(),
                        timeout=0.5,
                    )
                case _:
                    topic, type_name, cdr = self.draw.choice(self.messages)
                    key = key_expr_of(self.domain, topic, type_name, type_hash(type_name))
                    self.session.put(key, self.change_payload(cdr), attachment=self.change_attachment())
        except zenoh.ZError:
            return
        finally:
            while len(self._tokens) > 100:
                self._tokens.pop(self.draw.randrange(100)).undeclare()

    def change_token(self) -> str:
        """Return a token with changed numbers, names, kinds, QoS, and number of parts."""
        draw = self.draw
        kind = draw.choice(tuple(CODES))
        topic, type_name, _ = draw.choice(self.services if kind in ("server", "client") else self.messages)
        number = draw.randrange(5)
        entity = ZenohEntity(
            kind=kind,
            domain=self.domain,
            zid="a1",
            node_id=number,
            id=draw.randrange(50),
            namespace="/",
            node="robot",
            topic=topic,
            type_name=type_name,
            type_hash=type_hash(type_name),
            qos=draw.choice((Qos(), Qos(depth=1, durability="transient_local"))),
        )
        parts = entity.token.split("/")
        for _ in range(draw.randint(0, 3)):
            at = draw.randrange(2, len(parts))
            match draw.randrange(8):
                case 0:
                    parts[at] = str(draw.choice(EDGES))
                case 1:
                    parts[at] = draw.choice(NAMES)
                case 2:
                    parts.insert(at, draw.choice(NAMES))
                case 3 if len(parts) > 4:
                    del parts[at]
                case 4:
                    parts[2] = self.victim
                case 5 if len(parts) > 5:
                    parts[5] = draw.choice(tuple(CODES.values()))
                case 6:
                    numbers = [draw.choice(("", str(draw.choice(EDGES)))) for _ in range(9)]
                    parts[-1] = "{}:{}:{},{}:{},{}:{},{}:{},,".format(*numbers)
                case 7 if len(parts) > 10:
                    parts[10] = draw.choice(TYPES)
        return "/".join(parts)

    def change_attachment(self) -> bytes:
        """Return an attachment with changed numbers, GIDs and lengths."""
        draw, edges = self.draw, [edge for edge in EDGES if -(2**63) <= edge < 2**63]
        gid = draw.choice([*GIDS, draw.randbytes(16)])
        attachment = encode_attachment(draw.choice(edges), gid, draw.choice(edges))
        match draw.randrange(6):
            case 0:
                return attachment[: draw.randrange(34)]
            case 1:
                return attachment + bytes(draw.randrange(100))
            case 2:
                return attachment[:16] + draw.randbytes(1) + attachment[17:]
            case _:
                return attachment

    def change_payload(self, cdr: bytes) -> bytes:
        """Return a message with changed lengths, byte order and end."""
        draw, data = self.draw, bytearray(cdr)
        match draw.randrange(5):
            case 0:
                del data[draw.randrange(len(data) + 1) :]
            case 1 if len(data) >= 8:
                at = draw.randrange(0, len(data) - 3) & ~3
                struct.pack_into("<I", data, at, draw.choice(EDGES) & 0xFFFFFFFF)
            case 2 if data:
                data[draw.randrange(len(data))] = draw.randrange(256)
            case 3:
                data += draw.randbytes(draw.randrange(50))
        return bytes(data)
