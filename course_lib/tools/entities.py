"""`ros2 service`, `ros2 action`, `ros2 node`, `ros2 lifecycle` and `ros2 interface`."""

import re
import sys
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.graph.graph import EndpointInfo
from course_lib.ros.graph.topics import SERVICE_TOPICS
from course_lib.ros.messages import RosMessage, action_class, message_class, service_class, type_name
from course_lib.ros.messages.conversions import PrintOptions, to_yaml
from course_lib.ros.messages.definitions import (
    DEFAULTS,
    FIRST_PARTS,
    FOLDERS,
    PRIMITIVES,
    RENAMED,
    definition,
    field_definitions,
    find_package,
    find_workspace_packages,
    interfaces,
    type_names,
)
from course_lib.ros.messages.interface_files import PARTS, PLACEHOLDER, kit_files
from course_lib.ros.time.interrupts import until_interrupted
from course_lib.tools.sources import Source, is_hidden, own_node, wait_for_response
from course_lib.tools.verb import (
    NODE_OPTIONS,
    Option,
    Verb,
    Write,
    check_type,
    count,
    fill,
    flag,
    hidden,
    kind_of,
    make_find_verb,
    make_list_verb,
    make_type_verb,
    positive,
    show_types,
    value,
)

if TYPE_CHECKING:
    from rclpy.node import Node

# Time limit for a service's response if ■ cannot be pressed [s].
ANSWER_LIMIT = 10.0


def _print_service_info(source: Source, arguments: Namespace, write: Write) -> None:
    name, services = arguments.service_name, _services(source, True)
    if name not in services:
        raise CourseError(f"Unknown service '{name}'{did_you_mean(name, services)}")
    types = services[name]
    write(f"Type: {types[0] if len(types) == 1 else types}\n")
    prefix, suffix = SERVICE_TOPICS[0]
    write(f"Clients count: {len(source.endpoints(f'{prefix}{name}{suffix}', 'pub'))}\n")
    write(f"Services count: {len(source.endpoints(f'{prefix}{name}{suffix}', 'sub'))}\n")


def _call_service(source: Source, arguments: Namespace, write: Write) -> None:
    kind = kind_of(service_class, arguments.service_type, "srv")
    request = kind.Request()
    fill(request, sys.stdin.read() if arguments.stdin else arguments.values)
    name, limit, services = arguments.service_name, source.limit(ANSWER_LIMIT), _services(source, True)
    check_type(name, type_name(kind.Request).removesuffix("_Request"), services)
    with until_interrupted(), own_node(source) as node:
        client = node.create_client(kind, name)
        if not client.service_is_ready():
            write("waiting for service to become available...\n")
            # A launch that ends invalidates the context while the call waits.
            if not source.wait(lambda: node.context.ok() and client._course_is_ready(), limit):
                raise CourseError(f"No node serves the service '{name}'{did_you_mean(name, services) or '.'}")

        has_server = partial(_has_server, node, client)
        while not source.graph.ended:
            write(f"requester: making request: {request!r}\n\n")
            begun_ns = source.graph.now_ns
            response = wait_for_response(source, client.call_async(request), name, limit, has_server)
            write(f"response:\n{response!r}\n\n")
            if arguments.rate is None:
                return
            next_ns = begun_ns + round(1e9 / arguments.rate)
            source.wait(lambda: False, max(0, next_ns - source.graph.now_ns) * 1e-9)


def _has_server(node: "Node", client: Any) -> bool:
    """Return whether a service or action client has a server; also true after a shutdown of its context."""
    return not node.context.ok() or client._course_is_ready()


def _services(source: Source, with_hidden: bool) -> dict[str, list[str]]:
    """Return the sorted types of each service by name."""
    from rclpy.impl.graph_queries import services

    service_types = services(source.graph.endpoints())
    return {name: types for name, types in service_types if with_hidden or not is_hidden(name)}


