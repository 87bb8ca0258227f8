"""A gateway between a class and a robot, and `course router`, which runs it until Ctrl+C.

The permissions of the students' links and of the robot's link are Zenoh's access rules, which Zenoh
checks for each link. The robot is protected by two routers: students connect to one of them, and
its rules let only queries through to the robot: of the allowed services and of publishers' caches.
The driver's commands are forwarded by the gateway's own session.
"""

import asyncio
import csv
import io
import json
import re
import secrets
import signal
import socket
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import Any

import zenoh
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, RequestHandler

from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically
from course_lib.gateway.dds_bridge import ROS_NAME, DdsBridge
from course_lib.grading.submissions.roster import read_class
from course_lib.ros.graph.topics import ros_type
from course_lib.ros.robot.addresses import full_address, is_over_dds
from course_lib.ros.robot.sending import STALE_SECONDS, STOP_PERIOD, is_motion, stop_message
from course_lib.ros.zenoh.link import (
    ADMIN,
    PRESENCE,
    RETRY,
    ROBOT,
    STUDENTS,
    Handlers,
    ZenohEntity,
    encode_attachment,
    gateway_key,
)
from course_lib.third_party import read_json

# The protocol between both routers. Students can neither listen nor connect with it.
INNER = "unixsock-stream"
LOOK = ["declare_subscriber", "declare_liveliness_subscriber", "liveliness_query"]
MESSAGES = [*LOOK, "put", "delete", "declare_queryable", "query", "reply", "liveliness_token"]
# ** does not match chunks of a key that begin with @.
EVERYWHERE = ["**", "**/@adv/**", f"{ADMIN}/**", f"{PRESENCE}/**"]
# The domain IDs of ROS 2.
DOMAINS = range(233)


def relative_names(names: Iterable[str], option: str) -> list[str]:
    """Return topic or service names without their leading slash.

    Raises:
        CourseError: A name is not an absolute ROS name.
    """
    for name in names:
        if not ROS_NAME.fullmatch(name):
            raise CourseError(f"{option} {name}: expected a full ROS name, like {option} /cmd_vel")
    return [name[1:] for name in names]


def access_control(students: Sequence[str], calls: Sequence[str], domain: int) -> dict[str, Any]:
    """Return Zenoh's `access_control`, which denies everything that no rule allows.

    Students receive all messages. They publish and serve below /students/<name> and in domains
    other than the robot's, and may call `calls`. No put passes to the robot, because the gateway's
    own session forwards those of the driver.

    Args:
        students: User names, valid as parts of ROS names.
        calls: Services without their first slash.
        domain: The robot's ROS_DOMAIN_ID.
    """
    subjects: list[dict[str, Any]] = [{"id": name, "usernames": [name]} for name in (ROBOT, *students)]
    subjects.append({"id": INNER, "link_protocols": [INNER]})
    common = ["discover", "receive", "query", "list servers", "other domains"]
    policies: list[dict[str, Any]] = [
        {"rules": ["discover", "robot", "queried", "listed"], "subjects": [ROBOT, INNER]},
        *({"rules": [*common, f"own {name}"], "subjects": [name]} for name in students),
    ]
    # The caches of publishers.
    latched = f"{domain}/**/@adv/**"
    questions = [latched, *(f"{domain}/{name}/*/*" for name in calls)]
    clients = [_tokens(domain, "SC", name.replace("/", "%")) for name in calls]
    listeners = [_tokens(domain, "NN"), _tokens(domain, "MS"), *clients]
    other_domains = [
        key
        for other in DOMAINS
        if other != domain
        for key in [f"{other}/**", f"{other}/**/@adv/**", f"{ADMIN}/{other}/**"]
    ]
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": [
            _rule("discover", ["ingress", "egress"], LOOK, EVERYWHERE),
            _rule("receive", ["egress"], MESSAGES, EVERYWHERE),
            _rule("query", ["ingress"], ["query"], questions),
            _rule("list servers", ["ingress"], ["liveliness_token"], listeners),
            _rule("other domains", ["ingress"], MESSAGES, other_domains),
            *(_rule(f"own {name}", ["ingress"], MESSAGES, _student_keys(domain, name)) for name in students),
            _rule("robot", ["ingress"], MESSAGES, EVERYWHERE),
            _rule("queried", ["egress"], ["query"], questions),
            _rule("listed", ["egress"], ["liveliness_token"], listeners),
        ],
        "subjects": subjects,
        "policies": policies,
    }


