"""`%rqt console`, `topic`, `robot_monitor`, `plot` and `bag`: views of received and recorded messages.

The first three are tables. `plot /topic/field …` draws curves of the numbers in messages, which are
addressed by paths. `bag FOLDER` is a time line of a recording, which can be played to the nodes.
"""

import asyncio
import re
from bisect import bisect_right
from collections import deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import cycle, takewhile
from pathlib import Path
from typing import Any

import numpy as np

from course_lib.errors import CourseError, did_you_mean, format_count
from course_lib.recording import read_bag
from course_lib.ros.graph.graph import Sample
from course_lib.ros.messages import RosMessage
from course_lib.ros.messages.conversions import PrintOptions, to_csv, to_yaml
from course_lib.ros.messages.definitions import PRIMITIVES, definition
from course_lib.ros.time import wall
from course_lib.tools.rqt.view import RqtView, chart, color_of, drawing, icon, table, tag, text
from course_lib.tools.sources import PLAYER
from course_lib.tools.topic import format_byte_sizes

_LOG = "rcl_interfaces/msg/Log"
# Number of messages, as in rqt_console.
_LOG_LIMIT = 20_000
_LOGS_SHOWN = 200
_LOG_HEADS = ("#", "Message", "Severity", "Node", "Stamp", "Location")
_SEVERITIES = {
    10: ("Debug", "stale"),
    20: ("Info", "info"),
    30: ("Warn", "warn"),
    40: ("Error", "error"),
    50: ("Fatal", "error"),
}


class ConsoleView(RqtView):
    """A table of log messages, newest first, with filters and highlighting."""

    name, title, listens = "console", "Console", True
    topics = ("/rosout",)

    def build(self) -> None:
        """Create the filters of rqt_console: severity, node, text and highlighting."""
        # The collected messages with their numbers, (number, message).
        self._logs: deque[tuple[int, Any]] = deque(maxlen=_LOG_LIMIT)
        self._count = 0
        for severity, _ in _SEVERITIES.values():
            self.add_check(severity, on=True)
        for name in ("Node", "Text", "Highlight"):
            self.add_text(name, hint="part of it")
        self.add_check("Pause")

    def buttons(self) -> list[Any]:
        """Add a button that clears the collected messages."""
        return [self.button("Clear", "trash", self._logs.clear)]

    def on_sample(self, sample: Sample) -> None:
        """Collect a log message unless the view is paused."""
        if (sample.topic, sample.type_name) == ("/rosout", _LOG) and not self["Pause"]:
            self._count += 1
            self._logs.append((self._count, sample.message()))

    def picture(self) -> str:
        """Return the messages that match the filters as a table."""
        matching = [
            (number, log)
            for number, log in reversed(self._logs)
            if self[_SEVERITIES.get(log.level, _SEVERITIES[20])[0]]
            and self._matches("Node", log.name)
            and self._matches("Text", log.msg)
        ]
        more = f", the newest {_LOGS_SHOWN} of them here" if len(matching) > _LOGS_SHOWN else ""
        count = f"<p class='rqt-dim'>Displaying {len(matching)} of {len(self._logs)} messages{more}</p>"
        rows = []
        for number, log in matching[:_LOGS_SHOWN]:
            severity, sign = _SEVERITIES.get(log.level, _SEVERITIES[20])
            message = escape(log.msg)
            if self["Highlight"] and self._matches("Highlight", log.msg):
                message = f"<mark>► {message}</mark>"
            # In a narrow table, lines break between the parts, not within a number or a name.
            stamp = f"{log.stamp.sec}.<wbr>{log.stamp.nanosec:09d}"
            location = escape(f"{log.file}:{log.function}:{log.line}").replace(":", ":<wbr>")
            node = escape(log.name).replace(".", ".<wbr>")
            rows.append([str(number), message, icon(sign) + severity, node, stamp, location])
        return count + table(_LOG_HEADS, rows, "Log messages")

    def _matches(self, control: str, text: str) -> bool:
        return self[control].lower() in text.lower()


# Window of the statistics, in robot time.
_WINDOW_NS = 5 * 10**9
_TOPIC_HEADS = ("Topic", "Type", "Bandwidth", "Hz", "Value")