_SERVICE_NAME = value("service_name", help="Name of the ROS service (e.g. '/add_two_ints')")
_SERVICE_TYPE = "Type of the ROS service (e.g. 'std_srvs/srv/Empty')"
_CALL = (
    _SERVICE_NAME,
    value("service_type", help=_SERVICE_TYPE),
    value("values", nargs="?", default="{}", help="Values to fill the request with (e.g. '{a: 1, b: 2}')"),
    flag("--stdin", help="Read values from standard input"),
    value("-r", "--rate", metavar="N", type=positive(float), help="Repeat the call at a specific rate in Hz"),
)
SERVICE_VERBS = (
    make_list_verb("service", "Output a list of available services", _services, hidden("service")),
    make_type_verb("service", "Output a service's type", _services, _SERVICE_NAME),
    make_find_verb("service", _services, _SERVICE_TYPE),
    Verb(
        "service",
        "info",
        "Print information about a service",
        (*NODE_OPTIONS, _SERVICE_NAME),
        _print_service_info,
    ),
    Verb("service", "call", "Call a service", (*NODE_OPTIONS, *_CALL), _call_service),
)


# Time limit for a goal if ■ cannot be pressed [s].
GOAL_LIMIT = 60.0
# Suffix of the topic on which an action server publishes feedback.
FEEDBACK = "/_action/feedback"


def _print_action_info(source: Source, arguments: Namespace, write: Write) -> None:
    name = arguments.action_name
    write(f"Action: {name}\n")
    nodes = {node.id: node.full_name for node in source.graph.nodes()}
    sides: tuple[tuple[str, Literal["pub", "sub"]], ...] = (("clients", "sub"), ("servers", "pub"))
    for title, kind in sides:
        endpoints = source.endpoints(f"{name}{FEEDBACK}", kind)
        write(f"Action {title}: {len(endpoints)}\n")
        for endpoint in () if arguments.count else endpoints:
            type_text = (
                f" [{endpoint.type_name.removesuffix('_FeedbackMessage')}]" if arguments.show_types else ""
            )
            write(f"    {nodes[endpoint.node]}{type_text}\n")


def _send_goal(source: Source, arguments: Namespace, write: Write) -> None:
    """Send a goal and wait for its result. ■ cancels the goal."""
    from rclpy.action import ActionClient

    kind, name = kind_of(action_class, arguments.action_type, "action"), arguments.action_name
    goal = kind.Goal()
    text = sys.stdin.read() if arguments.stdin else arguments.goal
    fill(goal, text, failed="Failed to populate message fields")
    actions = _actions(source)
    check_type(name, type_name(kind.Goal).removesuffix("_Goal"), actions)
    with until_interrupted(), own_node(source) as node:
        client = ActionClient(node, kind, name)
        node.add_waitable(client)
        write("Waiting for an action server to become available...\n")
        if not source.wait(client._course_is_ready, source.limit()):
            raise CourseError(f"No node serves the action '{name}'{did_you_mean(name, actions) or '.'}")
        write(f"Sending goal:\n     {_text(goal)}\n")

        def show(message: Any) -> None:
            write(f"Feedback:\n    {_text(message.feedback)}\n")

        has_server = partial(_has_server, node, client)
        goal_future = client.send_goal_async(goal, show if arguments.feedback else None)
        handle = wait_for_response(source, goal_future, name, source.limit(), has_server)
        if handle.accepted:
            write(f"Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n\n")
            _wait_for_goal_end(source, handle, write, has_server)
        else:
            write("Goal was rejected.\n")


def _wait_for_goal_end(source: Source, handle: Any, write: Write, has_server: Callable[[], bool]) -> None:
    from rclpy.action.server import STATES

    future = handle.get_result_async()
    try:
        result = wait_for_response(source, future, "The action", source.limit(GOAL_LIMIT), has_server)
        write(f"Result:\n    {_text(result.result)}\nGoal finished with status: {STATES[result.status]}\n")
    finally:
        if future._pending() and has_server() and not source.graph.ended:
            write("Canceling goal...\n")
            response = wait_for_response(source, handle.cancel_goal_async(), "The action", source.limit())
            write("Goal canceled.\n" if response.goals_canceling else "Failed to cancel goal\n")


def _text(message: RosMessage) -> str:
    return to_yaml(message, PrintOptions(truncate=None))


