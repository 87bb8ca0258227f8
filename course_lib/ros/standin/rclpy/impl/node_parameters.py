"""The parameters of a node."""

import warnings
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor

from rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    ParameterAlreadyDeclaredException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.parameter import Parameter


class NodeParameters:
    """The part of Node that keeps parameters."""

    _parameters: dict[str, Parameter]
    _parameter_types: dict[str, Parameter.Type | None]  # None: it may change its type
    _parameter_overrides: dict[str, Parameter]
    _allow_undeclared_parameters: bool

    def declare_parameter(
        self,
        name: str,
        value: Any = None,
        descriptor: ParameterDescriptor | None = None,
        ignore_override: bool = False,
    ) -> Parameter:
        """Declare a parameter.

        Args:
            name: Its name.
            value: Its default value, or its `Parameter.Type` if it has none.
            descriptor: What else is known about it; `dynamic_typing` allows values of any type.
            ignore_override: Whether values from outside the program do not count.

        Returns:
            The parameter with the value that it has now.

        Raises:
            InvalidParameterException: If the name is empty.
            ParameterAlreadyDeclaredException: If it was declared before.
            InvalidParameterTypeException: If a value from outside the program has another type.
        """
        if not name:
            raise InvalidParameterException(name)
        if name in self._parameters:
            raise ParameterAlreadyDeclaredException([name])
        if value is Parameter.Type.NOT_SET:
            raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
        if value is None and descriptor is None:
            warnings.warn(_name_only(name), stacklevel=2)
        dynamic = value is None if descriptor is None else descriptor.dynamic_typing
        if value is None and not dynamic:
            raise ValueError(
                "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
            )
        typed_only = isinstance(value, Parameter.Type)
        kind = value if typed_only else Parameter.Type.from_parameter_value(value)
        default = Parameter(name, Parameter.Type.NOT_SET) if typed_only else Parameter(name, kind, value)
        parameter = default if ignore_override else self._parameter_overrides.get(name, default)
        if parameter is not default and not dynamic and parameter.type_ is not kind:
            raise InvalidParameterTypeException(parameter, kind.name)
        self._parameters[name] = parameter
        self._parameter_types[name] = None if dynamic else kind
        return parameter

    def has_parameter(self, name: str) -> bool:
        """Say whether a parameter is declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter.

        Raises:
            ParameterNotDeclaredException: If it is not declared.
            ParameterUninitializedException: If it was declared with a type only and has no value.
        """
        if name not in self._parameters:
            if self._allow_undeclared_parameters:
                return Parameter(name, Parameter.Type.NOT_SET)
            raise ParameterNotDeclaredException(name)
        parameter = self._parameters[name]
        if parameter.type_ is Parameter.Type.NOT_SET and self._parameter_types[name] is not None:
            raise ParameterUninitializedException(name)
        return parameter


def _name_only(name: str) -> str:
    return (
        f"when declaring parameter named '{name}', "
        "declaring a parameter only providing its name is deprecated. You have to either:\n"
        '\t- Pass a name and a default value different to "PARAMETER NOT SET"'
        " (and optionally a descriptor).\n"
        "\t- Pass a name and a parameter type.\n"
        "\t- Pass a name and a descriptor with `dynamic_typing=True"
    )
