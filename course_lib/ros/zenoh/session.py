"""Zenoh sessions in client mode, and handlers that run in Zenoh's own threads."""

import _thread
import json
import re
import ssl
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import zenoh
from zenoh.handlers import Callback

from course_lib.errors import CourseError
from course_lib.ros.time import wall

ROBOT = "robot"  # user name of a robot that connects to the gateway
# Namespace of the topics that students send, as in /students/ann/cmd_vel.
STUDENTS = "students"
# @course/ann/<zid> is the liveliness token of a connected kit. Students' names have no capital
# letters, so @course/GATEWAY is available for the gateway's token.
PRESENCE = "@course"
GATEWAY = f"{PRESENCE}/GATEWAY"
# Stands for no driver, or no topics, in the gateway's token.
NONE = "-"


@dataclass(frozen=True)
class Login:
    """The user of a link. An empty name means that no login is needed."""

    name: str = ""
    token: str = ""

    def settings(self, address: str) -> dict[str, Any]:
        """Return Zenoh's settings: the login and, for TLS, the certificates that this computer trusts."""
        settings: dict[str, Any] = {}
        if self.name:
            settings["transport/auth/usrpwd"] = {"user": self.name, "password": self.token}
        # The environment variable SSL_CERT_FILE overrides the default.
        certificates = ssl.get_default_verify_paths().cafile
        if address.startswith("tls/") and certificates:
            settings["transport/link/tls"] = {"root_ca_certificate": certificates}
        return settings

    def network_topic(self, topic: str) -> str:
        """Return the topic on which this user's messages are sent; for students, in their namespace."""
        namespace = f"/{STUDENTS}/{self.name}"
        if self.name in ("", ROBOT) or topic.startswith(f"{namespace}/"):
            return topic
        return namespace + topic

    def presence_key(self, zid: str) -> str:
        """Return the key of the token that makes this user known to a gateway; "" without a login."""
        return f"{PRESENCE}/{self.name}/{zid}" if self.name else ""


NO_LOGIN = Login()


def gateway_key(driver: str, topics: Iterable[str]) -> str:
    """Return the key of the token with the driver and the topics that are forwarded to the robot."""
    return f"{GATEWAY}/{driver or NONE}/{','.join(topics).replace('/', '%') or NONE}"


def read_gateway_key(key: str) -> tuple[str, list[str]]:
    """Return the driver ("" if there is none) and the topics in the key of a gateway's token."""
    driver, topics = key.removeprefix(f"{GATEWAY}/").split("/")
    names = [] if topics == NONE else topics.replace("%", "/").split(",")
    return driver if driver != NONE else "", [f"/{name.removeprefix('/')}" for name in names]


def split_login(address: str) -> tuple[str, Login]:
    """Split an address into the address without the login, and the login."""
    match = re.fullmatch(r"(\w+/)(\w+):([\w-]+)@(.+)", address)
    return (match[1] + match[4], Login(match[2], match[3])) if match else (address, NO_LOGIN)


class DriverLock:
    """Reports the student's topics that a gateway does not forward, once for each driver.

    Args:
        login: The student's login.
        report: Prints a line.
    """

    def __init__(self, login: Login, report: Callable[[str], None]) -> None:
        self._login, self._report = login, report
        # None: not known yet; "": there is no driver.
        self._driver: str | None = None
        # The topics that the gateway forwards.
        self._topics: Sequence[str] = ()
        # By sent topic: whether it was reported as not forwarded.
        self._reported: dict[str, bool] = {}

    def change(self, driver: str, topics: Sequence[str]) -> None:
        """Set the driver and the topics that the gateway forwards."""
        has_changed = driver != self._driver
        self._driver, self._topics = driver, topics
        for topic in tuple(self._reported) if has_changed else ():
            self._explain(topic)

    def on_sent(self, topic: str) -> None:
        """Record that a message on a topic has been sent."""
        if topic not in self._reported:
            self._reported[topic] = False
            self._explain(topic)

    def status_rows(self) -> list[tuple[str, object]]:
        """Return the driver as a row of `ros2 doctor`. Without a gateway, return no row."""
        if self._driver is None:
            return []
        return [("driver", "you" if self._driver == self._login.name else self._driver or "nobody")]

    def _explain(self, topic: str) -> None:
        network_topic = self._login.network_topic(topic)
        if self._driver is None or network_topic == topic:
            return
        if topic not in self._topics:
            if not self._reported[topic]:
                self._report(
                    f"The gateway does not pass {topic} on to the robot: others hear it as {network_topic}."
                )
            self._reported[topic] = True
        elif self._driver != self._login.name:
            self._report(
                f"{self._driver or 'Nobody'} drives: your {topic} is not passed on to the robot. "
                "The instructor chooses the driver."
            )
            self._reported[topic] = True
        elif self._reported[topic]:
            self._report(f"You drive now: your {topic} goes to the robot.")
            self._reported[topic] = False


