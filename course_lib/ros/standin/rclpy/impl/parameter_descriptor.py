"""Declarations of parameters and the values that their descriptors allow; with rclpy's texts."""

import warnings
from math import isclose
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor

from rclpy.exceptions import InvalidParameterException
from rclpy.parameter import Parameter

CLOSE = 1e-6  # relative; rclpy's PARAM_REL_TOL
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
    """Set a descriptor's type to that of the value, or to the type that is passed as the value."""
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


def refusal(
    parameter: Parameter, descriptor: ParameterDescriptor, *, is_declared: bool, new_descriptor: bool
) -> str:
    """Return why a parameter may not have its value; "" if it may. Sets the descriptor's name and type.

    While a descriptor is new, `read_only` does not count yet.
    """
    descriptor.name = parameter.name
    kind = parameter.type_
    if descriptor.read_only and not new_descriptor:
        return f"Trying to set a read-only parameter: {parameter.name}."
    if descriptor.dynamic_typing:
        descriptor.type = kind.value
    elif kind is Parameter.Type.NOT_SET:
        return "Static parameter cannot be undeclared" if is_declared else ""
    elif kind.value != descriptor.type:
        return f"Wrong parameter type, expected '{Parameter.Type(descriptor.type)}' got '{kind}'"
    if kind is Parameter.Type.INTEGER and descriptor.integer_range:
        return _outside_integers(parameter, descriptor.integer_range[0])
    if kind is Parameter.Type.DOUBLE and descriptor.floating_point_range:
        return _outside_doubles(parameter, descriptor.floating_point_range[0])
    return ""


def _outside_integers(parameter: Parameter, allowed: IntegerRange) -> str:
    low, high = sorted((allowed.from_value, allowed.to_value))
    name, value, step = parameter.name, parameter.value, allowed.step
    if not low <= value <= high:
        return f"Parameter {name} out of range. Min: {low}, Max: {high}, value: {value}"
    if value not in (low, high) and step and (value - low) % step:
        limits = f"Min: {low}, max: {high}, value: {value}, step: {step}"
        return f"The parameter value for {name} is not a valid step. {limits}"
    return ""


def _outside_doubles(parameter: Parameter, allowed: FloatingPointRange) -> str:
    low, high = sorted((allowed.from_value, allowed.to_value))
    name, value, step = parameter.name, parameter.value, allowed.step
    if any(isclose(value, end, rel_tol=CLOSE) for end in (low, high)):
        return ""
    if not low < value < high:  # without a full stop, other than for integers
        return f"Parameter {name} out of range Min: {low}, Max: {high}, value: {value}"
    if step and not isclose(low + round((value - low) / step) * step, value, rel_tol=CLOSE):
        limits = f"Min: {low}, max: {high}, value: {value}, step: {step}"
        return f"The parameter value for {name} is not close enough to a valid step. {limits}"
    return ""
