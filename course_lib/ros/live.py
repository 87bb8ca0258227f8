"""Nodes that run while other cells are free: `run_live`, its Stop button, and the task that drives it."""

import asyncio
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros import pace, wall
from course_lib.ros.baton import baton
from course_lib.ros.driving import executor_with, running_nodes
from course_lib.ros.graph import Graph, current_graph
from course_lib.ros.interrupts import Callback, live_interrupts, watch
from course_lib.ros.notices import say
from course_lib.ros.tracebacks import line_of_traceback

if TYPE_CHECKING:
    from rclpy.node import Node

WITHOUT_A_PAGE = 2.0  # [s] of robot time, before the next cell drives them on
STEP = 0.02  # [s] of the wall clock
CATCH_UP = 0.25  # [s] at most, after a cell that kept the kernel busy
RECENTLY = 60.0  # [s] of the wall clock: who has run a cell since then is taken to be there


class LiveRun:
    """The handle of a `run_live`: its nodes, its Stop button, and its state in the cell."""

    def __init__(self, graph: Graph, nodes: tuple["Node", ...]) -> None:
        self.nodes = nodes
        self.running = True
        self._graph = graph
        self.started_ns = graph.now_ns
        self.stop_clicked = False
        self.note = ""  # how it came to its end
        self._panel: Any = None

    @property
    def name(self) -> str:
        """The name on its panel."""
        return ", ".join(node.get_name() for node in self.nodes)

    def is_over(self) -> bool:
        """Return whether nothing of it is left: destroyed, or replaced as cells were run again."""
        return all(node.handle.has_left for node in self.nodes)

    def has_node(self, full_name: str) -> bool:
        """Return whether a node is one of its own."""
        return any(node.handle.full_name == full_name for node in self.nodes)

    def stop(self) -> None:
        """Stop; the nodes stay usable, but are not listed, as if their program had ended."""
        if not self.running:
            return
        self.running = False
        self._graph.part(_LiveRuns).runs.remove(self)
        for node in self.nodes:
            running_nodes().remove(node)
            if node.handle.executor is not None:  # a call in a cell may drive it right now
                node.handle.executor.remove_node(node)
            self._graph.rest(node.handle.id)
        self.show_state()

    def state(self, note: str = "") -> str:
        """Return in a few words whether it runs, since when, and a note."""
        seconds = (self._graph.now_ns - self.started_ns) * 1e-9
        state = f"{'▶ running' if self.running else '■ stopped'}: {self.name} ({seconds:.1f} s of robot time)"
        return ", ".join(filter(None, (state, note or self.note)))

    def show(self) -> None:
        """Show the state and a Stop button in the cell."""
        import ipywidgets
        from IPython.display import display

        button = ipywidgets.Button(description="Stop", icon="stop", tooltip="Stop these nodes")
        button.on_click(lambda _: self._stop_clicked())
        if hasattr(button.comm, "_reply_subshell_for"):
            # ipykernel 7.4 holds a page's messages back while a callback runs, JupyterLab's subshell or not.
            button.comm._reply_subshell_for = lambda data, default: default
        self._panel = ipywidgets.HBox([button, ipywidgets.Label(self.state())])
        display(self._panel)  # type: ignore[no-untyped-call]  # IPython does not annotate it

    def show_state(self, note: str = "") -> None:
        """Update the state in the cell."""
        if self._panel is not None:
            button, label = self._panel.children
            button.disabled, label.value = not self.running, self.state(note)

    def _stop_clicked(self) -> None:
        """Stop from the thread that hears the page; a callback that does not end is interrupted."""
        self.stop_clicked = True
        with watch.stopping(), baton.known():
            callback = watch.under_way
            if callback is not None and self.has_node(callback.node):
                watch.want_no_more()
            self.stop()

    def _ipython_display_(self) -> None:
        """Show nothing below the cell: the panel is there already."""


@dataclass
class _LiveRuns:
    """The live runs of a graph, and the task that drives them."""

    runs: list[LiveRun] = field(default_factory=list)
    task: "asyncio.Task[None] | None" = None

    def drive(self, graph: Graph) -> None:
        """Drive the graph between the cells from now on, unless a task does that already."""
        if self.task is None or self.task.done():
            self.task = asyncio.get_running_loop().create_task(_Loop(graph).run())

    def stop_those_over(self) -> None:
        """Stop the runs of which nothing is left."""
        for run in tuple(self.runs):
            if run.is_over():
                run.stop()


