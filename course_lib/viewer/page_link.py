"""Python's end of the connection between a scene and the pages that show it.

Changes of a scene are sent as numbered batches. A batch holds only the last value of everything
that changed within 1/40 s, so a scene may change as often as it likes. Four facts shape the rest of
this module:

- A page may load, reload or wake up at any time. It then gets a snapshot with the number of the
  last batch in it, and the numbers tell both ends whether they have the same scene.
- A slow page must not pile up messages in the kernel's connection. Some batches request an
  acknowledgement, and sending pauses while too many of these are pending (`FlowControl`). With it a page
  reports how long a picture takes, and batches are not sent faster than the fastest page draws.
- Most front ends deliver acknowledgements only after the running cell has ended, so a missing one
  does not mean that the page is slow.
- Batches are sent by a separate thread. A timer in a node's thread would use robot time, and would
  stop while robot time does not advance.
"""

import asyncio
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, cast, get_args

import numpy as np

from course_lib.arrays import Vector
from course_lib.viewer import encoding
from course_lib.viewer.encoding import Message, MessageError, from_json
from course_lib.viewer.scene import ChangeKind, Scene

Content: TypeAlias = dict[str, Any]
Send: TypeAlias = Callable[[Content, list[bytes]], None]
# Reports of a page: visible, with all views scrolled out of sight, or with its tab hidden.
Sight: TypeAlias = Literal["ready", "away", "hide"]

# The minimum time between two batches, and between a change and its batch, in which further changes
# of the same frame are collected [s].
INTERVAL, COLLECTING = 1 / 40, 1 / 100
# The longest interval for slow pages, so that a page that has become faster is soon noticed [s].
MAX_INTERVAL = 1 / 4
# The time after which an unresponsive page counts as disconnected [s].
MAX_SILENCE = 10.0
# An acknowledgement is requested after this many batches or bytes, whichever
# comes first. Each one makes the kernel busy and idle again, for which
# JupyterLab draws its indicators and loads two icons.
_ACK_BATCHES, _ACK_BYTES = 12, 1 << 18
_MAX_PENDING_ACKS = 3


class Click(Message, frozen=True, kw_only=True):
    """A click into a view; points are in the scene's frame, in [m]."""

    # Scene path of the clicked object.
    path: str | None = None
    # Clicked point.
    point: Vector | None = None
    # Surface normal at the point, if there is a surface.
    normal: Vector | None = None
    # Index of the clicked instance, segment, point or triangle.
    index: int | None = None
    # The button: 0 left, 1 middle, 2 right.
    button: int = 0
    # Start of the ray from the camera.
    origin: Vector
    # The unit direction of the ray.
    direction: Vector


@dataclass
class Page:
    """The state of a page: the batches that it has received, and the visibility of its views.

    Args:
        number: Number of the last batch that it has received.
        ack: Number of the last acknowledgement that had been requested at the page's last message.
        views: Number of its views.
        sight: Whether it is visible.
        drawing: Time from the arrival of a batch until its picture has been drawn [s].
    """

    number: int
    ack: int = 0
    views: int = 1
    sight: Sight = "ready"
    drawing: float = 0.0


