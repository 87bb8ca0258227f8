"""`%rqt plot /topic/field …`: numbers over time."""

from collections import deque
from collections.abc import Sequence
from itertools import takewhile
from math import isfinite
from typing import Any

import numpy as np
import numpy.typing as npt

from course_lib.ros.graph import Sample
from course_lib.tools.rqt.field_path import FieldPath, parse
from course_lib.tools.rqt.markup import drawing, tag, text
from course_lib.tools.rqt.view import View

_SAMPLES = 100_000  # that a curve keeps
_PLOT = (60.0, 10.0, 640.0, 250.0)  # [px] x, y, width, height
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8a6d00", "#56b4e9")
_DASHES = ("", "8 3", "2 3", "10 3 2 3", "5 5", "1 4")

Curve = npt.NDArray[np.float64]  # shape (n, 2), time [s] and value


class PlotView(View):
    """Curves of what came since the view was opened, by the time of publication."""

    name, title, listens = "plot", "MatPlot", True

    def build(self) -> None:
        """Make the controls, and a curve for each word."""
        from ipywidgets import BoundedFloatText, Text

        self._start_ns = self.graph.now_ns
        self._curves: dict[str, tuple[FieldPath, deque[tuple[float, float]]]] = {}
        hint, wide = "/topic/field /topic/list[0]", {"width": "480px"}
        topics = Text(" ".join(self.words), description="Topics", placeholder=hint, layout=wide)
        topics.continuous_update = False
        self.add(topics, self._choose)
        self.add_check("Pause")
        self.add_check("Autoscroll", on=True)
        self.add(BoundedFloatText(10, min=0.1, max=3600, description="Seconds", layout={"width": "140px"}))
        self._choose()

    def buttons(self) -> list[Any]:
        """Add a button that forgets what came."""
        return [self.button("Clear", "trash", self._clear)]

    def hear(self, sample: Sample) -> None:
        """Take the numbers out of a message."""
        message = None
        for path, points in self._curves.values():
            if (path.topic, path.type_name) == (sample.topic, sample.type_name):
                message = message or sample.message()
                points.append(((sample.stamp_ns - self._start_ns) * 1e-9, path.read(message)))

    def refresh(self) -> None:
        """Draw, unless that is paused."""
        if not self["Pause"]:
            super().refresh()

    def picture(self) -> str:
        """Draw the curves as SVG, with a legend that says the last values."""
        now = (self.graph.now_ns - self._start_ns) * 1e-9
        since = max(0.0, now - self["Seconds"]) if self["Autoscroll"] else 0.0
        curves = [
            np.array([*takewhile(lambda point: point[0] >= since, reversed(points))][::-1]).reshape(-1, 2)
            for _, points in self._curves.values()
        ]
        legend = [
            f"{text} = {points[-1][1]:.4g}" if points else f"{text}: nothing came yet"
            for text, (_, points) in self._curves.items()
        ]
        return curves_svg(curves, legend, (since, max(now, since + 1.0)))

    def _choose(self) -> None:
        """Let there be the curves that are named."""
        topics = self.source.topics()
        paths = [parse(word, topics) for word in self["Topics"].split()]
        self._curves = {
            path.text: self._curves.get(path.text, (path, deque(maxlen=_SAMPLES))) for path in paths
        }
        self.say("" if paths else "Name what to plot, like /joint_states/position[0], and press Enter.")
        self.refresh()

    def _clear(self) -> None:
        for _, points in self._curves.values():
            points.clear()


def curves_svg(curves: Sequence[Curve], legend: Sequence[str], span: tuple[float, float]) -> str:
    """Draw curves over a span of time [s]."""
    x0, y0, width, height = _PLOT
    low, high = _limits(curves)

    def to_x(time: float) -> float:
        return x0 + (time - span[0]) / (span[1] - span[0]) * width

    def to_y(value: float) -> float:
        return y0 + (high - value) / (high - low) * height

    thin = {"stroke": "var(--rqt-line)", "stroke_width": 0.6, "fill": "none"}
    shapes = tag("rect", x=x0, y=y0, width=width, height=height, **thin)
    for time in _ticks(*span, 8):
        shapes += tag("path", d=f"M{to_x(time):.1f} {y0}v{height}", **thin)
        shapes += text(f"{time:g}", to_x(time), y0 + height + 15, "middle")
    for value in _ticks(low, high, 6):
        shapes += tag("path", d=f"M{x0} {to_y(value):.1f}h{width}", **thin)
        shapes += text(f"{value:.6g}", x0 - 5, to_y(value) + 4, "end")
    y = y0 + height + 32
    shapes += text("time [s]", x0 + width, y, "end")
    for number, (curve, words) in enumerate(zip(curves, legend, strict=True)):
        line = {"stroke": _COLOURS[number % 6], "stroke_dasharray": _DASHES[number % 6], "fill": "none"}
        points = " ".join(f"{to_x(t):.1f},{to_y(v):.1f}" for t, v in _thinned(curve) if isfinite(v))
        shapes += tag("polyline", points=points, stroke_width=1.8, **line)
        shapes += tag("path", d=f"M{x0} {y - 4}h34", stroke_width=1.8, **line) + text(words, x0 + 42, y)
        y += 18
    said = f"Values from {span[0]:.1f} s to {span[1]:.1f} s: {'; '.join(legend) or 'no curve'}"
    return drawing(shapes, x0 + width + 12, y + 4, said)


def _limits(curves: Sequence[Curve]) -> tuple[float, float]:
    """Give the least and the greatest value, with a little room."""
    values = np.concatenate([curve[:, 1] for curve in curves]) if curves else np.empty(0)
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    room = (high - low) * 0.05 or max(abs(high) * 0.05, 0.5)
    return low - room, high + room


def _thinned(curve: Curve) -> Curve:
    """Keep the least and the greatest value of each pixel's width, in their order."""
    step = len(curve) // int(_PLOT[2]) * 2
    if step < 4:
        return curve
    blocks = curve[: len(curve) // step * step].reshape(-1, step, 2)
    picks = np.sort(np.stack([blocks[:, :, 1].argmin(1), blocks[:, :, 1].argmax(1)], 1), 1)
    return np.concatenate([np.take_along_axis(blocks, picks[:, :, None], 1).reshape(-1, 2), curve[-1:]])


def _ticks(low: float, high: float, count: int) -> list[float]:
    from matplotlib.ticker import MaxNLocator

    ticks = map(float, MaxNLocator(count).tick_values(low, high))
    return [tick for tick in ticks if low <= tick <= high]
