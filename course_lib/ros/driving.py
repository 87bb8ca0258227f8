"""Calls of a notebook's cell that drive nodes: the clock moves in them and stands still between them."""

from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros import pace
from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from course_lib.ros.interrupts import until_interrupted
from course_lib.ros.program_thread import never

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.impl.node_handle import HandledNode
    from rclpy.node import Node

MAX_SECONDS = 1e6  # [s]


class Done:
    """The result of a call that has driven nodes; `await` takes it as well."""

    def __await__(self) -> Generator[None, None, None]:
        """Complete immediately when awaited."""
        return
        yield

    def _ipython_display_(self) -> None:
        """Show nothing below the cell."""


def spin_for(seconds: float, *nodes: "Node") -> Done:
    """Run nodes for exactly so much robot time [s], together with those that run live.

    Those of earlier cells rest. Raises a CourseError if `seconds` is not a time or a node is not a Node.
    """
    if not isinstance(seconds, int | float) or not 0 <= seconds <= MAX_SECONDS:
        raise CourseError(
            f"spin_for({seconds!r}, …): give the seconds of robot time first, from 0 to {MAX_SECONDS:g}, "
            "like spin_for(2.0, node)."
        )
    graph = current_graph()
    with executor_with(nodes) as executor, until_interrupted(), pace.kept(graph):
        executor.spin_until(graph.now_ns + round(seconds * 1e9))
    return Done()


@contextmanager
def executor_with(nodes: Sequence["Node"]) -> Iterator["Executor"]:
    """Add all running nodes and `nodes` to the notebook's executor for a while.

    Raises a CourseError if one of them is not a Node.
    """
    from rclpy.executors import get_global_executor
    from rclpy.node import Node

    for node in nodes:
        if not isinstance(node, Node):
            raise CourseError(f"{node!r} is not a node. Give an object of your class, like MyNode().")
    executor = get_global_executor()
    with executor.joined_by([*running_nodes(), *nodes]):
        yield executor


def wait_for(ready: Callable[[], bool], *, seconds: float | None) -> bool:
    """Run the live nodes until `ready()`, at most so much robot time [s]; returns `ready()`."""
    from rclpy.executors import wait_driving_live_nodes

    return wait_driving_live_nodes(ready, seconds=seconds)


def drive_in_cell(seconds: float) -> bool:
    """Drive live nodes and threads of cells for a while, [s]; return whether there are any.

    Threads need no context: they also wait before `rclpy.init()` and after `rclpy.shutdown()`.
    """
    from rclpy.context import get_default_context

    graph = current_graph()
    if seconds < 0 or not (running_nodes() or baton.has_visitors(graph)):
        return False
    if get_default_context().is_valid:
        wait_for(never, seconds=seconds)
        return True
    with baton.known(), pace.kept(graph):
        baton.wait(never, until_ns=graph.now_ns + round(seconds * 1e9), what=f"time.sleep({seconds:g})")
    return True


def running_nodes() -> list["HandledNode"]:
    """List the nodes that run in every call that waits: live ones and the kit's own. Add one to start it."""
    from rclpy.impl.executor import RunningNodes

    return current_graph().part(RunningNodes).nodes
