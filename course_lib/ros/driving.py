"""Drives nodes from a notebook cell: the clock moves in these calls and stands still between them."""

import sys
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros import pace
from course_lib.ros.baton import baton
from course_lib.ros.graph import current_graph
from course_lib.ros.interrupts import interruptible
from course_lib.ros.own_line import line_of_traceback

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.node import Node

SECONDS_WITHOUT_A_PAGE = 5.0  # [s] of robot time, where a watched call would go on until it is stopped
MAX_SECONDS = 1e6  # [s]
FOR_EVER_NS = 2**62  # [ns]


class Done:
    """The result of a call that has driven nodes; `await` takes it as well."""

    def __await__(self) -> Generator[None, None, None]:
        """Be awaited: there is nothing left to wait for."""
        return
        yield

    def _ipython_display_(self) -> None:
        """Show nothing below the cell."""


def spin_for(seconds: float, *nodes: "Node") -> Done:
    """Run nodes for exactly so much robot time [s], together with those that run live.

    Those of earlier cells rest. Raises a CourseError if `seconds` is no time or a node is none.
    """
    if not isinstance(seconds, int | float) or not 0 <= seconds <= MAX_SECONDS:
        raise CourseError(
            f"spin_for({seconds!r}, …): give the seconds of robot time first, from 0 to {MAX_SECONDS:g}, "
            "like spin_for(2.0, node)."
        )
    graph = current_graph()
    with executor_with(nodes) as executor, until_interrupted(), pace.kept(graph):
        spin_until(executor, graph.now_ns + round(seconds * 1e9))
    return Done()


def spin_cell(executor: "Executor") -> None:
    """Do what `spin` does in a notebook: run until ■; without a page stop after a while and say so."""
    graph, limit_ns = current_graph(), FOR_EVER_NS
    if pace.wanted() == "fast":
        limit_ns = graph.now_ns + round(SECONDS_WITHOUT_A_PAGE * 1e9)
    with until_interrupted(), beside_live(executor):
        spin_until(executor, limit_ns, lambda: not executor.is_running)
    if graph.now_ns == limit_ns:
        say(f"No page is watching: spin() stopped after {SECONDS_WITHOUT_A_PAGE:g} s of robot time.")


def wait_for(ready: Callable[[], bool], *, seconds: float | None) -> bool:
    """Drive the live nodes until it is ready, at most so much robot time [s]; says whether it is."""
    graph = current_graph()
    until_ns = None if seconds is None else graph.now_ns + round(seconds * 1e9)
    with executor_with(()) as executor, pace.kept(graph):
        spin_until(executor, until_ns, ready)
    return ready()


def spin_until(executor: "Executor", until_ns: int | None, ready: Callable[[], bool] = lambda: False) -> None:
    """Run an executor's callbacks until `ready()` or robot time `until_ns`, events due then included.

    Callbacks that take robot time may end later; then none is begun any more.
    """
    graph = current_graph()

    def something_to_do() -> bool:
        return executor.can_work() or ready()

    while not ready() and (until_ns is None or graph.now_ns <= until_ns):
        if not baton.wait(something_to_do, until_ns=until_ns, what="a timer or a message"):
            return
        executor.run_next()


@contextmanager
def beside_live(executor: "Executor") -> Iterator[None]:
    """Let a call that waits drive the live nodes, too, at the pace that is wanted."""
    with joined_by(executor, running_nodes()), pace.kept(executor.context.graph):
        yield


@contextmanager
def executor_with(nodes: Sequence["Node"]) -> Iterator["Executor"]:
    """Give the notebook's executor, all running nodes and `nodes` in it; a CourseError if one is none."""
    import rclpy
    from rclpy.node import Node

    for node in nodes:
        if not isinstance(node, Node):
            raise CourseError(f"{node!r} is not a node. Give an object of your class, like MyNode().")
    executor: Executor = rclpy.get_global_executor()
    with joined_by(executor, [*running_nodes(), *nodes]):
        yield executor


@contextmanager
def joined_by(executor: "Executor", nodes: Sequence["Node"]) -> Iterator[None]:
    """Let nodes be in an executor for a while, in a thread that belongs to the program."""
    with baton.known():
        added = [node for node in nodes if executor.add_node(node)]
        try:
            yield
        finally:
            for node in added:
                executor.remove_node(node)


def running_nodes() -> list["Node"]:
    """List the nodes that run in every call that waits: live ones and the kit's own. Add one to start it."""
    nodes: list[Node] = current_graph().state.setdefault("driving.nodes", [])
    return nodes


@contextmanager
def until_interrupted() -> Iterator[None]:
    """End quietly with one line when the student presses ■; nodes stay usable."""
    graph = current_graph()
    start_ns = graph.now_ns
    try:
        with interruptible():
            yield
    except KeyboardInterrupt as interrupt:
        line = line_of_traceback(interrupt.__traceback__)
        where = line and f", in {line}"
        say(f"Stopped after {(graph.now_ns - start_ns) * 1e-9:.1f} s of robot time{where}.")


def say(line: str) -> None:
    """Say something to the student, in the cell's output."""
    sys.stdout.write(f"{line}\n")
