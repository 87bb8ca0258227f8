"""Linking a program or a notebook to a robot."""

import atexit
import os
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING

from course_lib.errors import CourseError, format_count
from course_lib.ros.graph.graph import Graph, current_graph, set_graph
from course_lib.ros.notices import print_notice, print_to_stderr
from course_lib.ros.robot.addresses import DDS, full_address, is_over_dds
from course_lib.ros.time import wall
from course_lib.ros.time.interrupts import exit_at_signals

if TYPE_CHECKING:
    from course_lib.ros.dds.link import DdsLink
    from course_lib.ros.robot.link import Link
    from course_lib.ros.robot.robot_graph import RobotGraph

MAX_DOMAIN = 232
# Time in which the first node of the robot must be discovered [s].
DISCOVERY_SECONDS = 1.0
# Time after the first node in which the other nodes are discovered [s].
SETTLING_SECONDS = 0.3


@dataclass(frozen=True)
class RobotAddress:
    """The address of a robot, and permissions for sending to it.

    Args:
        router: `dds/192.168.1.5` for a link over DDS, or the robot's Zenoh router, like
            `tcp/192.168.1.5:7447`; `tcp/` and the port are optional. The address of a gateway has a
            login: `tcp/ann:TOKEN@lab:7448`.
        domain: ROS_DOMAIN_ID; None: the value of the environment variable, else 0.
        send: Topics that may be sent.
        call: Services and actions that may be called or offered.
        everything: Whether everything may be sent and offered, because the linked program is the
            robot.
    """

    router: str
    domain: int | None = None
    send: Sequence[str] = ()
    call: Sequence[str] = ()
    everything: bool = False


def link_to(robot: RobotAddress, *, notebook: bool = False) -> "RobotGraph":
    """Return a graph that is linked to a robot. It is closed when Python exits, if not before.

    Raises:
        CourseError: The extra `robot` is not installed, no router answers, or the address or domain
            is malformed.
    """
    from course_lib.ros.robot.robot_graph import RobotGraph
    from course_lib.ros.robot.sending import Permissions

    report = print_notice if notebook else print_to_stderr
    # In ROS an empty variable means domain 0, too.
    text = (os.environ.get("ROS_DOMAIN_ID") or "0") if robot.domain is None else str(robot.domain)
    if not text.isdecimal() or int(text) > MAX_DOMAIN:
        raise CourseError(f"{text!r} is not a domain: expected a number from 0 to {MAX_DOMAIN}.")
    link: Link
    if is_over_dds(robot.router):
        link = open_dds_link(robot.router, int(text))
    else:
        router = full_address(robot.router)
        require_zenoh(f"A link over DDS, like {DDS}192.168.1.5, needs none.")
        from course_lib.ros.zenoh.link import ZenohLink

        link = ZenohLink(router, int(text))
    allowed = (
        Permissions(allows_everything=True)
        if robot.everything
        else Permissions.from_names(robot.send, robot.call)
    )
    graph = RobotGraph(link, allowed, report, notebook=notebook)
    atexit.register(graph.close_at_exit)
    if not notebook:
        exit_at_signals()
    deadline = wall.monotonic() + DISCOVERY_SECONDS
    settled_at: float | None = None
    while wall.monotonic() < min(deadline, settled_at or deadline):
        if settled_at is None and graph.nodes():
            settled_at = wall.monotonic() + SETTLING_SECONDS
        graph.advance()
    if not graph.nodes():
        report(link.no_nodes_message())
    return graph


def require_zenoh(instead: str) -> None:
    """Check that the optional packages of links over Zenoh are installed.

    Call it before an import of `course_lib.ros.zenoh`, whose modules need them.

    Args:
        instead: What works without them, for the error message.

    Raises:
        CourseError: One of the two packages is missing.
    """
    if find_spec("zenoh") is None or find_spec("xxhash") is None:
        raise CourseError(
            f'A link over Zenoh needs two more packages: pip install "course-lib[robot]". {instead}'
        )


def open_dds_link(address: str, domain: int) -> "DdsLink":
    """Open a link over DDS for an address like `dds/HOST`.

    Raises:
        CourseError: The address is malformed, the host is unknown, or no network leads there.
    """
    from course_lib.ros.dds.link import DdsLink

    return DdsLink(full_address(address).removeprefix(DDS), domain)


def connect(
    router: str, *, domain: int | None = None, send: Sequence[str] = (), call: Sequence[str] = ()
) -> None:
    """Link this notebook to a robot. Without `send` and `call` the link is read-only.

    Args:
        router: The robot, like `dds/192.168.1.5`, or its Zenoh router, like `tcp/192.168.1.5:7447`.
        domain: ROS_DOMAIN_ID; None: the value of the environment variable, else 0.
        send: Topics that may be sent to the robot, like `["/cmd_vel"]`.
        call: Services and actions that may be called.

    Raises:
        CourseError: `send` or `call` is a string, nodes or viewers already exist, the notebook is
            already linked, or the robot cannot be reached.
    """
    for name, value in (("send", send), ("call", call)):
        # A string is a sequence of its letters, each of which would be allowed as a topic.
        if isinstance(value, str):
            raise CourseError(f"{name}={value!r} is a string, and a list is expected: {name}=[{value!r}]")
    # Not at the top, because driving imports rclpy, which a command that only links does without.
    from course_lib.ros.time.driving import drive_between_cells

    graph = current_graph()
    if not graph.notebook:
        raise CourseError(
            "connect() is for notebooks; exercises are checked without a robot. For a program "
            f"type: course run my_node.py --robot {router}"
        )
    if graph.link_report():
        raise CourseError("This notebook is already linked to a robot. Type: %ros2 disconnect")
    if graph.nodes():
        names = ", ".join(node.full_name for node in graph.nodes())
        raise CourseError(f"Nodes already exist ({names}): restart the kernel, and connect first.")
    if graph.is_tapped:
        raise CourseError(
            "A viewer or a recording already exists, and would not receive the robot's messages: "
            "restart the kernel, and connect first."
        )
    linked = link_to(RobotAddress(router, domain, send, call), notebook=True)
    set_graph(linked)
    drive_between_cells(linked)
    allowed_names = ", ".join(sorted([*send, *call]))
    rule = f"Sending is allowed for {allowed_names}." if allowed_names else "The link is read-only."
    nodes = format_count(len(linked.nodes()), "node")
    print_notice(f"Linked to {linked.link.address}: {nodes}. {rule}")


def disconnect() -> None:
    """Close the notebook's link. The robot stops, and the notebook's nodes end.

    Raises:
        CourseError: There is no link.
    """
    from course_lib.ros.time.driving import stop_all

    graph = current_graph()
    if not graph.link_report():
        raise CourseError("This notebook is not linked to a robot. Type: %ros2 connect ADDRESS")
    stop_all()
    set_graph(Graph(notebook=True))
    graph.close()
    print_notice("The link is closed, and its nodes and viewers have ended: run their cells again.")
