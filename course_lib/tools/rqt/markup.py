"""HTML and SVG of the views, for light and dark pages."""

from collections.abc import Iterable, Sequence
from html import escape
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLE = f"<style>\n{Path(__file__).with_name('style.css').read_text(encoding='utf-8')}</style>"

_SIGNS = {  # a shape for each, so that its colour is not all that tells
    "info": ("#2b6cb0", "<circle cx='7' cy='7' r='6.5'/>", "M7 3V4.8M7 6.2V11"),
    "ok": ("#1a8a3a", "<circle cx='7' cy='7' r='6.5'/>", "M3.5 7.2 6 9.7 10.5 4.6"),
    "warn": ("#d98200", "<path d='M7 .5 13.8 13H.2z'/>", "M7 4.6V8.6M7 10.3V11.4"),
    "error": ("#c9281f", "<path d='M4 .5H10L13.5 4V10L10 13.5H4L.5 10V4z'/>", "M4.5 4.5l5 5m0-5l-5 5"),
    "stale": ("#6b7280", "<rect x='.5' y='.5' width='13' height='13' rx='2'/>", "M4 7H10"),
}


def icon(sign: str) -> str:
    """Draw the sign of a level; its meaning must stand beside it in words."""
    colour, shape, line = _SIGNS[sign]
    stroke = tag("path", d=line, stroke="white", stroke_width=1.8, fill="none")
    box = {"class": "rqt-icon", "viewBox": "0 0 14 14", "aria_hidden": "true"}
    return tag("svg", shape + stroke, width=14, height=14, fill=colour, **box)


def colour_of(sign: str) -> str:
    """Return the colour of a sign."""
    return _SIGNS[sign][0]


def tag(name: str, inside: str = "", /, **attributes: object) -> str:
    """Return an element; floats get one decimal, ``stroke_width`` becomes ``stroke-width``."""
    words = ""
    for key, value in attributes.items():
        short = f"{value:.1f}" if isinstance(value, float) else str(value)
        words += f' {key.replace("_", "-")}="{escape(short)}"'
    return f"<{name}{words}>{inside}</{name}>"


def text(words: str, x: float, y: float, anchor: str = "start", /, **attributes: object) -> str:
    """Return a text element of an SVG."""
    return tag("text", escape(words), x=x, y=y, text_anchor=anchor, **attributes)


def drawing(shapes: str, width: float, height: float, said: str) -> str:
    """Return an SVG with alternative text."""
    box = {"viewBox": f"0 0 {width:.0f} {height:.0f}", "aria_label": said}
    return tag("svg", shapes, role="img", width=width, **box)


def chart(figure: "Figure", said: str) -> str:
    """Return a matplotlib figure as SVG with alternative text; black text gets the page's colour."""
    from matplotlib import rc_context

    file = StringIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "rqt"}):
        figure.savefig(file, format="svg", transparent=True, metadata={"Date": None})
    picture = file.getvalue()
    return tag("div", picture[picture.index("<svg") :], role="img", aria_label=said)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], said: str) -> str:
    """Return a table with cells of HTML."""
    head = "".join(tag("th", name, scope="col") for name in heads)
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return tag("table", f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody>", aria_label=said)
