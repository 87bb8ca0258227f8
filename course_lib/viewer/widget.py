"""A scene in a notebook's cell, over the kernel's own connection to the page."""

import asyncio
import base64
import os
import threading
import uuid
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import anywidget
import traitlets

from course_lib.viewer import assets, zbuffer
from course_lib.viewer.camera import Vector
from course_lib.viewer.drawables import Mesh, Points, Solids
from course_lib.viewer.scene import Scene
from course_lib.viewer.stream import Stream

_PICTURE_WIDTH = 480  # [px] of the picture for pages that cannot show the scene itself
_PICTURE_LIMIT = 200_000  # triangles; more take seconds to draw


class _Code(anywidget.AnyWidget):
    """The viewer's script, sent once and shared by all widgets of a kernel."""

    _esm = "export default {}"
    code = traitlets.Bytes().tag(sync=True)


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


class SceneWidget(anywidget.AnyWidget):
    """Shows a scene in as many cells and pages as display it; all follow the scene.

    Args:
        scene: What to show.
        height: Height of the view in [px]; its width is that of the cell.
        label: What the view shows, for those who cannot see it.
    """

    _esm = assets.widget_module()
    name = traitlets.Unicode().tag(sync=True)
    code = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int(400).tag(sync=True)
    label = traitlets.Unicode("3D view").tag(sync=True)
    snapshot = traitlets.Bytes().tag(sync=True)
    number = traitlets.Int().tag(sync=True)

    def __init__(self, scene: Scene, height: int = 400, label: str = "3D view") -> None:
        self.scene = scene
        self.ready = False
        self.on_click: list[Callable[[Click], None]] = []
        self.keeps: object = None  # whatever must live as long as a page shows this
        self.on_views: Callable[[int], None] = lambda count: None  # told how many a page has now
        self._stream = Stream(scene, self._transmit)
        self._loop = _running_loop()
        super().__init__(name=uuid.uuid4().hex, code=_shared_code().model_id, height=height, label=label)
        self.on_msg(self._receive)
        if hasattr(self.comm, "_reply_subshell_for"):
            # ipykernel 7.4 holds a page's messages back while a cell runs, JupyterLab's subshell or not.
            self.comm._reply_subshell_for = lambda data, default: default
        if "JPY_SESSION_NAME" in os.environ:
            # A page is there, but after a restart it is not heard before the running cell ends.
            self._stream.connect(self._stream.number)

    def get_state(self, key: Any = None, drop_defaults: bool = False) -> dict[str, Any]:
        """Return the traits, with the scene as it is now: pages ask for them when they load."""
        state: dict[str, Any] = super().get_state(key, drop_defaults)
        if "snapshot" in state or "number" in state:
            state["number"], state["snapshot"] = self._stream.snapshot()
        return state

    def flush(self) -> None:
        """Send what has changed now, not with the next batch."""
        self._stream.flush()

    def close(self) -> None:
        """Remove the views from all pages and stop following the scene."""
        self._stream.close()
        super().close()

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the view, and a picture for pages that run nothing: saved, untrusted, on GitHub."""
        data, metadata = super()._repr_mimebundle_(**kwargs) or ({}, {})
        data["text/plain"] = f"{self.label}: {len(self.scene.objects())} objects"
        if _triangles(self.scene) <= _PICTURE_LIMIT:
            png = zbuffer.draw(self.scene, (_PICTURE_WIDTH, self.height * _PICTURE_WIDTH // 800))
            data["image/png"] = base64.b64encode(png).decode()
        return data, metadata

    def _transmit(self, number: int, batch: bytes) -> None:
        self.send({"type": "batch", "number": number}, [batch])

    def _receive(self, _: Any, content: dict[str, Any], __: Any) -> None:
        """Answer a page: it has started, missed a batch, made or removed a view, or somebody clicked."""
        kind = content.get("type")
        if kind == "ready":
            self.ready = True
            if not self._stream.connect(content.get("number", -1)):
                self._reset()
        elif kind == "resync":
            self._reset()
        elif kind == "views":
            self.on_views(int(content["count"]))
        elif kind == "click":
            fields: dict[str, Any] = {
                name: tuple(value) if isinstance(value, list) else value
                for name, value in content.items()
                if name != "type"
            }
            self._click(Click(**fields))

    def _reset(self) -> None:
        number, snapshot = self._stream.snapshot()
        self.send({"type": "reset", "number": number}, [snapshot])

    def _click(self, click: Click) -> None:
        """Call back in the thread of the cells, where nodes run too."""
        for callback in tuple(self.on_click):
            if self._loop is None or threading.current_thread() is threading.main_thread():
                callback(click)
            else:
                self._loop.call_soon_threadsafe(callback, click)


_code: _Code | None = None


def _shared_code() -> _Code:
    global _code
    if _code is None or _code.comm is None:
        _code = _Code(code=assets.bundle_zipped())
    return _code


def _running_loop() -> asyncio.AbstractEventLoop | None:
    try:
        return asyncio.get_running_loop()
    except RuntimeError:
        return None


def _triangles(scene: Scene) -> int:
    """Estimate how many triangles a picture has."""
    count = 0
    for thing in scene.objects().values():
        if isinstance(thing, Mesh):
            count += len(thing.faces)
        elif isinstance(thing, Solids):
            count += len(thing.placements) * (12 if thing.shape == "box" else 200)
        elif isinstance(thing, Points):
            count += 2 * len(thing.points)
    return count
