"""How the parameters of a node are set: by descriptors, callbacks and events."""

from collections.abc import Callable, Mapping

from rcl_interfaces.msg import ParameterDescriptor, ParameterEvent, SetParametersResult

from rclpy.clock import Clock
from rclpy.exceptions import ParameterNotDeclaredException
from rclpy.impl.parameter_descriptor import refusal
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher

Pre = Callable[[list[Parameter]], list[Parameter]]
On = Callable[[list[Parameter]], SetParametersResult]
Post = Callable[[list[Parameter]], object]
_EMPTIED = (
    "parameter list cannot be empty, this might be due to "
    "pre_set_parameters_callback modifying the original parameters list."
)


class ParameterSetting:
    """The part of Node that holds parameters and sets them."""

    def _keep_parameters(
        self,
        overrides: dict[str, Parameter],
        allow_undeclared: bool,
        events: Publisher[ParameterEvent],
        clock: Clock,
    ) -> None:
        """Begin without parameters; the overrides are values from outside the program."""
        self._parameters: dict[str, Parameter] = {}
        self._descriptors: dict[str, ParameterDescriptor] = {}
        self._parameter_overrides = overrides
        self._allow_undeclared_parameters = allow_undeclared
        self._parameter_events, self._stamps = events, clock
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
        """Have `callback(parameters)` called before all else; it returns the list that is to be set."""
        self._pre_set.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: On) -> None:
        """Have `callback(parameters)` called; its SetParametersResult allows or refuses the values."""
        self._on_set.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: Post) -> None:
        """Have `callback(parameters)` called after they have been set."""
        self._post_set.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: Pre) -> None:
        """Call it no more; raises ValueError if it was not."""
        self._pre_set.remove(callback)

    def remove_on_set_parameters_callback(self, callback: On) -> None:
        """Call it no more; raises ValueError if it was not."""
        self._on_set.remove(callback)

    def remove_post_set_parameters_callback(self, callback: Post) -> None:
        """Call it no more; raises ValueError if it was not."""
        self._post_set.remove(callback)

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
        """Keep values that were allowed; returns the event that tells of them."""
        event = ParameterEvent(node=self.get_fully_qualified_name(), stamp=self._stamps.now().to_msg())
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

    def get_fully_qualified_name(self) -> str:
        """Return the node's full name."""
        raise NotImplementedError