def _actions(source: Source, with_hidden: bool = True) -> dict[str, list[str]]:
    from rclpy.impl.graph_queries import actions

    return dict(actions(source.graph.endpoints()))


_ACTION_NAME = value("action_name", help="Name of the ROS action (e.g. '/fibonacci')")
_SHOW = show_types("action")
_COUNT = flag("-c", "--count", help="Only display the number of action clients and action servers")
_SEND = (
    value("action_type", help="Type of the ROS action (e.g. 'example_interfaces/action/Fibonacci')"),
    value("goal", nargs="?", default="{}", help="Goal request values in YAML format (e.g. '{order: 10}')"),
    flag("--stdin", help="Read goal from standard input"),
    flag("-f", "--feedback", help="Echo feedback messages for the goal"),
)
ACTION_VERBS = (
    make_list_verb("action", "Output a list of action names", _actions),
    make_type_verb("action", "Print a action's type", _actions, _ACTION_NAME),
    Verb(
        "action",
        "info",
        "Print information about an action",
        (*NODE_OPTIONS, _ACTION_NAME, _SHOW, _COUNT),
        _print_action_info,
    ),
    Verb("action", "send_goal", "Send an action goal", (*NODE_OPTIONS, _ACTION_NAME, *_SEND), _send_goal),
)


REQUESTS = f"{SERVICE_TOPICS[0][0]}/"
# The name and type of a topic, service or action.
Named = tuple[str, str]


def _list_nodes(source: Source, arguments: Namespace, write: Write) -> None:
    names = sorted(name for _, name in _graph_nodes(source, with_hidden=arguments.all))
    if arguments.count:
        write(f"{len(names)}\n")
        return
    if len(set(names)) < len(names):
        sys.stderr.write(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, which "
            "can have unintended side effects.\n"
        )
    write("".join(f"{name}\n" for name in names))


def _print_node_info(source: Source, arguments: Namespace, write: Write) -> None:
    node_name, with_hidden = arguments.node_name, arguments.include_hidden
    nodes = _graph_nodes(source, with_hidden=with_hidden)
    node_ids = [node for node, name in nodes if name == node_name]
    if not node_ids:
        raise CourseError(f"Unable to find node '{node_name}'{did_you_mean(node_name, dict(nodes).values())}")
    if len(node_ids) > 1:
        sys.stderr.write(
            f'There are {len(node_ids)} nodes in the graph with the exact name "{node_name}". You are seeing '
            "information about only one of them.\n"
        )
    write(f"{node_name}\n")
    for title, entities in _sections([e for e in source.graph.endpoints() if e.node == node_ids[0]]).items():
        rows = sorted({(name, of) for name, of in entities if with_hidden or not is_hidden(name)})
        write(f"  {title}:\n" + "\n".join(f"    {name}: {of}" for name, of in rows) + "\n")


def _graph_nodes(source: Source, *, with_hidden: bool) -> list[tuple[int, str]]:
    """List the ids and full names of the nodes."""
    nodes = source.graph.nodes()
    nodes = [node for node in nodes if with_hidden or not node.name.startswith("_")]
    return [(node.id, node.full_name) for node in nodes]


def _sections(endpoints: Iterable[EndpointInfo]) -> dict[str, list[Named]]:
    """Group a node's endpoints by section. A service counts once, by its request topic."""
    titles = ("Subscribers", "Publishers", "Service Servers", "Service Clients")
    sections: dict[str, list[Named]] = {name: [] for name in (*titles, "Action Servers", "Action Clients")}
    for endpoint in endpoints:
        section = "Subscribers" if endpoint.kind == "sub" else "Publishers"
        if endpoint.service is None:
            sections[section].append((endpoint.topic, endpoint.type_name))
        elif endpoint.topic.startswith(REQUESTS):
            sections["Service Servers" if endpoint.kind == "sub" else "Service Clients"].append(
                endpoint.service
            )
        if endpoint.topic.endswith(FEEDBACK):
            role = "Action Clients" if endpoint.kind == "sub" else "Action Servers"
            action = endpoint.topic.removesuffix(FEEDBACK)
            sections[role].append((action, endpoint.type_name.removesuffix("_FeedbackMessage")))
    return sections


