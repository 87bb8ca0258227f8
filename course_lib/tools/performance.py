"""`performance_report`: measurements of topics and callbacks, as tables and charts."""

import struct
from base64 import b64encode
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from html import escape
from io import BytesIO, StringIO
from itertools import pairwise
from pathlib import Path
from statistics import fmean, pstdev
from typing import TYPE_CHECKING, Any, TypeAlias

from course_lib.errors import CourseError
from course_lib.files import save_as
from course_lib.recording import Recording, read_bag, record
from course_lib.ros.graph.graph import Sample, current_graph
from course_lib.ros.messages import message_class
from course_lib.ros.notices import print_notice
from course_lib.ros.time.driving import spin_for
from course_lib.tools.sources import ALWAYS_THERE

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rclpy.node import Node

_SECOND = 10**9  # [ns]


@dataclass(frozen=True)
class TopicRow:
    """Measurements of a topic.

    Latency is the time from the header's stamp to reception, None without stamps.
    """

    topic: str
    messages: int
    # Messages per second [Hz]. Rate and jitter are 0 for fewer than two messages.
    rate: float
    # Standard deviation of the time between messages [s].
    jitter: float
    # Mean latency [s].
    latency: float | None
    longest_latency: float | None  # [s]
    # Mean size as CDR [bytes].
    size: float
    # In bytes per second.
    bandwidth: float


@dataclass(frozen=True)
class CallbackRow:
    """Measurements of a callback in robot time, except `load`, which depends on the machine."""

    node: str
    callback: str
    calls: int
    # Time from start to end [s].
    longest: float
    # Time from ready to start [s].
    longest_wait: float
    # Fraction of the time during which the callback ran.
    busy: float
    # Fraction of a processor used in real time; differs from run to run.
    load: float


@dataclass(frozen=True)
class CallbackRun:
    """One run of a callback: times in [ns] of robot time, CPU time in [s]."""

    node: str
    callback: str
    ready_ns: int
    start_ns: int
    end_ns: int
    cpu_seconds: float


def header_stamp(sample: Sample) -> int | None:
    """Read the stamp [ns] from the bytes of a message's header; None without a header or stamp."""
    fields = message_class(sample.type_name).get_fields_and_field_types()
    if next(iter(fields.items()), None) != ("header", "std_msgs/Header"):
        return None
    seconds, nanoseconds = struct.unpack_from("<iI" if sample.cdr[1] else ">iI", sample.cdr, 4)
    return seconds * _SECOND + nanoseconds or None


