"""What a descriptor allows a parameter to be, with rclpy's texts."""

from math import isclose

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor

from rclpy.parameter import Parameter

CLOSE = 1e-6  # relative; rclpy's PARAM_REL_TOL


def refusal(
    parameter: Parameter, descriptor: ParameterDescriptor, *, is_declared: bool, new_descriptor: bool
) -> str:
    """Say why a parameter may not have its value; "" if it may. A descriptor is told its name and type.

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
