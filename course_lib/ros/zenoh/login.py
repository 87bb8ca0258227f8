"""A gateway (`course router`): the login of a student there, as in tcp/ann:TOKEN@lab:7448, and who drives."""

import re
import ssl
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

ROBOT = "robot"  # the user of a robot that dials in
STUDENTS = "students"  # the namespace of what students send: /students/ann/cmd_vel
PRESENCE = "@course"  # @course/ann/<zid> is the liveliness token of a connected kit
GATEWAY = f"{PRESENCE}/GATEWAY"  # a gateway's token is below it; no student's name has capitals
NONE = "-"  # no driver, or no topics, in a gateway's token


@dataclass(frozen=True)
class Login:
    """The user of a link; without a name, nobody has to log in."""

    name: str = ""
    token: str = ""

    def settings(self, address: str) -> dict[str, Any]:
        """Return Zenoh's settings for the login, and for TLS the certificates that this computer trusts."""
        found: dict[str, Any] = {}
        if self.name:
            found["transport/auth/usrpwd"] = {"user": self.name, "password": self.token}
        trusted = ssl.get_default_verify_paths().cafile  # SSL_CERT_FILE may name others
        if address.startswith("tls/") and trusted:
            found["transport/link/tls"] = {"root_ca_certificate": trusted}
        return found

    def outward(self, topic: str) -> str:
        """Return the topic that a message of this user goes to: a student's below the student's name."""
        below = f"/{STUDENTS}/{self.name}"
        if self.name in ("", ROBOT) or topic.startswith(f"{below}/"):
            return topic
        return below + topic

    def presence(self, zid: str) -> str:
        """Return the key that shows a gateway who is there; "" without a login."""
        return f"{PRESENCE}/{self.name}/{zid}" if self.name else ""


NO_LOGIN = Login()


def gateway_key(driver: str, topics: Iterable[str]) -> str:
    """Return the token that shows students who drives, and the topics that go to the robot."""
    return f"{GATEWAY}/{driver or NONE}/{','.join(topics).replace('/', '%') or NONE}"


def read_gateway_key(key: str) -> tuple[str, list[str]]:
    """Return the driver, "" for none, and the topics in a gateway's token."""
    driver, topics = key.removeprefix(f"{GATEWAY}/").split("/")
    names = [] if topics == NONE else topics.replace("%", "/").split(",")
    return driver if driver != NONE else "", [f"/{name.removeprefix('/')}" for name in names]


def parted(address: str) -> tuple[str, Login]:
    """Return an address without its login, and the login."""
    found = re.fullmatch(r"(\w+/)(\w+):([\w-]+)@(.+)", address)
    return (found[1] + found[4], Login(found[2], found[3])) if found else (address, NO_LOGIN)


class Wheel:
    """The lines to a student on commands that the gateway does not pass on, once for each driver.

    Args:
        login: The student.
        tell: Prints a line.
    """

    def __init__(self, login: Login, tell: Callable[[str], None]) -> None:
        self._login, self._tell = login, tell
        self._driver: str | None = None  # None: not known, "": nobody
        self._topics: Sequence[str] = ()
        self._sent: dict[str, bool] = {}  # topic -> whether the student knows that it is not passed on

    def change(self, driver: str, topics: Sequence[str]) -> None:
        """Note who drives now, and by which topics."""
        changed, self._driver, self._topics = driver != self._driver, driver, topics
        for topic in tuple(self._sent) if changed else ():
            self._explain(topic)

    def sent(self, topic: str) -> None:
        """Note that a message of a topic has gone out."""
        if topic not in self._sent:
            self._sent[topic] = False
            self._explain(topic)

    def rows(self) -> list[tuple[str, object]]:
        """Return the driver as a row of `ros2 doctor`; none without a gateway."""
        if self._driver is None:
            return []
        return [("driver", "you" if self._driver == self._login.name else self._driver or "nobody")]

    def _explain(self, topic: str) -> None:
        outward = self._login.outward(topic)
        if self._driver is None or outward == topic:
            return
        if topic not in self._topics:
            if not self._sent[topic]:
                self._tell(f"The gateway does not pass {topic} on to the robot: others hear it as {outward}.")
            self._sent[topic] = True
        elif self._driver != self._login.name:
            self._tell(
                f"{self._driver or 'Nobody'} drives: your {topic} is not passed on to the robot. The "
                "instructor chooses the driver."
            )
            self._sent[topic] = True
        elif self._sent[topic]:
            self._tell(f"You drive now: your {topic} goes to the robot.")
            self._sent[topic] = False
