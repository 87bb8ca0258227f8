"""The part of Node that declares, reads and sets parameters."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rcl_interfaces.msg import ListParametersResult, ParameterDescriptor, ParameterEvent, SetParametersResult

from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.impl import node_entities
from rclpy.impl.parameter_descriptor import declaration, refusal
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher

Pre = Callable[[list[Parameter]], list[Parameter]]
On = Callable[[list[Parameter]], SetParametersResult]
Post = Callable[[list[Parameter]], object]
_EMPTIED = (
    "parameter list cannot be empty, this might be due to "
    "pre_set_parameters_callback modifying the original parameters list."
)


class Node(node_entities.Node):
    """The part of Node that holds parameters; it has the name Node for the sake of Python's errors."""

    def _keep_parameters(
        self, overrides: dict[str, Parameter], allow_undeclared: bool, events: Publisher[ParameterEvent]
    ) -> None:
        """Start without parameters; the overrides are values from outside the program."""
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, ParameterDescriptor] = {}
        self._parameter_overrides = overrides
        self._allow_undeclared_parameters = allow_undeclared
        self._parameter_events = events
        self._pre_set: list[Pre] = []  # the newest first, as in the other two
        self._on_set: list[On] = []
        self._post_set: list[Post] = []

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """Return a parameter, or the alternative if it is not declared or has no value."""
        parameter = self._parameters.get(name)
        if parameter is not None and parameter.type_ is not Parameter.Type.NOT_SET:
            return parameter
        return alternative_value or Parameter(name, Parameter.Type.NOT_SET)

    def set_parameters(self, parameter_list: list[Parameter]) -> list[SetParametersResult]:
        """Set parameters one after the other, with a result for each; raises at one that is not declared."""
        return [self.set_parameters_atomically([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all parameters, or none of them; raises as `set_parameters` does."""
        if self._pre_set:
            parameter_list = [parameter for call in self._pre_set for parameter in call(parameter_list)]
            if not parameter_list:
                return SetParametersResult(successful=False, reason=_EMPTIED)
        if not all(isinstance(parameter, Parameter) for parameter in parameter_list):
            raise TypeError(f"parameter must be instance of type '{Parameter!r}'")
        undeclared = [p.name for p in parameter_list if p.name not in self._parameters]
        if undeclared and not self._allow_undeclared_parameters:
            # rclpy means to name them all, but its generator is used up by then and it prints a shorter list
            raise ParameterNotDeclaredException(undeclared[1:])
        return self._set(parameter_list, {})

    def add_pre_set_parameters_callback(self, callback: Pre) -> None:
        """Call `callback(parameters)` before all else; it returns the list that is to be set."""
        self._pre_set.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: On) -> None:
        """Call `callback(parameters)`, whose SetParametersResult allows or refuses the values."""
        self._on_set.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: Post) -> None:
        """Call `callback(parameters)` after they have been set."""
        self._post_set.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: Pre) -> None:
        """Remove the callback; raises ValueError if it was not added."""
        self._pre_set.remove(callback)

    def remove_on_set_parameters_callback(self, callback: On) -> None:
        """Remove the callback; raises ValueError if it was not added."""
        self._on_set.remove(callback)

    def remove_post_set_parameters_callback(self, callback: Post) -> None:
        """Remove the callback; raises ValueError if it was not added."""
        self._post_set.remove(callback)

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
            descriptor: Its description and limits; `dynamic_typing` allows values of any type.
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
        """Remove a parameter; raises if it is not declared or is read-only."""
        if name not in self._parameters:
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name], self._descriptors[name]

    def has_parameter(self, name: str) -> bool:
        """Return whether a parameter is declared."""
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
        """Return the number of a parameter's type; as in rclpy not a `Parameter.Type`."""
        if name in self._parameters or not self._allow_undeclared_parameters:
            self.describe_parameter(name)
            return int(self._parameters[name].type_.value)
        return Parameter.Type.NOT_SET.value

    def get_parameter_types(self, names: Sequence[str]) -> list[int]:
        """Return the numbers of several parameters' types."""
        return [self.get_parameter_type(name) for name in names]

    def describe_parameter(self, name: str) -> ParameterDescriptor:
        """Return the descriptor of a parameter; raises ParameterNotDeclaredException."""
        if name not in self._descriptors and not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(name)
        return self._descriptors.get(name) or ParameterDescriptor()

    def describe_parameters(self, names: Sequence[str]) -> list[ParameterDescriptor]:
        """Return the descriptors of several parameters."""
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

    def _set(
        self, parameters: list[Parameter], new: Mapping[str, ParameterDescriptor]
    ) -> SetParametersResult:
        """Set parameters, which may be new with their descriptors."""
        for parameter in parameters:
            name = parameter.name
            descriptor = new.get(name) or self._descriptors.get(name)
            if descriptor is not None:
                declared = name in self._parameters
                reason = refusal(parameter, descriptor, is_declared=declared, new_descriptor=bool(new))
                if reason:
                    return SetParametersResult(successful=False, reason=reason)
        for allows in self._on_set:
            result = allows(parameters)
            if not result.successful:
                return result
        self._parameter_events.publish(self._store(parameters, new))
        for call in self._post_set:
            call(parameters)
        return SetParametersResult(successful=True)

    def _store(self, parameters: list[Parameter], new: Mapping[str, ParameterDescriptor]) -> ParameterEvent:
        """Store values that were allowed; returns the event that reports them."""
        event = ParameterEvent(node=self.handle.full_name, stamp=self._clock.now().to_msg())
        for parameter in parameters:
            name, message = parameter.name, parameter.to_parameter_msg()
            if parameter.type_ is Parameter.Type.NOT_SET and not new:
                event.deleted_parameters.append(message)
                self._parameters.pop(name, None)
                self._descriptors.pop(name, None)
                continue
            had_value = self.get_parameter_or(name).type_ is not Parameter.Type.NOT_SET
            (event.changed_parameters if had_value else event.new_parameters).append(message)
            if name in new or name not in self._descriptors:
                self._descriptors[name] = new.get(name) or ParameterDescriptor(dynamic_typing=True)
            self._parameters[name] = parameter
        return event
