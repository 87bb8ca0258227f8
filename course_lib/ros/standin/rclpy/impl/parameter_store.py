"""The parameters of a node: declarations, allowed values, and rclpy's error texts."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isclose
from typing import Any

from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterEvent,
    SetParametersResult,
)

from rclpy.clock import Clock
from rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
)
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher

Pre = Callable[[list[Parameter]], list[Parameter]]
On = Callable[[list[Parameter]], SetParametersResult]
Post = Callable[[list[Parameter]], object]

# Relative tolerance; PARAM_REL_TOL in rclpy.
CLOSE = 1e-6
_NAME_ONLY = (
    "when declaring parameter named '{}', "
    "declaring a parameter only providing its name is deprecated. You have to either:\n"
    '\t- Pass a name and a default value different to "PARAMETER NOT SET"'
    " (and optionally a descriptor).\n"
    "\t- Pass a name and a parameter type.\n"
    "\t- Pass a name and a descriptor with `dynamic_typing=True"
)
_EMPTIED = (
    "parameter list cannot be empty, this might be due to "
    "pre_set_parameters_callback modifying the original parameters list."
)
_NO_RESULT = "Callback returned an invalid type, it should return SetParameterResult."


@dataclass(eq=False, repr=False)
class ParameterStore:
    """The declared parameters of a node, and the callbacks that run when they change.

    Args:
        node_name: Returns the node's fully qualified name, for the events.
        clock: The clock of the events' stamps.
        events: Publishes the changes.
        overrides: Values from outside the program, which replace the defaults of declarations.
    """

    node_name: Callable[[], str]
    clock: Clock
    events: Publisher[ParameterEvent]
    overrides: Mapping[str, Parameter]
    values: dict[str, Parameter] = field(default_factory=dict)
    descriptors: dict[str, ParameterDescriptor] = field(default_factory=dict)
    # In all three lists, the newest callback comes first.
    pre_set_callbacks: list[Pre] = field(default_factory=list)
    on_set_callbacks: list[On] = field(default_factory=list)
    post_set_callbacks: list[Post] = field(default_factory=list)

    def declare(
        self, namespace: str, parameters: Sequence[tuple[Any, ...]], *, ignore_override: bool
    ) -> list[Parameter]:
        """Declare parameters, each given as (name), (name, value) or (name, value, descriptor)."""
        declared: list[tuple[Parameter, ParameterDescriptor]] = []
        for index, item in enumerate(parameters):
            _require_declaration(index, item)
            name, value, descriptor = _declaration(*item, namespace=namespace)
            if not ignore_override and name in self.overrides:
                value = self.overrides[name].value
            declared.append((Parameter(name, value=value), descriptor))
        already = [parameter.name for parameter, _ in declared if parameter.name in self.values]
        if already:
            raise ParameterAlreadyDeclaredException(already)
        # If a name is repeated, its last descriptor is used.
        descriptors = {parameter.name: descriptor for parameter, descriptor in declared}
        for parameter, _ in declared:
            name, descriptor = parameter.name, descriptors[parameter.name]
            result = self.change([parameter], {name: descriptor})
            if result.reason.startswith("Wrong parameter type"):
                raise InvalidParameterTypeException(parameter, Parameter.Type(descriptor.type).name)
            if not result.successful:
                raise InvalidParameterValueException(name, parameter.value, result.reason)
        return [self.values[parameter.name] for parameter, _ in declared]

    def undeclare(self, name: str) -> None:
        """Remove a parameter.

        Raises:
            ParameterNotDeclaredException: The parameter is not declared.
            ParameterImmutableException: The parameter is read-only.
        """
        if name not in self.values:
            raise ParameterNotDeclaredException(name)
        if self.descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self.values[name], self.descriptors[name]

    def set(self, parameters: list[Parameter], *, may_be_undeclared: bool) -> SetParametersResult:
        """Set all parameters or none of them, after the callbacks that may replace the list.

        Raises:
            TypeError: The list has an element that is not a parameter.
            ParameterNotDeclaredException: A parameter is not declared and may not be undeclared.
        """
        if self.pre_set_callbacks:
            parameters = [parameter for call in self.pre_set_callbacks for parameter in call(parameters)]
            if not parameters:
                return SetParametersResult(successful=False, reason=_EMPTIED)
        if not all(isinstance(parameter, Parameter) for parameter in parameters):
            raise TypeError(f"parameter must be instance of type '{Parameter!r}'")
        # rclpy intends to list all of them, but `any` consumes its generator up to the first one. An
        # empty name is accepted.
        names = (parameter.name for parameter in parameters if parameter.name not in self.values)
        if not may_be_undeclared and any(names):
            raise ParameterNotDeclaredException(list(names))
        return self.change(parameters, {})

    def change(
        self, parameters: list[Parameter], new: Mapping[str, ParameterDescriptor]
    ) -> SetParametersResult:
        """Set parameters if their descriptors and the callbacks accept them, and publish the event.

        `new` has new descriptors by the parameters' names.
        """
        for parameter in parameters:
            name = parameter.name
            descriptor = new.get(name) or self.descriptors.get(name)
            if descriptor is not None:
                declared = name in self.values
                reason = find_rejection(parameter, descriptor, is_declared=declared, new_descriptor=bool(new))
                if reason:
                    return SetParametersResult(successful=False, reason=reason)
        for allows in self.on_set_callbacks:
            result = allows(parameters)
            if not isinstance(result, SetParametersResult):
                # rclpy's warning contains a line of rclpy, which does not help to find the
                # callback.
                code = getattr(allows, "__code__", self.change.__code__)
                place = code.co_filename, code.co_firstlineno
                warnings.warn_explicit(_NO_RESULT, UserWarning, *place)
                result = SetParametersResult(successful=False, reason="Callback returned an invalid type")
            if not result.successful:
                return result
        event = ParameterEvent(node=self.node_name(), stamp=self.clock.now().to_msg())
        for parameter in parameters:
            name, message = parameter.name, parameter.to_parameter_msg()
            if parameter.type_ is Parameter.Type.NOT_SET and not new:
                event.deleted_parameters.append(message)
                self.values.pop(name, None)
                self.descriptors.pop(name, None)
                continue
            former = self.values.get(name)
            had_value = former is not None and former.type_ is not Parameter.Type.NOT_SET
            (event.changed_parameters if had_value else event.new_parameters).append(message)
            if name in new or name not in self.descriptors:
                self.descriptors[name] = new.get(name) or ParameterDescriptor(dynamic_typing=True)
            self.values[name] = parameter
        self.events.publish(event)
        for call in self.post_set_callbacks:
            call(parameters)
        return SetParametersResult(successful=True)


def _require_declaration(index: int, item: Any) -> None:
    """Raise rclpy's TypeError unless `item` is (name), (name, value) or (name, value, descriptor)."""
    at = f"at index {index} in parameters list"
    if not 1 <= len(item) <= 3:
        raise TypeError(f"Invalid parameter tuple length {at}: {item}; expecting length between 1 and 3")
    if not isinstance(item[0], str):
        raise TypeError(f"First element {item[0]} {at} is not a str.")
    if len(item) == 3 and not isinstance(item[2], ParameterDescriptor):
        raise TypeError(f"Third element {item[2]} {at} is not a ParameterDescriptor.")


