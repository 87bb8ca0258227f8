"""Stand-in for rclpy's C extension, `rclpy._rclpy_pybind11`. Programs use only its exceptions."""

# ruff: noqa: N818 - the names are ROS's

from rclpy.impl import implementation_singleton as rclpy_implementation

__all__ = ["rclpy_implementation"]

INVALID_CONTEXT = (
    "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."
)


class RCLError(RuntimeError):
    """An error reported by rcl, the layer below rclpy."""


class RMWError(RuntimeError):
    """An error reported by rmw, the interface of the middleware."""


class RCLInvalidROSArgsError(RCLError):
    """The arguments after `--ros-args` are malformed."""


class UnknownROSArgsError(RuntimeError):
    """There are arguments after `--ros-args` that ROS does not know."""


class NodeNameNonExistentError(RCLError):
    """There is no node of that name."""


class UnsupportedEventTypeError(RCLError):
    """The middleware does not support an event type. Not raised here, where all are supported."""


class InvalidHandle(RuntimeError):
    """A destroyed object was used."""

    def __init__(
        self,
        message: str = "cannot use Destroyable because destruction was requested",
    ) -> None:
        super().__init__(message)


# Tracebacks show the module of ROS.
for _error in (
    RCLError,
    RMWError,
    RCLInvalidROSArgsError,
    UnknownROSArgsError,
    NodeNameNonExistentError,
    UnsupportedEventTypeError,
    InvalidHandle,
):
    _error.__module__ = "rclpy._rclpy_pybind11"
