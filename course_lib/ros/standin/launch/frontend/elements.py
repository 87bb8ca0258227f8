"""The elements and substitutions of launch and launch_ros in XML and YAML files."""

from typing import Any

from launch_ros import actions as ros
from launch_ros import substitutions as ros_substitutions
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue

from launch import actions, substitutions
from launch.entities import LaunchContext, text_of
from launch.entities import SomeSubstitutionsType as Some
from launch.frontend.entity import Entity
from launch.frontend.grammar import (
    ELEMENTS,
    SUBSTITUTIONS,
    Attribute,
    Element,
    Form,
    Parts,
    build_element,
    command_line,
    launch_arguments,
    list_reader,
    mapping,
    on_exit,
    pairs,
    parse_substitution,
    reader_of,
    text,
    word,
)
from launch.frontend.grammar import actions as inner

_NAME = Attribute("name", text, needed=True)
_VALUE = Attribute("value", text, needed=True)
_INNER = Attribute("", inner, "actions")
# Attributes of all elements that start a process.
_PROCESS = (
    Attribute("cwd", text),
    Attribute("name", text),
    Attribute("on_exit", on_exit),
    Attribute("launch-prefix", text, "prefix"),
    Attribute("output", text),
    Attribute("respawn", text),
    Attribute("respawn_max_retries", reader_of(int)),
    Attribute("respawn_delay", reader_of(float)),
    Attribute("sigkill_timeout", reader_of(float)),
    Attribute("sigterm_timeout", reader_of(float)),
    Attribute("shell", reader_of(bool)),
    Attribute("emulate_tty", reader_of(bool)),
    Attribute("env", mapping, "additional_env"),
)
_CHOICE = Element(lambda value: value, (Attribute("value", word, needed=True),), conditional=False)
_SCALARS: dict[str | None, type] = {"str": str, "bool": bool, "float": float, "int": int}
_TYPES = (*_SCALARS, *(f"list_of_{name}" for name in _SCALARS), "yaml")


def _value(entity: Entity, name: str) -> Any:
    """Read a parameter's value as the type that the attribute `type` states."""
    kind = entity.get("type")
    if kind is not None and kind not in _TYPES:
        raise entity.error(f"type is '{kind}', expected one of {', '.join(map(str, _TYPES))}")
    value = entity.get(name, _SCALARS.get(kind))
    return [_parse_value(part) for part in value] if isinstance(value, list) else _parse_value(value)


def _parse_value(value: Any) -> Any:
    if not isinstance(value, str):
        return value
    parts = parse_substitution(value)
    is_plain = all(isinstance(part, substitutions.TextSubstitution) for part in parts)
    return text_of(LaunchContext(), parts) if is_plain else parts


def _inner_parameters(entity: Entity, name: str) -> dict[Any, Any] | None:
    parameters = [build_element(child, _PARAMETER) for child in entity.named(name)]
    if not all(isinstance(parameter, dict) for parameter in parameters):
        raise entity.error("a param with 'from' cannot stand in another one")
    return {key: value for parameter in parameters for key, value in parameter.items()} or None


def _parameter(
    name: Parts | None = None,
    file: Parts | None = None,
    allow_substs: Any = None,
    kind: str | None = None,
    value: Any = None,
    inner: dict[Any, Any] | None = None,
) -> Any:
    """Create an entry of a node's `parameters`: a file, or a dictionary with one parameter."""
    if (name is None) == (file is None):
        raise ValueError("it needs either 'name' or 'from'")
    if file is not None:
        return ParameterFile(file, allow_substs=allow_substs or False)
    if allow_substs is not None:
        raise ValueError("'allow_substs' can only be used together with 'from'")
    if (value is None) == (inner is None):
        raise ValueError("it needs either 'value' or param elements in it")
    if inner is not None:
        return {tuple(name or ()): inner}
    return {tuple(name or ()): ParameterValue(value, value_type=_SCALARS.get(kind))}


_PARAMETER = Element(
    _parameter,
    (
        Attribute("name", text),
        Attribute("from", text, "file"),
        Attribute("allow_substs", reader_of(bool)),
        Attribute("type", word, "kind"),
        Attribute("value", _value),
        Attribute("param", _inner_parameters, "inner"),
    ),
    conditional=False,
)
_OF_NODES = (
    Attribute("param", list_reader(_PARAMETER), "parameters"),
    Attribute("remap", pairs("from", "to"), "remappings"),
)
_NODE = (
    *_PROCESS,
    *_OF_NODES,
    Attribute("pkg", text, "package"),
    Attribute("exec", text, "executable", needed=True),
    Attribute("exec_name", text),
    Attribute("namespace", text),
    Attribute("args", command_line, "arguments"),
    Attribute("ros_args", command_line, "ros_arguments"),
)
_COMPONENT = Element(
    ros.ComposableNode,
    (
        *_OF_NODES,
        Attribute("pkg", text, "package", needed=True),
        Attribute("plugin", text, needed=True),
        Attribute("name", text, needed=True),
        Attribute("namespace", text),
        Attribute("extra_arg", mapping, "extra_arguments"),
    ),
)
_COMPONENTS = Attribute("composable_node", list_reader(_COMPONENT), "composable_node_descriptions")
_NAMESPACE = Element(ros.PushRosNamespace, (Attribute("namespace", text, needed=True),))

