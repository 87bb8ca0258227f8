"""A scene in a notebook's cell, over the kernel's own connection to the page."""

import base64
import os
import uuid
from collections.abc import Callable
from typing import Any

import anywidget
import traitlets
from IPython.core.getipython import get_ipython
from ipywidgets import Widget

from course_lib.viewer import assets, zbuffer
from course_lib.viewer.drawables import Mesh, Points, Solids
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene


class SidePanel:
    """The panel of one widget, opened and closed as its pages ask: only they know what JupyterLab is.

    Args:
        widget: What the panel shows.
        title: Of the panel's tab.
    """

    def __init__(self, widget: Widget, title: str) -> None:
        self._widget, self._title = widget, title
        self._panel: Widget | None = None

    def take(self, order: dict[str, Any]) -> str:
        """Open or close the panel; with `again` false, one that was opened before will do.

        Returns:
            The panel's model, or "".
        """
        wanted = bool(order.get("open"))
        if not wanted or order.get("again", True):
            self.close()
        if wanted and self._panel is None:
            from sidecar import Sidecar  # here: most kernels never need it

            view = {"version_major": 2, "version_minor": 0, "model_id": self._widget.model_id}
            data = {"application/vnd.jupyter.widget-view+json": view}
            shown = {"output_type": "display_data", "data": data, "metadata": {}}
            self._panel = Sidecar(title=self._title, anchor="split-right", outputs=(shown,))
        return "" if self._panel is None else str(self._panel.model_id)

    def close(self) -> None:
        """Remove the panel from the page."""
        if self._panel is not None:
            self._panel.close()
            self._panel = None


_PICTURE_WIDTH = 480  # [px] of the picture for pages that cannot show the scene itself
_PICTURE_LIMIT = 200_000  # triangles; more take seconds to draw


class _Code(anywidget.AnyWidget):
    """The viewer's script, sent once and shared by all widgets of a kernel."""

    _esm = "export default {}"
    code = traitlets.Bytes().tag(sync=True)


class SceneWidget(anywidget.AnyWidget):
    """A widget that shows a scene in any number of cells and pages.

    Args:
        scene: What to show.
        height: Height of the view in [px]; its width is that of the cell.
        label: What the view shows, for those who cannot see it.
        rest: The traits `film` and `panels` of a view at rest, and `words`.
    """

    _esm = assets.widget_module()
    name = traitlets.Unicode().tag(sync=True)
    code = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int(400).tag(sync=True)
    label = traitlets.Unicode("3D view").tag(sync=True)
    words = traitlets.Unicode().tag(sync=True)  # the label with what is drawn, where no panels tell it
    beside = traitlets.Bool(False).tag(sync=True)  # JupyterLab shall show it beside the notebook
    panel = traitlets.Unicode().tag(sync=True)  # the model that holds it there
    film = traitlets.Bytes().tag(sync=True)  # what a view at rest plays
    panels = traitlets.Unicode().tag(sync=True)  # what its panels show, as JSON
    snapshot = traitlets.Bytes().tag(sync=True)
    number = traitlets.Int().tag(sync=True)

    def __init__(self, scene: Scene, height: int = 400, label: str = "3D view", **rest: bytes | str) -> None:
        self.scene = scene
        self._saved = -1  # number of the scene in the last state
        self.keeps: object = None  # whatever must live as long as a page shows this
        self.on_views: Callable[[int], None] = lambda count: (
            None
        )  # called with the number of views in all pages
        self.link = PageLink(scene, lambda content, buffers: self.send(content, buffers))
        self.link.on_views = lambda count: self.on_views(count)
        shown = {"name": uuid.uuid4().hex, "code": _shared_code().model_id, "height": height, "label": label}
        super().__init__(**shown, **rest)
        self._panel = SidePanel(self, label)
        self.link.listen("dock", self._dock)
        self.on_msg(lambda _, content, buffers: self.link.receive(content, buffers))
        self.comm.on_close(lambda _: self.close())
        if hasattr(self.comm, "_reply_subshell_for"):
            # ipykernel 7.4 holds a page's messages back while a cell runs, JupyterLab's subshell or not.
            self.comm._reply_subshell_for = lambda data, default: default
        if "JPY_SESSION_NAME" in os.environ:
            # A page is open, but after a restart its messages wait for the running cell's end.
            self.link.expect()
        self._shell = get_ipython()
        if self._shell is not None:
            self._shell.events.register("post_run_cell", self._save)

    def get_state(self, key: Any = None, drop_defaults: bool = False) -> dict[str, Any]:
        """Return the traits, with the scene as it is now: pages ask for them when they load."""
        state: dict[str, Any] = super().get_state(key, drop_defaults)
        if "snapshot" in state or "number" in state:
            state["number"], state["snapshot"] = self.link.snapshot()
            self._saved = state["number"]
        return state

    def flush(self) -> None:
        """Send what has changed now, not with the next batch."""
        self.link.flush()

    def close(self) -> None:
        """Remove the views from all pages and stop following the scene."""
        self.link.close()
        self._panel.close()
        if self._shell is not None:
            self._shell.events.unregister("post_run_cell", self._save)
            self._shell = None
        super().close()

    def _dock(self, order: dict[str, Any]) -> None:
        self.panel = self._panel.take(order)

    def _save(self, _: object) -> None:
        """Save the present scene in a notebook that runs without a page, as by nbconvert."""
        if not self.link.watched and self.link.snapshot()[0] != self._saved:
            self.send_state(["snapshot", "number"])

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        """Return the view, and a picture for pages that run nothing: saved, untrusted, on GitHub."""
        data, metadata = super()._repr_mimebundle_(**kwargs) or ({}, {})
        data["text/plain"] = f"{self.label}: {len(self.scene.objects())} objects"
        if _triangles(self.scene) <= _PICTURE_LIMIT:
            png = zbuffer.draw(self.scene, (_PICTURE_WIDTH, self.height * _PICTURE_WIDTH // 800))
            data["image/png"] = base64.b64encode(png).decode()
        return data, metadata


_code: _Code | None = None


def _shared_code() -> _Code:
    global _code
    if _code is None or _code.comm is None:
        _code = _Code(code=assets.bundle_zipped())
    return _code


def _triangles(scene: Scene) -> int:
    """Estimate how many triangles a picture has."""
    things = scene.objects().values()
    count = sum(len(thing.faces) for thing in things if isinstance(thing, Mesh))
    count += sum(2 * len(thing.points) for thing in things if isinstance(thing, Points))
    solids = [(len(t.placements), 12 if t.shape == "box" else 200) for t in things if isinstance(t, Solids)]
    return count + sum(number * each for number, each in solids)
