"""`%rqt robot_monitor`: the tree of diagnostics."""

from collections import deque
from html import escape
from typing import Any

from course_lib.errors import counted
from course_lib.ros.graph import Sample
from course_lib.tools.rqt.markup import colour_of, drawing, icon, table, tag
from course_lib.tools.rqt.view import View

_TYPE = "diagnostic_msgs/msg/DiagnosticArray"
TOPICS = ("/diagnostics_agg", "/diagnostics")
STALE_NS = 5 * 10**9  # without a message, as the aggregator's own limit
_HISTORY = 30  # messages, as rqt_robot_monitor's timeline
_LEVELS = ("ok", "warn", "error", "stale")


class RobotMonitorView(View):
    """All statuses as a tree, the worst of each branch at its root; one of them with all that it says."""

    name, title, listens = "robot_monitor", "Robot Monitor", True

    def build(self) -> None:
        """Listen to the aggregator, or, until it is heard, to the nodes themselves."""
        self._topic, self._heard_ns = "", 0
        self._statuses: dict[str, tuple[int, Any]] = {}  # (when [ns], status) by path
        self._history: deque[tuple[int, str]] = deque(maxlen=_HISTORY)
        self.add_choice("Details of", [], None)
        self.add_check("Pause")

    def hear(self, sample: Sample) -> None:
        """Take an array of statuses."""
        is_other = sample.type_name != _TYPE or sample.topic not in TOPICS
        if is_other or self["Pause"] or self._topic == TOPICS[0] != sample.topic:
            return
        if sample.topic != self._topic:
            self._statuses.clear()  # the aggregator names them otherwise
        self._topic, self._heard_ns = sample.topic, sample.stamp_ns
        message: Any = sample.message()
        for status in message.status:
            self._statuses["/" + status.name.strip("/")] = sample.stamp_ns, status
        if self._statuses:
            self._history.append((sample.stamp_ns, self._worst("")))

    def refresh(self) -> None:
        """Draw, with the statuses that there are to choose from."""
        self.offer("Details of", sorted(self._statuses))
        super().refresh()

    def picture(self) -> str:
        """Write the head line, the history, the tree and what is chosen of it."""
        if not self._topic:
            return f"<p>{icon('stale')}No diagnostics heard yet on {' or '.join(TOPICS)}.</p>"
        age = (self.graph.now_ns - self._heard_ns) * 1e-9
        late = f"{icon('stale')}STALE: the l" if self._is_stale(self._heard_ns) else "L"
        levels = [self._level(path) for path in self._statuses]
        counts = " · ".join(f"{icon(level)}{levels.count(level)} {level.upper()}" for level in _LEVELS[::-1])
        head = f"<p>{late}ast message on {self._topic} came {age:.1f} s ago. {counts}</p>"
        tree = table(("Device", "Level", "Message"), map(self._row, self._paths()), "Devices")
        return head + self._timeline() + tree + self._details()

    def _is_stale(self, heard_ns: int) -> bool:
        return self.graph.now_ns - heard_ns > STALE_NS

    def _level(self, path: str) -> str:
        heard_ns, status = self._statuses[path]
        return "stale" if self._is_stale(heard_ns) else _LEVELS[min(status.level[0], 3)]

    def _worst(self, path: str) -> str:
        """Give the worst level of a branch."""
        branch = (p for p in self._statuses if f"{p}/".startswith(f"{path}/"))
        return max(map(self._level, branch), key=_LEVELS.index)

    def _paths(self) -> list[str]:
        """List the statuses with the branches that they are on, as a tree goes."""
        parts = [path.split("/") for path in self._statuses]
        return sorted({"/".join(names[:deep]) for names in parts for deep in range(2, len(names) + 1)})

    def _row(self, path: str) -> list[str]:
        level = self._worst(path)
        message = self._statuses[path][1].message if path in self._statuses else ""
        name = icon(level) + escape(path.rpartition("/")[2])
        indented = tag("span", name, style=f"padding-left:{18 * (path.count('/') - 1)}px")
        return [indented, level.upper(), escape(message)]

    def _timeline(self) -> str:
        """Draw a bar per message heard: the worse, the higher."""
        bars = ""
        for number, (_, level) in enumerate(self._history):
            high = 6 * (1 + _LEVELS.index(level))
            bars += tag("rect", x=9 * number, y=26 - high, width=7, height=high, fill=colour_of(level))
        said = ", ".join(level.upper() for _, level in self._history)
        return drawing(bars, 9 * _HISTORY, 28, f"The last {counted(len(self._history), 'message')}: {said}")

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
