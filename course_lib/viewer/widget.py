"""A scene in a notebook cell, connected to the page through the kernel."""

import base64
import os
import threading
import uuid
from collections.abc import Callable
from io import BytesIO
from typing import Any, TypeAlias

import anywidget
import traitlets
from IPython.core.getipython import get_ipython
from ipywidgets import Widget
from PIL import Image, ImageDraw, ImageFont

from course_lib.viewer import html, renderer
from course_lib.viewer.drawables import Mesh, Points, Solids
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene

# Data and metadata by MIME type.
MimeBundle: TypeAlias = tuple[dict[str, Any], dict[str, Any]]


class SidePanel:
    """The panel next to the notebook, which shows one view of the kernel at a time.

    Pages request it, because they know whether they are JupyterLab. Their messages arrive in
    another thread.
    """

    def __init__(self) -> None:
        # Whether the views of the next cells are shown in the panel.
        self.is_enabled = False
        self._lock = threading.RLock()
        # Widgets that were in the panel, or wait for it; the last one is to be shown.
        self._docked: list[SceneWidget] = []
        self._displayed: SceneWidget | None = None
        self._panel: Widget | None = None

    def take(self, widget: "SceneWidget") -> None:
        """Dock a widget that a cell is about to display, if the notebook uses the panel."""
        with self._lock:
            if self.is_enabled:
                self._add(widget)
                if self._panel is not None:
                    self._show(widget)

    def receive(self, widget: "SceneWidget", order: dict[str, Any]) -> None:
        """Execute the order of a page that shows a widget.

        Its action is "open" (a new panel with this widget), "take" (an open panel shows this
        widget), "join" (a panel opens with the last widget, unless there is one), "close", or
        "gone" (the reader has closed the panel with this model).
        """
        action = order.get("action")
        with self._lock:
            if action == "close" or (action == "gone" and order.get("panel") == widget.panel):
                self.close()
            if action == "open":
                self.is_enabled = True
                self._remove_panel()
            if action in ("open", "take") or (action == "join" and not self._docked):
                self._add(widget)
            if action in ("open", "take") or (action == "join" and self._panel is None):
                self._show(self._docked[-1])

    def close(self) -> None:
        """Remove the panel from the page, and show the views in their cells from now on."""
        with self._lock:
            self.is_enabled = False
            for widget in self._docked:
                widget.beside = False
            self._docked.clear()
            self._remove_panel()

    def forget(self, widget: "SceneWidget") -> None:
        """Remove the panel if it shows a widget that is being closed."""
        with self._lock:
            if widget in self._docked:
                self._docked.remove(widget)
            if widget is self._displayed:
                self._remove_panel()

    def _add(self, widget: "SceneWidget") -> None:
        """Make a widget the last one."""
        if widget in self._docked:
            self._docked.remove(widget)
        self._docked.append(widget)
        widget.beside = True

    def _show(self, widget: "SceneWidget") -> None:
        if widget is self._displayed:
            return
        view = {"version_major": 2, "version_minor": 0, "model_id": widget.model_id}
        data = {"application/vnd.jupyter.widget-view+json": view}
        outputs = ({"output_type": "display_data", "data": data, "metadata": {}},)
        if self._displayed is not None:
            self._displayed.panel = ""
        if self._panel is None:
            # Imported here because most kernels never need it.
            from sidecar import Sidecar

            self._panel = Sidecar(title=widget.label, anchor="split-right", outputs=outputs)
        else:
            self._panel.outputs = outputs
        self._displayed = widget
        widget.panel = str(self._panel.model_id)

    def _remove_panel(self) -> None:
        if self._displayed is not None:
            self._displayed.panel = ""
        if self._panel is not None:
            self._panel.close()
        self._displayed = self._panel = None


side_panel = SidePanel()

# Width [px] of the picture for pages without scripts.
_PICTURE_WIDTH = 480
# The same text as in js/link.js.
_CAPTION = "Picture of a 3D view. Run the cells in JupyterLab to bring it to life."
# The maximum number of triangles; more take seconds to draw.
_PICTURE_LIMIT = 200_000


class _Code(anywidget.AnyWidget):
    """The viewer's script, sent once and shared by all widgets of a kernel."""

    _esm = "export default {}"
    code = traitlets.Bytes().tag(sync=True)