def _declaration(name: str, *more: Any, namespace: str) -> tuple[str, Any, ParameterDescriptor]:
    """Read (name), (name, value) or (name, value, descriptor). A missing value becomes None.

    The descriptor's type is the type of the value, or the type that is passed instead of a value.
    """
    name = f"{namespace}.{name}" if namespace else name
    if not name:
        raise InvalidParameterException(name)
    value, descriptor = (*more, None, None)[:2]
    if not more:
        warnings.warn(_NAME_ONLY.format(name), stacklevel=5)
        descriptor = ParameterDescriptor(dynamic_typing=True)
    descriptor = descriptor or ParameterDescriptor()
    if isinstance(value, Parameter.Type):
        if value is Parameter.Type.NOT_SET:
            raise ValueError(f"Cannot declare parameter {{{name}}} as statically typed of type NOT_SET")
        if descriptor.dynamic_typing:
            raise ValueError(
                f"When declaring parameter {{{name}}} passing a descriptor "
                "with`dynamic_typing=True` is not allowed when the parameter type is provided"
            )
        descriptor.type = value.value
        return name, None, descriptor
    if not descriptor.dynamic_typing:
        descriptor.type = Parameter.Type.from_parameter_value(value).value
        if value is None:
            raise ValueError(
                "Cannot declare a statically typed parameter with default value of type PARAMETER_NOT_SET"
            )
    return name, value, descriptor


def find_rejection(
    parameter: Parameter,
    descriptor: ParameterDescriptor,
    *,
    is_declared: bool,
    new_descriptor: bool,
) -> str:
    """Set the descriptor's name and type. Return why a value is rejected, or "" if it is accepted.

    With a new descriptor, `read_only` has no effect yet.
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


def _outside_integers(parameter: Parameter, value_range: IntegerRange) -> str:
    low, high = sorted((value_range.from_value, value_range.to_value))
    name, value, step = parameter.name, parameter.value, value_range.step
    if not low <= value <= high:
        return f"Parameter {name} out of range. Min: {low}, Max: {high}, value: {value}"
    if value not in (low, high) and step and (value - low) % step:
        limits = f"Min: {low}, max: {high}, value: {value}, step: {step}"
        return f"The parameter value for {name} is not a valid step. {limits}"
    return ""


def _outside_doubles(parameter: Parameter, value_range: FloatingPointRange) -> str:
    low, high = sorted((value_range.from_value, value_range.to_value))
    name, value, step = parameter.name, parameter.value, value_range.step
    if any(isclose(value, end, rel_tol=CLOSE) for end in (low, high)):
        return ""
    # rcl's text has no full stop here, unlike the text for integers.
    if not low < value < high:
        return f"Parameter {name} out of range Min: {low}, Max: {high}, value: {value}"
    if step and not isclose(low + round((value - low) / step) * step, value, rel_tol=CLOSE):
        limits = f"Min: {low}, max: {high}, value: {value}, step: {step}"
        return f"The parameter value for {name} is not close enough to a valid step. {limits}"
    return ""
