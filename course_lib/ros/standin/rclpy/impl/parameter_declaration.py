"""What a parameter is declared with: checked, with rclpy's texts."""

import warnings
from typing import Any

from rcl_interfaces.msg import ParameterDescriptor

from rclpy.exceptions import InvalidParameterException
from rclpy.parameter import Parameter


def checked(index: int, given: tuple[Any, ...], namespace: str) -> tuple[str, Any, ParameterDescriptor]:
    """Check what one parameter is declared with; returns name, value (None if it has none) and descriptor."""
    if not 1 <= len(given) <= 3:
        raise TypeError(
            f"Invalid parameter tuple length at index {index} in parameters list: {given}; "
            "expecting length between 1 and 3"
        )
    name, value = given[0], given[1] if len(given) > 1 else None
    descriptor = given[2] if len(given) > 2 else ParameterDescriptor()
    if not isinstance(name, str):
        raise TypeError(f"First element {name} at index {index} in parameters list is not a str.")
    name = f"{namespace}.{name}" if namespace else name
    if not name:
        raise InvalidParameterException(name)
    if not isinstance(descriptor, ParameterDescriptor):
        raise TypeError(
            f"Third element {descriptor} at index {index} in parameters list is not a ParameterDescriptor."
        )
    if len(given) == 1:
        warnings.warn(_name_only(name), stacklevel=4)
        descriptor.dynamic_typing = True
    return name, *_typed(name, value, descriptor)


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


def _name_only(name: str) -> str:
    return (
        f"when declaring parameter named '{name}', "
        "declaring a parameter only providing its name is deprecated. You have to either:\n"
        '\t- Pass a name and a default value different to "PARAMETER NOT SET"'
        " (and optionally a descriptor).\n"
        "\t- Pass a name and a parameter type.\n"
        "\t- Pass a name and a descriptor with `dynamic_typing=True"
    )
