"""The changes of a scene as numbered batches, for pages that follow it; slow pages get fewer batches."""

import asyncio
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np

from course_lib.viewer import encoding
from course_lib.viewer.scene import Node, Scene, What

_BATCHES, _BYTES = 4, 1 << 18  # of what is sent, pages are asked to answer
_QUESTIONS = 3  # may be open at a time


# A page's word on itself: it is seen, its views are scrolled out of sight, it is behind another tab.
Sight: TypeAlias = Literal["ready", "away", "hide"]


@dataclass
class Page:
    """The progress of a page."""

    number: int  # of the last batch that it has
    heard: int = 0  # how many questions had been asked when it was heard last
    views: int = 1
    sight: Sight = "ready"


class Flow:
    """Flow control: batches that pages have not answered yet are counted, so that none pile up.

    Most front-ends' answers wait until the running cell ends, which is not the pages' fault: until then
    everything is sent. JupyterLab's come in between, in a thread of their own.
    """

    def __init__(self) -> None:
        self.pages: dict[str, Page] = {}
        self._loop = running_loop()  # that of the cells, if this is a kernel
        self._hears_in_cells = False
        self._asked = 0  # questions so far
        self._open: deque[tuple[int, int]] = deque()  # questions: a batch's number, and their own
        self._batches = self._bytes = 0  # since the last question
        self._idle_at = -1  # a question after which the kernel could receive answers

    def heard(self, name: str, number: int) -> bool:
        """Note how far a page has come; say whether it is a new one."""
        self._hears_in_cells |= threading.current_thread() is not threading.main_thread()
        is_new = name not in self.pages
        page = self.pages.setdefault(name, Page(number))
        page.number, page.heard = number, self._asked
        self._settle()
        return is_new

    def left(self, name: str) -> None:
        """Forget a page."""
        self.pages.pop(name, None)
        self._settle()

    def look(self, name: str, sight: Sight) -> None:
        """Note whether a page is seen; nobody waits for others, which may sleep."""
        self.pages[name].sight = sight
        self._settle()

    def sent(self, number: int, size: int) -> bool:
        """Count a message of a size in bytes, a batch or after one; say whether pages shall answer it."""
        self._batches, self._bytes = self._batches + 1, self._bytes + size
        if self._batches < _BATCHES and self._bytes < _BYTES:
            return False
        self._batches = self._bytes = 0
        self._asked += 1
        self._open.append((number, self._asked))
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._idle, self._asked)
        return True

    def room(self) -> bool:
        """Return whether one more batch may be sent."""
        questions = tuple(self._open)  # pages answer in other threads
        is_deaf = self._loop is not None and not self._hears_in_cells
        return len(questions) < _QUESTIONS or (is_deaf and self._idle_at < questions[0][1])

    def give_up(self) -> None:
        """Forget the pages that have not answered."""
        number, asked = self._open[0] if self._open else (-1, -1)
        left = {name: page for name, page in self.pages.items() if page.number >= number}
        self.pages = {name: page for name, page in left.items() if page.heard >= asked}
        self._open.clear()

    def _settle(self) -> None:
        pages = [page for page in tuple(self.pages.values()) if page.sight == "ready"]
        slowest = min((page.number for page in pages), default=-1)
        longest = min((page.heard for page in pages), default=-1)  # since one was heard
        while self._open and self._open[0][0] <= slowest and self._open[0][1] <= longest:
            self._open.popleft()

    def _idle(self, question: int) -> None:
        self._idle_at = question


def running_loop() -> asyncio.AbstractEventLoop | None:
    """Return the event loop of this thread, or None."""
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None


Content: TypeAlias = dict[str, Any]
Send: TypeAlias = Callable[[Content, list[bytes]], None]

INTERVAL = 1 / 40  # [s] between two batches
LONGEST_SILENCE = 10.0  # [s] until a page that does not answer is taken for gone


