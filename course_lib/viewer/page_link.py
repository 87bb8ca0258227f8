"""One scene's end of the connection to the pages that show it, over whatever carries messages."""

import threading
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any, cast, get_args

from course_lib.arrays import Vector
from course_lib.viewer.scene import Scene
from course_lib.viewer.stream import Content, Send, Sight, Stream, running_loop
from course_lib.viewer.wire import MessageError, from_json


@dataclass(frozen=True, kw_only=True)
class Click:
    """A click into a view; points are in the scene's frame, in [m]."""

    path: str | None = None  # what was hit, or None
    point: Vector | None = None  # where
    normal: Vector | None = None  # which way the surface looks there, if it has one
    index: int | None = None  # which instance, segment, point or triangle of the object was hit
    button: int = 0  # 0 left, 1 middle, 2 right
    origin: Vector  # start of the ray from the camera
    direction: Vector  # its unit direction


class PageLink:
    """The connection between a scene and its pages: changes out, messages in.

    Callbacks run in the thread of the cells, where nodes run too, if this was made there.

    Args:
        scene: What the pages show.
        send: Carries JSON and buffers to the pages; called from any thread.
        turn: Entered while callbacks run.
    """

    def __init__(
        self, scene: Scene, send: Send, turn: Callable[[], AbstractContextManager[Any]] = nullcontext
    ) -> None:
        self.scene = scene
        self.on_click: list[Callable[[Click], None]] = []
        self.on_views: Callable[[int], None] = lambda count: (
            None
        )  # called with the number of views in all pages
        self.at_once: dict[str, Callable[[Content], None]] = {}  # by kind, called in the receiving thread
        self._send = send
        self._turn = turn
        self._stream = Stream(scene, send, self._note_views)
        self._flow = self._stream.flow
        self._loop = running_loop()
        self._listeners: dict[str, Callable[[Content], None]] = {"click": self._click}

    @property
    def ready(self) -> bool:
        """A page shows the scene, and is not hidden behind others; its views may be out of sight."""
        return bool(self._sights() & {"ready", "away"})

    @property
    def watched(self) -> bool:
        """A view is in sight: only then changes are sent."""
        return "ready" in self._sights()

    @property
    def hidden(self) -> bool:
        """Pages show the scene, but all of them are hidden behind others."""
        return self._sights() == {"hide"}

    def listen(self, kind: str, callback: Callable[[Content], None]) -> None:
        """Register a callback for every message of a kind that a page sends."""
        self._listeners[kind] = callback

    def post(self, content: Content, buffers: Sequence[bytes] = ()) -> None:
        """Send a message to all pages; its "type" says of which kind it is.

        Pages answer some of them: those that went without a word are found out, though the scene may rest.
        """
        asks = {"ask": True} if self.watched and self._stream.asks() else {}
        self._send(content | asks, list(buffers))

    def receive(self, content: Content, buffers: Sequence[Any] = ()) -> None:
        """Handle a message from a page; a malformed one is skipped, and its views show a note.

        All messages say from which page they come and the last batch that it has.
        """
        try:
            kind, page = content["type"], str(content.get("page", ""))
            self._follow(page, int(content.get("number", -1)), kind)
            if kind == "views":
                self._count(page, int(content["count"]))
            elif kind == "click":
                content = {"click": from_json(Click, content)}
        except (KeyError, TypeError, ValueError, MessageError) as error:
            self._stream.say(f"A message of the page was passed over: {error!r}")
            return
        if kind in self.at_once:
            self.at_once[kind](content)
        elif kind in self._listeners:
            self._call(self._listeners[kind], content)

    def expect(self) -> None:
        """Send changes from now on, to a page that shall come with the present scene."""
        self._stream.connect(self._stream.number)

    def snapshot(self) -> tuple[int, bytes]:
        """Return the number of the last batch, and the scene with it, as a page starts from them."""
        return self._stream.snapshot()

    def flush(self) -> None:
        """Send what has changed now, not with the next batch."""
        self._stream.flush()

    def catch_up(self) -> None:
        """Send what has changed now, to pages out of sight too: they shall draw the scene."""
        if self.watched:
            self._stream.flush()
        else:
            self._stream.reset()

    def close(self) -> None:
        """Stop following the scene."""
        self._flow.pages.clear()
        self._stream.close()

    def _follow(self, page: str, number: int, kind: str) -> None:
        """Note how far a page has come, and send it the scene if it has another one.

        While no page is seen, nothing is sent; each gets the scene when it is seen again.
        """
        is_new = self._flow.heard(page, number)
        known = self._flow.pages[page]
        is_new |= known.sight != "ready" and kind == "ready"
        if kind in get_args(Sight):
            self._flow.look(page, cast(Sight, kind))
        if known.sight != "ready":
            if not self.watched:
                self._stream.disconnect()
            return
        is_equal = not is_new or self._stream.connect(number)
        if kind == "resync" or not is_equal:
            self._stream.reset(page)

    def _sights(self) -> set[Sight]:
        return {page.sight for page in tuple(self._flow.pages.values()) if page.views}

    def _count(self, page: str, count: int) -> None:
        if count:
            self._flow.pages[page].views = count
        else:
            self._flow.left(page)
        self._note_views()

    def _note_views(self) -> None:
        views = sum(page.views for page in self._flow.pages.values())
        if not views:
            self._stream.disconnect()
        self._call(self.on_views, views)

    def _click(self, content: Content) -> None:
        for callback in tuple(self.on_click):
            callback(content["click"])

    def _call(self, function: Callable[[Any], None], argument: Any) -> None:
        """Call in the thread of the cells."""
        if self._loop is None or threading.current_thread() is threading.main_thread():
            with self._turn():
                function(argument)
        else:
            self._loop.call_soon_threadsafe(function, argument)
