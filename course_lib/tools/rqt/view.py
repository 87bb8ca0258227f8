"""The base class of rqt's views: named controls, and a picture that follows the run."""

import asyncio
from collections.abc import Callable, Collection, Iterable, Sequence
from html import escape
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph, Sample
from course_lib.ros.time import pace, wall
from course_lib.ros.time.time_lock import time_lock
from course_lib.tools.sources import GraphSource

if TYPE_CHECKING:
    from ipywidgets import VBox
    from matplotlib.figure import Figure

STYLE = f"<style>\n{Path(__file__).with_name('style.css').read_text(encoding='utf-8')}</style>"

# A shape for each level, so that the levels do not differ by color only.
_SIGNS = {
    "info": ("#2b6cb0", "<circle cx='7' cy='7' r='6.5'/>", "M7 3V4.8M7 6.2V11"),
    "ok": ("#1a8a3a", "<circle cx='7' cy='7' r='6.5'/>", "M3.5 7.2 6 9.7 10.5 4.6"),
    "warn": ("#d98200", "<path d='M7 .5 13.8 13H.2z'/>", "M7 4.6V8.6M7 10.3V11.4"),
    "error": ("#c9281f", "<path d='M4 .5H10L13.5 4V10L10 13.5H4L.5 10V4z'/>", "M4.5 4.5l5 5m0-5l-5 5"),
    "stale": ("#6b7280", "<rect x='.5' y='.5' width='13' height='13' rx='2'/>", "M4 7H10"),
}


def icon(sign: str) -> str:
    """Draw the icon of a level. The level must also be given as text next to it."""
    color, shape, line = _SIGNS[sign]
    stroke = tag("path", d=line, stroke="white", stroke_width=1.8, fill="none")
    box = {"class": "rqt-icon", "viewBox": "0 0 14 14", "aria_hidden": "true"}
    return tag("svg", shape + stroke, width=14, height=14, fill=color, **box)


def color_of(sign: str) -> str:
    """Return the color of a level."""
    return _SIGNS[sign][0]


def tag(name: str, inside: str = "", /, **attributes: object) -> str:
    """Return an HTML or SVG element.

    Floats are rounded to one decimal, and ``stroke_width`` becomes ``stroke-width``.
    """
    attributes_text = ""
    for key, value in attributes.items():
        short = f"{value:.1f}" if isinstance(value, float) else str(value)
        attributes_text += f' {key.replace("_", "-")}="{escape(short)}"'
    return f"<{name}{attributes_text}>{inside}</{name}>"


def text(content: str, x: float, y: float, anchor: str = "start", /, **attributes: object) -> str:
    """Return an SVG text element."""
    return tag("text", escape(content), x=x, y=y, text_anchor=anchor, **attributes)


def drawing(shapes: str, width: float, height: float, label: str) -> str:
    """Return an SVG with alternative text."""
    box = {"viewBox": f"0 0 {width:.0f} {height:.0f}", "aria_label": label}
    return tag("svg", shapes, role="img", width=width, **box)


def chart(figure: "Figure", label: str) -> str:
    """Return a matplotlib figure as SVG with alternative text.

    Black text gets the page's color.
    """
    from matplotlib import rc_context

    file = StringIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "rqt"}):
        figure.savefig(file, format="svg", transparent=True, metadata={"Date": None})
    picture = file.getvalue()
    return tag("div", picture[picture.index("<svg") :], role="img", aria_label=label)


