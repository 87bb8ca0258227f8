"""Nodes that run while other cells are free: `run_live`."""

import asyncio
import sys
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros import pace, wall
from course_lib.ros.driving import executor_with, running_nodes, say, spin_until
from course_lib.ros.graph import Graph, current_graph

if TYPE_CHECKING:
    from rclpy.node import Node

STEP = 0.02  # [s] of the wall clock
CATCH_UP = 0.25  # [s] at most, after a cell that kept the kernel busy
WITHOUT_A_PAGE = 2.0  # [s] of robot time, before the next cell drives them on


class LiveRun:
    """A running `run_live`: its nodes, and how to stop them; `name` is what its panel calls it."""

    def __init__(self, graph: Graph, nodes: tuple["Node", ...]) -> None:
        self.nodes = nodes
        self.running = True
        self._graph = graph
        self.started_ns = graph.now_ns
        self._panel: Any = None

    @property
    def name(self) -> str:
        """What runs."""
        return ", ".join(node.get_name() for node in self.nodes)

    def is_over(self) -> bool:
        """Say whether nothing of it is left: destroyed, or replaced as cells were run again."""
        return all(node.handle.has_left for node in self.nodes)

    def stop(self) -> None:
        """Stop; the nodes stay usable, but are not listed, as if their program had ended."""
        if not self.running:
            return
        self.running = False
        _runs_of(self._graph).remove(self)
        for node in self.nodes:
            running_nodes().remove(node)
            self._graph.rest(node.handle.id)
        self.show_state()

    def state(self) -> str:
        """Say in a few words whether it runs and for how long it has."""
        seconds = (self._graph.now_ns - self.started_ns) * 1e-9
        return f"{'▶ running' if self.running else '■ stopped'}: {self.name} ({seconds:.1f} s of robot time)"

    def show(self) -> None:
        """Show the state and a Stop button in the cell."""
        import ipywidgets
        from IPython.display import display

        button = ipywidgets.Button(description="Stop", icon="stop", tooltip="Stop these nodes")
        button.on_click(lambda _: self.stop())
        self._panel = ipywidgets.HBox([button, ipywidgets.Label(self.state())])
        display(self._panel)  # type: ignore[no-untyped-call]  # IPython does not annotate it

    def show_state(self) -> None:
        """Bring what the cell says up to date."""
        if self._panel is not None:
            button, label = self._panel.children
            button.disabled, label.value = not self.running, self.state()

    def _ipython_display_(self) -> None:
        """Show nothing below the cell: the panel is there already."""


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
    _runs_of(graph).append(run)
    running_nodes().extend(run.nodes)
    if pace.wanted() == "real":
        run.show()
        task = graph.state.get("live.task")
        if task is None or task.done():
            graph.state["live.task"] = asyncio.get_running_loop().create_task(_keep_running(graph))
    return run


async def _keep_running(graph: Graph) -> None:
    """Move robot time along with the wall clock, step by step, between the cells."""
    last = wall.monotonic()
    while _runs_of(graph):
        await asyncio.sleep(STEP)
        _stop_what_is_over(graph)
        if not _runs_of(graph):
            return
        now = wall.monotonic()
        step_ns = pace.speed_of(graph).passed_ns(min(now - last, CATCH_UP))
        last = now
        try:
            with executor_with(()) as executor:
                spin_until(executor, graph.now_ns + step_ns)
        except (Exception, KeyboardInterrupt):
            _stop_with_an_error(graph)
        for run in _runs_of(graph):
            run.show_state()


def live_runs(graph: Graph) -> tuple[LiveRun, ...]:
    """List what runs."""
    _stop_what_is_over(graph)
    return tuple(_runs_of(graph))


def stop_all() -> None:
    """Stop all that runs between the cells: nodes of `run_live`, what `%ros2 launch` started."""
    for run in live_runs(current_graph()):
        run.stop()


def _stop_what_is_over(graph: Graph) -> None:
    for run in tuple(_runs_of(graph)):
        if run.is_over():
            run.stop()


def _stop_with_an_error(graph: Graph) -> None:
    """Show a callback's exception under the cell that started the run, and stop all that runs."""
    from IPython import get_ipython

    kind = sys.exc_info()[0]
    if kind is not KeyboardInterrupt:
        get_ipython().CustomTB(*sys.exc_info(), tb_offset=0)  # what loading the extension has set
    for run in tuple(_runs_of(graph)):
        run.stop()


def _runs_of(graph: Graph) -> list[LiveRun]:
    runs: list[LiveRun] = graph.state.setdefault("live.runs", [])
    return runs
