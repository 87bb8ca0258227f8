"""ROS software that a kit without ROS can't offer, and what does its work here."""

import re
import tomllib
from pathlib import Path

_ELSEWHERE = "or run it on a computer with ROS 2 and link to that: course run FILE --robot tcp/HOST:7447"
_TABLE = Path(__file__).with_name("not_offered.toml")
_PROJECTS = tomllib.loads(_TABLE.read_text(encoding="utf-8"))["project"]


def not_offered(package: str) -> str:
    """Return the reason for a package to be missing, and what to do; "" for other packages."""
    for one in _PROJECTS:
        if re.fullmatch(one["names"], package):
            return f"{one['reason']}, which pip can't install. Here {one['instead']}; {_ELSEWHERE}."
    return ""