class FlowControl:
    """Flow control by acknowledgements.

    While a cell runs, most front ends delay acknowledgements; until it ends, everything is sent.
    JupyterLab delivers them during the cell, in a separate thread.
    """

    def __init__(self) -> None:
        self.pages: dict[str, Page] = {}
        # The event loop of the cells, if this is a kernel.
        self._loop = running_loop()
        self._receives_in_cells = False
        # The number of acknowledgements that were requested.
        self._requested = 0
        # Number of a batch, and of its acknowledgement.
        self._pending: deque[tuple[int, int]] = deque()
        # The number of batches and of bytes since the last request.
        self._batches = self._bytes = 0
        # Last acknowledgement requested while the kernel could receive.
        self._idle_at = -1

    def on_message(self, name: str, number: int) -> bool:
        """Record the last batch that a page has, and return whether the page is new."""
        self._receives_in_cells |= threading.current_thread() is not threading.main_thread()
        is_new = name not in self.pages
        page = self.pages.setdefault(name, Page(number))
        page.number, page.ack = number, self._requested
        self.drop_acknowledged_batches()
        return is_new

    def remove(self, name: str) -> None:
        """Remove a page."""
        self.pages.pop(name, None)
        self.drop_acknowledged_batches()

    def count_message(self, number: int, size: int) -> bool:
        """Count a message of `size` bytes, and return whether it must request an acknowledgement.

        Args:
            number: The number of the batch, or of the batch before the message.
            size: The size in bytes.
        """
        self._batches, self._bytes = self._batches + 1, self._bytes + size
        if self._batches < _ACK_BATCHES and self._bytes < _ACK_BYTES:
            return False
        self._batches = self._bytes = 0
        self._requested += 1
        self._pending.append((number, self._requested))
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(setattr, self, "_idle_at", self._requested)
        return True

    @property
    def interval(self) -> float:
        """The minimum time between two batches [s]: the fastest visible page draws each batch."""
        drawing = [page.drawing for page in tuple(self.pages.values()) if page.sight == "ready"]
        return min(max(INTERVAL, min(drawing, default=0.0)), MAX_INTERVAL)

    def has_room(self) -> bool:
        """Return whether one more batch may be sent."""
        # A copy, because acknowledgements arrive in other threads.
        pending = tuple(self._pending)
        cannot_receive = self._loop is not None and not self._receives_in_cells
        return len(pending) < _MAX_PENDING_ACKS or (cannot_receive and self._idle_at < pending[0][1])

    def drop_silent_pages(self) -> None:
        """Remove the pages whose acknowledgements are pending."""
        number, ack = self._pending[0] if self._pending else (-1, -1)
        up_to_date = {name: page for name, page in self.pages.items() if page.number >= number}
        self.pages = {name: page for name, page in up_to_date.items() if page.ack >= ack}
        self._pending.clear()

    def drop_acknowledged_batches(self) -> None:
        """Remove the pending acknowledgements that all visible pages have sent."""
        pages = [page for page in tuple(self.pages.values()) if page.sight == "ready"]
        slowest = min((page.number for page in pages), default=-1)
        ack = min((page.ack for page in pages), default=-1)
        while self._pending and self._pending[0][0] <= slowest and self._pending[0][1] <= ack:
            self._pending.popleft()


def running_loop() -> asyncio.AbstractEventLoop | None:
    """Return the event loop of this thread, or None."""
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None


