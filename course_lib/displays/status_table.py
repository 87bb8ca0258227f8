"""Statuses as a table: for cells, pages and terminals."""

from collections.abc import Iterable, Mapping
from html import escape

from course_lib.displays.statuses import Level, StatusRow

# Icon and word tell the level without colour; the colours are RViz's, hints are ours.
_LEVELS: Mapping[Level, tuple[str, str, str]] = {
    "ok": ("✔", "Ok", "inherit"),
    "warn": ("⚠", "Warn", "rgb(192, 128, 0)"),
    "error": ("✖", "Error", "rgb(192, 32, 32)"),
    "hint": ("➤", "hint", "rgb(32, 96, 160)"),
}


class StatusTable(list[StatusRow]):
    """What RViz's Displays panel says, row by row: (display, name, level, text)."""

    def __str__(self) -> str:
        rows = [(row.display, row.name, " ".join(_LEVELS[row.level][:2]), row.text) for row in self]
        widths = [max((len(row[column]) for row in rows), default=0) for column in range(3)]
        padded = (
            "  ".join([*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[3]])
            for row in rows
        )
        return "\n".join(padded)

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return table(self)


def table(rows: Iterable[StatusRow]) -> str:
    """Return statuses as an HTML table; a hint says that RViz2 is silent there."""
    body = []
    for row in rows:
        icon, word, color = _LEVELS[row.level]
        title = ' title="from this viewer; RViz2 says nothing here"' if row.level == "hint" else ""
        body.append(
            f"<tr{title}><td>{escape(row.display)}</td><td>{escape(row.name)}</td>"
            f'<td style="color: {color}; white-space: nowrap">{icon} {word}</td>'
            f'<td style="text-align: left">{escape(row.text)}</td></tr>'
        )
    head = "<tr><th>Display</th><th>Status</th><th>Level</th><th style='text-align: left'>Text</th></tr>"
    style = "font-size: 90%; line-height: 1.2"
    return f'<table style="{style}"><thead>{head}</thead><tbody>{"".join(body)}</tbody></table>'