OPEN_SECONDS = 3.0  # [s] timeout of a router's answer
CALL_SECONDS = 600.0  # [s] timeout of a service call, as in rmw_zenoh
# Timeout of running handlers at the end, and the polling period.
END_SECONDS, POLL_SECONDS = 2.0, 0.005


class Handlers:
    """Handlers that are called by Zenoh's own threads and counted until each has been dropped.

    Handlers in Python threads would keep the interpreter alive while a session is open, and such a
    thread would belong to the program, whose `Thread.start` robot time replaces. But if the
    interpreter exits while a thread of Zenoh runs a handler, the process aborts. So `wait` has to
    be called after closing a session.
    """

    def __init__(self) -> None:
        self.alive_count, self._mutex = 0, _thread.allocate_lock()

    def direct(
        self,
        function: Callable[[Any], None],
        on_end: Callable[[], None] | None = None,
    ) -> "Callback[Any]":
        """Return a handler for `function`. `on_end` is called after the last call."""
        with self._mutex:
            self.alive_count += 1

        def on_drop() -> None:
            if on_end is not None:
                on_end()
            with self._mutex:
                self.alive_count -= 1

        return Callback(function, on_drop, indirect=False)

    def wait(self, seconds: float = END_SECONDS) -> None:
        """Wait until all handlers have been dropped, at most `seconds`."""
        deadline = wall.monotonic() + seconds
        while self.alive_count and wall.monotonic() < deadline:
            wall.sleep(POLL_SECONDS)


def open_session(address: str, login: Login = NO_LOGIN) -> zenoh.Session:
    """Open a session in client mode, because a robot's router does not route between peers.

    Raises:
        CourseError: No router answers, or the address is invalid.
    """
    settings = {
        "mode": "client",
        "connect/endpoints": [address],
        "connect/timeout_ms": round(OPEN_SECONDS * 1000),
        "connect/retry": {"period_init_ms": 200, "period_max_ms": 1000, "period_increase_factor": 2},
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "listen/endpoints": [],
        # The caches of latched topics require time stamps.
        "timestamping/enabled": True,
        "queries_default_timeout": round(CALL_SECONDS * 1000),
        "transport/shared_memory/enabled": False,
        **login.settings(address),
    }
    config = zenoh.Config()
    try:
        for key, value in settings.items():
            config.insert_json5(key, json.dumps(value))
    except zenoh.ZError as error:
        raise CourseError(f"{address!r} is not an address: write it like tcp/192.168.1.5:7447.") from error
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise CourseError(_unreachable_message(address, login)) from error


def _unreachable_message(address: str, login: Login) -> str:
    """Return the error text for an address that does not answer."""
    if login.name:
        return (
            f"No gateway lets {login.name} in at {address}. Does `course router` run there, is the "
            "token the one that you were given, is this the right network?"
        )
    return (
        f"No Zenoh router answers at {address}. Does `ros2 run rmw_zenoh_cpp rmw_zenohd` run on "
        "the robot, is its port open, is this the right network? A robot without Zenoh has an "
        "address like dds/192.168.1.5."
    )
