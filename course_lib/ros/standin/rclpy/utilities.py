"""The default context, and what the command line holds for ROS."""

import sys
from collections.abc import Sequence

from rclpy.constants import S_TO_NS
from rclpy.context import Context
from rclpy.impl.run import current_run


def get_default_context(*, shutting_down: bool = False) -> Context:
    """Return the context that is meant when none is given; `shutting_down` leaves room for a new one."""
    run = current_run()
    context = run.default_context or Context()
    run.default_context = None if shutting_down else context
    return context


def ok(*, context: Context | None = None) -> bool:
    """Say whether the context is initialised and not shut down, and the run goes on."""
    return (context or get_default_context()).ok()


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
