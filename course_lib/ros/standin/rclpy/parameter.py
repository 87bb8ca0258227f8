"""Parameters of nodes."""

import array
from enum import Enum
from typing import Any

from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterValue


class Parameter:
    """A name, a type and a value. The type is inferred from the value or has to match it."""

    class Type(Enum):
        """The types of parameters, numbered as in rcl_interfaces/msg/ParameterType."""

        NOT_SET = 0
        BOOL = 1
        INTEGER = 2
        DOUBLE = 3
        STRING = 4
        BYTE_ARRAY = 5
        BOOL_ARRAY = 6
        INTEGER_ARRAY = 7
        DOUBLE_ARRAY = 8
        STRING_ARRAY = 9

        @classmethod
        def from_parameter_value(cls, parameter_value: object) -> "Parameter.Type":
            """Infer the type of a value. Raise TypeError if parameters cannot have such a value."""
            for kind in cls:
                if kind.check(parameter_value):
                    return kind
            is_list = isinstance(parameter_value, (list, tuple, array.array))
            expected = "a list of one" if is_list else "one"
            raise TypeError(f"The given value is not {expected} of the allowed types '{parameter_value}'.")

        def check(self, parameter_value: object) -> bool:
            """Return whether a value is of this type."""
            if self is Parameter.Type.NOT_SET:
                return parameter_value is None
            element = _ELEMENTS[self.name.removesuffix("_ARRAY")]
            if not self.name.endswith("_ARRAY"):
                return isinstance(parameter_value, element)
            if not isinstance(parameter_value, (list, tuple, array.array)):
                return False
            return all(isinstance(value, element) for value in parameter_value)

    def __init__(self, name: str, type_: "Parameter.Type | None" = None, value: Any = None) -> None:
        if type_ is None:
            type_ = Parameter.Type.from_parameter_value(value)
        if not isinstance(type_, Parameter.Type):
            raise TypeError(f"type must be an instance of '{Parameter.Type!r}'")
        if not type_.check(value):
            raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
        self._name, self._type_, self._value = name, type_, value

    @property
    def name(self) -> str:
        """The parameter's name."""
        return self._name

    @property
    def type_(self) -> "Parameter.Type":
        """The parameter's type."""
        return self._type_

    @property
    def value(self) -> Any:
        """The parameter's value; None if it is not set."""
        return self._value

    def get_parameter_value(self) -> ParameterValue:
        """Convert the value to a message, in which the field for its type is set."""
        message = ParameterValue(type=self.type_.value)
        if self.type_ is not Parameter.Type.NOT_SET:
            setattr(message, f"{self.type_.name.lower()}_value", self.value)
        return message

    def to_parameter_msg(self) -> ParameterMsg:
        """Convert the parameter to a message."""
        return ParameterMsg(name=self.name, value=self.get_parameter_value())

    @classmethod
    def from_parameter_msg(cls, param_msg: ParameterMsg) -> "Parameter":
        """Create a parameter from a message."""
        kind = Parameter.Type(param_msg.value.type)
        value = None
        if kind is not Parameter.Type.NOT_SET:
            value = getattr(param_msg.value, f"{kind.name.lower()}_value")
        return cls(param_msg.name, kind, value)


PARAMETER_SEPARATOR_STRING = "."
_ELEMENTS: dict[str, type] = {"BOOL": bool, "INTEGER": int, "DOUBLE": float, "STRING": str, "BYTE": bytes}


def parameter_value_to_python(parameter_value: ParameterValue) -> Any:
    """Return the value in a message, or None if it is not set.

    Raises:
        RuntimeError: The type is unknown.
    """
    try:
        kind = Parameter.Type(parameter_value.type)
    except ValueError:
        raise RuntimeError(f"unexpected parameter type {parameter_value.type}") from None
    if kind is Parameter.Type.NOT_SET:
        return None
    value = getattr(parameter_value, f"{kind.name.lower()}_value")
    return list(value) if kind.name.endswith("_ARRAY") else value


def get_parameter_value(string_value: str) -> ParameterValue:
    """Parse a string as YAML and convert the value to a message.

    A value that parameters cannot have is kept as a string. PyYAML's rules differ from the rules of
    rcl, which parses values on the command line: `1e3` is a string here.
    """
    # Imported late, because only this function needs YAML.
    import yaml

    try:
        value = yaml.safe_load(string_value)
    except yaml.parser.ParserError:
        value = string_value
    if isinstance(value, list) and not value:
        return ParameterValue(type=Parameter.Type.BOOL_ARRAY.value)
    try:
        kind = Parameter.Type.from_parameter_value(value)
    except TypeError:
        kind = Parameter.Type.NOT_SET
    if kind in (Parameter.Type.NOT_SET, Parameter.Type.STRING):
        return Parameter(
            "", value=string_value if value is None or kind.value == 0 else value
        ).get_parameter_value()
    return Parameter("", kind, value).get_parameter_value()


def parameter_dict_from_yaml_file(
    parameter_file: str,
    use_wildcard: bool = False,
    target_nodes: list[str] | None = None,
    namespace: str = "",
) -> dict[str, ParameterMsg]:
    """Read a parameter file for `target_nodes`, spelled as in the file, or for all nodes.

    PyYAML reads it, whose rules differ from the rules of rcl for `--params-file`.

    Raises:
        RuntimeError: The file is not a parameter file or has no values for these nodes; the text is
            rclpy's.
    """
    # Imported late, because only this function and the one above need YAML.
    import yaml

    with open(parameter_file, encoding="utf-8") as file:
        nodes = yaml.safe_load(file)
    selected_nodes = ["/**"] if use_wildcard and "/**" in nodes else []
    for name in target_nodes or ():
        if name not in nodes.keys():  # noqa: SIM118  # rclpy's error for a file without nodes
            raise RuntimeError(
                f"Param file does not contain parameters for {name},only for nodes: {list(nodes)} "
            )
    selected_nodes += target_nodes or [name for name in nodes.keys() if name != "/**"]  # noqa: SIM118
    if not selected_nodes:
        raise RuntimeError("Param file does not contain selected parameters")
    values: dict[str, Any] = {}
    for name in selected_nodes:
        node = nodes[name]
        if not isinstance(node, dict) or "ros__parameters" not in node:
            raise RuntimeError(f"YAML file is not a valid ROS parameter file for node {name}")
        values.update(node["ros__parameters"])
    return _to_messages(values, namespace)


def _to_messages(values: dict[str, Any], prefix: str) -> dict[str, ParameterMsg]:
    messages: dict[str, ParameterMsg] = {}
    for key, value in values.items():
        name = f"{prefix}{key}"
        if isinstance(value, dict):
            messages |= _to_messages(value, f"{name}{PARAMETER_SEPARATOR_STRING}")
        else:
            messages[name] = ParameterMsg(name=name, value=get_parameter_value(str(value)))
    return messages
