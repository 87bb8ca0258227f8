"""What the stand-in keeps for one program in one run, so that the next one starts clean."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from course_lib.ros.graph import current_graph

if TYPE_CHECKING:
    from rcl_interfaces.msg import Log

    from rclpy.context import Context
    from rclpy.executors import Executor
    from rclpy.node import Node
    from rclpy.publisher import Publisher


@dataclass
class Run:
    """The state of one program in one run."""

    default_context: "Context | None" = None  # what `rclpy.init()` without a context initialises
    global_executor: "Executor | None" = None  # what `rclpy.spin()` without an executor uses
    contexts: list["Context"] = field(default_factory=list)  # that were initialised
    nodes: dict[int, "Node"] = field(default_factory=dict)  # by their id in the graph
    rosout: dict[str, "Publisher[Log]"] = field(default_factory=dict)  # what carries a logger's messages
    log_levels: dict[str, int] = field(default_factory=dict)  # that were set, by logger


def current_run() -> Run:
    """Return the state of the calling program in the current graph."""
    state = current_graph().state
    if "rclpy" not in state:
        state["rclpy"] = Run()
    run: Run = state["rclpy"]
    return run
