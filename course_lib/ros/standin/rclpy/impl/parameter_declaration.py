"""What a parameter is declared with: checked, with rclpy's texts."""

import warnings
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor

from rclpy.exceptions import InvalidParameterException
from rclpy.parameter import Parameter

_NAME_ONLY = (
    "when declaring parameter named '{}', "
    "declaring a parameter only providing its name is deprecated. You have to either:\n"
    '\t- Pass a name and a default value different to "PARAMETER NOT SET"'
    " (and optionally a descriptor).\n"
    "\t- Pass a name and a parameter type.\n"
    "\t- Pass a name and a descriptor with `dynamic_typing=True"
)


def declaration(name: str, *more: Any, namespace: str) -> tuple[str, Any, ParameterDescriptor]:
    """Read (name), (name, value) or (name, value, descriptor); the value is None if there is none."""
    name = f"{namespace}.{name}" if namespace else name
    if not name:
        raise InvalidParameterException(name)
    value, descriptor = (*more, None, None)[:2]
    if not more:
        warnings.warn(_NAME_ONLY.format(name), stacklevel=4)
        descriptor = ParameterDescriptor(dynamic_typing=True)
    return name, *_typed(name, value, descriptor or ParameterDescriptor())


def _typed(name: str, value: Any, descriptor: ParameterDescriptor) -> tuple[Any, ParameterDescriptor]:
    """Let a descriptor know the type of the value, or the type that stands in the value's place."""
    if isinstance(value, Parameter.Type):
        if value is Parameter.Type.NOT_SET:
            raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
        if descriptor.dynamic_typing:
            raise ValueError(
                f"When declaring parameter {{{name}}} passing a descriptor with`dynamic_typing=True` "
                "is not allowed when the parameter type is provided"
            )
        descriptor.type = value.value
        return None, descriptor
    if not descriptor.dynamic_typing:
        descriptor.type = Parameter.Type.from_parameter_value(value).value
        if value is None:
            raise ValueError(
                "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
            )
    return value, descriptor