class PageLink:
    """The connection between a scene and its pages: sends changes, receives messages.

    While no page is visible, it only records that a page would need a snapshot. Callbacks run in
    the thread of the cells, in which nodes run as well, if the link was created there.

    Args:
        scene: The scene that pages show.
        send: Sends JSON and buffers to all pages; called from any thread.
        turn: Context manager around callbacks.
    """

    def __init__(
        self,
        scene: Scene,
        send: Send,
        turn: Callable[[], AbstractContextManager[Any]] = nullcontext,
    ) -> None:
        self.scene = scene
        # Number of the last batch.
        self.number = 0
        self.is_connected = False
        self.on_click: list[Callable[[Click], None]] = []
        # Called with the number of views in all pages, when it has changed.
        self.on_views: Callable[[int], None] = lambda count: None
        # Callbacks by the type of a message, called in the receiving thread.
        self.immediate_handlers: dict[str, Callable[[Content], None]] = {}
        self._listeners: dict[str, Callable[[Content], None]] = {}
        self._send = send
        self._turn = turn
        self._flow = FlowControl()
        self._loop = running_loop()
        self._lock = threading.RLock()
        # Whether the scene has changed since the last batch or snapshot.
        self._is_stale = False
        self._changes: dict[tuple[ChangeKind, str], None] = {}
        self._moved_paths: dict[str, None] = {}
        # The paths of the transforms in the last batch.
        self._paths: list[str] = []
        self._thread: threading.Thread | None = None
        self._changed = threading.Event()
        self._is_closed = False
        # Whether an exception interrupted a batch.
        self._is_broken = False
        self._text = ""
        self._stop = scene.listen(self._on_scene_change)

    @property
    def is_ready(self) -> bool:
        """Whether the tab of a page with views is visible; its views may be out of sight."""
        return bool(self._page_sights() & {"ready", "away"})

    @property
    def is_watched(self) -> bool:
        """Whether a view is in sight. Changes are sent only then."""
        return "ready" in self._page_sights()

    @property
    def is_hidden(self) -> bool:
        """Whether the tabs of all pages are hidden."""
        return self._page_sights() == {"hide"}

    @property
    def pages(self) -> set[str]:
        """The ids of the connected pages."""
        return set(self._flow.pages)

    @property
    def interval(self) -> float:
        """The minimum time between two batches, which is longer for pages that draw slowly [s]."""
        return self._flow.interval

    def _page_sights(self) -> set[Sight]:
        return {page.sight for page in tuple(self._flow.pages.values()) if page.views}

    def listen(self, kind: str, callback: Callable[[Content], None]) -> None:
        """Register a callback for all messages of a type that pages send."""
        self._listeners[kind] = callback

    def post(self, content: Content) -> None:
        """Send a message to all pages; its "type" determines the handler.

        Pages acknowledge some messages, so that disconnected ones are detected even when the scene
        does not change.
        """
        ask = False
        if self.is_watched:
            if not self._flow.has_room():
                # The thread measures how long the pages are silent.
                self._changed.set()
            ask = self._flow.count_message(self.number, 0)
        self._send(content | ({"ask": True} if ask else {}), [])

    def receive(self, content: Content, buffers: Sequence[Any] = ()) -> None:
        """Handle a message from a page. A malformed message is ignored and reported in the views.

        Each message has the page's id and the number of the page's last batch.
        """
        try:
            kind, page = content["type"], str(content.get("page", ""))
            self._on_progress(page, int(content.get("number", -1)), kind)
            if kind == "ack":
                self._flow.pages[page].drawing = float(content.get("drawing", 0.0))
            elif kind == "views":
                count = int(content["count"])
                if count:
                    self._flow.pages[page].views = count
                else:
                    self._flow.remove(page)
                self._on_views_change()
            elif kind == "click":
                click = from_json(Click, content)
        except (KeyError, TypeError, ValueError, MessageError) as error:
            self.show_text(f"A message of the page was ignored: {error!r}")
            return
        if kind == "click":
            for on_click in tuple(self.on_click):
                self._call(on_click, click)
        elif kind in self.immediate_handlers:
            self.immediate_handlers[kind](content)
        elif kind in self._listeners:
            self._call(self._listeners[kind], content)

    def snapshot(self) -> tuple[int, bytes]:
        """Return the whole scene, and the number of the last batch in it."""
        with self._lock:
            self._count_stale()
            # A new page has not received the paths of earlier batches.
            self._paths = []
            return self.number, encoding.snapshot(self.scene)

    def connect(self, number: int) -> bool:
        """Start sending, and return whether a page with batch `number` has the current scene."""
        with self._lock:
            self._count_stale()
            self.is_connected = True
            if self._thread is None:
                self._thread = threading.Thread(target=self._send_batches, name="scene", daemon=True)
                self._thread.start()
            return number == self.number

    def disconnect(self) -> None:
        """Stop sending until the next `connect`."""
        with self._lock:
            self.is_connected = False
            self._is_stale |= bool(self._changes or self._moved_paths)
            self._changes, self._moved_paths = {}, {}
            # Otherwise pages with a pending acknowledgement would count as disconnected.
            if not self._is_broken:
                self._changed.clear()

    def reset(self, page: str | None = None) -> None:
        """Send the whole scene to one page, or to all."""
        with self._lock:
            number, snapshot = self.snapshot()
            self._send({"type": "reset", "number": number, "page": page}, [snapshot])

    def show_text(self, text: str) -> None:
        """Show a line of text in the views, unless it is already shown."""
        if text != self._text:
            self._text = text
            self._send({"type": "status", "text": text}, [])

    def flush(self) -> None:
        """Send all changes now, or as soon as pages have acknowledged earlier batches."""
        with self._lock:
            if not self._flow.has_room():
                return self._changed.set()
            is_sent = False
            try:
                batch = self._take_batch()
                if batch:
                    self.number += 1
                    batch_bytes = encoding.pack(batch)
                    ask = self._flow.count_message(self.number, len(batch_bytes))
                    self._send({"type": "batch", "number": self.number, "ask": ask}, [batch_bytes])
                is_sent = True
            finally:
                # If a batch was interrupted, the thread sends the whole scene instead.
                self._is_broken |= not is_sent
                if self._is_broken:
                    self._changed.set()

    def send_all(self) -> None:
        """Send all changes now, even to pages whose views are out of sight, for an image."""
        if self.is_watched:
            self.flush()
        else:
            self.reset()

    def close(self) -> None:
        """Stop following the scene."""
        self._flow.pages.clear()
        self._stop()
        with self._lock:
            self.is_connected = False
            self._is_closed = True
            self._changed.set()

    def _count_stale(self) -> None:
        """Count a batch if something has changed since the last snapshot."""
        self.number += self._is_stale
        self._is_stale = False

    def _on_progress(self, page: str, number: int, kind: str) -> None:
        """Record a page's progress, and send it the scene if its scene is outdated.

        Nothing is sent while no page is visible; each page gets the scene when it becomes visible
        again.
        """
        is_new = self._flow.on_message(page, number)
        page_state = self._flow.pages[page]
        is_new |= page_state.sight != "ready" and kind == "ready"
        if kind in get_args(Sight):
            # Pages that are not visible may sleep, so their acknowledgements are not awaited.
            page_state.sight = cast("Sight", kind)
            self._flow.drop_acknowledged_batches()
        if page_state.sight != "ready":
            if not self.is_watched:
                self.disconnect()
            return
        is_equal = not is_new or self.connect(number)
        if kind == "resync" or not is_equal:
            self.reset(page)

    def _on_views_change(self) -> None:
        views = sum(page.views for page in self._flow.pages.values())
        if not views:
            self.disconnect()
        self._call(self.on_views, views)

    def _call(self, function: Callable[[Any], None], argument: Any) -> None:
        """Call a function in the thread of the cells."""
        if self._loop is None or threading.current_thread() is threading.main_thread():
            with self._turn():
                function(argument)
        else:
            self._loop.call_soon_threadsafe(function, argument)

    def _on_scene_change(self, kind: ChangeKind, path: str) -> None:
        if not self.is_connected:
            self._is_stale = True
            return
        if kind == "transform":
            # Setting the event is slow, and transforms are many: the first one of a batch is
            # enough.
            if not self._moved_paths:
                self._changed.set()
            self._moved_paths[path] = None
        else:
            # Commands are sent in the order of the last changes.
            self._changes.pop((kind, path), None)
            self._changes[kind, path] = None
            self._changed.set()

    def _send_batches(self) -> None:
        silence = 0.0  # [s]
        sent = 0.0  # when the last batch was sent [s]
        while True:
            self._changed.wait()
            interval = self.interval
            # At most an interval, because robot time replaces this clock when a program starts.
            time.sleep(min(max(COLLECTING, sent + interval - time.monotonic()), interval))
            sent = time.monotonic()
            if self._is_closed:
                return
            silence = 0.0 if self._flow.has_room() else silence + interval
            if silence > MAX_SILENCE:
                self._flow.drop_silent_pages()
                self._on_views_change()
            elif not silence:
                self._changed.clear()
                try:
                    if self._is_broken:
                        self._is_broken = False
                        self.reset()
                        text = (
                            "An interrupt stopped a scene update halfway, so the whole scene was sent again."
                        )
                        self.show_text(text)
                    self.flush()
                except Exception as error:
                    # A closed connection can raise any exception, and a page may reconnect.
                    self._is_broken, self._is_stale = False, True
                    self.disconnect()
                    text = f"The view is no longer connected to its scene: {error!r}"
                    print(text, file=sys.stderr)  # noqa: T201

    def _take_batch(self) -> dict[str, Any]:
        """Return all changes since the last batch."""
        with self.scene.lock:
            changes, self._changes = self._changes, {}
            moved_paths, self._moved_paths = self._moved_paths, {}
            batch: dict[str, Any] = {}
            if changes:
                batch["commands"] = [
                    c for kind, path in changes for c in encoding.commands(self.scene, kind, path)
                ]
                self._paths = []
            nodes = [node for path in moved_paths if (node := self.scene.find(path)) is not None]
            if not nodes:
                return batch
            transforms = encoding.placements(nodes)
            if len(transforms["paths"]) < len(nodes):
                invalid_path = next(node.path for node in nodes if not np.isfinite(node.matrix).all())
                text = f"The transform of {invalid_path!r} is not finite (NaN or inf) and was ignored."
                self.show_text(text)
            # Paths take most of the bytes, so they are sent only if they differ from the last
            # batch.
            if transforms["paths"] == self._paths:
                del transforms["paths"]
            else:
                self._paths = transforms["paths"]
            return batch | transforms
