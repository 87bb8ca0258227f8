"""The default context, and the part of the command line that is not for ROS."""

import sys
from collections.abc import Sequence

from rclpy.constants import S_TO_NS
from rclpy.context import Context
from rclpy.context import get_default_context as get_default_context

RMW = "rmw_course_lib"


def ok(*, context: Context | None = None) -> bool:
    """Return whether the context is initialised and not shut down, and the run goes on."""
    return (context or get_default_context()).ok()


def get_rmw_implementation_identifier() -> str:
    """Return the name of the middleware: the kit's own."""
    return RMW


def get_available_rmw_implementations() -> set[str]:
    """Return the names of the middlewares that are there."""
    return {RMW}


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """Return the arguments without those between `--ros-args` and `--`; `sys.argv` if none are given."""
    kept: list[str] = []
    for_ros = False
    for argument in sys.argv if args is None else args:
        if argument == "--ros-args":
            for_ros = True
        elif for_ros and argument == "--":
            for_ros = False
        elif not for_ros:
            kept.append(argument)
    return kept


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Convert a time limit to [ns]; -1 stands for none (None or negative)."""
    return -1 if timeout_sec is None or timeout_sec < 0 else int(float(timeout_sec) * S_TO_NS)