def table(heads: Sequence[str], rows: Iterable[Sequence[str]], label: str) -> str:
    """Return a table whose cells are HTML, with a label for screen readers."""
    head = "".join(tag("th", name, scope="col") for name in heads)
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return tag("table", f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody>", aria_label=label)


# Wall-clock interval between pictures [s].
PERIOD = 0.25
# The interval is at least this multiple of the time that a picture takes, so that many views on a
# slow machine leave time for nodes and cells.
LEAST_FACTOR = 10


class RqtView:
    """A view with named controls and a picture as HTML, which subclasses draw.

    Args:
        graph: The graph whose nodes are shown.
        words: The arguments after the view's name.
    """

    # The word after %rqt.
    name: ClassVar[str]
    # The title in rqt.
    title: ClassVar[str]
    # Whether it shows only messages received after it was opened.
    listens: ClassVar[bool] = False
    # The topics that `on_sample` processes.
    topics: ClassVar[Collection[str]] = ()

    def __init__(self, graph: Graph, words: Sequence[str]) -> None:
        from ipywidgets import HTML

        self.graph, self.source = graph, GraphSource(graph)
        self.arguments = list(words)
        self.controls: dict[str, Any] = {}
        # This element scrolls, so that its scroll position survives new pictures.
        self.screen = HTML(tabbable=True)
        self.screen.add_class("rqt-screen")
        self.notice = HTML()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._refresh_timer: asyncio.TimerHandle | None = None
        # Wall-clock time from which the next picture is drawn [s].
        self._due = 0.0
        # Whether a control changes because its options were replaced, not because the user chose
        # one.
        self._is_updating_options = False
        self._stops: list[Callable[[], None]] = []
        self._frame: Any = None
        self.build()

    def build(self) -> None:
        """Create the controls, or raise a CourseError for invalid arguments."""

    def on_sample(self, sample: Sample) -> None:
        """Process a published message."""

    def required_topics(self) -> Collection[str]:
        """Return the topics that `on_sample` processes now. A linked robot sends only these."""
        return self.topics

    def picture(self) -> str:
        """Return the current state as HTML."""
        raise NotImplementedError

    def refresh(self) -> None:
        """Update the page."""
        self.screen.value = self.picture()

    def __getitem__(self, name: str) -> Any:
        """Return the value of a control."""
        return self.controls[name].value

    def add(self, control: Any, action: Callable[[], None] | None = None) -> Any:
        """Add a control under its description.

        A change of its value runs the action, by default a refresh.
        """
        # Only widgets of ipywidgets have a style.
        self.controls[control.description] = control
        if control.has_trait("style"):
            control.style.description_width = "initial"
        act = action or self.refresh
        control.observe(lambda _: None if self._is_updating_options else self.run_soon(act), "value")
        return control

    def add_check(
        self,
        name: str,
        *,
        on: bool = False,
        action: Callable[[], None] | None = None,
    ) -> None:
        """Add a check box."""
        from ipywidgets import Checkbox

        self.add(Checkbox(on, description=name, indent=False, layout={"width": "auto"}), action)

    def add_text(self, name: str, value: str = "", *, hint: str = "") -> None:
        """Add a text field."""
        from ipywidgets import Text

        self.add(Text(value, description=name, placeholder=hint, layout={"width": "190px"}))

    def add_choice(
        self,
        name: str,
        options: Sequence[str],
        value: str | None,
        action: Callable[[], None] | None = None,
    ) -> None:
        """Add a list of options. The value None selects none of them."""
        from ipywidgets import Dropdown

        self.add(
            Dropdown(options=options, value=value, description=name, layout={"max_width": "420px"}), action
        )

    def offer(self, name: str, options: Sequence[str]) -> None:
        """Replace the options of a list. The chosen option is kept if it still exists."""
        control, previous = self.controls[name], self[name]
        if control.options != tuple(options):
            new_value = previous if previous in options else None
            self._is_updating_options = True
            # Assigning the options selects the first one.
            control.options = tuple(options)
            self._is_updating_options = new_value == previous
            control.value = new_value
            self._is_updating_options = False

    def button(self, name: str, icon: str, action: Callable[[], None]) -> Any:
        """Return a button that runs an action and then a refresh."""
        from ipywidgets import Button

        def act() -> None:
            action()
            self.refresh()

        button = Button(description=name, icon=icon, tooltip=name, layout={"width": "auto"})
        button.on_click(lambda _: self.run_soon(act))
        return button

    def buttons(self) -> list[Any]:
        """Return the buttons next to the title."""
        return [self.button("Refresh", "refresh", lambda: None)]

    def body(self) -> list[Any]:
        """Return the widgets below the controls."""
        return [self.screen]

    def listen(self) -> None:
        """Process messages and redraw until `stop` is called."""
        self._stops = [
            self.graph.tap(self._on_sample, self.required_topics),
            self.graph.watch_time(lambda _: self._tick()),
        ]

    def stop(self) -> None:
        """Stop processing messages."""
        while self._stops:
            self._stops.pop()()

    def target(self) -> str | None:
        """Return the full name of the node or service in the first argument, or None."""
        return "/" + self.arguments[0].strip("/") if self.arguments else None

    def check_time(self) -> None:
        """Raise a CourseError while robot time is paused, because no node can respond."""
        if pace.mode() == "real" and pace.speed_of(self.graph).is_paused:
            raise CourseError(
                "Robot time is paused, so no node responds. Press ▶ in the viewer's Time panel to continue."
            )

    def close(self) -> None:
        """Stop processing messages and remove the view from the page."""
        self.stop()
        if self._frame is not None:
            self._frame.close()

    def widget(self) -> "VBox":
        """Return the widget for a cell, and start to process messages."""
        from ipywidgets import HTML, HBox, VBox

        # Imported here because anywidget is slow to import.
        from course_lib.controls import SAVED_AS_HTML

        self._loop = asyncio.get_running_loop()
        self.listen()
        title = HTML(f"{STYLE}<b class='rqt-title'>{self.title}</b>", layout={"flex": "1"})
        head = HBox([title, *self.buttons(), self.button("Close", "times", self.close)])
        controls = HBox(list(self.controls.values()))
        self._frame = VBox([head, controls, self.notice, *self.body()])
        self._frame.add_class("rqt")
        self._frame.add_class(SAVED_AS_HTML)
        self._act(self.refresh)
        return self._frame

    def show(self) -> None:
        """Display the view in the cell, with its first picture for pages without widgets.

        When JupyterLab saves the notebook, the kit's extension replaces it by the current picture.
        """
        from IPython.display import display

        data = self.widget()._repr_mimebundle_()
        text = f"A view of rqt was here: {self.title}. Run this cell to open it again."
        data |= {"text/html": self._page(self.screen.value), "text/plain": text}
        display(data, raw=True)

    def static_html(self) -> str:
        """Return the view as HTML for pages without widgets."""
        return self._page(self.picture())

    def _page(self, picture: str) -> str:
        head = f"<b class='rqt-title'>{self.title}</b>{self.notice.value}"
        # Focusable, because the element scrolls.
        return f"{STYLE}<div class='rqt'>{head}<div class='rqt-screen' tabindex='0'>{picture}</div></div>"

    def show_notice(self, text: str) -> None:
        """Show a line of text above the picture; "" removes it."""
        self.notice.value = f"<div role='status' class='rqt-notice'>{escape(text)}</div>" if text else ""

    def run_soon(self, action: Callable[[], None]) -> None:
        """Run an action in the kernel's main thread, because messages of a page may arrive in another one."""
        if self._loop is None:
            self._act(action)
        else:
            self._loop.call_soon_threadsafe(self._act, action)

    def _act(self, action: Callable[[], None]) -> None:
        try:
            action()
        except CourseError as error:
            self.show_notice(str(error))

    def _on_sample(self, sample: Sample) -> None:
        self.on_sample(sample)
        self._tick()

    def _tick(self) -> None:
        """Draw the first change that is due. The last change is drawn later if no other follows."""
        # Without a page, `static_html` draws once.
        if self._loop is None:
            return
        remaining = self._due - wall.monotonic()
        if remaining <= 0:
            self._draw()
        elif self._refresh_timer is None:
            self._refresh_timer = self._loop.call_later(remaining, self._draw)

    def _draw(self) -> None:
        if self._refresh_timer is not None:
            self._refresh_timer.cancel()
        start = wall.monotonic()
        self._refresh_timer, self._due = None, start + PERIOD
        if self._stops:
            # Events of a page are not part of the program, so they must not wait for its clock.
            with time_lock.as_ordinary_thread():
                self._act(self.refresh)
            self._due = start + max(PERIOD, LEAST_FACTOR * (wall.monotonic() - start))
