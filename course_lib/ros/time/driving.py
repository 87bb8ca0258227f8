"""Calls in a notebook cell that drive nodes, and nodes that run live between the cells.

Robot time advances during such a call and stands still between calls, unless nodes run live. Live
nodes have no thread of their own: an asyncio task in the kernel's event loop drives them in steps
of 20 ms (`_LiveLoop`), so their callbacks run in the main thread, between the cells.
"""

import asyncio
import sys
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from html import escape
from traceback import walk_tb
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph, ProgramNodes, current_graph
from course_lib.ros.notices import print_notice
from course_lib.ros.time import pace, wall
from course_lib.ros.time.interrupts import Callback, live_interrupts, until_interrupted, watch
from course_lib.ros.time.time_lock import never, time_lock
from course_lib.ros.tracebacks import line_of_traceback

if TYPE_CHECKING:
    from rclpy.executors import Executor
    from rclpy.impl.node_handle import HandledNode
    from rclpy.node import Node

# Limit on the duration of a call [s].
MAX_SECONDS = 1e6


class DriveResult:
    """The result of a call that has driven nodes. It can be awaited as well."""

    def __await__(self) -> Generator[None, None, None]:
        """Complete immediately when awaited."""
        return
        yield

    def _ipython_display_(self) -> None:
        """Display nothing below the cell."""


def spin_for(seconds: float, *nodes: "Node") -> DriveResult:
    """Run nodes for exactly `seconds` [s] of robot time, together with the live nodes.

    Nodes of earlier cells do not run.

    Args:
        seconds: The robot time, [s], at most 1e6.
        nodes: The nodes to run; without any, only the live nodes run.

    Raises:
        CourseError: `seconds` is not a valid time, or an argument is not a node.

    Example:
        >>> import rclpy
        >>> from rclpy.node import Node
        >>> context = rclpy.init()
        >>> node = Node("counter")
        >>> timer = node.create_timer(0.5, lambda: print("tick"))
        >>> result = spin_for(1.2, node)
        tick
        tick
    """
    if not isinstance(seconds, int | float) or not 0 <= seconds <= MAX_SECONDS:
        raise CourseError(
            f"spin_for({seconds!r}, …): pass the seconds of robot time first, from 0 to "
            f"{MAX_SECONDS:g}, like spin_for(2.0, node)."
        )
    graph = current_graph()
    with executor_with(nodes) as executor, until_interrupted(), pace.keep_pace(graph):
        executor._course_spin_until(graph.now_ns + round(seconds * 1e9))
    return DriveResult()


@contextmanager
def executor_with(nodes: Sequence["Node"]) -> Iterator["Executor"]:
    """Add all running nodes and `nodes` to the notebook's executor during the block.

    Raises a CourseError if one of them is not a Node.
    """
    from rclpy.executors import get_global_executor
    from rclpy.node import Node

    for node in nodes:
        if not isinstance(node, Node):
            if isinstance(node, list | tuple | set):
                raise CourseError(
                    f"{node!r:.60} is a {type(node).__name__}. Pass the nodes one by one, like "
                    "spin_for(2.0, talker, listener), or spin_for(2.0, *nodes)."
                )
            point = " A decimal number has a point: 0.5." if isinstance(node, int) else ""
            raise CourseError(f"{node!r} is not a node. Pass an object of your class, like MyNode().{point}")
    executor = get_global_executor()
    with executor._course_joined_by([*running_nodes(), *nodes]):
        yield executor


def wait_for(ready: Callable[[], bool], *, seconds: float | None) -> bool:
    """Run the live nodes until `ready()`, at most `seconds` of robot time. Return `ready()`."""
    from rclpy.executors import wait_driving_live_nodes

    return wait_driving_live_nodes(ready, seconds=seconds)


def drive_in_cell(seconds: float) -> bool:
    """Drive live nodes and threads of cells for `seconds`. Return whether there are any.

    Threads do not need a context: they also wait before `rclpy.init()` and after
    `rclpy.shutdown()`.
    """
    from rclpy.context import get_default_context

    graph = current_graph()
    if seconds < 0 or not (running_nodes() or time_lock.has_waiting_threads(graph)):
        return False
    if get_default_context().is_valid:
        wait_for(never, seconds=seconds)
        return True
    with time_lock.hold(), pace.keep_pace(graph):
        time_lock.wait(
            never, until_ns=graph.now_ns + round(seconds * 1e9), awaited=f"time.sleep({seconds:g})"
        )
    return True


