"""The base of rqt's views: named controls, and a picture that follows the run."""

import asyncio
from collections.abc import Callable, Collection, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING, Any, ClassVar

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros import pace, wall
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph, Sample
from course_lib.tools.rqt.markup import STYLE
from course_lib.tools.sources import GraphSource

if TYPE_CHECKING:
    from ipywidgets import VBox

PERIOD = 0.25  # [s] of the wall clock between two pictures


class RqtView:
    """A view with named controls and a picture as HTML, filled by subclasses.

    Args:
        graph: The nodes to look at.
        words: What stands behind the view's name.
    """

    name: ClassVar[str]  # behind %rqt
    title: ClassVar[str]  # as in rqt
    listens: ClassVar[bool] = False  # whether it shows what came since it was opened

    def __init__(self, graph: Graph, words: Sequence[str]) -> None:
        from ipywidgets import HTML

        self.graph, self.source = graph, GraphSource(graph)
        self.words = list(words)
        self.controls: dict[str, Any] = {}
        self.screen = HTML(tabbable=True)  # it is what scrolls, so that new pictures leave it where it is
        self.screen.add_class("rqt-screen")
        self.notice = HTML()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._late: asyncio.TimerHandle | None = None
        self._drawn = 0.0  # [s] of the wall clock
        self._offering = False  # a control changes for its new options, nobody has chosen anything
        self._stops: list[Callable[[], None]] = []
        self._frame: Any = None
        self.closed = False
        self.build()

    def build(self) -> None:
        """Create the controls; raises a CourseError for wrong words behind the view's name."""

    def hear(self, sample: Sample) -> None:
        """Process a published message."""

    def needed(self) -> Collection[str]:
        """Return the topics that `hear` waits for: a robot sends no others."""
        return ()

    def picture(self) -> str:
        """Return the present state as HTML."""
        raise NotImplementedError

    def refresh(self) -> None:
        """Update the page."""
        self.screen.value = self.picture()

    def __getitem__(self, name: str) -> Any:
        """Return the value of a control."""
        return self.controls[name].value

    def add(self, control: Any, action: Callable[[], None] | None = None) -> Any:
        """Add a control under its description; a change of its value runs the action, or a refresh."""
        self.controls[control.description] = control
        if control.has_trait("style"):  # of ipywidgets
            control.style.description_width = "initial"
        act = action or self.refresh
        control.observe(lambda _: None if self._offering else self.soon(act), "value")
        return control

    def add_check(self, name: str, *, on: bool = False, action: Callable[[], None] | None = None) -> None:
        """Add a check box."""
        from ipywidgets import Checkbox

        self.add(Checkbox(on, description=name, indent=False, layout={"width": "auto"}), action)

    def add_text(self, name: str, value: str = "", *, hint: str = "") -> None:
        """Add a line of text."""
        from ipywidgets import Text

        self.add(Text(value, description=name, placeholder=hint, layout={"width": "190px"}))

    def add_choice(
        self, name: str, options: Sequence[str], value: str | None, action: Callable[[], None] | None = None
    ) -> None:
        """Add a list of options; the value None selects nothing."""
        from ipywidgets import Dropdown

        self.add(
            Dropdown(options=options, value=value, description=name, layout={"max_width": "420px"}), action
        )

    def offer(self, name: str, options: Sequence[str]) -> None:
        """Replace the options of a choice; its value stays if it is among them."""
        control, kept = self.controls[name], self[name]
        if control.options != tuple(options):
            wanted = kept if kept in options else None
            self._offering = True
            control.options = tuple(options)  # selects the first one
            self._offering = wanted == kept
            control.value = wanted
            self._offering = False

    def button(self, name: str, icon: str, action: Callable[[], None]) -> Any:
        """Return a button that runs an action and a refresh."""
        from ipywidgets import Button

        def act() -> None:
            action()
            self.refresh()

        button = Button(description=name, icon=icon, tooltip=name, layout={"width": "auto"})
        button.on_click(lambda _: self.soon(act))
        return button

    def buttons(self) -> list[Any]:
        """Return the buttons beside the title."""
        return [self.button("Refresh", "refresh", lambda: None)]

    def body(self) -> list[Any]:
        """Return the widgets below the controls."""
        return [self.screen]

    def listen(self) -> None:
        """Follow the graph until it is closed."""
        self._stops = [self.graph.tap(self._take, self.needed), self.graph.watch_time(lambda _: self._tick())]

    def stop(self) -> None:
        """Stop following the graph."""
        while self._stops:
            self._stops.pop()()

    def wanted(self) -> str | None:
        """Return the full name of the node or service in the first word, or None."""
        return "/" + self.words[0].strip("/") if self.words else None

    def check_time(self) -> None:
        """Raise a CourseError while robot time is paused, because no node can answer."""
        if pace.wanted() == "real" and pace.speed_of(self.graph).paused:
            raise CourseError(
                "Robot time is paused, nobody answers: ▶ in the viewer's Time panel lets it go on."
            )

    def close(self) -> None:
        """Stop following the graph, and leave the page."""
        self.stop()
        self.closed = True
        if self._frame is not None:
            self._frame.close()

    def restore(self, settings: Mapping[str, Any]) -> None:
        """Set controls; a value that does not exist now, like a node, is named above the picture.

        Raises:
            CourseError: There is no such control.
        """
        from traitlets import TraitError

        for name, value in settings.items():
            if name not in self.controls:
                meant = did_you_mean(name, self.controls) or "."
                raise CourseError(f"{self.title} has no control {name!r}{meant}")
            try:
                self.controls[name].value = value
            except TraitError:
                self.say(f"“{name}” can't be {value!r} now.")

    def widget(self) -> "VBox":
        """Return the widget for a cell; from now on it follows the graph."""
        from ipywidgets import HTML, HBox, VBox

        self._loop = asyncio.get_running_loop()
        self.listen()
        title = HTML(f"{STYLE}<b class='rqt-title'>{self.title}</b>", layout={"flex": "1"})
        head = HBox([title, *self.buttons(), self.button("Close", "times", self.close)])
        controls = HBox(list(self.controls.values()))
        self._frame = VBox([head, controls, self.notice, *self.body()])
        self._frame.add_class("rqt")
        self._act(self.refresh)
        return self._frame

    def static(self) -> str:
        """Return the view as HTML for pages without widgets."""
        head = f"<b class='rqt-title'>{self.title}</b>{self.notice.value}"
        screen = f"<div class='rqt-screen' tabindex='0'>{self.picture()}</div>"  # it scrolls
        return f"{STYLE}<div class='rqt'>{head}{screen}</div>"

    def say(self, text: str) -> None:
        """Show a line of text above the picture; "" removes it."""
        self.notice.value = f"<div role='status' class='rqt-notice'>{escape(text)}</div>" if text else ""

    def soon(self, action: Callable[[], None]) -> None:
        """Run an action in the kernel's main thread: messages of a page may arrive in another one."""
        if self._loop is None:
            self._act(action)
        else:
            self._loop.call_soon_threadsafe(self._act, action)

    def _act(self, action: Callable[[], None]) -> None:
        try:
            action()
        except CourseError as error:
            self.say(str(error))

    def _take(self, sample: Sample) -> None:
        self.hear(sample)
        self._tick()

    def _tick(self) -> None:
        """Draw at most once per PERIOD; the last change is drawn late if none follows."""
        if self._loop is None:
            return  # without a page, `static` draws once
        left = self._drawn + PERIOD - wall.monotonic()
        if left <= 0:
            self._draw()
        elif self._late is None:
            self._late = self._loop.call_later(left, self._draw)

    def _draw(self) -> None:
        if self._late is not None:
            self._late.cancel()
        self._late, self._drawn = None, wall.monotonic()
        if self._stops:
            with baton.unknown():  # a page's matters are none of the program's
                self._act(self.refresh)
