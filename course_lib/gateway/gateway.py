"""A router between a class and a robot: students hear the robot, and one of them drives."""

import re
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.foreign import read_json
from course_lib.gateway.access import INNER, access_control
from course_lib.gateway.students import Access
from course_lib.gateway.zenoh_router import open_router
from course_lib.ros.zenoh.commands import moves, still
from course_lib.ros.zenoh.login import PRESENCE, ROBOT, STUDENTS, gateway_key
from course_lib.ros.zenoh.tokens import Entity, attachment, ros_name

if TYPE_CHECKING:
    import zenoh

SILENCE = 0.5  # [s] without a command, after which a moving robot is stopped
TURN = 0.05  # [s] between two looks at the driver
MOST_KEYS = 8  # that one driver's commands may use, so that nobody fills the memory
STUCK_US = 500_000  # [µs] after which a student's link that takes no more answers is closed
NOBODY_WAITS = {  # a link that is full loses messages; otherwise one stuck student would hold up all
    "messages": ["put", "delete"],
    "key_exprs": ["**", "**/@adv/**"],
    "flows": ["ingress"],
    "overwrite": {"congestion_control": "drop"},
}
COMMAND = re.compile(  # the key of a student's command
    rf"\d+/{STUDENTS}/(?P<name>\w+)/(?P<topic>\w+(/\w+)*)/(?P<dds>\w+::msg::dds_::\w+_)/(?P<hash>RIHS01_[0-9a-f]{{64}})",
    re.ASCII,
)


@dataclass(frozen=True)
class Settings:
    """The two sides of a gateway.

    Args:
        listen: Where students connect, `tcp/0.0.0.0:7448`; `tls/…` with a certificate.
        robot: The robot's router; "" to listen on `robot_listen` instead.
        sends: Topics that the driver may publish, without their first slash.
        calls: Services that students may call, without their first slash.
        domain: The robot's ROS_DOMAIN_ID.
        certificate: PEM file for TLS, with `key`.
        robot_listen: Where a robot on this machine connects.
    """

    listen: str
    robot: str = ""
    sends: Sequence[str] = ()
    calls: Sequence[str] = ()
    domain: int = 0
    certificate: Path | None = None
    key: Path | None = None
    robot_listen: str = "tcp/127.0.0.1:7447"


@dataclass
class _Stream:
    """The driver's commands on one key: its announced publisher, and whether the robot moves by them."""

    entity: Entity
    token: Any
    sequence: int = 0
    last: float = 0.0  # [s] of the monotonic clock
    moving: bool = False