def _rule(name: str, flows: list[str], messages: list[str], keys: list[str]) -> dict[str, Any]:
    return {"id": name, "permission": "allow", "flows": flows, "messages": messages, "key_exprs": keys}


def _tokens(domain: int, kind: str, topic: str = "") -> str:
    """Return the key expression for ROS's liveliness tokens of one kind.

    `topic` is mangled and without its first %.
    """
    name = f"/*/*/*/%{topic}" if topic else ""
    return f"{ADMIN}/{domain}/*/*/*/{kind}{name}/**"


def _student_keys(domain: int, name: str) -> list[str]:
    below = f"{domain}/{STUDENTS}/{name}/**"
    topics = f"{STUDENTS}%{name}%$*"
    return [
        below,
        f"{below}/@adv/**",
        f"{PRESENCE}/{name}/**",
        *(_tokens(domain, kind, topics) for kind in ("MP", "SS", "SC")),
    ]


# Names of the files in the gateway's folder.
TOKENS, PASSWORDS, DRIVER = "tokens.csv", "passwords.txt", "driver.txt"
PRIVATE = 0o600
# The user's name if the gateway has no roster.
GUEST = "guest"
# Replaces the student's ID. No ID contains parentheses.
THE_ROBOT = f"({ROBOT})"


@dataclass(frozen=True)
class GatewayUser:
    """A user of the gateway.

    Args:
        student: The ID in the roster.
        name: The ID as a part of ROS names, which is the user's name on the link.
        token: The password on the link.
    """

    student: str
    name: str
    token: str

    def address(self, place: str) -> str:
        """Return the address for a student to connect to, like tcp/ann:TOKEN@lab.example:7448."""
        protocol, _, host = place.partition("/")
        return f"{protocol}/{self.name}:{self.token}@{host}"


def load_users(
    folder: Path, roster: Path | None, id_column: str, place: str, driver: str = ""
) -> list[GatewayUser]:
    """Return the robot and the class, whose tokens are kept, and write the private files.

    Args:
        folder: The folder of the tokens.
        roster: A platform's CSV; None for the class stored in the folder, or for one guest.
        id_column: The heading of the IDs; "" to find the column.
        place: The address for students, which is listed together with the token.
        driver: A student who must be in the class; "" for none.

    Raises:
        CourseError: The driver is not in the class. No file is written then.
    """
    tokens = _stored_tokens(folder)
    before = [student for student in tokens if student != THE_ROBOT]
    ids = [THE_ROBOT, *(read_class(roster, id_column) if roster else before or [GUEST])]
    names = _ros_names(ids)
    users = [GatewayUser(key, names[key], tokens.get(key) or secrets.token_urlsafe(18)) for key in ids]
    if driver:
        find_student(users, driver)
    text = io.StringIO(newline="")
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(("student", "name", "token", "address"))
    rows.writerows((user.student, user.name, user.token, user.address(place)) for user in users)
    write_atomically(folder / TOKENS, text.getvalue().encode(), PRIVATE)
    lines = "".join(f"{user.name}:{user.token}\n" for user in users)
    write_atomically(folder / PASSWORDS, lines.encode(), PRIVATE)
    return users


def _stored_tokens(folder: Path) -> dict[str, str]:
    """Return the tokens in the gateway's folder by student, the robot included."""
    if not (folder / TOKENS).exists():
        return {}
    with (folder / TOKENS).open(encoding="utf-8", newline="") as file:
        tokens = {row.get("student", ""): row.get("token", "") for row in csv.DictReader(file)}
    return {student: token for student, token in tokens.items() if re.fullmatch(r"[\w-]{16,}", token or "")}


