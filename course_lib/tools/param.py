"""`ros2 param`, over the nodes' parameter services."""

import re
import sys
from argparse import Namespace
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.notices import print_to_stderr
from course_lib.tools.sources import Source, is_hidden, own_node, wait_for_response
from course_lib.tools.verb import NODE_OPTIONS, Option, Run, Verb, Write, flag, pattern, value

if TYPE_CHECKING:
    from rclpy.task import Future

# Time limit for a response [s].
ANSWER_LIMIT = 5.0


def _list_all(source: Source, arguments: Namespace, write: Write) -> None:
    requested_node, pattern = arguments.node_name, arguments.filter or re.compile("")
    visible = [name for name in parameter_nodes(source) if not is_hidden(name)]
    # ros2cli sorts by the name without its namespace.
    in_order = sorted(visible, key=lambda name: name.rpartition("/")[::-2])
    for node_name in [find_node(source, requested_node)] if requested_node else in_order:
        with parameter_client(source, node_name) as ask:
            names = ask("list_parameters", arguments.param_prefixes).result.names
            names = [name for name in sorted(names) if pattern.match(name)]
            types = ask("describe_parameters", names).descriptors if arguments.param_type else []
        if names and not requested_node:
            write(f"{node_name}:\n")
        kinds = {parameter.name: f" (type: {_kind(parameter.type)})" for parameter in types}
        write("".join(f"  {name}{kinds.get(name, '')}\n" for name in names))


def _get(source: Source, arguments: Namespace, write: Write) -> None:
    from rclpy.parameter import Parameter, parameter_value_to_python

    name = arguments.parameter_name
    with parameter_client(source, arguments.node_name) as ask:
        values = ask("get_parameters", [name]).values
        if not values:
            names = ask("list_parameters").result.names
            similar = "; it is declared without a value." if name in names else did_you_mean(name, names)
            raise CourseError(f"Parameter not set: {name}{similar}")
    kind = Parameter.Type(values[0].type)
    many = kind.name.endswith("_ARRAY")
    type_word = kind.name.removesuffix("_ARRAY").replace("BOOL", "Boolean").capitalize()
    value = parameter_value_to_python(values[0])
    if kind is Parameter.Type.NOT_SET:
        write("None\n" if arguments.hide_type else "Parameter not set.\n")
    elif arguments.hide_type:
        write(f"{value}\n")
    else:
        write(f"{type_word} {'values are' if many else 'value is'}: {value}\n")


def _set_one(source: Source, arguments: Namespace, write: Write) -> None:
    """Set a parameter. The YAML value determines the type."""
    from rclpy.parameter import Parameter

    from course_lib.ros.programs.parameter_yaml import read_value

    try:
        new = Parameter(arguments.parameter_name, value=read_value(arguments.value))
    except ValueError as error:
        raise CourseError(f"{arguments.value!r} is not a parameter value: {error}") from error
    with parameter_client(source, arguments.node_name) as ask:
        (result,) = ask("set_parameters", [new]).results
    outcome = "Set parameter successful" if result.successful else "Setting parameter failed"
    _write_result(outcome, result, write)


def _describe(source: Source, arguments: Namespace, write: Write) -> None:
    with parameter_client(source, arguments.node_name) as ask:
        descriptors = ask("describe_parameters", arguments.parameter_names).descriptors
    for descriptor in descriptors:
        lines = [f"Parameter name: {descriptor.name}", f"  Type: {_kind(descriptor.type)}"]
        lines += [f"  Description: {descriptor.description}"] if descriptor.description else []
        lines += ["  Constraints:"] + (["    Read only: true"] if descriptor.read_only else [])
        for limits in [*descriptor.floating_point_range, *descriptor.integer_range][:1]:
            lines += [f"    Min value: {limits.from_value}", f"    Max value: {limits.to_value}"]
            lines += [f"    Step: {limits.step}"] if limits.step else []
        more = descriptor.additional_constraints
        lines += [f"    Additional constraints: {more}"] if more else []
        write("".join(f"{line}\n" for line in lines))


def _dump(source: Source, arguments: Namespace, write: Write) -> None:
    """Print a node's parameters as YAML that `load` and `--params-file` can read."""
    import yaml
    from rclpy.parameter import parameter_value_to_python

    node_name, parameters = find_node(source, arguments.node_name), dict[str, Any]()
    with parameter_client(source, node_name) as ask:
        names = sorted(ask("list_parameters").result.names)
        values = ask("get_parameters", names).values
    if len(values) < len(names):
        # rclpy answers with no value at all if one parameter has none, and ROS prints no parameter.
        print_to_stderr("hint: a parameter has no value yet, so ROS dumps none. `ros2 param get` finds it.")
    for name, parameter in zip(names, values, strict=False):
        *groups, last_name = name.split(".")
        group_values = parameters
        for group in groups:
            group_values = group_values.setdefault(group, {})
        group_values[last_name] = parameter_value_to_python(parameter)
    write(f"{yaml.dump({node_name: {'ros__parameters': parameters}}, default_flow_style=False)}\n")