class Gateway:
    """Two routers in this process, linked by a socket: the students' one lets no put through to the robot's.

    A command on /students/NAME/cmd_vel is put on /cmd_vel by the robot's router itself, if NAME drives.

    Args:
        settings: Both sides.
        users: The robot and the students.
        passwords: The file with their tokens, in Zenoh's format.
    """

    def __init__(self, settings: Settings, users: Sequence[Access], passwords: Path) -> None:
        self.settings, self.users = settings, users
        self.driver: Access | None = None
        self.passed, self.held = Counter[str](), Counter[str]()  # commands by name
        self._names = {user.name for user in users} - {ROBOT}
        self._streams: dict[str, _Stream] = {}
        self._lock = threading.RLock()
        self._folder = tempfile.TemporaryDirectory(prefix="gateway_")  # only this user may enter it
        inner = f"{INNER}/{self._folder.name}/robot.sock"
        self.robot_side = open_router(_robots(settings, inner), "--robot-port")
        self.class_side = open_router(
            {
                "listen/endpoints": [settings.listen],
                "connect/endpoints": [inner],
                "transport/auth/usrpwd": {"dictionary_file": str(passwords)},
                "access_control": access_control(sorted(self._names), settings.calls, settings.domain),
                "qos/network": [NOBODY_WAITS],
                "transport/link/tx/queue/congestion_control/block/wait_before_close": STUCK_US,
                **_tls(settings),
            }
        )
        from course_lib.ros.zenoh.session import Handlers  # here: open_router has looked for Zenoh

        self._handlers = Handlers()
        self._node = Entity(settings.domain, str(self.robot_side.zid()), 0, 0, "NN", "/", "gateway")
        self._kept: list[Any] = [self._announced(self._node), *map(self._subscribed, settings.sends)]
        self._shown = self._show_driver()

    def drive(self, driver: Access | None) -> None:
        """Change the driver; the robot stops first."""
        with self._lock:
            if driver != self.driver:
                self.stop()
                for stream in self._streams.values():
                    stream.token.undeclare()
                self._streams.clear()
                self.driver = driver
                before, self._shown = self._shown, self._show_driver()
                before.undeclare()

    def turn(self) -> None:
        """Stop the robot where its driver has fallen silent; call it every TURN seconds."""
        with self._lock:
            now = time.monotonic()
            for stream in self._streams.values():
                if stream.moving and now - stream.last > SILENCE:
                    self._still(stream)

    def stop(self) -> None:
        """Send a command to stand still on each topic by which the robot moves."""
        with self._lock:
            for stream in self._streams.values():
                if stream.moving:
                    self._still(stream)

    def close(self) -> None:
        """Stop the robot and close both sides."""
        self.drive(None)
        for session in (self.robot_side, self.class_side):
            session.close()  # type: ignore[no-untyped-call]  # untyped there
        self._handlers.wait()
        self._folder.cleanup()

    def linked(self) -> bool:
        """Return whether the robot's router is connected, without waiting."""
        return any(zid != self.class_side.zid() for zid in self.robot_side.info.routers_zid())

    def present(self) -> dict[str, set[str]]:
        """Return the Zenoh IDs of the kits that are connected, by the student's name."""
        found: dict[str, set[str]] = {}
        for reply in self.class_side.liveliness().get(f"{PRESENCE}/*/*", timeout=1.0):
            if reply.ok is not None:
                _, name, zid = str(reply.ok.key_expr).split("/")
                found.setdefault(name, set()).add(zid)
        return found

    def links(self) -> tuple[list[str], list[str]]:
        """Return the addresses of the other ends: on the students' side, and on the robot's."""
        own = {str(self.class_side.zid()), str(self.robot_side.zid())}
        return _links(self.class_side, own), _links(self.robot_side, own)

    def _subscribed(self, topic: str) -> Any:
        key = f"{self.settings.domain}/{STUDENTS}/*/{topic}/*/*"
        return self.class_side.declare_subscriber(key, self._handlers.direct(self._heard))

    def _heard(self, sample: "zenoh.Sample") -> None:
        """Pass a driver's command on, hold back all others; called by Zenoh's threads."""
        found = COMMAND.fullmatch(str(sample.key_expr))  # a put may have wildcards in its key
        payload = bytes(sample.payload)
        if found is None or not payload:  # a delete has none
            return
        name, topic = found["name"], found["topic"]
        with self._lock:
            stream = self._stream(topic, found["dds"], found["hash"]) if self._drives(name) else None
            if stream is None:
                self.held[name] += 1
                return
            stream.moving, stream.last = moves(payload, stream.entity.type_name), time.monotonic()
            self.passed[name] += 1
            self._put(stream, payload)

    def _show_driver(self) -> Any:
        """Declare the token by which students' kits know who drives."""
        name = self.driver.name if self.driver is not None else ""
        return self.class_side.liveliness().declare_token(gateway_key(name, self.settings.sends))

    def _drives(self, name: str) -> bool:
        return self.driver is not None and self.driver.name == name

    def _stream(self, topic: str, dds: str, type_hash: str) -> _Stream | None:
        """Return the stream of a key, announced as a publisher of the gateway; None beyond MOST_KEYS."""
        key = f"{topic}/{dds}/{type_hash}"
        if key not in self._streams and len(self._streams) < MOST_KEYS:
            head = (self._node.domain, self._node.zid, 0, len(self._streams) + 1)
            publisher = Entity(*head, "MP", "/", "gateway", f"/{topic}", ros_name(dds), type_hash)
            self._streams[key] = _Stream(publisher, self._announced(publisher))
        return self._streams.get(key)

    def _announced(self, entity: Entity) -> Any:
        return self.robot_side.liveliness().declare_token(entity.token)

    def _still(self, stream: _Stream) -> None:
        stream.moving = False
        payload = still(stream.entity.type_name, time.time_ns())
        if payload is not None:
            self._put(stream, payload)

    def _put(self, stream: _Stream, payload: bytes) -> None:
        stream.sequence += 1
        note = attachment(stream.sequence, stream.entity.gid, time.time_ns())
        self.robot_side.put(stream.entity.key, payload, attachment=note)


def _robots(settings: Settings, inner: str) -> dict[str, Any]:
    """Return the robot's side: a router to connect to, or a place where the robot's nodes find each other."""
    if settings.robot:
        return {"listen/endpoints": [inner], "connect/endpoints": [settings.robot]}
    return {"listen/endpoints": [inner, settings.robot_listen], "scouting/gossip/enabled": True}


def _tls(settings: Settings) -> dict[str, Any]:
    if settings.certificate is None:
        return {}
    own = {"listen_certificate": str(settings.certificate), "listen_private_key": str(settings.key)}
    return {"transport/link/tls": own}


def _links(session: "zenoh.Session", own: set[str]) -> list[str]:
    """Return the far addresses of a router's links, as its admin space lists them."""
    found = []
    for reply in session.get(f"@/{session.zid()}/router", timeout=1.0):
        if reply.ok is not None:
            sessions = read_json(bytes(reply.ok.payload))["sessions"]
            found += [link["dst"] for one in sessions if one["peer"] not in own for link in one["links"]]
    return found
