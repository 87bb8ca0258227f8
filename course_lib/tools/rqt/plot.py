"""`%rqt plot /topic/field …`: curves of the numbers in messages, addressed by paths."""

import re
from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import cycle, takewhile
from typing import Any

import numpy as np

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.graph.graph import Sample
from course_lib.ros.messages import RosMessage
from course_lib.ros.messages.definitions import PRIMITIVES, definition
from course_lib.tools.rqt.view import RqtView, chart

_STEP = re.compile(r"(\w+)(?:\[(\d+)\])?")


@dataclass(frozen=True)
class FieldPath:
    """The path to a number in the messages of a topic."""

    text: str
    topic: str
    type_name: str
    # Each step is a field and an index, if there is one.
    steps: tuple[tuple[str, int | None], ...]

    def read(self, message: RosMessage) -> float:
        """Return the value of the field, or NaN if an index is out of range."""
        value: object = message
        for name, index in self.steps:
            value = getattr(value, name)
            if index is not None:
                # parse() has checked that the indexed value is a list and the result a number.
                if index >= len(value):  # type: ignore[arg-type]
                    return float("nan")
                value = value[index]  # type: ignore[index]
        return float(value)  # type: ignore[arg-type]


def parse(text: str, topics: Mapping[str, Sequence[str]]) -> FieldPath:
    """Parse a path.

    Args:
        text: A path like /topic/field/part[0].
        topics: The types of each topic.

    Raises:
        CourseError: The path is invalid. The message begins like that of rqt_plot.
    """
    path = "/" + text.strip("/")
    fitting = [topic for topic in topics if f"{path}/".startswith(f"{topic}/")]
    if not fitting:
        raise CourseError(f"topic {path} does not exist{did_you_mean(path, topics)}")
    topic = max(fitting, key=len)
    type_name = topics[topic][0]
    field_path = path[len(topic) :].strip("/")
    current_type, steps, field = type_name, list[tuple[str, int | None]](), None
    for step_text in filter(None, field_path.split("/")):
        fields = {field.name: field for field in definition(current_type).fields} if current_type else {}
        step = _STEP.fullmatch(step_text)
        if step is None or step[1] not in fields:
            raise CourseError(
                f"{path}: {current_type or 'a number'} has no field {step_text!r}"
                f"{did_you_mean(step_text, fields)}"
            )
        field, index = fields[step[1]], None if step[2] is None else int(step[2])
        if index is None and field.container != "scalar":
            raise CourseError(f"{path}: {field.name} is a list. Add an index, like {field.name}[0].")
        if index is not None and (field.container == "scalar" or 0 < field.size <= index):
            size = f"a list of {field.size}" if field.container == "array" else "not a list"
            raise CourseError(f"{path}: {step_text} does not exist, {field.name} is {size}.")
        steps.append((field.name, index))
        current_type = field.base if field.is_message else ""
    if field is None or field.is_message or PRIMITIVES[field.base].python not in (bool, int, float):
        numbers = [f"{path}/{name}" for name in _numbers(current_type)] if current_type else []
        why = "is not a number" if steps else f'no field specified in topic name "{path}"'
        raise CourseError(
            f"{f'{path} ' if steps else ''}{why}. Numbers here: {', '.join(numbers) or 'none'}."
        )
    return FieldPath(path, topic, type_name, tuple(steps))


def _numbers(type_name: str, deep: int = 2) -> Iterator[str]:
    """Yield the paths of the numbers in a message. Lists are addressed by index 0."""
    for field in definition(type_name).fields:
        name = field.name if field.container == "scalar" else f"{field.name}[0]"
        if field.is_message and deep:
            yield from (f"{name}/{inner}" for inner in _numbers(field.base, deep - 1))
        elif not field.is_message and PRIMITIVES[field.base].python in (bool, int, float):
            yield name


