"""Tables that readers look things up in: the properties of displays and views, and the `ros2` commands."""

import os
from collections.abc import Iterable, Iterator, Sequence
from unittest.mock import patch

from course_lib.displays.display import DrawnDisplay
from course_lib.displays.properties import LimitedConversion, Property, PropertyHolder
from course_lib.displays.registry import REGISTRY, short_name
from course_lib.displays.views import VIEWS
from course_lib.recording import Recording
from course_lib.tools.ros2 import VERBS, ros2
from course_lib.tools.sources import RecordingSource
from course_lib.tools.verb import Verb

WIDTH = "88"  # letters of a line of help
TAKES = {
    "booleans": "names with True or False",
    "color": "a colour, `255; 80; 60` or `orange`",
    "flag": "True or False",
    "frame": "a frame",
    "read_only": "shown only",
    "vector": "x, y, z",
}


def common_rows() -> str:
    """Return the rows that each display with a topic has."""
    return _table(DrawnDisplay.properties, DrawnDisplay)


def display_rows() -> str:
    """Return a section with the properties of each display."""
    common = [(one.label, one.default) for one in DrawnDisplay.properties]
    names = sorted(REGISTRY, key=lambda name: name.lower())
    return "\n".join(_section(short_name(name), REGISTRY[name], common) for name in names)


def view_rows() -> str:
    """Return a section with the properties of each view."""
    return "\n".join(_section(name, view, []) for name, view in sorted(VIEWS.items()))


def commands() -> str:
    """Return the help of each `ros2` command, as the kit prints it."""
    ordered = sorted(VERBS, key=lambda verb: verb.words)
    return "\n".join(f"## ros2 {' '.join(verb.words)}\n\n```text\n{_help(verb)}```\n" for verb in ordered)


def _section(name: str, kind: type[PropertyHolder], common: Sequence[tuple[str, object]]) -> str:
    own = [one for one in kind.properties if (one.label, one.default) not in common]
    about = " ".join((kind.__doc__ or "").partition("\n\n")[0].split())
    topic = getattr(kind, "type_name", "")
    shows = f" It shows `{topic}`." if topic else ""
    return f"### {name}\n\n{about}{shows}\n\n{_table(own, kind)}"


def _table(rows: Iterable[Property], kind: type[PropertyHolder]) -> str:
    lines = [
        f"| `{row.label}` | {_shown(row.default)} | {_takes(row)} | {kind.describe(row)} |" for row in rows
    ]
    return "\n".join(
        ["| Property | At first | Takes | RViz2's description |", "|---|---|---|---|", *lines, ""]
    )


def _shown(value: object) -> str:
    """Return a default as RViz's panel writes it."""
    parts = value if isinstance(value, tuple) else (value,)
    text = "; ".join(f"{part:.6g}" if isinstance(part, float) else str(part) for part in parts)
    return f"`{text}`" if text.strip("{}") else "-"


def _takes(row: Property) -> str:
    if not isinstance(row.convert, LimitedConversion):
        return TAKES.get(getattr(row.convert, "__name__", ""), "text")
    if row.convert.editor == "enum":
        return ", ".join(option for option in row.convert.options if option)
    kind = "a whole number" if row.convert.editor == "integer" else "a number"
    return " ".join([kind, *_bounds(row.convert)])


def _bounds(limits: LimitedConversion) -> Iterator[str]:
    if abs(limits.low) < 2**31 - 1:
        yield f"from {limits.low:g}"
    if abs(limits.high) < 2**31 - 1:
        yield f"to {limits.high:g}"


def _help(verb: Verb) -> str:
    words: Sequence[str] = [*verb.words, "--help"]
    written: list[str] = []
    with patch.dict(os.environ, COLUMNS=WIDTH):
        ros2(words, RecordingSource(Recording(())), written.append)
    return "".join(written)