def find_student(users: Sequence[GatewayUser], query: str) -> GatewayUser:
    """Return the student with an ID or a name.

    Raises:
        CourseError: The student does not exist.
    """
    folded_query = query.strip().casefold()
    for user in users:
        if user.name != ROBOT and folded_query in (user.student.casefold(), user.name):
            return user
    if [user.student for user in users if user.name != ROBOT] == [GUEST]:
        raise CourseError(
            f"--driver {query}: this folder has no class. Start the gateway with --students CSV, "
            "or pass the --folder of a gateway with a class"
        )
    raise CourseError(
        f"--driver {query}: no such student. The file {TOKENS} in the gateway's folder lists all "
        "IDs in its column `student`."
    )


def _ros_names(ids: Iterable[str]) -> dict[str, str]:
    """Return a unique ROS name for each ID: lower-case letters, digits and single underscores."""
    names: dict[str, str] = {}
    for student_id in ids:
        plain = re.sub(r"[^a-z0-9]+", "_", student_id.casefold()).strip("_")
        name = plain if plain[:1].isalpha() else f"s{plain}"
        while name in names.values():
            name += "x"
        names[student_id] = name
    return names


def open_router(settings: dict[str, Any], option: str = "--listen") -> zenoh.Session:
    """Open a router in this process. If a connection fails, it tries again.

    Args:
        settings: Zenoh's settings by key, including `listen/endpoints`.
        option: The option for another port, for the error message.

    Raises:
        CourseError: Zenoh rejects an address or a file.
    """
    config = zenoh.Config()
    common = {
        "mode": "router",
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "connect/retry": RETRY,
        "timestamping/enabled": True,
        "queries_default_timeout": 600_000,
        # Read by Gateway.links.
        "adminspace": {"enabled": True, "permissions": {"read": True, "write": False}},
    }
    for name, value in (common | settings).items():
        config.insert_json5(name, json.dumps(value))
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        place = settings["listen/endpoints"][-1]
        # The rest of the message is a location in Zenoh's source code.
        reason = str(error).split(" at /")[0]
        raise CourseError(
            f"Zenoh can't listen at {place}: {reason}. Is the port in use? Choose another one with {option}."
        ) from error


# Maximum number of keys per driver, so that commands cannot exhaust the memory.
MOST_KEYS = 8
# Timeout after which a blocked link of a student is closed [µs].
STUCK_US = 500_000
# A full link loses messages. Otherwise a blocked link of one student would delay all others.
NOBODY_WAITS = {
    "messages": ["put", "delete"],
    "key_exprs": ["**", "**/@adv/**"],
    "flows": ["ingress"],
    "overwrite": {"congestion_control": "drop"},
}
# The suffixes of an action's services, which follow its name.
ACTION_SERVICES = tuple(f"/_action/{name}" for name in ("send_goal", "cancel_goal", "get_result"))
# The key of a student's command.
COMMAND = re.compile(
    rf"\d+/{STUDENTS}/(?P<name>\w+)/(?P<topic>\w+(/\w+)*)/(?P<dds>\w+::msg::dds_::\w+_)/(?P<hash>RIHS01_[0-9a-f]{{64}})",
    re.ASCII,
)


@dataclass(frozen=True)
class Settings:
    """The settings of a gateway.

    Args:
        listen: The address for students, like `tcp/0.0.0.0:7448`, or `tls/…` with a certificate.
        robot: The robot's router, or the robot itself over DDS, `dds/192.168.1.5`; "" to listen on
            `robot_listen_address` instead.
        sends: Topics that the driver may publish, without their first slash.
        calls: Services and actions that students may call, without their first slash.
        domain: The robot's ROS_DOMAIN_ID.
        certificate: PEM file for TLS.
        key: PEM file with the certificate's private key.
        robot_listen_address: The address for a robot on this machine.
    """

    listen: str
    robot: str = ""
    sends: Sequence[str] = ()
    calls: Sequence[str] = ()
    domain: int = 0
    certificate: Path | None = None
    key: Path | None = None
    robot_listen_address: str = "tcp/127.0.0.1:7447"

    @property
    def services(self) -> list[str]:
        """The services that students may call, including the services of each action."""
        return [f"{name}{suffix}" for name in self.calls for suffix in ("", *ACTION_SERVICES)]


@dataclass
class _Stream:
    """The stream of a driver's commands on a key: its publisher, and whether it moves the robot."""

    entity: ZenohEntity
    token: Any
    sequence: int = 0
    # Monotonic time of the last command [s].
    last: float = 0.0
    is_moving: bool = False


