"""Access to the default context, and the command-line arguments that are not for ROS."""

import sys
from collections.abc import Sequence

from rclpy.context import Context
from rclpy.context import get_default_context as get_default_context
from rclpy.duration import S_TO_NS
from rclpy.impl.arguments import Arguments, strip_ros_arguments
from rclpy.logging import get_logger

RMW = "rmw_course_lib"


def ok(*, context: Context | None = None) -> bool:
    """Return whether the context is initialized and not shut down, and the run has not ended."""
    return (get_default_context() if context is None else context).ok()


def shutdown(*, context: Context | None = None) -> None:
    """Shut a context down."""
    (get_default_context(shutting_down=True) if context is None else context).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """Shut a context down if it is valid."""
    (get_default_context(shutting_down=True) if context is None else context).try_shutdown()


def get_rmw_implementation_identifier() -> str:
    """Return the name of the middleware, which is the kit's own."""
    return RMW


def get_available_rmw_implementations() -> set[str]:
    """Return the names of the available middlewares."""
    return {RMW}


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return the arguments (default: `sys.argv`) that are not for ROS.

    Arguments between `--ros-args` and `--` are removed, and so are remappings like
    `chatter:=other`.
    """
    parsed = Arguments()
    try:
        return strip_ros_arguments(sys.argv if args is None else args, parsed)
    finally:
        parsed.log_warnings(get_logger("rcl").warning)


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Convert a timeout to [ns]. None and negative values become -1, which means no timeout."""
    return -1 if timeout_sec is None or timeout_sec < 0 else int(float(timeout_sec) * S_TO_NS)
