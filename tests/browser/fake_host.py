"""Real widgets in Chromium without Jupyter; messages are passed between Python and the page."""

import base64
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from typing import Any

import comm
import numpy as np
from comm.base_comm import BaseComm
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, ConsoleMessage, Page, sync_playwright

from course_lib.viewer.renderer import FLAGS, find_browser
from course_lib.viewer.widget import SceneWidget
from tests.browser.waiting import wait_until

Pixels = NDArray[np.int64]

# The model that anywidget passes to a widget's module: one per comm, with state and messages.
_HOST = """
globalThis.models = {};
globalThis.contexts = [];
const getContext = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  const context = getContext.call(this, kind, ...rest);
  if (kind.startsWith("webgl") && context) contexts.push(context);
  return context;
};
globalThis.toPython = [];
const bytes = (text) => new DataView(Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer);
class Model {
  constructor(id, state) { Object.assign(this, { id, state, handlers: new Map() }); }
  get(name) { return this.state[name]; }
  set(name, value) { this.state[name] = value; }
  on(name, handler) { this.handlers.set(name, handler); }
  off(name) { this.handlers.delete(name); }
  send(content) { if (models[this.id] === this) toPython.push([this.id, content]); }
  widget_manager = { get_model: async (id) => models[id] };
}
globalThis.open_model = async (id, state, paths, buffers) => {
  paths.forEach((path, i) => (state[path[0]] = bytes(buffers[i])));
  const model = (models[id] = new Model(id, state));
  const address = URL.createObjectURL(new Blob([state._esm], { type: "text/javascript" }));
  model.module = (await import(address)).default;
  model.close = model.module.initialize?.({ model });
};
globalThis.tell = (id, content, buffers) =>
  models[id]?.handlers.get("msg:custom")?.(content, buffers.map(bytes));
globalThis.hides = [];
globalThis.show = async (id, width) => {
  const el = document.createElement("div");
  el.style.width = width + "px";
  document.body.append(el);
  hides.push(await models[id].module.render({ model: models[id], el }));
};
globalThis.clear = async () => {
  if (document.fullscreenElement) await document.exitFullscreen();
  hides.splice(0).forEach((hide) => hide?.());
  Object.values(models).forEach((model) => model.close?.());
  document.body.replaceChildren();
  globalThis.models = {};
  toPython.length = 0;
};
"""


class FakeComm(BaseComm):
    """A comm that stores the messages of a widget."""

    sent: list[tuple[str, str, dict[str, Any], list[bytes]]]

    def publish_msg(self, msg_type: str, data: Any = None, *_: Any, buffers: Any = None, **__: Any) -> None:
        self.sent.append((self.comm_id, msg_type, data, [bytes(buffer) for buffer in buffers or []]))


class Host:
    """A page with widgets, which begins as a notebook's page does whose cells were all cleared.

    Args:
        page: The page; the viewer's script and its graphics context may be there from another host.
        monkeypatch: Widgets made from now on are connected with this page.
    """

    def __init__(self, page: Page, monkeypatch: Any) -> None:
        self.page = page
        self.errors: list[str] = []
        self.sent: list[tuple[str, str, dict[str, Any], list[bytes]]] = []
        self._comms: dict[str, FakeComm] = {}
        monkeypatch.setattr(comm, "create_comm", self._create)
        page.on("pageerror", self._hear_error)
        page.on("console", self._hear_console)
        if page.evaluate("'clear' in globalThis"):
            page.evaluate("clear()")
        else:
            self.reload()

    def leave(self) -> None:
        """Clear the page for the next host."""
        self.page.remove_listener("pageerror", self._hear_error)
        self.page.remove_listener("console", self._hear_console)

    def _hear_error(self, error: object) -> None:
        self.errors.append(str(error))

    def _hear_console(self, said: ConsoleMessage) -> None:
        self.errors += [said.text] if said.type == "error" else []

    def _create(self, *args: Any, **kwargs: Any) -> FakeComm:
        FakeComm.sent = self.sent
        made = FakeComm(*args, **kwargs)
        self._comms[made.comm_id] = made
        return made

    def reload(self) -> None:
        """Begin with an empty page; all widgets are opened again from the state that they have now."""
        self.page.goto("about:blank")
        self.page.set_content('<body style="margin:0"></body>')
        self.page.evaluate(f"() => {{ {_HOST} }}")
        self.sent.clear()

    def open(self, widget: SceneWidget) -> None:
        """Request the state of all models, as JupyterLab does on a new page."""
        from ipywidgets.widgets.widget import _instances, _remove_buffers

        for model in (_instances[widget.code], widget):
            state, paths, buffers = _remove_buffers(model.get_state())
            state = {name: value for name, value in state.items() if isinstance(value, str | int)}
            self._call("open_model", model.model_id, state, paths, buffers)
        self.sent.clear()

    def show(self, widget: SceneWidget, width: int = 400) -> None:
        """Show a view of a widget, at the end of the page."""
        self._call("show", widget.model_id, width)
        self.carry()

    def hide(self) -> None:
        """Remove the last view, as a page does with the output of a cell that is run again."""
        self._call("(() => hides.pop()())")
        self.carry()

    def carry(self, frames: int = 2) -> None:
        """Carry all messages both ways, and wait until the page has drawn."""
        while self.sent:
            comm_id, kind, data, buffers = self.sent.pop(0)
            if kind == "comm_msg" and data.get("method") == "custom":
                self._call("tell", comm_id, data["content"], buffers)
        for comm_id, content in self.page.evaluate("toPython.splice(0)"):
            message = {"comm_id": comm_id, "data": {"method": "custom", "content": content}}
            self._comms[comm_id].handle_msg({"content": message, "buffers": []})
        if self.sent:
            self.carry()
        for _ in range(frames):
            self.page.evaluate("() => new Promise(requestAnimationFrame)")

    def wait_until(self, ready: Callable[[], object]) -> None:
        """Carry messages until something is so, however slow the machine is."""

        def is_ready() -> object:
            self.carry()
            return ready()

        wait_until(is_ready, self.page)

    def pixels(self) -> Pixels:
        """Return a screenshot of the page, RGB, shape (rows, columns, 3)."""
        return np.asarray(Image.open(BytesIO(self.page.screenshot())).convert("RGB")).astype(np.int64)

    def _call(self, function: str, *arguments: Any) -> None:
        ready = [
            [base64.b64encode(bytes(part)).decode() for part in argument]
            if isinstance(argument, list) and argument and isinstance(argument[0], bytes | memoryview)
            else argument
            for argument in arguments
        ]
        self.page.evaluate(f"(all) => {function}(...all)", ready)


@contextmanager
def chromium() -> Iterator[Browser]:
    """Run the browser that is installed, without a window."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=find_browser(), args=FLAGS[1:])
        try:
            yield browser
        finally:
            browser.close()


def count(pixels: Pixels, color: tuple[int, int, int], within: int = 60) -> int:
    """Count the pixels of about a colour."""
    return int((np.abs(pixels - color).max(axis=-1) < within).sum())
