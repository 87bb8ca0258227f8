"""One scene's end of the connection to the pages that show it, over whatever carries messages."""

import asyncio
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from course_lib.viewer.camera import Vector
from course_lib.viewer.scene import Scene
from course_lib.viewer.stream import Stream

Content: TypeAlias = dict[str, Any]
Transmit: TypeAlias = Callable[[Content, list[bytes]], None]


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
    """Keeps pages equal to a scene, and hears what is done there.

    Callbacks run in the thread of the cells, where nodes run too, if this was made there.

    Args:
        scene: What the pages show.
        send: Carries JSON and buffers to the pages; called from any thread.
    """

    def __init__(self, scene: Scene, send: Transmit) -> None:
        self.scene = scene
        self.ready = False  # whether a page has answered
        self.on_click: list[Callable[[Click], None]] = []
        self.post = send
        self._stream = Stream(scene, lambda number, batch: send({"type": "batch", "number": number}, [batch]))
        self._loop = _running_loop()
        self._heard: dict[str, Callable[[Content], None]] = {"ready": self._start, "resync": self._reset}
        self._listeners: dict[str, Callable[[Content], None]] = {"click": self._click}

    def listen(self, kind: str, callback: Callable[[Content], None]) -> None:
        """Have a function called with every message of a kind that a page sends."""
        self._listeners[kind] = callback

    def receive(self, content: Content, buffers: Sequence[Any] = ()) -> None:
        """Take a message from a page; one of no known kind is passed over."""
        kind = content.get("type", "")
        if kind in self._heard:
            self._heard[kind](content)
        elif kind in self._listeners:
            if self._loop is None or threading.current_thread() is threading.main_thread():
                self._listeners[kind](content)
            else:
                self._loop.call_soon_threadsafe(self._listeners[kind], content)

    def expect(self) -> None:
        """Send changes from now on, to a page that shall come with the present scene."""
        self._stream.connect(self._stream.number)

    def snapshot(self) -> tuple[int, bytes]:
        """Return the number of the last batch, and the scene with it, as a page starts from them."""
        return self._stream.snapshot()

    def flush(self) -> None:
        """Send what has changed now, not with the next batch."""
        self._stream.flush()

    def close(self) -> None:
        """Stop following the scene."""
        self._stream.close()
        self.ready = False

    def _start(self, content: Content) -> None:
        self.ready = True
        if not self._stream.connect(content.get("number", -1)):
            self._reset(content)

    def _reset(self, _: Content) -> None:
        number, snapshot = self._stream.snapshot()
        self.post({"type": "reset", "number": number}, [snapshot])

    def _click(self, content: Content) -> None:
        fields: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value
            for name, value in content.items()
            if name != "type"
        }
        click = Click(**fields)
        for callback in tuple(self.on_click):
            callback(click)


def _running_loop() -> asyncio.AbstractEventLoop | None:
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None
