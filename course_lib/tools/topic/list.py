"""`ros2 topic list`, `info`, `type` and `find`."""

from argparse import Namespace
from typing import Literal

from course_lib.errors import CourseError, counted, did_you_mean
from course_lib.ros.graph import EndpointInfo, NodeInfo
from course_lib.ros.messages.hashes import is_known, type_hash
from course_lib.ros.qos import Qos
from course_lib.tools.sources import Source
from course_lib.tools.verb import (
    NODE_OPTIONS,
    Verb,
    Write,
    count,
    find_verb,
    flag,
    hidden,
    show_types,
    type_verb,
    value,
    write_names,
)

_SIDES: tuple[tuple[str, Literal["pub", "sub"], str], ...] = (
    ("Published", "pub", "publisher"),
    ("Subscribed", "sub", "subscriber"),
)


def _list_all(source: Source, arguments: Namespace, write: Write) -> None:
    topics = source.topics(hidden=arguments.hidden)
    if arguments.count or not arguments.verbose:
        write_names(topics, arguments, write)
        return
    for title, kind, one in _SIDES:
        write(f"{title} topics:\n")
        for name, types in topics.items():
            if number := len(source.endpoints(name, kind)):
                write(f" * {name} [{', '.join(types)}] {counted(number, one)}\n")
        write("\n")


def _info(source: Source, arguments: Namespace, write: Write) -> None:
    topic, end = arguments.topic_name, "\n\n" if arguments.verbose else "\n"
    types = source.topics().get(topic)
    if not types:
        raise CourseError(f"Unknown topic '{topic}'{did_you_mean(topic, source.topics())}")
    write(f"Type: {types[0] if len(types) == 1 else types}{end}")
    nodes = {node.id: node for node in source.graph.nodes()}
    for title, endpoints in (
        ("Publisher", source.endpoints(topic, "pub")),
        ("Subscription", source.endpoints(topic, "sub")),
    ):
        write(f"{title} count: {len(endpoints)}{end}")
        for endpoint in endpoints if arguments.verbose else ():
            write(f"{describe(endpoint, nodes[endpoint.node], title.upper())}{end}")


def describe(endpoint: EndpointInfo, node: NodeInfo, kind: str) -> str:
    """Describe an endpoint as rclpy's TopicEndpointInfo does."""
    gid = ".".join(f"{byte:02x}" for byte in endpoint.id.to_bytes(16, "big"))
    return (
        f"Node name: {node.name}\nNode namespace: {node.namespace}\nTopic type: {endpoint.type_name}\n"
        f"Topic type hash: {type_hash(endpoint.type_name) if is_known(endpoint.type_name) else 'INVALID'}\n"
        f"Endpoint type: {kind}\nGID: {gid}\nQoS profile:\n{_profile(endpoint.qos)}"
    )


def _profile(qos: Qos) -> str:
    depth = f"KEEP_LAST ({qos.depth})" if qos.history == "keep_last" else "KEEP_ALL"
    rows = {
        "Reliability": qos.reliability.upper(),
        "History (Depth)": depth,
        "Durability": qos.durability.upper(),
        "Lifespan": _duration(qos.lifespan_ns),
        "Deadline": _duration(qos.deadline_ns),
        "Liveliness": qos.liveliness.upper(),
        "Liveliness lease duration": _duration(qos.lease_ns),
    }
    return "\n".join(f"  {name}: {setting}" for name, setting in rows.items())


def _duration(limit_ns: int | None) -> str:
    return "Infinite" if limit_ns is None else f"{limit_ns} nanoseconds"


def _topics(source: Source, with_hidden: bool) -> dict[str, list[str]]:
    return source.topics(hidden=with_hidden)


_NAME = value("topic_name", help="Name of the ROS topic (e.g. '/chatter')")
_TYPE = "Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')"
_VERBOSE = flag(
    "-v", "--verbose", help="Show full details: of each topic, or of who publishes and subscribes"
)
_LIST = (*NODE_OPTIONS, show_types("topic"), count("topic"), hidden("topic"), _VERBOSE)
TOPIC_LISTS = (
    Verb("topic", "list", "Output a list of available topics", _LIST, _list_all),
    Verb("topic", "info", "Print information about a topic", (*NODE_OPTIONS, _NAME, _VERBOSE), _info),
    type_verb("topic", "Print a topic's type", _topics, _NAME),
    find_verb("topic", _topics, _TYPE),
)
