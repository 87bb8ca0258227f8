"""`ros2 service list|type|find|info|call`."""

import sys
from argparse import Namespace

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.messages import service_class, type_name
from course_lib.ros.topics import SERVICE_TOPICS
from course_lib.tools.message_yaml import check_type, fill, kind_of
from course_lib.tools.sources import Source, answer, is_hidden, own_node
from course_lib.tools.verb import (
    NODE_OPTIONS,
    Verb,
    Write,
    count,
    find_verb,
    flag,
    hidden,
    positive,
    show_types,
    type_verb,
    value,
    write_names,
)

CALL_LIMIT = 10.0  # [s] for a service and its answer, if nobody can press ■


def _list_all(source: Source, arguments: Namespace, write: Write) -> None:
    write_names(_services(source, arguments.hidden), arguments, write)


def _info(source: Source, arguments: Namespace, write: Write) -> None:
    name, there = arguments.service_name, _services(source, True)
    if name not in there:
        raise CourseError(f"Unknown service '{name}'{did_you_mean(name, there)}")
    types = there[name]
    write(f"Type: {types[0] if len(types) == 1 else types}\n")
    prefix, suffix = SERVICE_TOPICS[0]
    write(f"Clients count: {len(source.endpoints(f'{prefix}{name}{suffix}', 'pub'))}\n")
    write(f"Services count: {len(source.endpoints(f'{prefix}{name}{suffix}', 'sub'))}\n")


def _call(source: Source, arguments: Namespace, write: Write) -> None:
    kind = kind_of(service_class, arguments.service_type, "srv")
    request = kind.Request()
    fill(request, sys.stdin.read() if arguments.stdin else arguments.values)
    name, limit, there = arguments.service_name, source.limit(CALL_LIMIT), _services(source, True)
    check_type(name, type_name(kind.Request).removesuffix("_Request"), there)
    with until_interrupted(), own_node(source) as node:
        client = node.create_client(kind, name)
        if not client.service_is_ready():
            write("waiting for service to become available...\n")
            if not source.wait(client.service_is_ready, limit):
                raise CourseError(f"Nobody offers the service '{name}'{did_you_mean(name, there) or '.'}")
        while not source.graph.ended:
            write(f"requester: making request: {request!r}\n\n")
            begun_ns = source.graph.now_ns
            write(f"response:\n{answer(source, client.call_async(request), name, limit)!r}\n\n")
            if arguments.rate is None:
                return
            next_ns = begun_ns + round(1e9 / arguments.rate)
            source.wait(lambda: False, max(0, next_ns - source.graph.now_ns) * 1e-9)


def _services(source: Source, with_hidden: bool) -> dict[str, list[str]]:
    """Return the sorted types of each service, by name."""
    from rclpy.impl.graph_queries import services

    found = services(source.graph.endpoints())
    return {name: types for name, types in found if with_hidden or not is_hidden(name)}


_NAME = value("service_name", help="Name of the ROS service (e.g. '/add_two_ints')")
_TYPE = "Type of the ROS service (e.g. 'std_srvs/srv/Empty')"
_LIST = (show_types("service"), count("service"), hidden("service"))
_CALL = (
    _NAME,
    value("service_type", help=_TYPE),
    value("values", nargs="?", default="{}", help="Values to fill the request with (e.g. '{a: 1, b: 2}')"),
    flag("--stdin", help="Read values from standard input"),
    value("-r", "--rate", metavar="N", type=positive(float), help="Repeat the call at a specific rate in Hz"),
)
SERVICE_VERBS = (
    Verb("service", "list", "Output a list of available services", (*NODE_OPTIONS, *_LIST), _list_all),
    type_verb("service", "Output a service's type", _services, _NAME),
    find_verb("service", _services, _TYPE),
    Verb("service", "info", "Print information about a service", (*NODE_OPTIONS, _NAME), _info),
    Verb("service", "call", "Call a service", (*NODE_OPTIONS, *_CALL), _call),
)