# Number of points per curve.
_SAMPLES = 100_000
# Longer curves are drawn as pixels, because thousands of lines would slow down the page.
_LONG = 5000
# Color and dashes of the first curve, the second one …
_LOOKS: tuple[tuple[str, Any], ...] = (
    ("#0072b2", "-"),
    ("#d55e00", (0, (6, 2))),
    ("#009e73", (0, (2, 2))),
    ("#cc79a7", (0, (8, 2, 2, 2))),
    ("#8a6d00", (0, (4, 4))),
    ("#56b4e9", (0, (1, 4))),
)


class PlotView(RqtView):
    """Curves of numbers by the time of publication, since the view was opened."""

    name, title, listens = "plot", "MatPlot", True

    def build(self) -> None:
        """Create the controls, and a curve for each path in the arguments."""
        from ipywidgets import BoundedFloatText, Text

        self._start_ns = self.graph.now_ns
        self.curves: dict[str, tuple[FieldPath, deque[tuple[float, float]]]] = {}
        hint, wide = "/topic/field /topic/list[0]", {"width": "480px"}
        topics = Text(" ".join(self.words), description="Topics", placeholder=hint, layout=wide)
        topics.continuous_update = False
        self.add(topics, self._choose)
        self.add_check("Pause")
        self.add_check("Autoscroll", on=True)
        self.add(BoundedFloatText(10, min=0.1, max=3600, description="Seconds", layout={"width": "140px"}))
        self._choose()

    def buttons(self) -> list[Any]:
        """Add a button that clears the curves."""
        return [self.button("Clear", "trash", self.clear)]

    def required_topics(self) -> Collection[str]:
        """Return the topics of the curves."""
        return {path.topic for path, _ in self.curves.values()}

    def on_sample(self, sample: Sample) -> None:
        """Append the values in a message to the curves."""
        message = None
        for path, points in self.curves.values():
            if (path.topic, path.type_name) == (sample.topic, sample.type_name):
                message = message or sample.message()
                points.append(((sample.stamp_ns - self._start_ns) * 1e-9, path.read(message)))

    def refresh(self) -> None:
        """Draw the curves unless the view is paused."""
        if not self["Pause"]:
            super().refresh()

    def picture(self) -> str:
        """Draw the curves, with the last values in the legend."""
        from matplotlib.figure import Figure

        now = (self.graph.now_ns - self._start_ns) * 1e-9
        since = max(0.0, now - self["Seconds"]) if self["Autoscroll"] else 0.0
        # Height of the legend [inch]. matplotlib's automatic layouts take twice as long.
        below = 0.5 + 0.24 * len(self.curves)
        figure = Figure(figsize=(7.2, 2.7 + below))
        margins = {"left": 0.1, "right": 0.98, "top": 0.97, "bottom": below / (2.7 + below)}
        axes = figure.subplots(gridspec_kw=margins)
        for (name, (_, points)), (colour, dash) in zip(self.curves.items(), cycle(_LOOKS)):
            shown_points = [*takewhile(lambda point: point[0] >= since, reversed(points))]
            label = f"{name} = {points[-1][1]:.4g}" if points else f"{name}: no message yet"
            look = {
                "label": label,
                "color": colour,
                "linestyle": dash,
                "rasterized": len(shown_points) > _LONG,
            }
            axes.plot(*np.reshape(shown_points, (-1, 2)).T, **look)
        axes.set(xlim=(since, max(now, since + 1.0)), xlabel="time [s]")
        axes.grid(alpha=0.4)
        names = axes.get_legend_handles_labels()
        figure.legend(*names, loc="lower left", frameon=False, handlelength=4)
        curve_names = "; ".join(map(str, names[1])) or "no curve"
        return chart(figure, f"Values from {since:.1f} s to {max(now, since + 1.0):.1f} s: {curve_names}")

    def _choose(self) -> None:
        """Create the requested curves. Existing curves keep their points."""
        topics = self.source.topics()
        paths = [parse(word, topics) for word in self["Topics"].split()]
        self.curves = {
            path.text: self.curves.get(path.text, (path, deque(maxlen=_SAMPLES))) for path in paths
        }
        self.show_notice(
            "" if paths else "Enter the path of a number to plot, like /joint_states/position[0]."
        )
        self.refresh()

    def clear(self) -> None:
        """Remove the points of all curves."""
        for _, points in self.curves.values():
            points.clear()