_NODE_LIST = (flag("-a", "--all", help="Display all nodes even hidden ones"), count("node"))
_NODE_INFO = (
    value("node_name", help="Node name to request information"),
    flag("--include-hidden", help="Display hidden topics, services, and actions as well"),
)
NODE_VERBS = (
    Verb("node", "list", "Output a list of available nodes", (*NODE_OPTIONS, *_NODE_LIST), _list_nodes),
    Verb("node", "info", "Output information about a node", (*NODE_OPTIONS, *_NODE_INFO), _print_node_info),
)


GET_STATE, STATE_TYPE = "/get_state", "lifecycle_msgs/srv/GetState"


def _list_lifecycle_nodes(source: Source, arguments: Namespace, write: Write) -> None:
    names = _lifecycle_nodes(source, with_hidden=arguments.all)
    write(f"{len(names)}\n" if arguments.count else "".join(f"{name}\n" for name in names))


def _print_state(source: Source, arguments: Namespace, write: Write) -> None:
    node_name, with_hidden = arguments.node_name, arguments.hidden
    for name in (
        [_find_lifecycle_node(source, arguments)]
        if node_name
        else _lifecycle_nodes(source, with_hidden=with_hidden)
    ):
        state = _call_lifecycle_service(source, name, "GetState", "get_state").current_state
        write(f"{'' if node_name else f'{name}: '}{state.label} [{state.id}]\n")


def _list_transitions(source: Source, arguments: Namespace, write: Write) -> None:
    service = "get_transition_graph" if arguments.all else "get_available_transitions"
    for edge in _transitions(source, _find_lifecycle_node(source, arguments), service):
        write(f"- {edge.transition.label} [{edge.transition.id}]\n")
        write(f"\tStart: {edge.start_state.label}\n\tGoal: {edge.goal_state.label}\n")


def _change_state(source: Source, arguments: Namespace, write: Write) -> None:
    node, label_or_id = _find_lifecycle_node(source, arguments), arguments.transition
    available = [edge.transition for edge in _transitions(source, node, "get_available_transitions")]
    matching = [transition for transition in available if transition.label == label_or_id] or [
        transition for transition in available if str(transition.id) == label_or_id
    ]
    if not matching:
        lines = "".join(f"\n- {transition.label} [{transition.id}]" for transition in available)
        raise CourseError(f"Unknown transition requested, available ones are:{lines}")
    is_changed = _call_lifecycle_service(
        source, node, "ChangeState", "change_state", transition=matching[0]
    ).success
    write_line = write if is_changed else sys.stderr.write
    write_line(f"Transitioning {'successful' if is_changed else 'failed'}\n")


def _transitions(source: Source, node: str, service: str) -> Any:
    return _call_lifecycle_service(source, node, "GetAvailableTransitions", service).available_transitions


def _call_lifecycle_service(
    source: Source, node_name: str, kind_name: str, service: str, **fields: Any
) -> Any:
    """Return the response of one of a node's services."""
    kind: Any = service_class(f"lifecycle_msgs/srv/{kind_name}")
    name = f"{node_name}/{service}"
    with until_interrupted(), own_node(source) as node:
        future = node.create_client(kind, name).call_async(kind.Request(**fields))
        return wait_for_response(source, future, name, source.limit(ANSWER_LIMIT))


def _lifecycle_nodes(source: Source, *, with_hidden: bool) -> list[str]:
    """List the full names of nodes with the service `get_state`."""
    services = {e.service[0] for e in source.graph.endpoints() if e.service and e.service[1] == STATE_TYPE}
    nodes = {node.full_name for node in source.graph.nodes() if f"{node.full_name}{GET_STATE}" in services}
    return sorted(name for name in nodes if with_hidden or not is_hidden(name))


def _find_lifecycle_node(source: Source, arguments: Namespace) -> str:
    """Return the full name of the lifecycle node in the arguments."""
    name = arguments.node_name
    full = name if name.startswith("/") else f"/{name}"
    nodes = _lifecycle_nodes(source, with_hidden=arguments.hidden)
    if full not in nodes:
        raise CourseError(f"Node not found{did_you_mean(full, nodes)}")
    return full


