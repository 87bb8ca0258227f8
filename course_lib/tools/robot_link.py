"""`%ros2 connect` and `%ros2 disconnect`: a notebook's link to a robot."""

from argparse import Namespace

from course_lib.ros.connecting import connect, disconnect
from course_lib.tools.sources import Source
from course_lib.tools.verb import Verb, Write, value


def _connect(source: Source, arguments: Namespace, write: Write) -> None:
    connect(arguments.router, domain=arguments.domain, send=arguments.send, call=arguments.call)


def _disconnect(source: Source, arguments: Namespace, write: Write) -> None:
    disconnect()


_OPTIONS = (
    value("router", help="The Zenoh router of the robot: tcp/192.168.1.5:7447"),
    value("--domain", type=int, help="The robot's ROS_DOMAIN_ID"),
    value("--send", action="append", default=[], help="A topic that may go out to the robot"),
    value("--call", action="append", default=[], help="A service or action that may be called"),
)
LINK_VERBS = (
    Verb("connect", "", "Link this notebook to a robot", _OPTIONS, _connect, from_start=True, looks=False),
    Verb("disconnect", "", "End the link to the robot", (), _disconnect, from_start=True, looks=False),
)