class SceneWidget(anywidget.AnyWidget):
    """A widget that shows a scene in any number of cells and pages.

    Args:
        scene: The scene to show.
        height: Height of the view in [px]; its width is that of the cell.
        label: What the view shows, for those who cannot see it.
        rest: The traits `recording`, `plays` and `panels` of a view at rest, and `words`.
    """

    _esm = html.widget_module()
    name = traitlets.Unicode().tag(sync=True)
    code = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int(400).tag(sync=True)
    label = traitlets.Unicode("3D view").tag(sync=True)
    # Label and contents, for a view without panels.
    words = traitlets.Unicode().tag(sync=True)
    # Whether JupyterLab shows this view, or another one of the notebook, in a side panel.
    beside = traitlets.Bool(False).tag(sync=True)
    # Model of the side panel, while it shows this widget.
    panel = traitlets.Unicode().tag(sync=True)
    # Recording of a frozen view.
    recording = traitlets.Bytes().tag(sync=True)
    # Whether the recording plays repeatedly while it is in sight.
    plays = traitlets.Bool(False).tag(sync=True)
    # State of the panels, as JSON.
    panels = traitlets.Unicode().tag(sync=True)
    snapshot = traitlets.Bytes().tag(sync=True)
    number = traitlets.Int().tag(sync=True)

    def __init__(
        self, scene: Scene, height: int = 400, label: str = "3D view", **rest: bytes | str | bool
    ) -> None:
        self.scene = scene
        # Number of the last saved scene.
        self._saved = -1
        # Object that is kept alive while a page shows the widget.
        self.keeps: object = None
        # Called with the number of views in all pages.
        self.on_views: Callable[[int], None] = lambda count: None
        self.link = PageLink(scene, lambda content, buffers: self.send(content, buffers))
        self.link.on_views = lambda count: self.on_views(count)
        global _code
        if _code is None or _code.comm is None:
            _code = _Code(code=html.bundle().zipped)
        traits = {"name": uuid.uuid4().hex, "code": _code.model_id, "height": height, "label": label}
        super().__init__(**traits, **rest)
        self.link.listen("dock", lambda order: side_panel.receive(self, order))
        self.on_msg(lambda _, content, buffers: self.link.receive(content, buffers))
        self.comm.on_close(lambda _: self.close())
        # Pages send messages while a cell runs, which are received in another thread. The comm's
        # own method also triggers IPython's event `post_execute`, after which Matplotlib draws and
        # closes the figure that the cell is still drawing: its picture was white, in part or
        # completely.
        self.comm.handle_msg = self._handle_msg
        if hasattr(self.comm, "_reply_subshell_for"):
            # ipykernel 7.4 delays a page's messages while a cell runs, with or without JupyterLab's
            # subshells.
            self.comm._reply_subshell_for = lambda data, default: default
        if "JPY_SESSION_NAME" in os.environ:
            # A page is open, but after a restart its messages wait for the running cell's end. It
            # will load with the current scene, and gets changes from now on.
            self.link.connect(self.link.number)
        self._shell = get_ipython()
        if self._shell is not None:
            self._shell.events.register("post_run_cell", self._save)

    def get_state(self, key: Any = None, drop_defaults: bool = False) -> dict[str, Any]:
        """Return the traits with the present scene. Pages request them when they load."""
        state: dict[str, Any] = super().get_state(key, drop_defaults)
        if "snapshot" in state or "number" in state:
            state["number"], state["snapshot"] = self.link.snapshot()
            self._saved = state["number"]
        return state

    def flush(self) -> None:
        """Send all changes now, without waiting for the next batch."""
        self.link.flush()

    def close(self) -> None:
        """Remove the views from all pages and stop following the scene."""
        self.link.close()
        side_panel.forget(self)
        if self._shell is not None:
            self._shell.events.unregister("post_run_cell", self._save)
            self._shell = None
        super().close()

    def _save(self, _: object) -> None:
        """Save the present scene in a notebook run without a page, for example by nbconvert."""
        if not self.link.is_watched and self.link.snapshot()[0] != self._saved:
            self.send_state(["snapshot", "number"])

    def _repr_mimebundle_(self, **kwargs: Any) -> MimeBundle:
        """Return the view, and a picture for pages that run no scripts: saved, untrusted, on GitHub."""
        data, metadata = super()._repr_mimebundle_(**kwargs) or ({}, {})
        is_wanted = "image/png" in (kwargs.get("include") or ("image/png",))
        # An estimate of the number of triangles in the picture.
        count = 0
        for drawable in self.scene.objects().values():
            if isinstance(drawable, Mesh):
                count += len(drawable.faces)
            elif isinstance(drawable, Points):
                count += 2 * len(drawable.points)
            elif isinstance(drawable, Solids):
                count += len(drawable.placements) * (12 if drawable.shape == "box" else 200)
        if is_wanted and count <= _PICTURE_LIMIT:
            png = renderer.draw(self.scene, (_PICTURE_WIDTH, self.height * _PICTURE_WIDTH // 800))
            picture = Image.open(BytesIO(png)).convert("RGB")
            # The caption explains how to get the interactive view.
            captioned = Image.new("RGB", (picture.width, picture.height + 20), "white")
            captioned.paste(picture, (0, 0))
            font, place = ImageFont.load_default(12), (4, picture.height + 3)
            ImageDraw.Draw(captioned).text(place, _CAPTION, fill="black", font=font)
            small = BytesIO()
            captioned.quantize(128).save(small, "png", optimize=True)
            data["image/png"] = base64.b64encode(small.getvalue()).decode()
        return with_description((data, metadata), f"{self.label}: {len(self.scene.objects())} objects")


_code: _Code | None = None


def with_description(bundle: MimeBundle, text: str) -> MimeBundle:
    """Return a bundle with this text, which is also the alternative text of its picture."""
    data, metadata = bundle
    return data | {"text/plain": text}, metadata | {"image/png": {"alt": text}}
