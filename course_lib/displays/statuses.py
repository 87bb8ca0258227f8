"""Statuses of a display, as RViz shows them, and hints where RViz has no status."""

from collections.abc import Mapping
from html import escape
from typing import Literal, NamedTuple, TypeAlias

Level: TypeAlias = Literal["ok", "warn", "error", "hint"]

# Icon and word tell the level without colour; the colours are RViz's, hints are ours.
LEVELS: Mapping[Level, tuple[str, str, str]] = {
    "ok": ("✔", "Ok", "currentcolor"),
    "warn": ("⚠", "Warn", "rgb(192, 128, 0)"),
    "error": ("✖", "Error", "rgb(192, 32, 32)"),
    "hint": ("➤", "hint", "rgb(32, 96, 160)"),
}
# Titles of RViz's own statuses that nobody understands.
NOTES: Mapping[str, str] = {
    "Array Topic": "RViz's Marker display also listens to arrays, on its topic's name with _array behind it."
}
# Half of the page's own text in a colour: RViz's alone are too pale on some of the grounds of a page.
_READABLE = "color-mix(in srgb, {} 50%, currentcolor)"
_HEAD = "<tr><th>Display</th><th>Status</th><th>Level</th><th style='text-align: left'>Text</th></tr>"


class StatusRow(NamedTuple):
    """One line of the status table; level ``hint`` is ours, the others are RViz's."""

    display: str
    name: str
    level: Level
    text: str


class Statuses:
    """A display's statuses and hints by name; the last one of a name counts."""

    def __init__(self) -> None:
        self._said: dict[str, tuple[Level, str]] = {}
        self._hints: dict[str, tuple[str, ...]] = {}

    def set(self, level: Level, name: str, text: str) -> None:
        """Set the status of a name, in RViz's words."""
        self._said[name] = (level, text)

    def hint(self, name: str, *texts: str) -> None:
        """Set the hints of a name, in place of earlier ones; without a text there is none."""
        self._hints[name] = texts

    def delete(self, name: str) -> None:
        """Remove the status and the hints of a name."""
        self._said.pop(name, None)
        self._hints.pop(name, None)

    def clear(self) -> None:
        """Forget everything."""
        self._said.clear()
        self._hints.clear()

    def rows(self, display: str) -> list[StatusRow]:
        """List everything, hints last."""
        said = [StatusRow(display, name, *status) for name, status in self._said.items()]
        hints = ((name, text) for name, texts in self._hints.items() for text in texts)
        return said + [StatusRow(display, name, "hint", text) for name, text in hints]


class StatusTable(list[StatusRow]):
    """The statuses of RViz's Displays panel as a table, for cells, pages and terminals."""

    def __str__(self) -> str:
        rows = [(row.display, row.name, " ".join(LEVELS[row.level][:2]), row.text) for row in self]
        widths = [max((len(row[column]) for row in rows), default=0) for column in range(3)]
        return "\n".join("  ".join([*map(str.ljust, row, widths), row[3]]) for row in rows)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return f'<table style="font-size: 90%; line-height: 1.2">{_HEAD}{"".join(map(_row, self))}</table>'


def _row(row: StatusRow) -> str:
    """Return one row in HTML, with a title where it needs one."""
    icon, word, color = LEVELS[row.level]
    note = "from this viewer; RViz2 says nothing here" if row.level == "hint" else NOTES.get(row.name, "")
    title = f' title="{note}"' if note else ""
    return (
        f"<tr{title}><td>{escape(row.display)}</td><td>{escape(row.name)}</td>"
        f'<td style="color: {_READABLE.format(color)}; white-space: nowrap">{icon} {word}</td>'
        f'<td style="text-align: left">{escape(row.text)}</td></tr>'
    )
