"""The changes of a scene as numbered batches, for pages that follow it."""

import threading
import time
from collections.abc import Callable
from typing import Any, TypeAlias

from course_lib.viewer import encoding
from course_lib.viewer.scene import Node, Scene, What

Send: TypeAlias = Callable[[int, bytes], None]

INTERVAL = 1 / 40  # [s] between two batches


class Stream:
    """Follows a scene and sends what has changed since the last batch, the last value of each thing only.

    While it is not connected it does nothing but remember that a page would need a snapshot. Then a thread of
    its own sends: a timer started by whoever changes the scene would live by that one's time, robot time.

    Args:
        scene: What to follow.
        send: Takes a batch with its number; called from any thread, never twice at a time.
    """

    def __init__(self, scene: Scene, send: Send) -> None:
        self.scene = scene
        self.number = 0
        self.connected = False
        self._send = send
        self._lock = threading.RLock()
        self._stale = False
        self._changes: dict[tuple[What, str], None] = {}
        self._moved: dict[str, None] = {}
        self._paths: list[str] = []
        self._thread: threading.Thread | None = None
        self._changed = threading.Event()
        self._closed = False
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

    def flush(self) -> None:
        """Send what has changed, now."""
        with self._lock:
            batch = self._batch()
            if batch:
                self.number += 1
                self._send(self.number, encoding.pack(batch))

    def close(self) -> None:
        """Forget the scene."""
        self._stop()
        with self._lock:
            self.connected = False
            self._closed = True
            self._changed.set()

    def _refresh(self) -> None:
        """Make older snapshots known as such, if something has changed since."""
        self.number += self._stale
        self._stale = False

    def _note(self, what: What, path: str) -> None:
        if not self.connected:
            self._stale = True
            return
        if what == "transform":
            self._moved[path] = None
        else:
            self._changes.pop((what, path), None)  # the order of the last changes counts
            self._changes[what, path] = None
        self._schedule()

    def _schedule(self) -> None:
        self._changed.set()

    def _send_batches(self) -> None:
        while True:
            self._changed.wait()
            time.sleep(INTERVAL)  # more changes may come with it
            self._changed.clear()
            if self._closed:
                return
            self.flush()

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
        if placed["paths"] == self._paths:
            del placed["paths"]
        else:
            self._paths = placed["paths"]
        return placed