class Gateway:
    """Two connected routers in this process. The students' router forwards no put to the other one.

    If NAME drives, a command on /students/NAME/cmd_vel is put on /cmd_vel by the robot's router
    itself.

    Args:
        settings: The settings of both routers.
        users: The robot and the students.
        passwords: The file with their tokens in Zenoh's format.
        report: Prints a line for the instructor.

    Raises:
        CourseError: An address or a file cannot be used.
    """

    def __init__(
        self,
        settings: Settings,
        users: Sequence[GatewayUser],
        passwords: Path,
        report: Callable[[str], None],
    ) -> None:
        self.settings, self.users = settings, users
        self.driver: GatewayUser | None = None
        # Number of commands by the student's name.
        self.passed, self.held = Counter[str](), Counter[str]()
        self._names = {user.name for user in users} - {ROBOT}
        self._streams: dict[str, _Stream] = {}
        self._lock = threading.RLock()
        # Only this user has access to the folder.
        self._folder = tempfile.TemporaryDirectory(prefix="gateway_")
        inner = f"{INNER}/{self._folder.name}/robot.sock"
        # The robot's router connects to a given address, or listens for the robot. A bridge
        # replaces it for a robot over DDS.
        robot_config: dict[str, Any] = {"listen/endpoints": [inner]}
        if settings.robot and not is_over_dds(settings.robot):
            robot_config["connect/endpoints"] = [settings.robot]
        elif not settings.robot:
            robot_config = {
                "listen/endpoints": [inner, settings.robot_listen_address],
                "scouting/gossip/enabled": True,
            }
        self.robot_side = open_router(robot_config, "--robot-port")
        tls = {
            "transport/link/tls": {
                "listen_certificate": str(settings.certificate),
                "listen_private_key": str(settings.key),
            }
        }
        self.class_side = open_router(
            {
                "listen/endpoints": [settings.listen],
                "connect/endpoints": [inner],
                "transport/auth/usrpwd": {"dictionary_file": str(passwords)},
                "access_control": access_control(sorted(self._names), settings.services, settings.domain),
                "qos/network": [NOBODY_WAITS],
                "transport/link/tx/queue/congestion_control/block/wait_before_close": STUCK_US,
                **({} if settings.certificate is None else tls),
            }
        )
        self._handlers = Handlers()
        self._bridge: DdsBridge | None = None
        if is_over_dds(settings.robot):
            allowed = settings.sends, settings.services
            self._bridge = DdsBridge(settings.robot, inner, settings.domain, *allowed, report)
        self._node = ZenohEntity(
            kind="node",
            domain=settings.domain,
            zid=str(self.robot_side.zid()),
            node_id=0,
            id=0,
            namespace="/",
            node="gateway",
        )
        # Zenoh undeclares a token or a subscriber whose object is deleted.
        self._declarations: list[Any] = [
            self.robot_side.liveliness().declare_token(self._node.token),
            *(
                self.class_side.declare_subscriber(
                    f"{settings.domain}/{STUDENTS}/*/{topic}/*/*", self._handlers.wrap(self._on_command)
                )
                for topic in settings.sends
            ),
        ]
        self._driver_token = self._declare_driver()

    def set_driver(self, driver: GatewayUser | None) -> None:
        """Change the driver. The robot is stopped first."""
        with self._lock:
            if driver != self.driver:
                self.stop()
                for stream in self._streams.values():
                    stream.token.undeclare()
                self._streams.clear()
                self.driver = driver
                old_token, self._driver_token = self._driver_token, self._declare_driver()
                old_token.undeclare()

    def wait(self, seconds: float) -> None:
        """Wait, and serve the link to a robot over DDS during the wait."""
        if self._bridge is None:
            time.sleep(seconds)
        else:
            self._bridge.run(seconds)

    def stop(self, older_than: float = 0.0) -> None:
        """Send a stop command on each topic that moves the robot.

        Args:
            older_than: Topics with a newer command are left alone [s]. With STALE_SECONDS, call it
                every STOP_PERIOD seconds, so that the robot stops when its driver sends no more
                commands.
        """
        with self._lock:
            for stream in self._streams.values():
                if stream.is_moving and time.monotonic() - stream.last >= older_than:
                    stream.is_moving = False
                    payload = stop_message(stream.entity.type_name, time.time_ns())
                    if payload is not None:
                        self._put(stream, payload)

    def close(self) -> None:
        """Stop the robot and close both routers."""
        self.set_driver(None)
        if self._bridge is not None:
            self._bridge.close()
        for session in (self.robot_side, self.class_side):
            session.close()
        self._handlers.wait()
        self._folder.cleanup()

    def is_robot_connected(self) -> bool:
        """Return whether the robot's router, or the robot over DDS, is connected. Does not wait."""
        if self._bridge is not None:
            return self._bridge.is_up()
        return any(zid != self.class_side.zid() for zid in self.robot_side.info.routers_zid())

    def connected_students(self) -> dict[str, set[str]]:
        """Return the Zenoh IDs of the connected kits by the student's name."""
        sessions: dict[str, set[str]] = {}
        for reply in self.class_side.liveliness().get(f"{PRESENCE}/*/*", timeout=1.0):
            if reply.ok is not None:
                _, name, zid = str(reply.ok.key_expr).split("/")
                sessions.setdefault(name, set()).add(zid)
        return sessions

    def links(self) -> tuple[list[str], list[str]]:
        """Return the addresses of connected peers on the students' side and on the robot's side."""
        own_ids = {str(self.class_side.zid()), str(self.robot_side.zid())}
        if self._bridge is not None:
            return _links(self.class_side, own_ids), [self.settings.robot] * self._bridge.is_up()
        return _links(self.class_side, own_ids), _links(self.robot_side, own_ids)

    def _on_command(self, sample: zenoh.Sample) -> None:
        """Forward a command of the driver, and count all others. Called by Zenoh's threads."""
        # A put may have wildcards in its key.
        match = COMMAND.fullmatch(str(sample.key_expr))
        payload = bytes(sample.payload)
        # A delete has no payload.
        if match is None or not payload:
            return
        name, topic = match["name"], match["topic"]
        with self._lock:
            is_driver = self.driver is not None and self.driver.name == name
            stream = self._stream(topic, match["dds"], match["hash"]) if is_driver else None
            if stream is None:
                self.held[name] += 1
                return
            stream.is_moving = is_motion(payload, stream.entity.type_name)
            stream.last = time.monotonic()
            self.passed[name] += 1
            self._put(stream, payload)

    def _declare_driver(self) -> Any:
        """Declare the token that reports the driver to the students' kits."""
        name = self.driver.name if self.driver is not None else ""
        return self.class_side.liveliness().declare_token(gateway_key(name, self.settings.sends))

    def _stream(self, topic: str, dds: str, type_hash: str) -> _Stream | None:
        """Return the stream of a key. A new stream is announced as a publisher of the gateway.

        It is None if there are MOST_KEYS already, or if a robot over DDS does not subscribe to the
        type.
        """
        key = f"{topic}/{dds}/{type_hash}"
        if self._bridge is not None and not self._bridge.is_command(f"/{topic}", ros_type(dds), type_hash):
            return None
        if key not in self._streams and len(self._streams) < MOST_KEYS:
            publisher = replace(
                self._node,
                kind="publisher",
                id=len(self._streams) + 1,
                topic=f"/{topic}",
                type_name=ros_type(dds),
                type_hash=type_hash,
            )
            token = self.robot_side.liveliness().declare_token(publisher.token)
            self._streams[key] = _Stream(publisher, token)
        return self._streams.get(key)

    def _put(self, stream: _Stream, payload: bytes) -> None:
        if self._bridge is not None:
            self._bridge.publish(stream.entity.topic, stream.entity.type_name, payload)
            return
        stream.sequence += 1
        attachment = encode_attachment(stream.sequence, stream.entity.gid, time.time_ns())
        self.robot_side.put(stream.entity.key_expr, payload, attachment=attachment)


