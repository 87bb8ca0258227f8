"""`ros2 node list` and `ros2 node info`."""

from argparse import Namespace
from collections.abc import Iterable

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.graph import EndpointInfo
from course_lib.ros.topics import SERVICE_TOPICS
from course_lib.tools.sources import Source, is_hidden
from course_lib.tools.verb import NODE_OPTIONS, Verb, Write, count, flag, value

FEEDBACK = "/_action/feedback"  # of a topic on which an action's server publishes
REQUESTS = f"{SERVICE_TOPICS[0][0]}/"
Named = tuple[str, str]  # a topic's, a service's or an action's name and type


def _list_all(source: Source, arguments: Namespace, write: Write) -> None:
    names = sorted(name for _, name in _nodes(source, hidden=arguments.all))
    if arguments.count:
        write(f"{len(names)}\n")
        return
    if len(set(names)) < len(names):
        write(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, which can have "
            "unintended side effects.\n"
        )
    write("".join(f"{name}\n" for name in names))


def _info(source: Source, arguments: Namespace, write: Write) -> None:
    wanted, hidden = arguments.node_name, arguments.include_hidden
    nodes = _nodes(source, hidden=hidden)
    found = [node for node, name in nodes if name == wanted]
    if not found:
        raise CourseError(f"Unable to find node '{wanted}'{did_you_mean(wanted, dict(nodes).values())}")
    if len(found) > 1:
        write(
            f'There are {len(found)} nodes in the graph with the exact name "{wanted}". You are seeing '
            "information about only one of them.\n"
        )
    write(f"{wanted}\n")
    for title, named in _sections([e for e in source.graph.endpoints() if e.node == found[0]]).items():
        shown = sorted({(name, of) for name, of in named if hidden or not is_hidden(name)})
        write(f"  {title}:\n" + "\n".join(f"    {name}: {of}" for name, of in shown) + "\n")


def _nodes(source: Source, *, hidden: bool) -> list[tuple[int, str]]:
    """List the nodes' ids and full names."""
    nodes = source.graph.nodes()
    return [(node.id, node.full_name) for node in nodes if hidden or not node.name.startswith("_")]


def _sections(endpoints: Iterable[EndpointInfo]) -> dict[str, list[Named]]:
    """Group a node's endpoints by section; of a service's two the one for requests counts."""
    titles = ("Subscribers", "Publishers", "Service Servers", "Service Clients")
    found: dict[str, list[Named]] = {name: [] for name in (*titles, "Action Servers", "Action Clients")}
    for endpoint in endpoints:
        one = "Subscribers" if endpoint.kind == "sub" else "Publishers"
        if endpoint.service is None:
            found[one].append((endpoint.topic, endpoint.type_name))
        elif endpoint.topic.startswith(REQUESTS):
            found["Service Servers" if endpoint.kind == "sub" else "Service Clients"].append(endpoint.service)
        if endpoint.topic.endswith(FEEDBACK):
            role = "Action Clients" if endpoint.kind == "sub" else "Action Servers"
            action = endpoint.topic.removesuffix(FEEDBACK)
            found[role].append((action, endpoint.type_name.removesuffix("_FeedbackMessage")))
    return found


_LIST = (flag("-a", "--all", help="Display all nodes even hidden ones"), count("node"))
_INFO = (
    value("node_name", help="Node name to request information"),
    flag("--include-hidden", help="Display hidden topics, services, and actions as well"),
)
NODE_VERBS = (
    Verb("node", "list", "Output a list of available nodes", (*NODE_OPTIONS, *_LIST), _list_all),
    Verb("node", "info", "Output information about a node", (*NODE_OPTIONS, *_INFO), _info),
)
