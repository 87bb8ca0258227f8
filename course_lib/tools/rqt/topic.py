"""`%rqt topic`: what is published, how much, how often, and the values."""

from collections import deque
from html import escape
from typing import Any

from course_lib.ros.graph import Sample
from course_lib.tools.message_text import Style, to_csv, to_yaml
from course_lib.tools.rqt.markup import table, tag
from course_lib.tools.rqt.view import View
from course_lib.tools.topic.measure import in_bytes

_WINDOW_NS = 5 * 10**9  # of robot time
_COLUMNS = ("Topic", "Type", "Bandwidth", "Hz", "Value")


class TopicView(View):
    """A row per topic; its button opens the whole value below it."""

    name, title, listens = "topic", "Topic Monitor", True

    def build(self) -> None:
        """Begin without rows; words are topics to open."""
        from ipywidgets import VBox

        self._heard: dict[str, deque[tuple[int, int]]] = {}  # (time [ns], bytes) by topic
        self._last: dict[str, Sample] = {}
        self._rows: dict[str, Any] = {}
        self._table = VBox()
        self.add_text("Filter", hint="part of a name")

    def body(self) -> list[Any]:
        """Show a head line above the rows."""
        return [self.screen, self._table]

    def hear(self, sample: Sample) -> None:
        """Count a message."""
        window = self._heard.setdefault(sample.topic, deque())
        window.append((sample.stamp_ns, len(sample.cdr)))
        while window[0][0] < sample.stamp_ns - _WINDOW_NS:
            window.popleft()
        self._last[sample.topic] = sample

    def refresh(self) -> None:
        """Bring the rows up to date."""
        self.screen.value = f"<b style='display:block;margin-left:214px'>{_cells(_COLUMNS[1:])}</b>"
        for topic in (topics := self._topics()):
            if topic not in self._rows:
                self._rows[topic] = self._row(topic)
            line, value = self._rows[topic].children
            button, about = line.children
            about.value = _cells(self._about(topic, topics[topic]))
            button.icon = "caret-down" if button.value else "caret-right"
            value.value = f"<pre>{escape(self._value(topic))}</pre>" if button.value else ""
        self._table.children = tuple(self._rows[topic] for topic in topics)

    def picture(self) -> str:
        """Write all as a table."""
        rows = ([topic, *map(escape, self._about(topic, types))] for topic, types in self._topics().items())
        return table(_COLUMNS, rows, "Topics")

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

    def _about(self, topic: str, types: list[str]) -> list[str]:
        """Give a topic's cells behind its name."""
        since = self.graph.now_ns - _WINDOW_NS
        window = [(at, size) for at, size in self._heard.get(topic, ()) if at >= since]
        seconds = (window[-1][0] - window[0][0]) * 1e-9 if len(window) > 1 else 0.0
        rates = ["", ""]
        if seconds:
            (bandwidth,) = in_bytes(sum(size for _, size in window[1:]) / seconds)
            rates = [f"{bandwidth}/s", f"{(len(window) - 1) / seconds:.2f}"]
        last = self._last.get(topic)
        value = to_csv(last.message(), Style(truncate=8))[:200] if last else "not heard yet"
        return [", ".join(types), *rates, value]

    def _value(self, topic: str) -> str:
        last = self._last.get(topic)
        return to_yaml(last.message(), Style()) if last else "nothing came yet"


def _cells(texts: tuple[str, ...] | list[str]) -> str:
    cells = "".join(tag("span", escape(words), title=words) for words in texts)
    return tag("div", cells, **{"class": "rqt-cells"})