class Stream:
    """The changes of a scene since the last batch, sent with the last value of each thing only.

    While it is not connected it does nothing but remember that a page would need a snapshot. Then a thread of
    its own sends: a timer started by a node's thread would run by robot time.

    Args:
        scene: What to follow.
        send: Carries a message with its buffers; called from any thread.
        on_silence: Called when pages have not answered for long, and are taken for gone.
    """

    def __init__(self, scene: Scene, send: Send, on_silence: Callable[[], None] = lambda: None) -> None:
        self.scene = scene
        self.flow = Flow()
        self.number = 0
        self.connected = False
        self._send = send
        self._on_silence = on_silence
        self._lock = threading.RLock()
        self._stale = False
        self._changes: dict[tuple[What, str], None] = {}
        self._moved: dict[str, None] = {}
        self._paths: list[str] = []
        self._thread: threading.Thread | None = None
        self._changed = threading.Event()
        self._closed = False
        self._broken = False  # a batch was cut off
        self._said = ""
        self._stop = scene.listen(self._note)

    def snapshot(self) -> tuple[int, bytes]:
        """Return the whole scene, and the number of the last batch that is in it."""
        with self._lock:
            self._refresh()
            self._paths = []  # a new page does not know them
            return self.number, encoding.snapshot(self.scene)

    def connect(self, number: int) -> bool:
        """Begin to send, to a page that has a snapshot; say whether that is still the present scene."""
        with self._lock:
            self._refresh()
            self.connected = True
            if self._thread is None:
                self._thread = threading.Thread(target=self._send_batches, name="scene", daemon=True)
                self._thread.start()
            return number == self.number

    def disconnect(self) -> None:
        """Send nothing until the next `connect`."""
        with self._lock:
            self.connected = False
            self._stale |= bool(self._changes or self._moved)
            self._changes, self._moved = {}, {}
            if not self._broken:
                self._changed.clear()  # or pages that owe an answer would be taken for gone

    def reset(self, page: str | None = None) -> None:
        """Send the whole scene to a page, or to all."""
        with self._lock:
            number, snapshot = self.snapshot()
            self._send({"type": "reset", "number": number, "page": page}, [snapshot])

    def say(self, text: str) -> None:
        """Show a line of text in the views, once."""
        if text != self._said:
            self._said = text
            self._send({"type": "status", "text": text}, [])

    def asks(self) -> bool:
        """Count a message beside the batches; say whether pages shall answer it, to show they are there."""
        if not self.flow.room():
            self._changed.set()  # the thread counts how long they are silent
        return self.flow.sent(self.number, 0)

    def flush(self) -> None:
        """Send what has changed, now, or as soon as pages have answered what they have."""
        with self._lock:
            if not self.flow.room():
                return self._changed.set()
            done = False
            try:
                self._send_batch()
                done = True
            finally:  # whatever came in between, an interrupt too: pages must not miss the batch
                self._broken |= not done
                if self._broken:
                    self._changed.set()

    def close(self) -> None:
        """Forget the scene."""
        self._stop()
        with self._lock:
            self.connected = False
            self._closed = True
            self._changed.set()

    def _send_batch(self) -> None:
        batch = self._batch()
        if batch:
            self.number += 1
            packed = encoding.pack(batch)
            asks = self.flow.sent(self.number, len(packed))
            self._send({"type": "batch", "number": self.number, "ask": asks}, [packed])

    def _refresh(self) -> None:
        """Count a batch if something has changed since the last snapshot."""
        self.number += self._stale
        self._stale = False

    def _note(self, what: What, path: str) -> None:
        if not self.connected:
            self._stale = True
            return
        if what == "transform":
            if not self._moved:  # the others go with the first: scheduling is slow, and transforms are many
                self._changed.set()
            self._moved[path] = None
        else:
            self._changes.pop((what, path), None)  # the order of the last changes counts
            self._changes[what, path] = None
            self._changed.set()

    def _send_batches(self) -> None:
        silence = 0.0  # [s]
        while True:
            self._changed.wait()
            time.sleep(INTERVAL)  # more changes may come with it
            if self._closed:
                return
            silence = 0.0 if self.flow.room() else silence + INTERVAL
            if silence > LONGEST_SILENCE:
                self.flow.give_up()
                self._on_silence()
            elif not silence:
                self._changed.clear()
                self._flush_whatever()

    def _flush_whatever(self) -> None:
        """Flush, in place of what an interrupt or a fault has cut off before."""
        try:
            if self._broken:
                self._broken = False
                self.reset()
                self.say("An interrupt cut off a change of the scene; it has been sent again, whole.")
            self.flush()
        except Exception as error:  # whatever a closed connection leads to; a page may come back over it
            self._broken, self._stale = False, True
            self.disconnect()
            print(f"The view does not follow its scene any more: {error!r}", file=sys.stderr)  # noqa: T201

    def _batch(self) -> dict[str, Any]:
        with self.scene.lock:
            changes, self._changes = self._changes, {}
            moved, self._moved = self._moved, {}
            batch: dict[str, Any] = {}
            if changes:
                batch["commands"] = [
                    c for what, path in changes for c in encoding.commands(self.scene, what, path)
                ]
                self._paths = []
            nodes = [node for path in moved if (node := self.scene.find(path)) is not None]
            if nodes:
                batch.update(self._placed(nodes))
            return batch

    def _placed(self, nodes: list[Node]) -> dict[str, Any]:
        """Write the transforms; the paths only if they are not those of the last batch."""
        placed = encoding.placements(nodes)
        if len(placed["paths"]) < len(nodes):
            lost = next(node.path for node in nodes if not np.isfinite(node.matrix).all())
            self.say(f"The transform of {lost!r} is not finite (NaN or inf): it stays where it was.")
        if placed["paths"] == self._paths:
            del placed["paths"]
        else:
            self._paths = placed["paths"]
        return placed