class TopicView(RqtView):
    """A row per topic with bandwidth, rate and value. A button unfolds the value."""

    name, title, listens = "topic", "Topic Monitor", True

    def build(self) -> None:
        """Create the filter and an empty table."""
        from ipywidgets import VBox

        # Time [ns] and size [bytes] by topic.
        self._received: dict[str, deque[tuple[int, int]]] = {}
        self._last_samples: dict[str, Sample] = {}
        self.rows: dict[str, Any] = {}
        self.table = VBox()
        self.add_text("Filter", hint="part of a name")

    def body(self) -> list[Any]:
        """Return the headings above the rows, which have more lines in a narrow window."""
        from ipywidgets import VBox

        sheet = VBox([self.screen, self.table])
        sheet.add_class("rqt-wide")
        return [sheet]

    def required_topics(self) -> Collection[str]:
        """Return all topics."""
        return {endpoint.topic for endpoint in self.graph.endpoints()}

    def on_sample(self, sample: Sample) -> None:
        """Update the rate and bandwidth of a message's topic."""
        window = self._received.setdefault(sample.topic, deque())
        window.append((sample.stamp_ns, len(sample.cdr)))
        while window[0][0] < sample.stamp_ns - _WINDOW_NS:
            window.popleft()
        self._last_samples[sample.topic] = sample

    def refresh(self) -> None:
        """Update the rows."""
        first, *others = _TOPIC_HEADS
        self.screen.value = f"<b class='rqt-heads'>{tag('span', first)}{topic_cells(others)}</b>"
        for topic in (topics := self._topics()):
            if topic not in self.rows:
                self.rows[topic] = self._row(topic)
            line, value = self.rows[topic].children
            button, about = line.children
            about.value = topic_cells(self.cells(topic, topics[topic]))
            button.icon = "caret-down" if button.value else "caret-right"
            last = self._last_samples.get(topic)
            text = to_yaml(last.message(), PrintOptions()) if last and button.value else "no message yet"
            value.value = f"<pre>{escape(text)}</pre>" if button.value else ""
        self.table.children = tuple(self.rows[topic] for topic in topics)

    def picture(self) -> str:
        """Return all rows as a table."""
        rows = ([topic, *map(escape, self.cells(topic, types))] for topic, types in self._topics().items())
        return table(_TOPIC_HEADS, rows, "Topics")

    def _topics(self) -> dict[str, list[str]]:
        topics = self.source.topics(with_hidden=False)
        return {topic: types for topic, types in topics.items() if self["Filter"] in topic}

    def _row(self, topic: str) -> Any:
        from ipywidgets import HTML, HBox, ToggleButton, VBox

        button = ToggleButton(topic in self.arguments, description=topic, tooltip=f"Value of {topic}")
        button.layout.width = "210px"
        button.add_class("rqt-topic")
        button.observe(lambda _: self.run_soon(self.refresh), "value")
        line = HBox([button, HTML(layout={"flex": "1"})])
        line.add_class("rqt-row")
        return VBox([line, HTML(layout={"margin": "0 0 0 24px"})])

    def cells(self, topic: str, types: list[str]) -> list[str]:
        """Return the cells to the right of a topic's name."""
        since = self.graph.now_ns - _WINDOW_NS
        window = [(at, size) for at, size in self._received.get(topic, ()) if at >= since]
        seconds = (window[-1][0] - window[0][0]) * 1e-9 if len(window) > 1 else 0.0
        rates = ["", ""]
        if seconds:
            (bandwidth,) = format_byte_sizes(sum(size for _, size in window[1:]) / seconds)
            rates = [f"{bandwidth}/s", f"{(len(window) - 1) / seconds:.2f}"]
        last = self._last_samples.get(topic)
        value = to_csv(last.message(), PrintOptions(truncate=8))[:200] if last else "no message yet"
        return [", ".join(types), *rates, value]


def topic_cells(texts: tuple[str, ...] | list[str]) -> str:
    """Return the cells of a row as HTML, with tooltips."""
    # The spaces separate the cells on pages without the view's style.
    cells = " ".join(tag("span", escape(cell_text), title=cell_text) for cell_text in texts)
    return tag("div", cells, **{"class": "rqt-cells"})


_DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
TOPICS = ("/diagnostics_agg", "/diagnostics")
# Time without a message, as in the diagnostic aggregator.
STALE_NS = 5 * 10**9
# Number of messages, as in rqt_robot_monitor's timeline.
_HISTORY = 30
_LEVELS = ("ok", "warn", "error", "stale")


