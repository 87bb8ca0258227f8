"""The exceptions of rclpy, with its texts."""

# ruff: noqa: N818 - the names are ROS's

from typing import TYPE_CHECKING

from course_lib.ros.program_thread import ShutDown

if TYPE_CHECKING:
    from rclpy.parameter import Parameter


class NotInitializedException(Exception):
    """Something was asked of ROS before `rclpy.init()`."""

    def __init__(self, message: str | None = None) -> None:
        super().__init__("rclpy.init() has not been called." + (f" msg:{message}" if message else ""))


class RCLError(RuntimeError):
    """An error that rcl, the layer below rclpy, reports."""


class RCLInvalidROSArgsError(RCLError):
    """The arguments behind `--ros-args` are malformed."""


class UnknownROSArgsError(RuntimeError):
    """There are arguments behind `--ros-args` that ROS does not know."""


class NodeNameNonExistentError(RCLError):
    """A node of that name is not there."""


class NoTypeSupportImportedException(Exception):
    """A type was used that has no type support; here every type has it."""


class TimeoutException(Exception):
    """No callback became ready in time."""


class ExternalShutdownException(ShutDown):
    """The context was shut down while an executor waited."""


class ShutdownException(Exception):
    """An executor was shut down while it waited."""


class ConditionReachedException(Exception):
    """The awaited condition became true before a callback was ready."""


class UnsupportedEventTypeError(RCLError):
    """An event that this middleware does not have; here it has all of them."""


class InvalidHandle(Exception):
    """Something was used that had been destroyed."""

    def __init__(self, message: str = "cannot use Destroyable because destruction was requested") -> None:
        super().__init__(message)


class ROSInterruptException(ShutDown):
    """A wait was ended by `rclpy.shutdown()`."""

    def __init__(self) -> None:
        super().__init__("rclpy.shutdown() has been called")


class NameValidationException(Exception):
    """A name breaks the rules; the message points at the character."""

    _kind = "name"

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__(f"Invalid {self._kind}: {error_msg}:\n  '{name}'\n   {' ' * invalid_index}^")


class InvalidNamespaceException(NameValidationException):
    """A namespace breaks the rules."""

    _kind = "namespace"


class InvalidNodeNameException(NameValidationException):
    """A node's name breaks the rules."""

    _kind = "node name"


class InvalidTopicNameException(NameValidationException):
    """A topic's name breaks the rules."""

    _kind = "topic name"


class InvalidServiceNameException(NameValidationException):
    """A service's name breaks the rules."""

    _kind = "service name"


class ParameterException(Exception):
    """The base of what can go wrong with parameters: a text, and the parameters that it is about."""

    _text = ""

    def __init__(self, parameters: str | list[str], text: str = "") -> None:
        super().__init__(f"{text or self._text}: {parameters}")


class ParameterNotDeclaredException(ParameterException):
    """A parameter was used that had not been declared."""

    _text = "Invalid access to undeclared parameter(s)"


class ParameterAlreadyDeclaredException(ParameterException):
    """A parameter was declared twice."""

    _text = "Parameter(s) already declared"


class InvalidParameterException(ParameterException):
    """A parameter's name is empty."""

    _text = "Invalid parameter name"


class ParameterImmutableException(ParameterException):
    """A read-only parameter was to be changed."""

    _text = "Attempted to modify read-only parameter"


class ParameterUninitializedException(ParameterException):
    """A parameter was read that was declared with a type, and never got a value."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__(parameter_name, f"The parameter '{parameter_name}' is not initialized")


class InvalidParameterTypeException(ParameterException):
    """A declared parameter was given a value of another type."""

    def __init__(self, desired_parameter: "Parameter", expected_type: str) -> None:
        super().__init__(
            desired_parameter.name,
            f"Trying to set parameter '{desired_parameter.name}' to '{desired_parameter.value}'"
            f" of type '{desired_parameter.type_.name}', expecting type '{expected_type}'",
        )


class InvalidParameterValueException(ParameterException):
    """A parameter's range or a callback refuses a value."""

    def __init__(self, parameter: str, value: object, reason: str) -> None:
        super().__init__(parameter, f"Invalid parameter value ({value}) for parameter. Reason: {reason}")
