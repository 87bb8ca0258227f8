"""The elements and substitutions of launch_ros in XML and YAML launch files."""

from typing import Any

from launch.entities import LaunchContext, text_of
from launch.frontend.elements import PROCESS
from launch.frontend.entity import Entity
from launch.frontend.grammar import (
    ELEMENTS,
    SUBSTITUTIONS,
    Attribute,
    Element,
    Form,
    Parts,
    actions,
    build_element,
    command_line,
    list_reader,
    mapping,
    pairs,
    parse_substitution,
    reader_of,
    text,
    word,
)
from launch.substitutions import TextSubstitution

from launch_ros import actions as ros
from launch_ros import substitutions
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue

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
    is_plain = all(isinstance(part, TextSubstitution) for part in parts)
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
    *PROCESS,
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
    "load_composable_node": Element(
        ros.LoadComposableNodes, (Attribute("target", text, "target_container", needed=True), _COMPONENTS)
    ),
    "node": Element(ros.Node, _NODE),
    "node_container": Element(ros.ComposableNodeContainer, (*_NODE, _COMPONENTS)),
    "push-ros-namespace": _NAMESPACE,
    "push_ros_namespace": _NAMESPACE,
    "ros_timer": Element(
        ros.ROSTimer, (Attribute("period", reader_of(float), needed=True), Attribute("", actions, "actions"))
    ),
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
SUBSTITUTIONS |= {
    "exec-in-pkg": Form(substitutions.ExecutableInPackage, 2, 2),
    "find-pkg-prefix": Form(substitutions.FindPackagePrefix, 1, 1),
    "find-pkg-share": Form(substitutions.FindPackageShare, 1, 1),
    "param": Form(lambda name, default=None: substitutions.Parameter(name, default=default), 1, 2),
}
