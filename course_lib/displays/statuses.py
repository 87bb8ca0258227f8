"""Statuses of a display, hints where RViz has no status, and exceptions that become statuses.

RViz runs in a process of its own, so its errors never reach the node that publishes. Here a
display runs inside `publish()`, or in the call that requests the scene. Every call from outside
into a display therefore passes through `exceptions_as_status`, which turns exceptions into error
statuses.
The text of a `CourseError` explains what is wrong with a message or a file. An exception in a
student's display names the student's line. Any other exception is an error of the kit: it is also
reported once per line of code, as a `DisplayFaultWarning`.
"""

import warnings
from collections.abc import Mapping
from html import escape
from pathlib import Path
from traceback import walk_tb
from types import TracebackType
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.student_code import KIT
from course_lib.ros.tracebacks import line_of_traceback

Level: TypeAlias = Literal["ok", "warn", "error", "hint"]

# Icon and word show the level without color. The colors are the same as in RViz, which has no
# hints.
LEVELS: Mapping[Level, tuple[str, str, str]] = {
    "ok": ("✔", "Ok", "currentcolor"),
    "warn": ("⚠", "Warn", "rgb(192, 128, 0)"),
    "error": ("✖", "Error", "rgb(192, 32, 32)"),
    "hint": ("➤", "hint", "rgb(32, 96, 160)"),
}
# Explanations of RViz statuses that are hard to understand.
NOTES: Mapping[str, str] = {
    "Array Topic": "RViz's Marker display also subscribes to arrays, on the topic name with _array appended."
}
# Mixed with the page's text color: RViz's colors are too pale on some backgrounds.
_READABLE = "color-mix(in srgb, {} 50%, currentcolor)"
_HEAD = "<tr><th>Display</th><th>Status</th><th>Level</th><th style='text-align: left'>Text</th></tr>"


class StatusRow(NamedTuple):
    """One row of the status table. RViz has all levels except ``hint``."""

    display: str
    name: str
    level: Level
    text: str


class Statuses:
    """A display's statuses and hints by name; a new one replaces an earlier one."""

    def __init__(self) -> None:
        self._texts: dict[str, tuple[Level, str]] = {}
        self._hints: dict[str, tuple[str, ...]] = {}
        # Errors about failed operations by name, shown in addition to RViz's statuses.
        self.failures: dict[str, str] = {}

    def set(self, level: Level, name: str, text: str) -> None:
        """Set the status with this name. The text is RViz's message."""
        self._texts[name] = (level, text)

    def hint(self, name: str, *texts: str) -> None:
        """Set the hints with this name, replacing earlier ones. Without `texts`, remove them."""
        self._hints[name] = texts

    def delete(self, name: str) -> None:
        """Remove the status and the hints with this name."""
        self._texts.pop(name, None)
        self._hints.pop(name, None)

    def clear(self) -> None:
        """Remove all statuses and hints."""
        self._texts.clear()
        self._hints.clear()
        self.failures.clear()

    def rows(self, display: str) -> list[StatusRow]:
        """Return the statuses and hints of a display as rows, hints last."""
        rows = [(name, *status) for name, status in self._texts.items()]
        rows += [(name, "error", text) for name, text in self.failures.items()]
        rows += [(name, "hint", text) for name, texts in self._hints.items() for text in texts]
        return [
            StatusRow(display, shorten_middle(name), level, shorten_middle(text))
            for name, level, text in rows
        ]


def shorten_middle(text: str) -> str:
    """Return a string, shortened in the middle if it would make pages and tables slow."""
    half = _LONGEST_TEXT // 2
    return text if len(text) <= _LONGEST_TEXT else f"{text[:half]} … {text[-half:]}"


class StatusTable(list[StatusRow]):
    """The statuses of RViz's Displays panel as a table, for cells, pages and terminals."""

    def __str__(self) -> str:
        rows = [(row.display, row.name, " ".join(LEVELS[row.level][:2]), row.text) for row in self]
        widths = [max((len(row[column]) for row in rows), default=0) for column in range(3)]
        return "\n".join("  ".join([*map(str.ljust, row, widths), row[3]]) for row in rows)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        lines = []
        for row in self:
            icon, word, color = LEVELS[row.level]
            note = NOTES.get(row.name, "")
            if row.level == "hint":
                note = "from this viewer; RViz2 shows no status here"
            title = f' title="{note}"' if note else ""
            lines.append(
                f"<tr{title}><td>{escape(row.display)}</td><td>{escape(row.name)}</td>"
                f'<td style="color: {_READABLE.format(color)}; white-space: nowrap">{icon} {word}</td>'
                f'<td style="text-align: left">{escape(row.text)}</td></tr>'
            )
        return f'<table style="font-size: 90%; line-height: 1.2">{_HEAD}{"".join(lines)}</table>'


# Characters of an exception's text in a status.
LONGEST = 300
# Characters of the name or the text of a status, which may contain the names in a message. RViz's
# longest own text lists all displays.
_LONGEST_TEXT = 3000
# Locations of errors that were reported.
_warned: set[tuple[str, int, type[BaseException]]] = set()


class DisplayFaultWarning(UserWarning):
    """Warning about an error in the kit's own code inside a display."""


class exceptions_as_status:  # noqa: N801  # a context manager, named like those of contextlib
    """Turn an exception in a `with` block into an error status, which the next such block removes.

    Interrupts and SystemExit pass, because they are not subclasses of Exception. So does a
    `DisplayFaultWarning` that a filter made an exception: an enclosing block would hide it. numpy's
    warnings about overflow and invalid numbers are disabled, because drawables check their arrays.

    Args:
        statuses: The statuses of the display, or the Global Status.
        name: The name of the status.
    """

    def __init__(self, statuses: Statuses, name: str) -> None:
        self._statuses, self._name = statuses, name
        self._numpy = np.errstate(all="ignore")

    def __enter__(self) -> None:
        self._numpy.__enter__()
        # The operation is attempted again.
        if self._statuses.failures:
            self._statuses.failures.pop(self._name, None)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> bool:
        self._numpy.__exit__(kind, error, trace)
        if not isinstance(error, Exception) or isinstance(error, DisplayFaultWarning):
            return False
        self._statuses.failures[self._name] = describe(error)
        return True


def describe(error: Exception) -> str:
    """Return the status text for an exception, and issue a warning if it is an error of the kit."""
    text = str(error)
    text = text if len(text) <= LONGEST else f"{text[:LONGEST]} …"
    if isinstance(error, CourseError):
        return text
    error_text = f"{type(error).__name__}: {text}" if text else type(error).__name__
    own_line = line_of_traceback(error.__traceback__)
    if own_line:
        return f"{error_text} ({own_line})"
    # One warning for each line of the kit and type of exception, with the innermost line.
    lines = [(frame.f_code.co_filename, line) for frame, line in walk_tb(error.__traceback__)]
    file, line = next(((f, n) for f, n in reversed(lines) if f.startswith(KIT)), ("", 0))
    place = (file, line, type(error))
    if place not in _warned:
        _warned.add(place)
        name = Path(file).relative_to(KIT).as_posix() if file else ""
        where = f"course_lib/{name}, line {line}" if file else "an unknown place"
        warnings.warn(
            f"A display failed with {error_text}, in {where}. This is an error of the kit: please "
            "report it with this line. Your program continues, and the display's status describes "
            "the error.",
            DisplayFaultWarning,
            stacklevel=3,
        )
    return (
        f"{error_text}. This is an error of the viewer, not of your program; everything else is still shown."
    )
