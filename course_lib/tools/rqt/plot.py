"""`%rqt plot /topic/field …`: numbers over time."""

from collections import deque
from itertools import cycle, takewhile
from typing import Any

import numpy as np

from course_lib.ros.graph import Sample
from course_lib.tools.rqt.field_path import FieldPath, parse
from course_lib.tools.rqt.markup import chart
from course_lib.tools.rqt.view import View

_SAMPLES = 100_000  # that a curve keeps
_LONG = 5000  # samples of a curve that is drawn as pixels: as lines it would be heavy for the page
_LOOKS: tuple[tuple[str, Any], ...] = (  # colour and dashes of the first curve, the second one …
    ("#0072b2", "-"),
    ("#d55e00", (0, (6, 2))),
    ("#009e73", (0, (2, 2))),
    ("#cc79a7", (0, (8, 2, 2, 2))),
    ("#8a6d00", (0, (4, 4))),
    ("#56b4e9", (0, (1, 4))),
)


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
        """Draw the curves, with a legend that says the last values."""
        from matplotlib.figure import Figure

        now = (self.graph.now_ns - self._start_ns) * 1e-9
        since = max(0.0, now - self["Seconds"]) if self["Autoscroll"] else 0.0
        below = 0.5 + 0.24 * len(
            self._curves
        )  # [inch] for the legend; layouts by themselves take twice as long
        figure = Figure(figsize=(7.2, 2.7 + below))
        place = {"left": 0.1, "right": 0.98, "top": 0.97, "bottom": below / (2.7 + below)}
        axes = figure.subplots(gridspec_kw=place)
        for (name, (_, points)), (colour, dash) in zip(self._curves.items(), cycle(_LOOKS)):
            shown = [*takewhile(lambda point: point[0] >= since, reversed(points))]
            said = f"{name} = {points[-1][1]:.4g}" if points else f"{name}: nothing came yet"
            look = {"label": said, "color": colour, "linestyle": dash, "rasterized": len(shown) > _LONG}
            axes.plot(*np.reshape(shown, (-1, 2)).T, **look)
        axes.set(xlim=(since, max(now, since + 1.0)), xlabel="time [s]")
        axes.grid(alpha=0.4)
        names = axes.get_legend_handles_labels()
        figure.legend(*names, loc="lower left", frameon=False, handlelength=4)
        words = "; ".join(map(str, names[1])) or "no curve"
        return chart(figure, f"Values from {since:.1f} s to {max(now, since + 1.0):.1f} s: {words}")

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
