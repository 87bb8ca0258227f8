"""Statuses of a display, as RViz shows them, and our hints where RViz says nothing."""

from typing import Literal, NamedTuple, TypeAlias

Level: TypeAlias = Literal["ok", "warn", "error", "hint"]


class StatusRow(NamedTuple):
    """One line of the status table; level ``hint`` is ours, the others are RViz's."""

    display: str
    name: str
    level: Level
    text: str


class Statuses:
    """What a display says of itself, by name; of one name the last word counts."""

    def __init__(self) -> None:
        self._said: dict[str, tuple[Level, str]] = {}
        self._hints: dict[str, tuple[str, ...]] = {}

    def set(self, level: Level, name: str, text: str) -> None:
        """Say something in RViz's words."""
        self._said[name] = (level, text)

    def hint(self, name: str, *texts: str) -> None:
        """Say what RViz does not, in place of earlier hints of that name; no text takes them back."""
        if texts:
            self._hints[name] = texts
        else:
            self._hints.pop(name, None)

    def delete(self, name: str) -> None:
        """Forget all that was said under a name."""
        self._said.pop(name, None)
        self._hints.pop(name, None)

    def clear(self) -> None:
        """Forget everything."""
        self._said.clear()
        self._hints.clear()

    def rows(self, display: str) -> list[StatusRow]:
        """List everything, hints last."""
        said = [StatusRow(display, name, level, text) for name, (level, text) in self._said.items()]
        hints = [
            StatusRow(display, name, "hint", text) for name, texts in self._hints.items() for text in texts
        ]
        return said + hints
