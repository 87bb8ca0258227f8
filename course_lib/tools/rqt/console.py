"""`%rqt console`: what nodes log."""

from collections import deque
from html import escape
from typing import Any

from course_lib.ros.graph import Sample
from course_lib.tools.rqt.markup import icon, table
from course_lib.tools.rqt.view import View

_TYPE = "rcl_interfaces/msg/Log"
_LIMIT = 20_000  # messages, as in rqt_console
_SHOWN = 200
_HEADS = ("#", "Message", "Severity", "Node", "Stamp", "Location")
_SEVERITIES = {
    10: ("Debug", "stale"),
    20: ("Info", "info"),
    30: ("Warn", "warn"),
    40: ("Error", "error"),
    50: ("Fatal", "error"),
}


class ConsoleView(View):
    """A table of log messages, the newest first; filters leave messages out or mark them."""

    name, title, listens = "console", "Console", True

    def build(self) -> None:
        """Make rqt_console's filters: by severity, node and text, and what to highlight."""
        self._logs: deque[tuple[int, Any]] = deque(maxlen=_LIMIT)  # numbered
        self._count = 0
        for severity, _ in _SEVERITIES.values():
            self.add_check(severity, on=True)
        for name in ("Node", "Text", "Highlight"):
            self.add_text(name, hint="part of it")
        self.add_check("Pause")

    def buttons(self) -> list[Any]:
        """Add a button that forgets what came."""
        return [self.button("Clear", "trash", self._logs.clear)]

    def hear(self, sample: Sample) -> None:
        """Take a log message, unless that is paused."""
        if (sample.topic, sample.type_name) == ("/rosout", _TYPE) and not self["Pause"]:
            self._count += 1
            self._logs.append((self._count, sample.message()))

    def picture(self) -> str:
        """Write the table."""
        shown = [(number, log) for number, log in reversed(self._logs) if self._passes(log)]
        more = f", the newest {_SHOWN} of them here" if len(shown) > _SHOWN else ""
        count = f"<p class='rqt-dim'>Displaying {len(shown)} of {len(self._logs)} messages{more}</p>"
        return count + table(_HEADS, [self._row(*one) for one in shown[:_SHOWN]], "Log messages")

    def _passes(self, log: Any) -> bool:
        severity, _ = _SEVERITIES.get(log.level, _SEVERITIES[20])
        return self[severity] and self._has("Node", log.name) and self._has("Text", log.msg)

    def _has(self, control: str, words: str) -> bool:
        return self[control].lower() in words.lower()

    def _row(self, number: int, log: Any) -> list[str]:
        severity, sign = _SEVERITIES.get(log.level, _SEVERITIES[20])
        message = escape(log.msg)
        if self["Highlight"] and self._has("Highlight", log.msg):
            message = f"<mark>► {message}</mark>"
        stamp = f"{log.stamp.sec}.{log.stamp.nanosec:09d}"
        place = escape(f"{log.file}:{log.function}:{log.line}")
        return [str(number), message, icon(sign) + severity, escape(log.name), stamp, place]