def running_nodes() -> list["HandledNode"]:
    """List the nodes that run during every waiting call: live nodes and the kit's own nodes.

    Appending a node to this list starts it.
    """
    from rclpy.executors import RunningNodes

    return current_graph().state(RunningNodes).nodes


# Robot time for which live nodes run without a viewer page; the following cells drive them further
# [s].
WITHOUT_A_PAGE = 2.0
# Wall time per step of the live loop [s].
STEP = 0.02
# Limit on the robot time that is caught up after a cell kept the kernel busy [s].
CATCH_UP = 0.25
# Limit on the characters of an exception in a state.
_LONGEST_ERROR = 160
# Wall time since the last cell for which its user is assumed to be present [s].
RECENTLY = 60.0


class LiveRun:
    """The handle that `run_live` returns: its nodes, Stop button and state, shown in the cell."""

    def __init__(self, graph: Graph, nodes: tuple["Node", ...]) -> None:
        self.nodes = nodes
        self.is_running = True
        self._graph = graph
        self.started_ns = graph.now_ns
        self.is_stop_clicked = False
        # How the run ended.
        self.note = ""
        # The exception that ended the run.
        self.error = ""
        self._panel: Any = None

    @property
    def name(self) -> str:
        """The name shown on its panel."""
        # The handle is used because get_name() of a destroyed node raises an InvalidHandle.
        return ", ".join(node.handle.name for node in self.nodes)

    def is_over(self) -> bool:
        """Return whether all of its nodes were destroyed, or replaced by running their cell again."""
        return all(node.handle.has_left for node in self.nodes)

    def has_node(self, full_name: str) -> bool:
        """Return whether a node belongs to this run."""
        return any(node.handle.full_name == full_name for node in self.nodes)

    def stop(self) -> None:
        """Stop the run.

        Its nodes stay usable, but are no longer listed, as if their program had ended.
        """
        if not self.is_running:
            return
        self.is_running = False
        self._graph.state(_LiveRuns).runs.remove(self)
        for node in self.nodes:
            running_nodes().remove(node)
            # A call in a cell may be driving the node at this moment.
            if node.handle.executor is not None:
                node.handle.executor.remove_node(node)
            self._graph.hide_node(node.handle.id)
        self.show_state()

    def state(self, note: str = "") -> str:
        """Return a short description: whether the run is active, for how long, and a note."""
        seconds = (self._graph.now_ns - self.started_ns) * 1e-9
        status = "✗ stopped by an error" if self.error else "▶ running" if self.is_running else "■ stopped"
        # Each change is a message and a frame of the page, so the tenths are shown only at the end.
        text = f"{int(seconds)}" if self.is_running else f"{seconds:.1f}"
        state = f"{status}: {self.name} ({text} s of robot time)"
        return ", ".join(filter(None, (state, note or self.note, self.error)))

    def show(self) -> None:
        """Display the state and a Stop button in the cell."""
        import ipywidgets
        from IPython.display import display

        look = {"flex": "none"}  # not squeezed by a long error message
        button = ipywidgets.Button(description="Stop", icon="stop", tooltip="Stop these nodes", layout=look)
        button.on_click(lambda _: self._on_stop_click())
        if hasattr(button.comm, "_reply_subshell_for"):
            # ipykernel 7.4 delays a page's messages while a callback runs, with or without
            # JupyterLab's subshells.
            button.comm._reply_subshell_for = lambda data, default: default
        self._panel = ipywidgets.HBox([button, ipywidgets.HTML(self._html())])
        # Shown by pages without this kernel, such as nbviewer or a notebook that is opened the next
        # day.
        saved_text = f"{self.name} ran here. Run this cell to start it again."
        bundle = {**self._panel._repr_mimebundle_(), "text/plain": saved_text}
        display(bundle, raw=True)

    def show_state(self, note: str = "") -> None:
        """Update the displayed state."""
        if self._panel is not None:
            button, label = self._panel.children
            button.disabled, label.value = not self.is_running, self._html(note)

    def _html(self, note: str = "") -> str:
        """Return the state as HTML.

        Errors are red, because the view covers the traceback below it. A long list of nodes is
        wrapped, and ipywidgets' lines are as high as a button.
        """
        color = "var(--jp-error-color1, #d32f2f)" if self.error else "inherit"
        weight = "bold" if self.error else "normal"
        style = f"color: {color}; font-weight: {weight}; line-height: 1.4; padding: 5px 0"
        return f'<div style="{style}">{escape(self.state(note))}</div>'

    def fail(self, error: Exception) -> None:
        """Stop because a callback raised an exception, which the state then shows."""
        line = line_of_traceback(error.__traceback__)
        summary = f"{type(error).__name__}: {error}".splitlines()[0][:_LONGEST_ERROR]
        error_with_line = f"{summary}{line and f' in {line}'}"
        self.error = f"{error_with_line}. Read on below."
        self.stop()
        errors = self._graph.state(ProgramNodes).errors
        for node in self.nodes:
            errors[node.handle.full_name] = f"{self.name}: stopped by an error, {error_with_line}"

    def _on_stop_click(self) -> None:
        """Stop the run.

        Called in the thread that receives the page's messages. A callback that does not end is
        interrupted.
        """
        self.is_stop_clicked = True
        with watch.stopping(), time_lock.hold():
            callback = watch.running_callback
            if callback is not None and self.has_node(callback.node):
                watch.interrupt_callback()
            self.stop()

    def _ipython_display_(self) -> None:
        """Display nothing below the cell, because the panel is already shown."""


