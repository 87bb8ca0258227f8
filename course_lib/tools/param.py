"""`ros2 param list|get|set`: asks the nodes' parameter services, as ROS does."""

from argparse import Namespace
from collections.abc import Sequence
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.driving import running_nodes, wait_for
from course_lib.tools.sources import NODE_NAME, Source
from course_lib.tools.verb import Verb, Write, value

PATIENCE = 5.0  # [s] for an answer


def list_all(source: Source, arguments: Namespace, write: Write) -> None:
    """Print the names of one node's parameters, or of all nodes'."""
    from rcl_interfaces.srv import ListParameters

    for node in [_found(source, arguments.node_name)] if arguments.node_name else _nodes(source):
        if not arguments.node_name:
            write(f"{node}:\n")
        for name in sorted(_ask(ListParameters, node, "list_parameters").result.names):
            write(f"  {name}\n")


def get(source: Source, arguments: Namespace, write: Write) -> None:
    """Print a parameter's value."""
    from rcl_interfaces.srv import GetParameters
    from rclpy.parameter import Parameter

    node, name = _found(source, arguments.node_name), arguments.parameter_name
    values = _ask(GetParameters, node, "get_parameters", names=[name]).values
    if not values:
        raise CourseError(f"Parameter not set. `ros2 param list {node}` shows what there is.")
    kind = Parameter.Type(values[0].type)
    if kind is Parameter.Type.NOT_SET:
        write("Parameter not set.\n")
        return
    found = getattr(values[0], f"{kind.name.lower()}_value")
    many = kind.name.endswith("_ARRAY")
    word = kind.name.removesuffix("_ARRAY").replace("BOOL", "Boolean").capitalize()
    write(f"{word} {'values are' if many else 'value is'}: {list(found) if many else found}\n")


def set_one(source: Source, arguments: Namespace, write: Write) -> None:
    """Set a parameter; the value's type is that of its YAML."""
    from rcl_interfaces.srv import SetParameters
    from rclpy.impl.parameter_yaml import read_value
    from rclpy.parameter import Parameter

    try:
        new = Parameter(arguments.parameter_name, value=read_value(arguments.value))
    except ValueError as error:
        raise CourseError(f"{arguments.value!r} is no value of a parameter: {error}") from error
    node = _found(source, arguments.node_name)
    (result,) = _ask(SetParameters, node, "set_parameters", parameters=[new.to_parameter_msg()]).results
    reason = f": {result.reason}" if result.reason else ""
    write("Set parameter successful\n" if result.successful else f"Setting parameter failed{reason}\n")


def _ask(kind: Any, node_name: str, service: str, **request: Any) -> Any:
    """Ask one of a node's services with a node of our own, which drives those that run live."""
    from rclpy.node import Node

    node = Node(NODE_NAME, start_parameter_services=False, enable_rosout=False)
    running_nodes().append(node)
    try:
        future = node.create_client(kind, f"{node_name}/{service}").call_async(kind.Request(**request))
        if not wait_for(future.done, seconds=PATIENCE):
            raise CourseError(f"{node_name} does not answer: is it running? Start it, like run_live(node).")
        return future.result()
    finally:
        running_nodes().remove(node)
        node.destroy_node()


def _nodes(source: Source) -> Sequence[str]:
    """List the full names of nodes that offer their parameters."""
    import rclpy

    from course_lib.ros.graph import current_graph

    if not source.live or not rclpy.ok():
        raise CourseError("Parameters belong to nodes that run: start one, like run_live(MyNode()).")
    services = {e.service[0] for e in current_graph().endpoints() if e.is_service and e.service}
    end = "/list_parameters"
    return sorted(name.removesuffix(end) for name in services if name.endswith(end))


def _found(source: Source, name: str) -> str:
    full = name if name.startswith("/") else f"/{name}"
    if full not in _nodes(source):
        raise CourseError(f"Node not found: {name}. There are: {', '.join(_nodes(source)) or 'none'}.")
    return full


_NODE = value("node_name", help="Name of the ROS node")
_NAME = value("parameter_name", help="Name of the parameter")
PARAM_LIST = Verb(
    "param",
    "list",
    "Output a list of available parameters",
    (value("node_name", nargs="?", help="Name of the ROS node"),),
    list_all,
)
PARAM_GET = Verb("param", "get", "Get parameter", (_NODE, _NAME), get)
PARAM_SET = Verb(
    "param", "set", "Set parameter", (_NODE, _NAME, value("value", help="Value of the parameter")), set_one
)
