"""The parameters of a node."""

from collections.abc import Sequence
from typing import Any

from rcl_interfaces.msg import ListParametersResult, ParameterDescriptor

from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.impl.parameter_descriptor import declaration
from rclpy.impl.parameter_setting import ParameterSetting
from rclpy.parameter import Parameter


class NodeParameters(ParameterSetting):
    """The part of Node that declares parameters and tells of them."""

    def declare_parameter(
        self,
        name: str,
        value: Any = None,
        descriptor: ParameterDescriptor | None = None,
        ignore_override: bool = False,
    ) -> Parameter:
        """Declare a parameter; returns it with the value that it has now.

        Args:
            name: Its name.
            value: Its default value, or its `Parameter.Type` if it has none.
            descriptor: What else is known about it; `dynamic_typing` allows values of any type.
            ignore_override: Whether values from outside the program do not count.
        """
        more = () if value is None and descriptor is None else (value, descriptor or ParameterDescriptor())
        return self.declare_parameters("", [(name, *more)], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare several: (name), (name, value) or (name, value, descriptor) each, put into a namespace."""
        declared: list[Parameter] = []
        descriptors: dict[str, ParameterDescriptor] = {}
        for given in parameters:
            name, value, descriptor = declaration(*given, namespace=namespace)
            if not ignore_override and name in self._parameter_overrides:
                value = self._parameter_overrides[name].value
            declared.append(Parameter(name, value=value))
            descriptors[name] = descriptor
        already = [parameter.name for parameter in declared if parameter.name in self._parameters]
        if already:
            raise ParameterAlreadyDeclaredException(already)
        for parameter in declared:
            self._declare(parameter, descriptors[parameter.name])
        return [self._parameters[parameter.name] for parameter in declared]

    def undeclare_parameter(self, name: str) -> None:
        """Forget a parameter; raises if it is not declared or is read-only."""
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name], self._descriptors[name]

    def has_parameter(self, name: str) -> bool:
        """Say whether a parameter is declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> Parameter:
        """Return a parameter; raises if it is not declared, or has got no value yet."""
        parameter = self._parameters.get(name)
        if parameter is None:
            if self._allow_undeclared_parameters:
                return Parameter(name, Parameter.Type.NOT_SET)
            raise ParameterNotDeclaredException(name)
        if parameter.type_ is Parameter.Type.NOT_SET and not self._descriptors[name].dynamic_typing:
            raise ParameterUninitializedException(name)
        return parameter

    def get_parameters(self, names: Sequence[str]) -> list[Parameter]:
        """Return several parameters; raises as `get_parameter` does."""
        return [self.get_parameter(name) for name in names]

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Return the parameters whose names begin with `prefix.`, by the rest of their names."""
        start = f"{prefix}." if prefix else ""
        return {n[len(start) :]: value for n, value in self._parameters.items() if n.startswith(start)}

    def get_parameter_type(self, name: str) -> int:
        """Return the number of a parameter's type; as in rclpy no `Parameter.Type`."""
        if name in self._parameters or not self._allow_undeclared_parameters:
            self.describe_parameter(name)
            return int(self._parameters[name].type_.value)
        return Parameter.Type.NOT_SET.value

    def get_parameter_types(self, names: Sequence[str]) -> list[int]:
        """Return the numbers of several parameters' types."""
        return [self.get_parameter_type(name) for name in names]

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """Return what is known about a parameter; raises ParameterNotDeclaredException."""
        if name not in self._descriptors and not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(name)
        return self._descriptors.get(name) or ParameterDescriptor()

    def describe_parameters(self, names: Sequence[str]) -> list[ParameterDescriptor]:
        """Return what is known about several parameters."""
        return [self.describe_parameter(name) for name in names]

    def list_parameters(self, prefixes: list[str], depth: int) -> ListParametersResult:
        """List names below prefixes, at most `depth` parts deep (0: without limit), and their prefixes."""

        def shown(name: str) -> bool:
            rests = [name[len(p) + 1 :] for p in prefixes if name.startswith(f"{p}.")] if prefixes else [name]
            return name in prefixes or any(not depth or rest.count(".") < depth for rest in rests)

        names = [name for name in self._parameters if shown(name)]
        above = dict.fromkeys(name.rpartition(".")[0] for name in names if "." in name)
        return ListParametersResult(names=names, prefixes=list(above))

    def _declare(self, parameter: Parameter, descriptor: ParameterDescriptor) -> None:
        result = self._set([parameter], {parameter.name: descriptor})
        if result.successful:
            return
        if result.reason.startswith("Wrong parameter type"):
            raise InvalidParameterTypeException(parameter, Parameter.Type(descriptor.type).name)
        raise InvalidParameterValueException(parameter.name, parameter.value, result.reason)