ELEMENTS |= {
    "append_env": Element(
        actions.AppendEnvironmentVariable,
        (_NAME, _VALUE, Attribute("prepend", reader_of(bool)), Attribute("separator", text)),
    ),
    "arg": Element(
        actions.DeclareLaunchArgument,
        (
            Attribute("name", word, needed=True),
            Attribute("default", text, "default_value"),
            Attribute("description", word),
            Attribute("choice", list_reader(_CHOICE), "choices"),
        ),
    ),
    "executable": Element(actions.ExecuteProcess, (Attribute("cmd", command_line, needed=True), *_PROCESS)),
    "group": Element(
        actions.GroupAction,
        (
            Attribute("scoped", reader_of(bool)),
            Attribute("forwarding", reader_of(bool)),
            Attribute("keep", mapping, "launch_configurations"),
            Attribute("keep", inner, "actions"),
        ),
    ),
    "include": Element(
        actions.IncludeLaunchDescription,
        (
            Attribute("file", text, "launch_description_source", needed=True),
            Attribute("let", launch_arguments, "launch_arguments"),
        ),
    ),
    "let": Element(actions.SetLaunchConfiguration, (_NAME, _VALUE)),
    "log": Element(actions.LogInfo, (Attribute("message", text, "msg", needed=True),)),
    "reset": Element(
        actions.ResetLaunchConfigurations, (Attribute("keep", mapping, "launch_configurations"),)
    ),
    "reset_env": Element(actions.ResetEnvironment),
    "set_env": Element(actions.SetEnvironmentVariable, (_NAME, _VALUE)),
    "shutdown": Element(actions.Shutdown, (Attribute("reason", text),)),
    "timer": Element(
        actions.TimerAction,
        (
            Attribute("period", reader_of(float), needed=True),
            _INNER,
            Attribute("cancel_on_shutdown", reader_of(bool)),
        ),
    ),
    "unset_env": Element(actions.UnsetEnvironmentVariable, (_NAME,)),
    # launch_ros
    "load_composable_node": Element(
        ros.LoadComposableNodes, (Attribute("target", text, "target_container", needed=True), _COMPONENTS)
    ),
    "node": Element(ros.Node, _NODE),
    "node_container": Element(ros.ComposableNodeContainer, (*_NODE, _COMPONENTS)),
    "push-ros-namespace": _NAMESPACE,
    "push_ros_namespace": _NAMESPACE,
    "ros_timer": Element(ros.ROSTimer, (Attribute("period", reader_of(float), needed=True), _INNER)),
    "set_parameter": Element(
        ros.SetParameter, (Attribute("name", text, needed=True), Attribute("value", text, needed=True))
    ),
    "set_parameters_from_file": Element(
        ros.SetParametersFromFile, (Attribute("filename", text, needed=True),)
    ),
    "set_remap": Element(
        ros.SetRemap, (Attribute("from", text, "src", True), Attribute("to", text, "dst", True))
    ),
    "set_ros_log_dir": Element(ros.SetROSLogDir, (Attribute("new_log_dir", text, needed=True),)),
    "set_use_sim_time": Element(ros.SetUseSimTime, (Attribute("value", text, needed=True),)),
}


def _expression(value: Some, modules: Some = "math") -> substitutions.PythonExpression:
    """Create `$(eval …)`. The second argument contains module names, separated by commas."""
    names = text_of(LaunchContext(), modules).split(",")
    return substitutions.PythonExpression(value, [name.strip() for name in names if name.strip()])


SUBSTITUTIONS |= {
    "all": Form(substitutions.AllSubstitution, 0, None),
    "and": Form(substitutions.AndSubstitution, 2, 2),
    "anon": Form(substitutions.AnonName, 1, 1),
    "any": Form(substitutions.AnySubstitution, 0, None),
    "command": Form(
        lambda command, on_stderr="fail": substitutions.Command(command, on_stderr=on_stderr), 1, 2
    ),
    "dirname": Form(substitutions.ThisLaunchFileDir),
    "env": Form(
        lambda name, default=None: substitutions.EnvironmentVariable(name, default_value=default), 1, 2
    ),
    "equals": Form(substitutions.EqualsSubstitution, 2, 2),
    "eval": Form(_expression, 1, 2),
    "file-content": Form(substitutions.FileContent, 1, 1),
    "filename": Form(substitutions.ThisLaunchFile),
    "find-exec": Form(lambda name: substitutions.FindExecutable(name=name), 1, 1),
    "if": Form(substitutions.IfElseSubstitution, 2, 3),
    "launch_log_dir": Form(substitutions.LaunchLogDir),
    "log_dir": Form(substitutions.LaunchLogDir),
    "not": Form(substitutions.NotSubstitution, 1, 1),
    "not-equals": Form(substitutions.NotEqualsSubstitution, 2, 2),
    "or": Form(substitutions.OrSubstitution, 2, 2),
    "var": Form(lambda name, default=None: substitutions.LaunchConfiguration(name, default=default), 1, 2),
    # launch_ros
    "exec-in-pkg": Form(ros_substitutions.ExecutableInPackage, 2, 2),
    "find-pkg-prefix": Form(ros_substitutions.FindPackagePrefix, 1, 1),
    "find-pkg-share": Form(ros_substitutions.FindPackageShare, 1, 1),
    "param": Form(lambda name, default=None: ros_substitutions.Parameter(name, default=default), 1, 2),
}