@dataclass
class _LiveRuns:
    """The live runs of a graph, and the asyncio task that drives them."""

    runs: list[LiveRun] = field(default_factory=list)
    task: "asyncio.Task[None] | None" = None

    def drive(self, graph: Graph, *, from_this_cell: bool = False) -> None:
        """Start to drive the graph between the cells, unless a task already does so.

        Jupyter shows the output of a task in the cell that started it. `from_this_cell` replaces a
        task of an earlier cell, where nobody would look for the output of new nodes.
        """
        if self.task is not None and from_this_cell:
            self.task.cancel()
        if self.task is None or self.task.done() or from_this_cell:
            self.task = asyncio.get_running_loop().create_task(_LiveLoop(graph).run())

    def stop_finished_runs(self) -> None:
        """Stop the runs whose nodes no longer exist."""
        for run in tuple(self.runs):
            if run.is_over():
                run.stop()


def run_live(*nodes: "Node") -> LiveRun:
    """Run nodes in real time while no cell runs. Return a handle with `stop()`.

    Without a viewer page (nbclient, scripts) they run for a few seconds of robot time at full speed
    instead, and later calls that wait, like `spin_for`, drive them further.

    Args:
        nodes: The nodes to run, at least one: ``live = run_live(Camera(), Detector())``.

    Raises:
        CourseError: No node was passed, or an argument is not a node.
    """
    if not nodes:
        raise CourseError("run_live() needs at least one node, like run_live(MyNode()).")
    graph = current_graph()
    with executor_with(nodes):
        run = LiveRun(graph, nodes)
    for earlier_run in live_runs(graph):
        # A node has one Stop button only.
        if not set(nodes).isdisjoint(earlier_run.nodes):
            earlier_run.stop()
    return start_live_run(run)


def start_live_run(run: LiveRun) -> LiveRun:
    """Start a live run. Without a viewer page it first runs for a few seconds at full speed."""
    graph = current_graph()
    with executor_with(run.nodes) as executor:
        if pace.mode() == "fast":
            executor._course_spin_until(graph.now_ns + round(WITHOUT_A_PAGE * 1e9))
            print_notice(f"No page is watching: ran {WITHOUT_A_PAGE:g} s of robot time at full speed.")
    run.started_ns = graph.now_ns
    live = graph.state(_LiveRuns)
    live.stop_finished_runs()
    live.runs.append(run)
    running_nodes().extend(run.nodes)
    if pace.mode() == "real":
        run.show()
        live.drive(graph, from_this_cell=True)
    return run


def live_runs(graph: Graph) -> tuple[LiveRun, ...]:
    """List the live runs."""
    live = graph.state(_LiveRuns)
    live.stop_finished_runs()
    return tuple(live.runs)


def stop_all() -> None:
    """Stop everything that runs between the cells: `run_live` and `%ros2 launch`."""
    for run in live_runs(current_graph()):
        run.stop()


def drive_between_cells(graph: Graph) -> None:
    """Drive a graph between the cells even without live runs, because it is linked to a robot."""
    # In `course run` of a notebook there is no event loop; the cells drive the graph.
    with suppress(RuntimeError):
        graph.state(_LiveRuns).drive(graph)


def drive_threads() -> None:
    """Drive the graph between the cells while threads wait for robot time, as in `rclpy.spin`."""
    graph = current_graph()
    if time_lock.has_waiting_threads(graph) and pace.mode() == "real":
        drive_between_cells(graph)


