"""The login of a student at a gateway (`course router`), from an address like tcp/ann:TOKEN@lab:7448."""

import re
import ssl
from collections.abc import Iterable
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