_HIDDEN = flag("--include-hidden-nodes", dest="hidden", help="Consider hidden nodes as well")
_NODE = value("node_name", help="Name of the ROS node")
_NODES = (flag("-a", "--all", help="Display all nodes even hidden ones"), count("node"))
_MAYBE = value(
    "node_name",
    nargs="?",
    help="Name of the ROS node. If no name is provided, then get the state for all nodes.",
)
_ALL = flag("-a", "--all", help="Display all existing transitions")
_TRANSITION = value("transition", help="The lifecycle transition")
LIFECYCLE_VERBS = tuple(
    Verb("lifecycle", name, about, (*NODE_OPTIONS, *options), run)
    for name, about, options, run in (
        ("get", "Get lifecycle state for one or more nodes", (_MAYBE, _HIDDEN), _print_state),
        ("list", "Output a list of available transitions", (_NODE, _HIDDEN, _ALL), _list_transitions),
        ("nodes", "Output a list of nodes with lifecycle", _NODES, _list_lifecycle_nodes),
        ("set", "Trigger lifecycle state transition", (_NODE, _HIDDEN, _TRANSITION), _change_state),
    )
)


_TITLES = {"msg": "Messages", "srv": "Services", "action": "Actions"}


def _find_workspace_types() -> None:
    """Add the types of the workspace's packages, and report invalid files on stderr."""
    for error in find_workspace_packages():
        sys.stderr.write(f"warning: {error}\n")


def _list_types(source: Source, arguments: Namespace, write: Write) -> None:
    _find_workspace_types()
    for kind in _kinds(arguments):
        write(f"{_TITLES[kind]}:\n" + "".join(f"    {name}\n" for name in interfaces(kind)))


def _list_packages(source: Source, arguments: Namespace, write: Write) -> None:
    _find_workspace_types()
    write("".join(f"{name}\n" for name in sorted(_packages(*_kinds(arguments)))))


def _list_package(source: Source, arguments: Namespace, write: Write) -> None:
    package = arguments.package_name
    _check_package(package)
    for kind in _kinds(arguments):
        write("".join(f"{name}\n" for name in interfaces(kind) if name.startswith(f"{package}/")))


def _print_definition(source: Source, arguments: Namespace, write: Write) -> None:
    name = _check_type_name(arguments.type)
    write("".join(_definition_lines(name, 0, not arguments.no_comments, arguments.all_comments)))


def _print_prototype(source: Source, arguments: Namespace, write: Write) -> None:
    name = _check_type_name(arguments.type)
    message = message_class(name + FIRST_PARTS[name.split("/")[1]])()
    quote = "" if arguments.no_quotes else '"'
    write(f"{quote}{to_yaml(message, PrintOptions(truncate=None))}{quote}\n")


def _kinds(arguments: Namespace) -> list[str]:
    """Return the kinds selected by flags, or all kinds without a flag."""
    return [kind for kind in _TITLES if getattr(arguments, f"only_{kind}s")] or list(_TITLES)


def _packages(*kinds: str) -> set[str]:
    return {name.split("/")[0] for kind in kinds for name in interfaces(kind)}


def _check_package(name: str) -> None:
    find_package(name)
    packages = _packages(*_TITLES)
    if name not in packages:
        raise CourseError(f"Unknown package '{name}'{did_you_mean(name, packages)}")


def _check_type_name(name: str) -> str:
    if len(name.split("/")) != 3:
        close = did_you_mean(name.replace("/", "/msg/", 1), type_names())
        raise CourseError(f"Invalid name '{name}'. Expected three parts separated by '/'{close}")
    _check_package(name.split("/")[0])
    known_interfaces = [interface for kind in _TITLES for interface in interfaces(kind)]
    if name not in known_interfaces:
        raise CourseError(f"Could not find the interface '{name}'{did_you_mean(name, known_interfaces)}")
    return name


