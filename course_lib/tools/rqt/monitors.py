"""`%rqt console`, `topic` and `robot_monitor`: tables of received messages."""

from collections import deque
from collections.abc import Collection
from html import escape
from typing import Any

from course_lib.errors import format_count
from course_lib.ros.graph.graph import Sample
from course_lib.ros.messages.conversions import PrintOptions, to_csv, to_yaml
from course_lib.tools.rqt.view import RqtView, colour_of, drawing, icon, table, tag
from course_lib.tools.topic import in_bytes

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

    def required_topics(self) -> Collection[str]:
        """Return the topic of log messages."""
        return ("/rosout",)

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
            and self._has("Node", log.name)
            and self._has("Text", log.msg)
        ]
        more = f", the newest {_LOGS_SHOWN} of them here" if len(matching) > _LOGS_SHOWN else ""
        count = f"<p class='rqt-dim'>Displaying {len(matching)} of {len(self._logs)} messages{more}</p>"
        return count + table(
            _LOG_HEADS, [self._row(*entry) for entry in matching[:_LOGS_SHOWN]], "Log messages"
        )

    def _has(self, control: str, text: str) -> bool:
        return self[control].lower() in text.lower()

    def _row(self, number: int, log: Any) -> list[str]:
        severity, sign = _SEVERITIES.get(log.level, _SEVERITIES[20])
        message = escape(log.msg)
        if self["Highlight"] and self._has("Highlight", log.msg):
            message = f"<mark>► {message}</mark>"
        stamp = f"{log.stamp.sec}.{log.stamp.nanosec:09d}"
        location = escape(f"{log.file}:{log.function}:{log.line}")
        return [str(number), message, icon(sign) + severity, escape(log.name), stamp, location]


# In robot time.
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
        """Return the headings above the rows."""
        return [self.screen, self.table]

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
        self.screen.value = f"<b style='display:block;margin-left:214px'>{_cells(_TOPIC_HEADS[1:])}</b>"
        for topic in (topics := self._topics()):
            if topic not in self.rows:
                self.rows[topic] = self._row(topic)
            line, value = self.rows[topic].children
            button, about = line.children
            about.value = _cells(self.cells(topic, topics[topic]))
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
        topics = self.source.topics(hidden=False)
        return {topic: types for topic, types in topics.items() if self["Filter"] in topic}

    def _row(self, topic: str) -> Any:
        from ipywidgets import HTML, HBox, ToggleButton, VBox

        button = ToggleButton(topic in self.words, description=topic, tooltip=f"Value of {topic}")
        button.layout.width = "210px"
        button.add_class("rqt-topic")
        button.observe(lambda _: self.soon(self.refresh), "value")
        return VBox([HBox([button, HTML(layout={"flex": "1"})]), HTML(layout={"margin": "0 0 0 24px"})])

    def cells(self, topic: str, types: list[str]) -> list[str]:
        """Return the cells to the right of a topic's name."""
        since = self.graph.now_ns - _WINDOW_NS
        window = [(at, size) for at, size in self._received.get(topic, ()) if at >= since]
        seconds = (window[-1][0] - window[0][0]) * 1e-9 if len(window) > 1 else 0.0
        rates = ["", ""]
        if seconds:
            (bandwidth,) = in_bytes(sum(size for _, size in window[1:]) / seconds)
            rates = [f"{bandwidth}/s", f"{(len(window) - 1) / seconds:.2f}"]
        last = self._last_samples.get(topic)
        value = to_csv(last.message(), PrintOptions(truncate=8))[:200] if last else "no message yet"
        return [", ".join(types), *rates, value]


def _cells(texts: tuple[str, ...] | list[str]) -> str:
    cells = "".join(tag("span", escape(cell_text), title=cell_text) for cell_text in texts)
    return tag("div", cells, **{"class": "rqt-cells"})


_DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
TOPICS = ("/diagnostics_agg", "/diagnostics")
# Time without a message, as in the diagnostic aggregator.
STALE_NS = 5 * 10**9
# Number of messages, as in rqt_robot_monitor's timeline.
_HISTORY = 30
_LEVELS = ("ok", "warn", "error", "stale")


