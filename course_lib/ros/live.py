"""Nodes that run while other cells are free: `run_live`."""

import asyncio
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros import pace
from course_lib.ros.driving import executor_with, running_nodes, say, spin_until
from course_lib.ros.graph import Graph, current_graph
from course_lib.ros.live_loop import LiveLoop
from course_lib.ros.live_run import LiveRun, runs_of

if TYPE_CHECKING:
    from rclpy.node import Node

WITHOUT_A_PAGE = 2.0  # [s] of robot time, before the next cell drives them on


def run_live(*nodes: "Node") -> LiveRun:
    """Run nodes at the wall clock's pace while the next cells are free; returns at once what has `stop()`.

    Without a page (nbclient, scripts) they run a few seconds of robot time at full speed instead; calls that
    wait, like `spin_for`, drive them on. Raises a CourseError if no node, or what is none, is given.
    """
    if not nodes:
        raise CourseError("run_live() needs at least one node, like run_live(MyNode()).")
    graph = current_graph()
    with executor_with(nodes):
        run = LiveRun(graph, nodes)
    for former in live_runs(graph):
        if not set(nodes).isdisjoint(former.nodes):  # one node, one Stop button
            former.stop()
    return go_live(run)


def go_live(run: LiveRun) -> LiveRun:
    """Let a run go on between the cells; without a page it first has a few seconds at full speed."""
    graph = current_graph()
    with executor_with(run.nodes) as executor:
        if pace.wanted() == "fast":
            spin_until(executor, graph.now_ns + round(WITHOUT_A_PAGE * 1e9))
            say(f"No page is watching: ran {WITHOUT_A_PAGE:g} s of robot time at full speed.")
    run.started_ns = graph.now_ns
    _stop_what_is_over(graph)
    runs_of(graph).append(run)
    running_nodes().extend(run.nodes)
    if pace.wanted() == "real":
        run.show()
        task = graph.state.get("live.task")
        if task is None or task.done():
            loop = LiveLoop(graph)
            graph.state["live.task"] = asyncio.get_running_loop().create_task(loop.run())
    return run


def live_runs(graph: Graph) -> tuple[LiveRun, ...]:
    """List what runs."""
    _stop_what_is_over(graph)
    return tuple(runs_of(graph))


def stop_all() -> None:
    """Stop all that runs between the cells: nodes of `run_live`, what `%ros2 launch` started."""
    for run in live_runs(current_graph()):
        run.stop()


def _stop_what_is_over(graph: Graph) -> None:
    for run in tuple(runs_of(graph)):
        if run.is_over():
            run.stop()