def _definition_lines(
    name: str,
    depth: int,
    comments: bool,
    nested_comments: bool,
) -> Iterator[str]:
    for line in _lines(name):
        text = line if comments else line.split("#")[0].strip()
        if text or comments:
            yield "\t" * depth * bool(text) + f"{text}\n"
        base = re.match(r"([\w/]+)(\[[<=\d]*\])? +\w+ *($|[^=\s])", line)
        if base and base[1] not in PRIMITIVES and base[1] != "wstring":
            inner = base[1].replace("/", "/msg/") if "/" in base[1] else f"{name.split('/')[0]}/msg/{base[1]}"
            yield from _definition_lines(inner, depth + 1, nested_comments, nested_comments)


def _lines(name: str) -> list[str]:
    """Return the lines of a type's file. Types that only rosbags defines have no comments."""
    package, kind, _ = name.split("/")
    if (text := kit_files().get(f"{name}.{kind}")) is not None:
        return [line.rstrip() for line in text.splitlines()]
    file = f"{kind}/**/{name.rpartition('/')[2]}.{kind}"
    renamed = RENAMED[package].glob(file) if package in RENAMED else ()
    for path in (*renamed, *(path for folder in FOLDERS for path in folder.glob(f"{package}/{file}"))):
        return [line.rstrip() for line in path.read_text(encoding="utf-8").splitlines()]
    # An .idl file is shown as the .msg file of the same type.
    first, *others = (list(_lines_of_message(name + part)) for part in PARTS[kind])
    return [*first, *(line for lines in others for line in ("---", *lines))]


def _lines_of_message(name: str) -> Iterator[str]:
    """Yield the lines of the .msg file that defines a message."""
    package_prefix = f"{name.split('/')[0]}/"
    for constant, base, number in field_definitions()[name][0]:
        yield f"{base} {constant}={number}"
    for field in (field for field in definition(name).fields if field.name != PLACEHOLDER):
        bound_text = f"<={field.string_bound}" if field.string_bound else ""
        max_text = f"<={field.size}" if field.size else ""
        size = {"scalar": "", "array": f"[{field.size}]", "sequence": f"[{max_text}]"}[field.container]
        default = DEFAULTS.get((name, field.name))
        tail = "" if default is None else f" {_default_text(default)}"
        yield (
            f"{field.base.replace('/msg/', '/').removeprefix(package_prefix)}{bound_text}{size} "
            f"{field.name}{tail}"
        )


def _default_text(default: Any) -> str:
    """Return a default value as it is written in a .msg file."""
    if isinstance(default, list):
        return f"[{', '.join(map(_default_text, default))}]"
    if isinstance(default, bytes):
        return str(default[0])
    if isinstance(default, bool):
        return str(default).lower()
    return f"{default:g}" if isinstance(default, float) else repr(default)


_ONLY: tuple[Option, ...] = tuple(
    flag(f"-{kind[0]}", f"--only-{kind}s", help=f"Only the {_TITLES[kind][:-1].lower()} types")
    for kind in _TITLES
)
_INTERFACE_TYPE = value("type", help="Show an interface definition (e.g. 'example_interfaces/msg/String')")
_IN_PACKAGE = (*_ONLY, value("package_name", help="Name of the ROS package (e.g. 'example_interfaces')"))
_NO_QUOTES = flag("--no-quotes", help="if true output has no outer quotes.")
_COMMENTS = (
    flag("--all-comments", help="Show all comments, including for nested interface definitions"),
    flag("--no-comments", help="Show no comments or whitespace"),
)
_verb = partial(Verb, "interface", needs_nodes=False)
INTERFACE_VERBS = (
    _verb("list", "List all interface types available", _ONLY, _list_types),
    _verb(
        "package",
        "Output a list of available interface types within one package",
        _IN_PACKAGE,
        _list_package,
    ),
    _verb("packages", "Output a list of packages that provide interfaces", _ONLY, _list_packages),
    _verb("proto", "Output an interface prototype", (_INTERFACE_TYPE, _NO_QUOTES), _print_prototype),
    _verb("show", "Output the interface definition", (*_COMMENTS, _INTERFACE_TYPE), _print_definition),
)
