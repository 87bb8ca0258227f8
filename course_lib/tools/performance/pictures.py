"""The pictures of a performance report, with words for those who do not see them."""

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.tools.performance.measure import Call, CallbackRow, TopicRow

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SHORTEST = 0.004  # of the picture's width: what a callback that takes no robot time is drawn with
_RAN, _WAITED = "tab:blue", "lightgrey"
_ROW = 0.35  # [inch]


@dataclass(frozen=True)
class Chart:
    """A picture and its alternative text; a cell shows both to those who need them."""

    figure: "Figure"
    alt: str

    def png(self) -> bytes:
        """Give the picture as PNG."""
        file = BytesIO()
        self.figure.savefig(file, format="png", dpi=100, bbox_inches="tight")
        return file.getvalue()

    def save(self, path: str | Path) -> None:
        """Write the picture as a PNG file."""
        Path(path).write_bytes(self.png())

    def _repr_html_(self) -> str:
        data = b64encode(self.png()).decode()
        return f'<img alt="{escape(self.alt)}" src="data:image/png;base64,{data}"/>'


def overview(topics: Sequence[TopicRow], callbacks: Sequence[CallbackRow]) -> Chart:
    """Draw rates and latencies of topics, and how busy callbacks are, as bars."""
    from matplotlib.figure import Figure

    panels = [
        ("Rate [Hz]", [(row.topic, row.rate) for row in topics]),
        ("Mean latency [ms]", [(row.topic, row.latency * 1e3) for row in topics if row.latency is not None]),
        ("Busy, robot time [%]", [(f"{row.node} {row.callback}", row.busy * 1e2) for row in callbacks]),
    ]
    panels = [(title, bars) for title, bars in panels if bars]
    figure = Figure(figsize=(8, sum(1 + _ROW * len(bars) for _, bars in panels)), layout="constrained")
    heights = [2 + len(bars) for _, bars in panels]
    grid = figure.subplots(len(panels), squeeze=False, gridspec_kw={"height_ratios": heights})
    for axes, (title, bars) in zip(grid.flat, panels, strict=True):
        _bars(axes, title, bars)
    lines = (
        f"{title}: {', '.join(f'{name} {value:.3g}' for name, value in bars)}." for title, bars in panels
    )
    return Chart(figure, "Bars. " + " ".join(lines))


def timeline(calls: Sequence[Call], start_ns: int, begin: float, end: float) -> Chart:
    """Draw a lane per callback: when it ran, dark, and when it was ready but had to wait, hatched."""
    from matplotlib.figure import Figure

    lanes: dict[str, list[tuple[float, float, float]]] = {}  # ready, begun, ended [s]
    for call in calls:
        times = [(ns - start_ns) * 1e-9 for ns in (call.ready_ns, call.start_ns, call.end_ns)]
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
        waits = [(ready, began - ready) for ready, began, _ in runs if began > ready]
        axes.broken_barh(waits, (number - 0.2, 0.4), facecolor=_WAITED, edgecolor="grey", hatch="////")
        bars = [(began, max(ended - began, shortest)) for _, began, ended in runs]
        axes.broken_barh(bars, (number - 0.35, 0.7), facecolor=_RAN, edgecolor="white", linewidth=0.5)
    axes.set(xlim=(begin, end), ylim=(len(lanes) - 0.4, -0.6), xlabel="robot time [s]")
    axes.set_yticks(range(len(lanes)), list(lanes))
    axes.set_title("Callbacks: dark while they ran, hatched while they waited for their turn", fontsize=10)
    axes.grid(axis="x", alpha=0.4)
    lines = (_lane(name, runs) for name, runs in lanes.items())
    return Chart(figure, f"Callback timeline from {begin:g} to {end:g} s of robot time. {' '.join(lines)}")


def _bars(axes: "Axes", title: str, bars: Sequence[tuple[str, float]]) -> None:
    drawn = axes.barh([name for name, _ in bars], [value for _, value in bars], color=_RAN)
    axes.bar_label(drawn, fmt="%.3g", padding=3)
    axes.set_title(title, fontsize=10, loc="left")
    axes.invert_yaxis()
    axes.margins(x=0.12)


def _lane(name: str, runs: Sequence[tuple[float, float, float]]) -> str:
    longest = max(ended - began for _, began, ended in runs) * 1e3  # [ms]
    wait = max(began - ready for ready, began, _ in runs) * 1e3  # [ms]
    return f"{name}: {len(runs)} calls, the longest {longest:.3g} ms, the longest wait {wait:.3g} ms."
