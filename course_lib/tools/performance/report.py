"""`performance_report`: how a robot system does, as a table and as pictures."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.recording import Recording, read_bag, record
from course_lib.ros.driving import spin_for
from course_lib.ros.graph import current_graph
from course_lib.tools.performance.measure import (
    Call,
    CallbackRow,
    TopicRow,
    callback_rows,
    called,
    topic_rows,
)
from course_lib.tools.performance.pictures import Chart, overview, timeline
from course_lib.tools.sources import ALWAYS_THERE

if TYPE_CHECKING:
    from rclpy.node import Node

_COLUMNS: dict[str, tuple[str, float, str]] = {  # field: heading, factor, format
    "rate": ("Rate (Hz)", 1, ".2f"),
    "jitter": ("Jitter (ms)", 1e3, ".2f"),
    "latency": ("Latency (ms)", 1e3, ".1f"),
    "longest_latency": ("Longest latency (ms)", 1e3, ".1f"),
    "size": ("Size (B)", 1, ".0f"),
    "bandwidth": ("Bandwidth (KB/s)", 1e-3, ".2f"),
    "longest": ("Longest (ms)", 1e3, ".1f"),
    "longest_wait": ("Longest wait (ms)", 1e3, ".1f"),
    "busy": ("Busy (%)", 1e2, ".1f"),
    "load": ("Processor (%) *", 1e2, ".2f"),
}
_NOTE = "* processor time on this machine at the wall clock's pace: all other numbers are by robot time"


@dataclass(frozen=True, repr=False)
class PerformanceReport:
    """What was measured; a cell shows it as a table.

    Attributes:
        seconds: Robot time that was measured, [s].
        start_ns: Its beginning, [ns].
        calls: Every run of a callback, in the order of their ends; none from a bag.
    """

    seconds: float
    start_ns: int
    topics: tuple[TopicRow, ...]
    callbacks: tuple[CallbackRow, ...]
    calls: tuple[Call, ...]

    @property
    def busy(self) -> dict[str, float]:
        """Give, by node, the share of robot time in which its callbacks were under way."""
        nodes = dict.fromkeys((row.node for row in self.callbacks), 0.0)
        for row in self.callbacks:
            nodes[row.node] += row.busy
        return nodes

    def to_plain(self) -> dict[str, Any]:
        """Give all that robot time decides as dicts and lists: the same in every run."""
        callbacks = [{k: v for k, v in asdict(row).items() if k != "load"} for row in self.callbacks]
        return {
            "seconds": self.seconds,
            "topics": [asdict(row) for row in self.topics],
            "callbacks": callbacks,
            "nodes": self.busy,
        }

    def figure(self) -> Chart:
        """Draw rates, latencies and how busy the callbacks are."""
        return overview(self.topics, self.callbacks)

    def timeline(self, begin: float = 0.0, end: float | None = None) -> Chart:
        """Draw which callback ran when, and what waited, from `begin` to `end` [s] of what was measured.

        Raises:
            CourseError: There are no callbacks in that time.
        """
        until = min(self.seconds, begin + 1.0) if end is None else end
        return timeline(self.calls, self.start_ns, begin, until)

    def __repr__(self) -> str:
        from io import StringIO

        from rich.console import Console
        from rich.table import Table

        console = Console(file=StringIO(), width=140, markup=False, force_jupyter=False, force_terminal=False)
        for title, heads, rows in self._grids():
            table = Table(*heads, title=title, title_justify="left")
            for row in rows:
                table.add_row(*row)
            console.print(table)
        console.print(_NOTE if self.callbacks else "")
        return str(console.file.getvalue())  # type: ignore[attr-defined]  # it is the StringIO from above

    def _repr_html_(self) -> str:
        def line(kind: str, cells: Sequence[str]) -> str:
            return f"<tr>{''.join(f'<{kind}>{escape(cell)}</{kind}>' for cell in cells)}</tr>"

        tables = "".join(
            f"<table><caption>{escape(title)}</caption>{line('th', heads)}"
            f"{''.join(line('td', row) for row in rows)}</table>"
            for title, heads, rows in self._grids()
        )
        return tables + (f"<p>{_NOTE}</p>" if self.callbacks else "")

    def _grids(self) -> Iterator[tuple[str, list[str], list[list[str]]]]:
        """Yield title, headings and rows of each table that has rows."""
        for title, rows in (
            (f"Topics in {self.seconds:g} s of robot time", self.topics),
            ("Callbacks", self.callbacks),
        ):
            plain = [asdict(row) for row in rows]
            if plain:
                heads = [_COLUMNS[name][0] if name in _COLUMNS else name.capitalize() for name in plain[0]]
                yield title, heads, [[_cell(*item) for item in row.items()] for row in plain]


def performance_report(what: "float | Recording | str | Path", *nodes: "Node") -> PerformanceReport:
    """Measure nodes that run for so many seconds of robot time, together with live ones; or a bag.

    Args:
        what: Seconds of robot time, like `performance_report(5.0, camera, detector)`; or a recording, or a
            bag's folder.
        nodes: What runs.

    Raises:
        CourseError: No time, no node or no bag.
    """
    if not isinstance(what, int | float):
        recording = what if isinstance(what, Recording) else read_bag(what)
        return _report(recording, recording.start_ns, recording.end_ns, (), 0)
    graph, calls = current_graph(), list[Call]()

    def listen(*call: Any) -> None:
        calls.append(called(*call))

    start_ns = graph.now_ns
    graph.callback_listeners.append(listen)
    try:
        with record(graph) as recorder:
            spin_for(what, *nodes)
    finally:
        graph.callback_listeners.remove(listen)
    samples = [sample for sample in recorder.recording().samples if sample.stamp_ns >= start_ns]
    return _report(Recording(samples), start_ns, graph.now_ns, calls, graph.delay_ns)


def _report(
    recording: Recording, start_ns: int, end_ns: int, calls: Sequence[Call], delay_ns: int
) -> PerformanceReport:
    seconds = (end_ns - start_ns) * 1e-9
    topics = [row for row in topic_rows(recording.samples, delay_ns) if row.topic not in ALWAYS_THERE]
    callbacks = callback_rows(calls, seconds) if seconds else ()
    return PerformanceReport(seconds, start_ns, tuple(topics), tuple(callbacks), tuple(calls))


def _cell(name: str, value: Any) -> str:
    if value is None:
        return "-"
    if name not in _COLUMNS:
        return str(value)
    _, factor, form = _COLUMNS[name]
    return f"{value * factor:{form}}"