class RobotMonitorView(RqtView):
    """The tree of diagnostics with the worst level of each branch, and the details of one status."""

    name, title, listens = "robot_monitor", "Robot Monitor", True

    def build(self) -> None:
        """Create the controls. /diagnostics is shown until the aggregator publishes."""
        self._topic, self._heard_ns = "", 0
        # Time [ns] and status by path.
        self._statuses: dict[str, tuple[int, Any]] = {}
        self._history: deque[tuple[int, str]] = deque(maxlen=_HISTORY)
        self.add_choice("Details of", [], None)
        self.add_check("Pause")

    def required_topics(self) -> Collection[str]:
        """Return the topics of diagnostics."""
        return TOPICS

    def on_sample(self, sample: Sample) -> None:
        """Collect an array of statuses."""
        is_other = sample.type_name != _DIAGNOSTICS or sample.topic not in TOPICS
        if is_other or self["Pause"] or self._topic == TOPICS[0] != sample.topic:
            return
        if sample.topic != self._topic:
            # The aggregator publishes the statuses under different names.
            self._statuses.clear()
        self._topic, self._heard_ns = sample.topic, sample.stamp_ns
        message: Any = sample.message()
        for status in message.status:
            self._statuses["/" + status.name.strip("/")] = sample.stamp_ns, status
        if self._statuses:
            self._history.append((sample.stamp_ns, self.worst("")))

    def refresh(self) -> None:
        """Update the choice of statuses and the picture."""
        self.offer("Details of", sorted(self._statuses))
        super().refresh()

    def picture(self) -> str:
        """Return summary, history, tree and the details of the chosen status."""
        if not self._topic:
            return f"<p>{icon('stale')}No diagnostics received yet on {' or '.join(TOPICS)}.</p>"
        age = (self.graph.now_ns - self._heard_ns) * 1e-9
        is_stale = self.graph.now_ns - self._heard_ns > STALE_NS
        stale_text = f"{icon('stale')}STALE: the l" if is_stale else "L"
        levels = [self._level(path) for path in self._statuses]
        counts = " · ".join(f"{icon(level)}{levels.count(level)} {level.upper()}" for level in _LEVELS[::-1])
        head = f"<p>{stale_text}ast message on {self._topic} came {age:.1f} s ago. {counts}</p>"
        tree = table(("Device", "Level", "Message"), map(self._row, self.paths()), "Devices")
        return head + self._timeline() + tree + self._details()

    def _level(self, path: str) -> str:
        heard_ns, status = self._statuses[path]
        is_stale = self.graph.now_ns - heard_ns > STALE_NS
        return "stale" if is_stale else _LEVELS[min(status.level[0], 3)]

    def worst(self, path: str) -> str:
        """Return the worst level of a branch."""
        branch = (p for p in self._statuses if f"{p}/".startswith(f"{path}/"))
        return max(map(self._level, branch), key=_LEVELS.index)

    def paths(self) -> list[str]:
        """List the paths of all statuses and of their branches, sorted as a tree."""
        split_paths = [path.split("/") for path in self._statuses]
        return sorted({"/".join(names[:deep]) for names in split_paths for deep in range(2, len(names) + 1)})

    def _row(self, path: str) -> list[str]:
        level = self.worst(path)
        message = self._statuses[path][1].message if path in self._statuses else ""
        name = icon(level) + escape(path.rpartition("/")[2])
        indented = tag("span", name, style=f"padding-left:{18 * (path.count('/') - 1)}px")
        return [indented, level.upper(), escape(message)]

    def _timeline(self) -> str:
        """Draw a bar per message, whose height is the level."""
        bars = ""
        for number, (_, level) in enumerate(self._history):
            high = 6 * (1 + _LEVELS.index(level))
            bars += tag("rect", x=9 * number, y=26 - high, width=7, height=high, fill=colour_of(level))
        levels = ", ".join(level.upper() for _, level in self._history)
        return drawing(
            bars, 9 * _HISTORY, 28, f"The last {format_count(len(self._history), 'message')}: {levels}"
        )

    def _details(self) -> str:
        if (path := self["Details of"]) not in self._statuses:
            return ""
        status, level = self._statuses[path][1], self._level(path)
        pairs = [("Message", status.message), ("Hardware ID", status.hardware_id)]
        pairs += [(pair.key, pair.value) for pair in status.values]
        rows = [list(map(escape, pair)) for pair in pairs]
        return f"<p>{icon(level)}<b>{escape(path)}</b>: {level.upper()}</p>" + table(
            ("Key", "Value"), rows, path
        )