def run_live(*nodes: "Node") -> LiveRun:
    """Run nodes at the wall clock's pace while the next cells are free; returns a handle with `stop()`.

    Without a page (nbclient, scripts) they run a few seconds of robot time at full speed instead; calls that
    wait, like `spin_for`, drive them on. Raises a CourseError without nodes, or for an object that is none.
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
    """Drive a run between the cells; without a page it first has a few seconds at full speed."""
    graph = current_graph()
    with executor_with(run.nodes) as executor:
        if pace.wanted() == "fast":
            executor.spin_until(graph.now_ns + round(WITHOUT_A_PAGE * 1e9))
            say(f"No page is watching: ran {WITHOUT_A_PAGE:g} s of robot time at full speed.")
    run.started_ns = graph.now_ns
    live = graph.part(_LiveRuns)
    live.stop_those_over()
    live.runs.append(run)
    running_nodes().extend(run.nodes)
    if pace.wanted() == "real":
        run.show()
        live.drive(graph)
    return run


def live_runs(graph: Graph) -> tuple[LiveRun, ...]:
    """List the runs that are live."""
    live = graph.part(_LiveRuns)
    live.stop_those_over()
    return tuple(live.runs)


def stop_all() -> None:
    """Stop all that runs between the cells: nodes of `run_live`, and launches of `%ros2 launch`."""
    for run in live_runs(current_graph()):
        run.stop()


def drive_between_cells(graph: Graph) -> None:
    """Drive a graph between the cells, also without live runs: one that is linked to a robot."""
    with suppress(RuntimeError):  # no kernel, `course run` of a notebook: the cells drive it
        graph.part(_LiveRuns).drive(graph)


def drive_threads() -> None:
    """Drive threads of cells that wait for robot time, like `rclpy.spin` in one, also between the cells."""
    graph = current_graph()
    if baton.has_visitors(graph) and pace.wanted() == "real":
        drive_between_cells(graph)


class _Audience:
    """The audience of live runs: a page shows a view, or a cell was run a short time ago.

    Each update of a state is a message, and a hub never ends a kernel that sends messages: it is not idle.
    """

    def __init__(self) -> None:
        self._cells = -1  # that were run
        self._last = 0.0  # [s] when the last one was
        self.was_there = True

    def is_there(self) -> bool:
        """Return whether there may be one, now."""
        ipython = sys.modules.get("IPython")
        cells = getattr(ipython and ipython.get_ipython(), "execution_count", 0)
        if cells != self._cells:
            self._cells, self._last = cells, wall.monotonic()
        return wall.monotonic() - self._last < RECENTLY or any(there() for there in tuple(pace.views))

    def tell(self, runs: Sequence[LiveRun]) -> None:
        """Update the states in the cells as long as somebody may see it."""
        was_there, self.was_there = self.was_there, self.is_there()
        for run in runs if was_there else ():
            run.show_state("" if self.was_there else "goes on")


class _Loop:
    """The task that drives a graph's live runs along with the wall clock, as long as there are any.

    It goes on while threads of cells wait for robot time, and where the graph is linked to a robot until the
    kernel has another graph.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._live = graph.part(_LiveRuns)
        self._paced = pace.WallPace(graph)
        self._audience = _Audience()

    async def run(self) -> None:
        """Go on step by step; a callback's exception, or ■, stops all that runs."""
        try:
            while self._goes_on():
                await asyncio.sleep(STEP)
                self._live.stop_those_over()
                if self._goes_on():
                    self._step()
                self._audience.tell(tuple(self._live.runs))
        finally:
            live_interrupts.give_back()

    def _goes_on(self) -> bool:
        """Return whether nodes, threads or a robot need robot time."""
        is_linked = self._graph.keeps_wall_time and current_graph() is self._graph
        return bool(self._live.runs) or is_linked or baton.has_visitors(self._graph)

    def _until_ns(self) -> int:
        """Return the robot time until which a step lasts, [ns]."""
        if self._graph.keeps_wall_time:
            return self._graph.now_ns + round(STEP * 1e9)
        return self._paced.come_to(CATCH_UP)

    def _step(self) -> None:
        runs = tuple(self._live.runs)
        try:
            with live_interrupts.heard(), self._kept(), baton.known():
                if runs:
                    with executor_with(()) as executor:
                        executor.spin_until(self._until_ns())
                else:
                    baton.sleep_until(self._until_ns(), "the next step")
        except KeyboardInterrupt as interrupt:
            self._interrupted(runs, line_of_traceback(interrupt.__traceback__))
        except Exception:
            show_error()
            for run in runs:
                run.stop()
        if live_interrupts.asked:
            self._interrupted(runs, "")

    def _interrupted(self, runs: tuple[LiveRun, ...], line: str) -> None:
        """Stop the runs whose Stop was clicked; all of them if it was ■."""
        asked, live_interrupts.asked = live_interrupts.asked, False
        for run in runs:
            if asked or run.stop_clicked:
                run.note = f"interrupted in {line}" if line else ""
                run.stop()
                run.show_state()

    @contextmanager
    def _kept(self) -> Iterator[None]:
        """Keep robot time to the wall clock also where a callback sleeps; name a line that takes long."""
        former, watch.tell = watch.tell, self._tell
        self._graph.pace = self._paced
        try:
            yield
        finally:
            self._graph.pace = None
            watch.tell = former

    def _tell(self, callback: Callback, line: str) -> None:
        runs = self._live.runs
        its_own = [run for run in runs if run.has_node(callback.node)]
        for run in its_own or tuple(runs):
            run.show_state(f"busy for {callback.seconds:.0f} s in {line}")


def show_error() -> None:
    """Show a callback's exception under the cell that started the run."""
    from IPython import get_ipython

    get_ipython().CustomTB(*sys.exc_info(), tb_offset=0)  # what loading the extension has set
