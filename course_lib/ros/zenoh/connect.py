"""Links to robots, from the words that a user writes."""

import atexit
import os
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros import wall
from course_lib.ros.notices import say

if TYPE_CHECKING:
    from course_lib.ros.zenoh.robot_graph import RobotGraph

PORT = 7447  # of rmw_zenohd
MAX_DOMAIN = 232
DISCOVERY = 1.0  # [s] in which nodes of the robot have come up
SETTLED = 0.3  # [s] in which the rest of them comes


@dataclass(frozen=True)
class RobotAddress:
    """The address of a robot, and the names that may go out to it.

    Args:
        router: Like `tcp/192.168.1.5:7447`; the port and `tcp/` may be left out. A gateway's has a login:
            `tcp/ann:TOKEN@lab:7448`.
        domain: ROS_DOMAIN_ID; None takes the environment's, else 0.
        send: Topics that may be sent.
        call: Services and actions that may be called or offered.
        everything: All may go out and be called: the programs are the robot.
    """

    router: str
    domain: int | None = None
    send: Sequence[str] = ()
    call: Sequence[str] = ()
    everything: bool = False


def link_to(robot: RobotAddress, *, notebook: bool = False) -> "RobotGraph":
    """Return a graph that is linked to a robot; it is closed at Python's exit, if not before.

    Raises:
        CourseError: The extra `robot` is not installed, no router answers, or a word is not an address or a
            domain.
    """
    if find_spec("zenoh") is None or find_spec("xxhash") is None:
        raise CourseError('For robots install two more packages: pip install "course-lib[robot]"')
    from course_lib.ros.zenoh.explain import about_domains
    from course_lib.ros.zenoh.link import RobotLink
    from course_lib.ros.zenoh.robot_graph import RobotGraph
    from course_lib.ros.zenoh.sending import Allowed

    tell = say if notebook else _tell_apart
    link = RobotLink(_router(robot.router), _domain(robot.domain))
    allowed = Allowed(everything=True) if robot.everything else Allowed.of(robot.send, robot.call)
    graph = RobotGraph(link, allowed, tell, notebook=notebook)
    atexit.register(graph.leave)
    begun = found = wall.monotonic()
    while wall.monotonic() < min(begun + DISCOVERY, found + SETTLED if graph.nodes() else begun + DISCOVERY):
        found = found if graph.nodes() else wall.monotonic()
        graph.advance()
    if not graph.nodes():
        tell(about_domains(link.domain, link.domains()))
    return graph


def _tell_apart(line: str) -> None:
    """Print a line beside the output of a program or a tool."""
    sys.stderr.write(f"{line}\n")


def _router(text: str) -> str:
    """Return the address in Zenoh's words."""
    found = re.fullmatch(r"(?:(\w+)/)?(\w+:[\w-]+@)?([\w.-]+|\[[0-9a-fA-F:]+\])(?::(\d+))?", text, re.ASCII)
    if found is None:
        raise CourseError(f"{text!r} is not an address of a robot: write it like tcp/192.168.1.5:{PORT}.")
    return f"{found[1] or 'tcp'}/{found[2] or ''}{found[3]}:{found[4] or PORT}"


def _domain(domain: int | None) -> int:
    text = os.environ.get("ROS_DOMAIN_ID", "0") if domain is None else str(domain)
    if not text.isdigit() or int(text) > MAX_DOMAIN:
        raise CourseError(f"{text!r} is not a domain: give a number from 0 to {MAX_DOMAIN}.")
    return int(text)