def _links(session: zenoh.Session, own_ids: set[str]) -> list[str]:
    """Return the remote addresses of a router's links from its admin space."""
    addresses = []
    for reply in session.get(f"@/{session.zid()}/router", timeout=1.0):
        if reply.ok is not None:
            sessions = read_json(bytes(reply.ok.payload))["sessions"]
            addresses += [
                link["dst"] for peer in sessions if peer["peer"] not in own_ids for link in peer["links"]
            ]
    return addresses


# Interval between updates of the page [s].
REFRESH = 2
# Time limit for the last response [s].
PATIENCE = 5.0
HOST = "127.0.0.1"
# The notation of Zenoh: protocol, host and port.
LISTEN = re.compile(r"\w+/[^/]+:\d+", re.ASCII)
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="refresh" content="{refresh}">
<title>{title}</title>
<style>td, th {{ padding: .2rem 1rem; text-align: left }}</style>
</head><body><h1>{title}</h1>
<p>Robot: {robot}. Links of students: {links}.</p>
<table><caption>Students</caption>
<thead><tr><th scope="col">Student</th><th scope="col">Namespace</th><th scope="col">Connected</th>
<th scope="col">Drives</th><th scope="col">Commands passed on</th>
<th scope="col">Blocked commands</th></tr></thead>
<tbody>
{rows}
</tbody></table></body></html>
"""


def page_text(gateway: Gateway) -> str:
    """Return the HTML of the current status."""
    students, robots = gateway.links()
    present, driver = gateway.connected_students(), gateway.driver
    rows = []
    for user in gateway.users:
        if user.name != ROBOT:
            connected = (
                f"yes, {format_count(len(present[user.name]), 'kit')}" if user.name in present else "no"
            )
            cells = (f"/{STUDENTS}/{user.name}", connected, "drives" if user == driver else "")
            counts = (gateway.passed[user.name], gateway.held[user.name])
            tail = "".join(f"<td>{escape(str(cell))}</td>" for cell in (*cells, *counts))
            rows.append(f'<tr><th scope="row">{escape(user.student)}</th>{tail}</tr>')
    return PAGE.format(
        refresh=REFRESH,
        title=f"Gateway: {escape(driver.student) if driver else 'nobody'} drives",
        robot=f"linked to {escape(', '.join(robots))}" if robots else "no link",
        links=len(students),
        rows="\n".join(rows),
    )


class _StatusHandler(RequestHandler):
    def initialize(self, text: Callable[[], str]) -> None:
        self.text = text

    def get(self) -> None:
        """Respond to GET. The address contains a secret."""
        self.set_header("Cache-Control", "no-store")
        self.finish(self.text())


class StatusPage:
    """Serves a string on a free port of 127.0.0.1.

    It runs in a separate thread, so it never delays the gateway.

    Args:
        text: Called in that thread for each request.
    """

    def __init__(self, text: Callable[[], str]) -> None:
        (self._socket,) = bind_sockets(0, HOST)
        self._secret = secrets.token_urlsafe(12)
        self._loop = asyncio.new_event_loop()
        self._text = text
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """The address to open."""
        return f"http://{HOST}:{self._socket.getsockname()[1]}/{self._secret}/"

    def close(self) -> None:
        """Stop the server.

        An interpreter that exits while its thread uses Zenoh would be aborted.
        """
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(PATIENCE)

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        pages = Application([(f"/{self._secret}/", _StatusHandler, {"text": self._text})])
        HTTPServer(pages).add_socket(self._socket)
        self._loop.run_forever()


NOBODY = "nobody"
# Name of the file with the address of the page, which exists while a gateway runs.
PAGE_ADDRESS = "page.txt"

Write = Callable[[str], None]


def router(
    settings: Settings, folder: Path, roster: Path | None, id_column: str, driver: str, write: Write
) -> None:
    """Run a gateway until it is interrupted, or change the driver of a gateway that already runs.

    Raises:
        CourseError: A name, file, address or option cannot be used.
    """
    if driver and _is_running(folder):
        if driver != NOBODY:
            tokens = _stored_tokens(folder)
            names = _ros_names(tokens)
            find_student([GatewayUser(key, names[key], token) for key, token in tokens.items()], driver)
        write_atomically(folder / DRIVER, driver.encode(), PRIVATE)
        write(f"The gateway in {folder} now has the driver {driver}.")
        return
    if (settings.certificate is None) != (settings.key is None):
        raise CourseError("TLS needs two files: --certificate cert.pem --key key.pem")
    # Malformed addresses are reported before the first file is written.
    if settings.robot:
        settings = replace(settings, robot=full_address(settings.robot))
    if not LISTEN.fullmatch(settings.listen):
        raise CourseError(f"--listen {settings.listen}: write it like tcp/0.0.0.0:7448")
    protocol, port = settings.listen.partition("/")[0], settings.listen.rpartition(":")[2]
    if (protocol == "tls") != (settings.certificate is not None):
        raise CourseError(f"--listen {settings.listen}: use a certificate with tls/…, and none with tcp/…")
    place = f"{protocol}/{socket.getfqdn()}:{port}"
    users = load_users(folder, roster, id_column, place, "" if driver == NOBODY else driver)
    if not driver and users[-1].student == GUEST:
        driver = GUEST
    first = find_student(users, driver).student if driver and driver != NOBODY else NOBODY
    gateway = Gateway(settings, users, folder / PASSWORDS, write)
    page = StatusPage(lambda: page_text(gateway))
    try:
        write_atomically(folder / PAGE_ADDRESS, page.address.encode(), PRIVATE)
        write_atomically(folder / DRIVER, first.encode(), PRIVATE)
        last = users[-1]
        domain = f" with --domain {settings.domain}" if settings.domain else ""
        write(f"Students connect to {last.address(place) if last.student == GUEST else place}{domain}")
        write(f"Tokens to hand out: {folder / TOKENS}")
        for line in (
            [f"Robot: {settings.robot}"] if settings.robot else _robot_settings(settings, folder, place)
        ):
            write(line)
        for topic in settings.sends:
            write(f"/{STUDENTS}/NAME/{topic} is forwarded to /{topic} while NAME drives")
        for service in settings.calls:
            write(f"Everybody may call /{service}")
        write(f"Status: {page.address}")
        write("Change the driver in another terminal: course router --driver NAME (or: nobody)")
        _serve(gateway, folder / DRIVER, write)
    finally:
        page.close()
        gateway.close()
        (folder / PAGE_ADDRESS).unlink(missing_ok=True)


def _robot_settings(settings: Settings, folder: Path, place: str) -> list[str]:
    """Return the settings for a robot that connects to the gateway."""
    login = f'transport/auth/usrpwd/user="{ROBOT}";transport/auth/usrpwd/password="TOKEN"'
    return [
        "Robot: --robot names no address, so the robot connects to this gateway. Set one of these for it:",
        f"  on this computer, for its nodes:  {_override(settings.robot_listen_address)}",
        f"  on another one, for rmw_zenohd:   {_override(place, login)}",
        f"  (TOKEN is in the row {THE_ROBOT} of {folder / TOKENS}; programs of the course: --robot "
        f"{settings.robot_listen_address})",
    ]


def _override(place: str, *more: str) -> str:
    """Return the shell command with which rmw_zenoh connects to an address."""
    return "export ZENOH_CONFIG_OVERRIDE='" + ";".join([f'connect/endpoints=["{place}"]', *more]) + "'"


def _serve(gateway: Gateway, driver_file: Path, write: Write) -> None:
    """Run the gateway until an interrupt. The file `driver_file` contains the driver's name."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    driver_text, is_linked = "", False
    robot = "robot" if is_over_dds(gateway.settings.robot) else "robot's router"
    try:
        while True:
            gateway.stop(older_than=STALE_SECONDS)
            text = driver_file.read_text(encoding="utf-8").strip() if driver_file.exists() else driver_text
            if text != driver_text:
                driver_text = text
                try:
                    gateway.set_driver(None if text == NOBODY else find_student(gateway.users, text))
                except CourseError as error:
                    write(f"{error} The driver is unchanged.")
                else:
                    write(f"{text} drives.")
            if is_linked != gateway.is_robot_connected():
                is_linked = not is_linked
                write(f"The {robot} is linked." if is_linked else f"The link to the {robot} is lost.")
            gateway.wait(STOP_PERIOD)
    except KeyboardInterrupt:
        write("Stopped.")


def _is_running(folder: Path) -> bool:
    """Return whether a gateway responds at the address stored in the folder."""
    try:
        host, _, port = (folder / PAGE_ADDRESS).read_text("utf-8").split("/")[2].partition(":")
        socket.create_connection((host, int(port)), timeout=1.0).close()
    except (OSError, ValueError, IndexError):
        return False
    return True