class _LiveLoop:
    """The task that drives a graph's live runs in real time, as long as there are any.

    It continues while threads of cells wait for robot time and, if the graph is linked to a robot,
    until the kernel has another graph.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._live = graph.state(_LiveRuns)
        self._wall_pace = pace.WallPace(graph)
        # The number of executed cells, and the time at which the last cell was executed [s].
        self._cell_count, self._last_cell_at = -1, 0.0
        # Whether someone may have seen the states at their last update.
        self._was_visible = True

    async def run(self) -> None:
        """Drive step by step. An exception of a callback, or ■, stops the runs."""
        try:
            while self._should_continue():
                await asyncio.sleep(STEP)
                self._live.stop_finished_runs()
                if self._should_continue():
                    self._step()
                self._update_states()
        finally:
            live_interrupts.ignore()

    def _should_continue(self) -> bool:
        """Return whether live nodes, threads or a robot need robot time."""
        is_linked = self._graph.keeps_wall_time and current_graph() is self._graph
        return bool(self._live.runs) or is_linked or time_lock.has_waiting_threads(self._graph)

    def _step(self) -> None:
        runs = tuple(self._live.runs)
        try:
            with live_interrupts.handle(), self._keep_pace(), time_lock.hold(), ExitStack() as stack:
                executor = stack.enter_context(executor_with(())) if runs else None
                if self._graph.keeps_wall_time:
                    end_ns = self._graph.now_ns + round(STEP * 1e9)
                else:
                    end_ns = self._wall_pace.reached_ns(CATCH_UP)
                if executor is not None:
                    executor._course_spin_until(end_ns)
                else:
                    time_lock.sleep_until(end_ns, "the next step")
        except KeyboardInterrupt as interrupt:
            self._on_interrupt(runs, line_of_traceback(interrupt.__traceback__))
        except Exception as error:
            show_error()
            # The run is to blame if the exception was raised in a method of one of its nodes.
            frames = [frame for frame, _ in walk_tb(error.__traceback__)]
            failed_runs = [r for r in runs if any(f.f_locals.get("self") in r.nodes for f in frames)] or runs
            for run in failed_runs:
                run.fail(error)
            for run in set(runs).difference(failed_runs):
                run.note = f"as {failed_runs[0].name} ended with an error"
                run.stop()
        if live_interrupts.was_pressed:
            self._on_interrupt(runs, "")

    def _update_states(self) -> None:
        """Update the states in the cells as long as someone may see them.

        That is assumed while a page shows a view, and for a short time after each cell. Each update
        is a message, and JupyterHub never considers a kernel that sends messages idle.
        """
        ipython = sys.modules.get("IPython")
        cells = getattr(ipython and ipython.get_ipython(), "execution_count", 0)
        if cells != self._cell_count:
            self._cell_count, self._last_cell_at = cells, wall.monotonic()
        is_recent = wall.monotonic() - self._last_cell_at < RECENTLY
        was_visible = self._was_visible
        self._was_visible = is_recent or any(is_shown() for is_shown in tuple(pace.views))
        for run in tuple(self._live.runs) if was_visible else ():
            run.show_state("" if self._was_visible else "goes on")

    def _on_interrupt(self, runs: tuple[LiveRun, ...], line: str) -> None:
        """Stop the runs whose Stop button was clicked, or all of them if ■ was pressed."""
        was_pressed, live_interrupts.was_pressed = live_interrupts.was_pressed, False
        for run in runs:
            if was_pressed or run.is_stop_clicked:
                run.note = f"interrupted in {line}" if line else ""
                run.stop()
                run.show_state()

    @contextmanager
    def _keep_pace(self) -> Iterator[None]:
        """Keep robot time to the wall clock even while a callback sleeps.

        Report lines that take long.
        """
        previous_report, watch.report = watch.report, self._report_busy
        self._graph.pace = self._wall_pace
        try:
            yield
        finally:
            self._graph.pace = None
            watch.report = previous_report

    def _report_busy(self, callback: Callback, line: str) -> None:
        runs = self._live.runs
        for run in [run for run in runs if run.has_node(callback.node)] or tuple(runs):
            run.show_state(f"busy for {callback.seconds:.0f} s in {line}")


def show_error() -> None:
    """Show a callback's exception below the cell that started the run."""
    from IPython import get_ipython

    # The formatter that loading the extension has set.
    get_ipython().CustomTB(*sys.exc_info(), tb_offset=0)