# Heading, factor and format by field.
_COLUMNS: dict[str, tuple[str, float, str]] = {
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
_NO_MEASUREMENT = "No topic had a message and no callback ran in {:g} s of robot time: does a node run?"
_NOTE = "* processor time on this machine at the wall clock's pace: all other numbers are by robot time"


# Fraction of the picture's width for callbacks that take no robot time.
_SHORTEST = 0.004
_RAN, _WAITED = "tab:blue", "lightgrey"
_ROW = 0.35  # [inch]
# Names and values; a topic without stamps has no latency.
_Bars: TypeAlias = list[tuple[str, float | None]]
# The height of a bar of `figure`: more than 20 fit into a window.
_BAR = 0.2  # [inch]


@dataclass(frozen=True)
class Chart:
    """A picture with its alternative text."""

    figure: "Figure"
    alt: str

    def png(self) -> bytes:
        """Return the picture as PNG."""
        file = BytesIO()
        self.figure.savefig(file, format="png", dpi=100, bbox_inches="tight")
        return file.getvalue()

    def save(self, path: str | Path) -> None:
        """Write the picture as a PNG file.

        Raises:
            CourseError: The file cannot be written.
        """
        save_as(path, self.png(), "the picture")
        print_notice(f"Saved {path}.")

    def _repr_html_(self) -> str:
        data = b64encode(self.png()).decode()
        return f'<img alt="{escape(self.alt)}" src="data:image/png;base64,{data}"/>'


@dataclass(frozen=True, repr=False)
class PerformanceReport:
    """Measurements of topics and callbacks. A cell displays them as tables.

    Attributes:
        seconds: Measured robot time, [s].
        start_ns: Start of the measured time, [ns].
        calls: All runs of callbacks in the order of their ends; empty for a bag.
    """

    seconds: float
    start_ns: int
    topics: tuple[TopicRow, ...]
    callbacks: tuple[CallbackRow, ...]
    calls: tuple[CallbackRun, ...]

    @property
    def busy(self) -> dict[str, float]:
        """The fraction of robot time during which callbacks of a node ran, by node."""
        nodes = dict.fromkeys((row.node for row in self.callbacks), 0.0)
        for row in self.callbacks:
            nodes[row.node] += row.busy
        return nodes

    def to_plain(self) -> dict[str, Any]:
        """Return the reproducible measurements (all except `load`) as dicts and lists."""
        callbacks = [{k: v for k, v in asdict(row).items() if k != "load"} for row in self.callbacks]
        return {
            "seconds": self.seconds,
            "topics": [asdict(row) for row in self.topics],
            "callbacks": callbacks,
            "nodes": self.busy,
        }

    def figure(self) -> Chart:
        """Draw the rates, latencies and busy fractions as bar charts.

        Raises:
            CourseError: Nothing was measured.
        """
        from matplotlib.figure import Figure

        rates: _Bars = [(row.topic, row.rate) for row in self.topics]
        latencies: _Bars = [(row.topic, row.latency and row.latency * 1e3) for row in self.topics]
        busy: _Bars = [(f"{row.node} {row.callback}", row.busy * 1e2) for row in self.callbacks]
        # Charts of rates and latencies share the topic names, which halves the height.
        rows = [
            {"Rate [Hz]": rates, "Mean latency [ms]": latencies},
            {"Busy, robot time [%]": busy},
        ]
        rows = [
            {title: bars for title, bars in row.items() if any(value is not None for _, value in bars)}
            for row in rows
        ]
        rows = [row for row in rows if row]
        if not rows:
            raise CourseError(_NO_MEASUREMENT.format(self.seconds))
        heights = [_BAR * (3 + len(next(iter(row.values())))) for row in rows]
        figure = Figure(figsize=(8, sum(heights)), layout="constrained")
        parts = figure.subfigures(len(rows), squeeze=False, height_ratios=heights)
        for part, row in zip(parts.flat, rows, strict=True):
            plots = part.subplots(1, len(row), sharey=True, squeeze=False)
            for axes, (title, bars) in zip(plots.flat, row.items(), strict=True):
                values = [value or 0.0 for _, value in bars]
                drawn = axes.barh([name for name, _ in bars], values, color=_RAN)
                texts = ["-" if value is None else f"{value:.3g}" for _, value in bars]
                axes.bar_label(drawn, texts, padding=3, fontsize=9)
                axes.set_title(title, fontsize=10, loc="left")
                axes.tick_params(labelsize=9)
                axes.set_xlim(0.0, 1.2 * max(values) or 1.0)
                axes.margins(y=0.02)
            plots[0, 0].invert_yaxis()
        panels = [
            (title, [(name, value) for name, value in bars if value is not None])
            for row in rows
            for title, bars in row.items()
        ]
        lines = (
            f"{title}: {', '.join(f'{name} {value:.3g}' for name, value in bars)}." for title, bars in panels
        )
        return Chart(figure, "Bars. " + " ".join(lines))

    def timeline(self, begin: float = 0.0, end: float | None = None) -> Chart:
        """Draw when the callbacks ran and waited, from `begin` to `end` [s] of the measured time.

        Each callback has a lane, dark while it ran and hatched while it was ready and waited.

        Raises:
            CourseError: No callback ran in that time.
        """
        from matplotlib.figure import Figure

        end = min(self.seconds, begin + 1.0) if end is None else end
        # Ready, begun, ended [s].
        lanes: dict[str, list[tuple[float, float, float]]] = {}
        for call in self.calls:
            times = [(ns - self.start_ns) * 1e-9 for ns in (call.ready_ns, call.start_ns, call.end_ns)]
            if times[0] <= end and times[2] >= begin:
                lanes.setdefault(f"{call.node} {call.callback}", []).append((times[0], times[1], times[2]))
        if not lanes:
            raise CourseError(
                f"No callback ran from {begin:g} to {end:g} s. Measure nodes: performance_report(5.0, node)"
            )
        figure = Figure(figsize=(10, 1 + _ROW * len(lanes)), layout="constrained")
        axes = figure.subplots()
        shortest = _SHORTEST * (end - begin)
        for number, runs in enumerate(lanes.values()):
            waits = [(ready, start - ready) for ready, start, _ in runs if start > ready]
            axes.broken_barh(waits, (number - 0.2, 0.4), facecolor=_WAITED, edgecolor="grey", hatch="////")
            bars = [(start, max(stop - start, shortest)) for _, start, stop in runs]
            axes.broken_barh(bars, (number - 0.35, 0.7), facecolor=_RAN, edgecolor="white", linewidth=0.5)
        axes.set(xlim=(begin, end), ylim=(len(lanes) - 0.4, -0.6), xlabel="robot time [s]")
        axes.set_yticks(range(len(lanes)), list(lanes))
        axes.set_title(
            "Callbacks: dark while they ran, hatched while they waited for their turn", fontsize=10
        )
        axes.grid(axis="x", alpha=0.4)
        lines = []
        for name, runs in lanes.items():
            longest = max(stop - start for _, start, stop in runs) * 1e3  # [ms]
            wait = max(start - ready for ready, start, _ in runs) * 1e3  # [ms]
            lines.append(
                f"{name}: {len(runs)} calls, the longest {longest:.3g} ms, the longest wait {wait:.3g} ms."
            )
        return Chart(
            figure, f"Callback timeline from {begin:g} to {end:g} s of robot time. {' '.join(lines)}"
        )

    def __repr__(self) -> str:
        from rich.console import Console
        from rich.table import Table

        console = Console(file=StringIO(), width=140, markup=False, force_jupyter=False, force_terminal=False)
        for title, heads, rows in self._grids():
            table = Table(*heads, title=title, title_justify="left")
            for row in rows:
                table.add_row(*row)
            console.print(table)
        console.print(self._note())
        return str(console.file.getvalue())  # type: ignore[attr-defined]  # it is the StringIO from above

    def _repr_html_(self) -> str:
        def line(kind: str, cells: Sequence[str]) -> str:
            # Long names wrap after a slash, so that the table fits beside a view.
            texts = (escape(cell).replace("/", "/<wbr>") for cell in cells)
            return f"<tr>{''.join(f'<{kind}>{text}</{kind}>' for text in texts)}</tr>"

        tables = "".join(
            f"<table><caption>{escape(title)}</caption>{line('th', heads)}"
            f"{''.join(line('td', row) for row in rows)}</table>"
            for title, heads, rows in self._grids()
        )
        return tables + (f"<p>{note}</p>" if (note := self._note()) else "")

    def _note(self) -> str:
        """Return the line below the tables, or instead of tables if there are none."""
        if self.callbacks:
            return _NOTE
        return "" if self.topics else _NO_MEASUREMENT.format(self.seconds)

    def _grids(self) -> Iterator[tuple[str, list[str], list[list[str]]]]:
        """Yield title, headings and rows of each table that is not empty."""
        for title, rows in (
            (f"Topics in {self.seconds:g} s of robot time", self.topics),
            ("Callbacks", self.callbacks),
        ):
            plain = [asdict(row) for row in rows]
            if plain:
                heads = [_COLUMNS[name][0] if name in _COLUMNS else name.capitalize() for name in plain[0]]
                yield title, heads, [[_cell(*item) for item in row.items()] for row in plain]


def performance_report(what: "float | Recording | str | Path", *nodes: "Node") -> PerformanceReport:
    """Measure nodes while they run together with live nodes, or measure a recording.

    Args:
        what: Seconds of robot time, like `performance_report(5.0, camera, detector)`; or a
            recording, or a bag's folder.
        nodes: Nodes to run.

    Raises:
        CourseError: The time is invalid, there is no node to run, or the folder has no bag.
    """
    if not isinstance(what, int | float):
        recording = what if isinstance(what, Recording) else read_bag(what)
        return _report(recording, recording.start_ns, recording.end_ns, (), 0)
    graph, calls = current_graph(), list[CallbackRun]()

    def listen(entity: Any, ready_ns: int, start_ns: int, cpu_seconds: float) -> None:
        # The label of a run is the topic, service or period.
        handle, period = entity._course_node, getattr(entity, "timer_period_ns", None)
        label = getattr(entity, "topic_name", None) or getattr(entity, "srv_name", None)
        if period is not None:
            label = f"timer {period / _SECOND:g} s"
        times = ready_ns, start_ns, handle.graph.now_ns
        calls.append(CallbackRun(handle.full_name, label or type(entity).__name__, *times, cpu_seconds))

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
    recording: Recording, start_ns: int, end_ns: int, calls: Sequence[CallbackRun], delay_ns: int
) -> PerformanceReport:
    seconds = (end_ns - start_ns) * 1e-9
    by_topic: dict[tuple[str, str], list[Sample]] = {}
    for sample in recording.samples:
        if sample.topic not in ALWAYS_THERE:
            by_topic.setdefault((sample.topic, sample.type_name), []).append(sample)
    topics = []
    for (topic, _), samples in sorted(by_topic.items()):
        gaps = [(b.stamp_ns - a.stamp_ns) / _SECOND for a, b in pairwise(samples)]
        rate = 1 / fmean(gaps) if sum(gaps) else 0.0
        latencies = [
            (sample.stamp_ns + delay_ns - made_ns) / _SECOND
            for sample in samples
            if (made_ns := header_stamp(sample)) is not None
        ]
        size = fmean(len(sample.cdr) for sample in samples)
        topics.append(
            TopicRow(
                topic,
                len(samples),
                rate=rate,
                jitter=pstdev(gaps) if gaps else 0.0,
                latency=fmean(latencies) if latencies else None,
                longest_latency=max(latencies, default=None),
                size=size,
                bandwidth=size * rate,
            )
        )
    by_callback: dict[tuple[str, str], list[CallbackRun]] = {}
    for call in calls if seconds else ():
        by_callback.setdefault((call.node, call.callback), []).append(call)
    callbacks = [
        CallbackRow(
            *name,
            calls=len(runs),
            longest=max(c.end_ns - c.start_ns for c in runs) / _SECOND,
            longest_wait=max(c.start_ns - c.ready_ns for c in runs) / _SECOND,
            busy=sum(c.end_ns - c.start_ns for c in runs) / _SECOND / seconds,
            load=sum(c.cpu_seconds for c in runs) / seconds,
        )
        for name, runs in sorted(by_callback.items())
    ]
    return PerformanceReport(seconds, start_ns, tuple(topics), tuple(callbacks), tuple(calls))


def _cell(name: str, value: Any) -> str:
    if value is None:
        return "-"
    if name not in _COLUMNS:
        return str(value)
    _, factor, form = _COLUMNS[name]
    return f"{value * factor:{form}}"