def _load(source: Source, arguments: Namespace, write: Write) -> None:
    import yaml
    from rclpy.parameter import parameter_dict_from_yaml_file

    try:
        parameters = parameter_dict_from_yaml_file(arguments.parameter_file, not arguments.no_use_wildcard)
    except OSError as error:
        file = arguments.parameter_file
        raise CourseError(
            f"{file} cannot be read: {error.strerror}. `ros2 param dump` writes such a file."
        ) from error
    except (RuntimeError, AttributeError, TypeError, ValueError, yaml.YAMLError) as error:
        problem = " ".join(str(error).split())
        raise CourseError(
            f"{arguments.parameter_file} is not a parameter file: {problem}. "
            "`ros2 param dump` writes such a file."
        ) from error
    with parameter_client(source, arguments.node_name) as ask:
        results = ask("set_parameters", list(parameters.values())).results
    for name, result in zip(parameters, results, strict=True):
        outcome = f"Set parameter {name} {'successful' if result.successful else 'failed'}"
        _write_result(outcome, result, write)


def _delete(source: Source, arguments: Namespace, write: Write) -> None:
    with parameter_client(source, arguments.node_name) as ask:
        (result,) = ask("delete_parameters", [arguments.parameter_name]).results
    outcome = "Deleted parameter successfully" if result.successful else "Deleting parameter failed"
    _write_result(outcome, result, write)


@contextmanager
def parameter_client(source: Source, node_name: str) -> Iterator[Any]:
    """Provide a function that calls a method of a node's AsyncParameterClient and returns the response."""
    from rclpy.parameter_client import AsyncParameterClient

    full = find_node(source, node_name)
    with own_node(source) as node:
        client = AsyncParameterClient(node, full)

        def ask(method: str, *arguments: Any) -> Any:
            future: Future[Any] = getattr(client, method)(*arguments)
            return wait_for_response(source, future, full, ANSWER_LIMIT)

        yield ask


def parameter_nodes(source: Source) -> Sequence[str]:
    """List the full names of nodes with parameter services."""
    if not source.is_live:
        raise CourseError("Parameters need a running node. Start one, like run_live(MyNode()).")
    services = {e.service[0] for e in source.graph.endpoints() if e.is_service and e.service}
    suffix = "/list_parameters"
    return sorted(name.removesuffix(suffix) for name in services if name.endswith(suffix))


def find_node(source: Source, name: str) -> str:
    """Return a node's full name. Raise a CourseError if it does not exist."""
    full = name if name.startswith("/") else f"/{name}"
    if full not in parameter_nodes(source):
        raise CourseError(
            f"Node not found: {name}. There are: {', '.join(parameter_nodes(source)) or 'none'}."
        )
    return full


def _kind(number: int) -> str:
    """Return the name of a type as ros2cli writes it, like "integer array"."""
    from rclpy.parameter import Parameter

    return Parameter.Type(number).name.lower().replace("_", " ").replace("bool", "boolean")


def _write_result(outcome: str, result: Any, write: Write) -> None:
    """Write the result of a change with its reason; as in ROS, a failure goes to stderr."""
    write_line = write if result.successful else sys.stderr.write
    write_line(f"{outcome}: {result.reason}\n" if result.reason else f"{outcome}\n")


_NODE = value("node_name", help="Name of the ROS node")
_NAME = value("parameter_name", help="Name of the parameter")
_NAMES = value("parameter_names", nargs="+", help="Names of the parameters")
_VALUE = value("value", help="Value of the parameter")
_HIDE = flag("--hide-type", help="Hide the type")
_WAIT = value(
    "--timeout", metavar="N", type=int, default=1, help="Wait for N seconds until node is available"
)
_LIST = (
    *NODE_OPTIONS,
    value("node_name", nargs="?", help="Name of the ROS node"),
    value("--filter", type=pattern, help="Only parameters matching the regex expression will be showed"),
    value("--param-prefixes", nargs="+", default=[], help="Only list parameters with these prefixes"),
    flag("--param-type", help="Print parameter types with parameter names"),
)
_LOAD = (
    value("parameter_file", help="Parameter file"),
    flag("--no-use-wildcard", help="Do not load parameters in the '/**' namespace into the node"),
)


def _verb(name: str, about: str, run: Run, *options: Option) -> Verb:
    return Verb("param", name, about, (*NODE_OPTIONS, _NODE, *options, _WAIT), run)


PARAM_VERBS = (
    _verb("delete", "Delete parameter", _delete, _NAME),
    _verb("describe", "Show descriptive information about declared parameters", _describe, _NAMES),
    _verb("dump", "Show all of the parameters of a node in a YAML file format", _dump),
    _verb("get", "Get parameter", _get, _NAME, _HIDE),
    Verb("param", "list", "Output a list of available parameters", _LIST, _list_all),
    _verb("load", "Load parameter file for a node", _load, *_LOAD),
    _verb("set", "Set parameter", _set_one, _NAME, _VALUE),
)
