"""One `run_live`: its nodes, its Stop button, and what its cell says of it."""

from typing import TYPE_CHECKING, Any

from course_lib.ros.baton import baton
from course_lib.ros.busy import watch
from course_lib.ros.driving import running_nodes
from course_lib.ros.graph import Graph

if TYPE_CHECKING:
    from rclpy.node import Node


class LiveRun:
    """A running `run_live`: its nodes, and how to stop them; `name` is what its panel calls it."""

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
        """What runs."""
        return ", ".join(node.get_name() for node in self.nodes)

    def is_over(self) -> bool:
        """Say whether nothing of it is left: destroyed, or replaced as cells were run again."""
        return all(node.handle.has_left for node in self.nodes)

    def has_node(self, full_name: str) -> bool:
        """Return whether a node is one of its own."""
        return any(node.handle.full_name == full_name for node in self.nodes)

    def stop(self) -> None:
        """Stop; the nodes stay usable, but are not listed, as if their program had ended."""
        if not self.running:
            return
        self.running = False
        runs_of(self._graph).remove(self)
        for node in self.nodes:
            running_nodes().remove(node)
            if node.handle.executor is not None:  # a call in a cell may drive it right now
                node.handle.executor.remove_node(node)
            self._graph.rest(node.handle.id)
        self.show_state()

    def state(self, note: str = "") -> str:
        """Return in a few words whether it runs, for how long it has, and what is to be noted."""
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
        """Bring what the cell says up to date."""
        if self._panel is not None:
            button, label = self._panel.children
            button.disabled, label.value = not self.running, self.state(note)

    def _stop_clicked(self) -> None:
        """Stop from a thread that hears the page; a callback that does not end is interrupted."""
        self.stop_clicked = True
        with watch.stopping(), baton.known():
            callback = watch.under_way
            if callback is not None and self.has_node(callback.node):
                watch.want_no_more()
            self.stop()

    def _ipython_display_(self) -> None:
        """Show nothing below the cell: the panel is there already."""


def runs_of(graph: Graph) -> list[LiveRun]:
    """Return the list of what runs in a graph; it is changed in place."""
    runs: list[LiveRun] = graph.state.setdefault("live.runs", [])
    return runs
