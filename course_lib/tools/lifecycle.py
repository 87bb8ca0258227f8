"""`ros2 lifecycle nodes|get|set|list`, over the services of lifecycle nodes."""

from argparse import Namespace
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.messages import service_class
from course_lib.tools.sources import Source, answer, is_hidden, own_node
from course_lib.tools.verb import NODE_OPTIONS, Verb, Write, count, flag, value

GET_STATE, STATE_TYPE = "/get_state", "lifecycle_msgs/srv/GetState"
ANSWER_LIMIT = 10.0  # [s] for an answer, if nobody can press ■


def _nodes(source: Source, arguments: Namespace, write: Write) -> None:
    names = _lifecycle_nodes(source, hidden=arguments.all)
    write(f"{len(names)}\n" if arguments.count else "".join(f"{name}\n" for name in names))


def _get(source: Source, arguments: Namespace, write: Write) -> None:
    wanted, hidden = arguments.node_name, arguments.hidden
    for name in [_found(source, arguments)] if wanted else _lifecycle_nodes(source, hidden=hidden):
        state = _ask(source, name, "GetState", "get_state").current_state
        write(f"{'' if wanted else f'{name}: '}{state.label} [{state.id}]\n")


def _list_all(source: Source, arguments: Namespace, write: Write) -> None:
    service = "get_transition_graph" if arguments.all else "get_available_transitions"
    for one in _transitions(source, _found(source, arguments), service):
        write(f"- {one.transition.label} [{one.transition.id}]\n")
        write(f"\tStart: {one.start_state.label}\n\tGoal: {one.goal_state.label}\n")


def _set(source: Source, arguments: Namespace, write: Write) -> None:
    node, wanted = _found(source, arguments), arguments.transition
    there = [one.transition for one in _transitions(source, node, "get_available_transitions")]
    chosen = [one for one in there if one.label == wanted] or [one for one in there if str(one.id) == wanted]
    if not chosen:
        lines = "".join(f"\n- {one.label} [{one.id}]" for one in there)
        raise CourseError(f"Unknown transition requested, available ones are:{lines}")
    changed = _ask(source, node, "ChangeState", "change_state", transition=chosen[0]).success
    write(f"Transitioning {'successful' if changed else 'failed'}\n")


def _transitions(source: Source, node: str, service: str) -> Any:
    return _ask(source, node, "GetAvailableTransitions", service).available_transitions


def _ask(source: Source, node_name: str, kind_name: str, service: str, **fields: Any) -> Any:
    """Return the answer of one of a node's services."""
    kind: Any = service_class(f"lifecycle_msgs/srv/{kind_name}")
    name = f"{node_name}/{service}"
    with until_interrupted(), own_node(source) as node:
        future = node.create_client(kind, name).call_async(kind.Request(**fields))
        return answer(source, future, name, source.limit(ANSWER_LIMIT))


def _lifecycle_nodes(source: Source, *, hidden: bool) -> list[str]:
    """List the full names of nodes that tell their state."""
    services = {e.service[0] for e in source.graph.endpoints() if e.service and e.service[1] == STATE_TYPE}
    nodes = {node.full_name for node in source.graph.nodes() if f"{node.full_name}{GET_STATE}" in services}
    return sorted(name for name in nodes if hidden or not is_hidden(name))


def _found(source: Source, arguments: Namespace) -> str:
    """Return the full name of the node that the command names."""
    name = arguments.node_name
    full = name if name.startswith("/") else f"/{name}"
    there = _lifecycle_nodes(source, hidden=arguments.hidden)
    if full not in there:
        raise CourseError(f"Node not found{did_you_mean(full, there)}")
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
        ("get", "Get lifecycle state for one or more nodes", (_MAYBE, _HIDDEN), _get),
        ("list", "Output a list of available transitions", (_NODE, _HIDDEN, _ALL), _list_all),
        ("nodes", "Output a list of nodes with lifecycle", _NODES, _nodes),
        ("set", "Trigger lifecycle state transition", (_NODE, _HIDDEN, _TRANSITION), _set),
    )
)
