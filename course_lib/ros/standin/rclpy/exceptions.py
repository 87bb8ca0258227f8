"""The exceptions of rclpy, with its messages."""

# ruff: noqa: N818 - the names are ROS's

from typing import TYPE_CHECKING

from course_lib.ros.time.time_lock import ShutDown

if TYPE_CHECKING:
    from rclpy.parameter import Parameter


INVALID_CONTEXT = (
    "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."
)


class NotInitializedException(Exception):
    """A ROS function was called before `rclpy.init()`."""

    def __init__(self, message: str | None = None) -> None:
        super().__init__("rclpy.init() has not been called." + (f" msg:{message}" if message else ""))


class RCLError(RuntimeError):
    """An error reported by rcl, the layer below rclpy."""


class RCLInvalidROSArgsError(RCLError):
    """The arguments after `--ros-args` are malformed."""


class UnknownROSArgsError(RuntimeError):
    """There are arguments after `--ros-args` that ROS does not know."""


class NodeNameNonExistentError(RCLError):
    """There is no node of that name."""


class NoTypeSupportImportedException(Exception):
    """The class has no ROS type support. Not raised here, where every message type has it."""


class TimeoutException(Exception):
    """No callback became ready before the timeout."""


class ExternalShutdownException(ShutDown):
    """The context was shut down while an executor waited."""


class ShutdownException(Exception):
    """An executor was shut down while it was waiting."""


class ConditionReachedException(Exception):
    """The awaited condition became true before a callback was ready."""


class UnsupportedEventTypeError(RCLError):
    """The middleware does not support an event type. Not raised here, where all are supported."""


class InvalidHandle(RuntimeError):
    """A destroyed object was used."""

    def __init__(
        self,
        message: str = "cannot use Destroyable because destruction was requested",
    ) -> None:
        super().__init__(message)


class ROSInterruptException(ShutDown):
    """A wait was ended by `rclpy.shutdown()`."""

    def __init__(self) -> None:
        super().__init__("rclpy.shutdown() has been called")


class NameValidationException(Exception):
    """A name is invalid. The message points to the invalid character."""

    _kind = "name"

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        self.name, self.error_msg, self.invalid_index = name, error_msg, invalid_index
        super().__init__(f"Invalid {self._kind}: {error_msg}:\n  '{name}'\n   {' ' * invalid_index}^")


class InvalidNamespaceException(NameValidationException):
    """A namespace is invalid."""

    _kind = "namespace"


class InvalidNodeNameException(NameValidationException):
    """A node name is invalid."""

    _kind = "node name"


class InvalidTopicNameException(NameValidationException):
    """A topic name is invalid."""

    _kind = "topic name"


class InvalidServiceNameException(NameValidationException):
    """A service name is invalid."""

    _kind = "service name"


class ParameterException(Exception):
    """Base class of parameter errors: a message and the names of the parameters."""

    _text = ""

    def __init__(self, parameters: str | list[str], text: str = "") -> None:
        super().__init__(f"{text or self._text}: {parameters}")


class ParameterNotDeclaredException(ParameterException):
    """An undeclared parameter was used."""

    _text = "Invalid access to undeclared parameter(s)"


class ParameterAlreadyDeclaredException(ParameterException):
    """A parameter was declared twice."""

    _text = "Parameter(s) already declared"


class InvalidParameterException(ParameterException):
    """A parameter name is empty."""

    _text = "Invalid parameter name"


class ParameterImmutableException(ParameterException):
    """A read-only parameter cannot be changed."""

    _text = "Attempted to modify read-only parameter"


class ParameterUninitializedException(ParameterException):
    """A parameter was read that was declared with a type only and has no value yet."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__(parameter_name, f"The parameter '{parameter_name}' is not initialized")


class InvalidParameterTypeException(ParameterException):
    """A declared parameter was set to a value of another type."""

    def __init__(self, desired_parameter: "Parameter", expected_type: str) -> None:
        super().__init__(
            desired_parameter.name,
            f"Trying to set parameter '{desired_parameter.name}' to '{desired_parameter.value}'"
            f" of type '{desired_parameter.type_.name}', expecting type '{expected_type}'",
        )


class InvalidParameterValueException(ParameterException):
    """A value was rejected by the parameter's range or by a callback."""

    def __init__(self, parameter: str, value: object, reason: str) -> None:
        super().__init__(parameter, f"Invalid parameter value ({value}) for parameter. Reason: {reason}")