class RobotMonitorView(RqtView):
    """The diagnostics tree with the worst level of each branch, and the details of one status."""

    name, title, listens = "robot_monitor", "Robot Monitor", True
    topics = TOPICS

    def build(self) -> None:
        """Create the controls. /diagnostics is shown until the aggregator publishes."""
        self._topic, self._received_ns = "", 0
        # Time [ns] and status by path.
        self._statuses: dict[str, tuple[int, Any]] = {}
        self._history: deque[tuple[int, str]] = deque(maxlen=_HISTORY)
        self.add_choice("Details of", [], None)
        self.add_check("Pause")

    def on_sample(self, sample: Sample) -> None:
        """Collect an array of statuses."""
        is_other = sample.type_name != _DIAGNOSTICS or sample.topic not in TOPICS
        if is_other or self["Pause"] or self._topic == TOPICS[0] != sample.topic:
            return
        if sample.topic != self._topic:
            # The aggregator publishes the statuses under different names.
            self._statuses.clear()
        self._topic, self._received_ns = sample.topic, sample.stamp_ns
        message: Any = sample.message()
        for status in message.status:
            self._statuses["/" + status.name.strip("/")] = sample.stamp_ns, status
        if self._statuses:
            self._history.append((sample.stamp_ns, self.worst_level("")))

    def refresh(self) -> None:
        """Update the choice of statuses and the picture."""
        self.offer("Details of", sorted(self._statuses))
        super().refresh()

    def picture(self) -> str:
        """Return summary, history, tree and the details of the chosen status."""
        if not self._topic:
            return f"<p>{icon('stale')}No diagnostics received yet on {' or '.join(TOPICS)}.</p>"
        age = (self.graph.now_ns - self._received_ns) * 1e-9
        is_stale = self.graph.now_ns - self._received_ns > STALE_NS
        stale_text = f"{icon('stale')}STALE: the l" if is_stale else "L"
        levels = [self._level(path) for path in self._statuses]
        counts = " · ".join(f"{icon(level)}{levels.count(level)} {level.upper()}" for level in _LEVELS[::-1])
        head = f"<p>{stale_text}ast message on {self._topic} came {age:.1f} s ago. {counts}</p>"
        tree = table(("Device", "Level", "Message"), map(self._row, self.paths()), "Devices")
        # A bar per message, whose height is the level.
        bars = ""
        for number, (_, level) in enumerate(self._history):
            high = 6 * (1 + _LEVELS.index(level))
            bars += tag("rect", x=9 * number, y=26 - high, width=7, height=high, fill=color_of(level))
        history = ", ".join(level.upper() for _, level in self._history)
        count = format_count(len(self._history), "message")
        details = ""
        if (path := self["Details of"]) in self._statuses:
            status, level = self._statuses[path][1], self._level(path)
            pairs = [("Message", status.message), ("Hardware ID", status.hardware_id)]
            pairs += [(pair.key, pair.value) for pair in status.values]
            rows = [list(map(escape, pair)) for pair in pairs]
            details = f"<p>{icon(level)}<b>{escape(path)}</b>: {level.upper()}</p>"
            details += table(("Key", "Value"), rows, path)
        timeline = drawing(bars, 9 * _HISTORY, 28, f"The last {count}: {history}")
        return head + timeline + tree + details

    def _level(self, path: str) -> str:
        received_ns, status = self._statuses[path]
        is_stale = self.graph.now_ns - received_ns > STALE_NS
        return "stale" if is_stale else _LEVELS[min(status.level[0], 3)]

    def worst_level(self, path: str) -> str:
        """Return the worst level of a branch."""
        branch = (p for p in self._statuses if f"{p}/".startswith(f"{path}/"))
        return max(map(self._level, branch), key=_LEVELS.index)

    def paths(self) -> list[str]:
        """List the paths of all statuses and of their branches, sorted as a tree."""
        split_paths = [path.split("/") for path in self._statuses]
        return sorted({"/".join(names[:deep]) for names in split_paths for deep in range(2, len(names) + 1)})

    def _row(self, path: str) -> list[str]:
        level = self.worst_level(path)
        message = self._statuses[path][1].message if path in self._statuses else ""
        name = icon(level) + escape(path.rpartition("/")[2])
        indented = tag("span", name, style=f"padding-left:{18 * (path.count('/') - 1)}px")
        return [indented, level.upper(), escape(message)]


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
        topics = Text(" ".join(self.arguments), description="Topics", placeholder=hint, layout=wide)
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
        for (name, (_, points)), (color, dash) in zip(self.curves.items(), cycle(_LOOKS)):
            shown_points = [*takewhile(lambda point: point[0] >= since, reversed(points))]
            label = f"{name} = {points[-1][1]:.4g}" if points else f"{name}: no message yet"
            look = {
                "label": label,
                "color": color,
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


# Widths of names and time line, and height of a topic [px].
_LEFT, _WIDTH, _ROW = 190, 560, 22
# Wall-clock period of playback [s].
_PLAYING_STEP = 0.05


class BagView(RqtView):
    """A row per topic with a mark for each message, a cursor, and the last message before it."""

    name, title = "bag", "Bag"

    def build(self) -> None:
        """Read the bag, or raise a CourseError if it does not exist."""
        # Imported here because anywidget is slow to import.
        from course_lib.controls import Slider

        if len(self.arguments) != 1:
            raise CourseError("Add the folder of a bag from ros2 bag record: %rqt bag FOLDER")
        self._recording = read_bag(Path(self.arguments[0]))
        self._samples = self._recording.samples
        self._times = np.array([s.stamp_ns for s in self._samples], np.int64) - self._recording.start_ns
        self._topics = {topic.name: topic for topic in self._recording.topics()}
        self._node: int | None = None
        self._publishers: dict[str, int] = {}
        # Position of the cursor [s].
        self._at = 0.0
        self._task: asyncio.Task[None] | None = None
        length = (self._recording.end_ns - self._recording.start_ns) * 1e-9
        limits = {"max": max(length, 1e-3), "step": max(length / 1000, 1e-3)}
        self.add(Slider(**limits, description="Time [s]", layout={"width": "480px"}), self._move)
        self.add_check("Play", action=self._play)
        self.add_check("Publish", on=True)
        self.add_choice("Message of", list(self._topics), None)

    def stop(self) -> None:
        """Stop playing and remove the player from the graph."""
        super().stop()
        if self._task is not None:
            self._task.cancel()
        if self._node is not None:
            self.graph.remove_node(self._node)

    def picture(self) -> str:
        """Draw the time line above the last message before the cursor."""
        length = self.controls["Time [s]"].max
        x, height = _LEFT + self._at / length * _WIDTH, _ROW * len(self._topics) + 22
        shapes = ""
        # A topic's name, a mark at each pixel with messages, and the number of messages.
        for row, topic in enumerate(self._topics):
            stamps, y = self._times[[s.topic == topic for s in self._samples]] * 1e-9, _ROW * row + 15
            pixels = np.unique((stamps / length * _WIDTH).round()).astype(int)
            marks = "".join(f"M{_LEFT + pixel} {y - 10}v12" for pixel in pixels.tolist())
            shapes += tag("path", d=f"M{_LEFT} {y - 4}h{_WIDTH}", stroke="var(--rqt-line)")
            shapes += tag("path", d=marks, stroke="#0072b2") + text(topic[-26:], _LEFT - 8, y, "end")
            shapes += text(str(len(stamps)), _LEFT + _WIDTH + 8, y)
        shapes += text("0 s", _LEFT, height - 4) + text(f"{length:.1f} s", _LEFT + _WIDTH, height - 4, "end")
        shapes += tag("path", d=f"M{x:.1f} 0v{height - 16}", stroke="#c9281f", stroke_width=2)
        messages, topics = (
            format_count(len(self._samples), "message"),
            format_count(len(self._topics), "topic"),
        )
        description = f"{messages} of {topics}, the cursor at {self._at:.2f} s"
        earlier = self._samples[: self._index(self._at)]
        sample = next((s for s in reversed(earlier) if s.topic == self["Message of"]), None)
        last = "<p class='rqt-dim'>Choose a topic to see its last message before the cursor.</p>"
        if sample is not None:
            stamp = (sample.stamp_ns - self._recording.start_ns) * 1e-9
            fields = escape(to_yaml(sample.message(), PrintOptions()))
            last = f"<p><b>{escape(sample.topic)}</b> at {stamp:.3f} s</p><pre>{fields}</pre>"
        return drawing(shapes, _LEFT + _WIDTH + 90, height, description) + last

    def _index(self, seconds: float) -> int:
        """Return the number of messages up to a time [s]."""
        return bisect_right(self._times.tolist(), round(seconds * 1e9))

    def _move(self) -> None:
        """Move the cursor to the time of the slider."""
        if abs(self["Time [s]"] - self._at) > self.controls["Time [s]"].step:
            self._at = self["Time [s]"]
        self.refresh()

    def _play(self) -> None:
        if (
            self._loop is not None
            and self.controls["Play"].value
            and (self._task is None or self._task.done())
        ):
            self._task = self._loop.create_task(self._keep_playing())

    async def _keep_playing(self) -> None:
        """Move the cursor in real time. If it is at the end, start again."""
        slider, last_update = self.controls["Time [s]"], wall.monotonic()
        if self._at >= slider.max:
            self._at = 0.0
        while self["Play"] and self._at < slider.max:
            await asyncio.sleep(_PLAYING_STEP)
            now = wall.monotonic()
            self.play_to(min(self._at + now - last_update, slider.max))
            last_update, slider.value = now, self._at
        self.controls["Play"].value = False

    def play_to(self, seconds: float) -> None:
        """Advance the cursor to a time [s], and publish the messages up to it if Publish is checked."""
        first_index = self._index(self._at) if self._at > 0 else 0
        if self["Publish"]:
            indices = range(first_index, self._index(seconds))
            if self._node is None:
                self._node = self.graph.add_node(PLAYER, "/")
                for topic in self._topics.values():
                    self._publishers[topic.name] = self.graph.add_publisher(
                        self._node, topic.name, topic.type_name, topic.offered[0]
                    )
            for index in indices:
                self.graph.publish(self._publishers[self._samples[index].topic], self._samples[index].cdr)
        self._at = seconds
