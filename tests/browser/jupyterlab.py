"""Drives the real JupyterLab in a real Chromium, as a student would."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, BrowserContext, Locator, Page, ViewportSize

from course_lib.course.student_folder import prepare
from tests.patience import PATIENCE
from tests.processes import LIMIT_OF_A_SESSION, Program

ANSWER = 3 * PATIENCE  # [s]; cells may run for long on a busy machine
KERNEL = "courseNotebook()?.context?.sessionContext?.session?.kernel"
# The notebook of the front tab. It is not JupyterLab's current widget after a click into the view
# beside it. Nor is it always visible: JupyterLab hides its whole window for a frame after a change
# of theme, but no tab.
FIND_NOTEBOOK = """globalThis.courseNotebook = () => [...jupyterapp.shell.widgets('main')]
    .find((one) => one.context?.sessionContext && !one.isHidden);"""
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
VIEWPORT: ViewportSize = {"width": 1280, "height": 900 if PICTURES else 720}  # [px]
# Software draws the views here: a screen of three frames a second, and edges that are not smooth,
# are enough. A frame is at least half an interval away: if the next one were always used, views
# would be drawn soon after some changes, and Python sends batches as often as the fastest picture.
SLOW_SCREEN = """{
    window.courseRestScale = 1;
    const everyFrame = window.requestAnimationFrame, interval = 330;  // [ms]
    window.requestAnimationFrame = (draw) =>
        setTimeout(() => everyFrame(draw), 1.5 * interval - (performance.now() + interval / 2) % interval);
    window.cancelAnimationFrame = clearTimeout;  // a frame that has begun is drawn
    const getContext = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, options) {
        return getContext.call(this, kind, kind === "2d" ? options : { ...options, antialias: false }); };
}"""


def slow_down(pages: Page | BrowserContext) -> None:
    """Draw little in pages that will be loaded, unless they are for pictures."""
    if not PICTURES:
        pages.add_init_script(SLOW_SCREEN)


@contextmanager
def course_lab(folder: Path, home: Path) -> Iterator[str]:
    """Run `course lab` on a folder with the settings in `home`. Yield the printed address."""
    dirs = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")
    settings = ("JUPYTERLAB_SETTINGS_DIR", "JUPYTERLAB_WORKSPACES_DIR")
    environment = os.environ | {name: str(home / name.lower()) for name in (*dirs, *settings)}
    config = Path(environment["JUPYTER_CONFIG_DIR"]) / "jupyter_lab_config.json"
    config.parent.mkdir(parents=True)
    config.write_text(json.dumps({"LabApp": {"expose_app_in_browser": True}}))
    command = [sys.executable, "-m", "course_lib", "lab", str(folder), "--no-browser"]
    with Program(command, limit=LIMIT_OF_A_SESSION, env=environment, stdout=subprocess.PIPE) as process:
        try:
            yield process.find(r"http://\S+")
        finally:
            process.terminate()
            process.wait(PATIENCE)


def write_notebook(path: Path, sources: Sequence[str]) -> None:
    """Write a notebook of code cells that were not run."""
    empty: dict[str, object] = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None}
    cells = [{**empty, "id": f"cell-{number}", "source": source} for number, source in enumerate(sources)]
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    content = {"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}
    path.write_text(json.dumps(content))


class Notebook:
    """One notebook, open in JupyterLab.

    Args:
        page: The browser's page, with a time out for busy machines; where it shows JupyterLab
            already, the notebook takes the place of what is open there: to load the page costs
            seconds.
        address: The server's address, as `course lab` prints it.
        folder: The student's folder, a folder of the server's root.
        name: The notebook's path in the student's folder.
    """

    def __init__(self, page: Page, address: str, folder: Path, name: str) -> None:
        self.page, self.folder, self.name = page, folder, name
        base, _, query = address.partition("?")
        # A separate workspace, so that documents opened by other tests stay closed.
        workspace = f"{base.split('/lab')[0]}/lab/workspaces/{folder.name}"
        self._url = f"{workspace}/tree/{folder.name}/{name}?{query}"
        if page.url == "about:blank":
            page.add_init_script(FIND_NOTEBOOK)
            self.open()
        else:
            self.leave_for(name)

    def ask(self, script: str, argument: object = None) -> Any:
        """Return the result of a function of the page. Playwright has no timeout for this."""
        late = f"reject(new Error('The page did not answer within {ANSWER:g} s'))"
        limit = f"new Promise((_, reject) => setTimeout(() => {late}, {1000 * ANSWER:g}))"
        return self.page.evaluate(f"argument => Promise.race([({script})(argument), {limit}])", argument)

    def open(self) -> None:
        """Open the notebook, or reload the page, and wait for its kernel."""
        self.page.goto(self._url)
        self.page.wait_for_selector(".jp-Notebook .jp-Cell")
        self.wait_idle()

    def leave_for(self, name: str) -> None:
        """Shut down the kernels and open another notebook in the same tab."""
        self.end()
        script = """async path => {
            const opened = await jupyterapp.commands.execute('docmanager:open', { path });
            for (const other of [...jupyterapp.shell.widgets('main')])
                if (other !== opened) other.dispose();  // JupyterLab's launcher
            await opened.context.ready; }"""
        self.ask(script, f"{self.folder.name}/{name}")
        self.name = name
        self.page.wait_for_selector(".jp-Notebook .jp-Cell")
        self.wait_idle()

    def end(self) -> None:
        """End all kernels of the server, and close all that is open in the page."""
        script = """async () => {
            await jupyterapp.serviceManager.sessions.shutdownAll();
            for (const one of [...jupyterapp.shell.widgets('main')]) one.dispose(); }"""
        self.ask(script)

    def wait_idle(self) -> None:
        """Wait until the kernel has nothing to do."""
        self.page.wait_for_function(f"() => window.jupyterapp && {KERNEL}?.status == 'idle'")

    def run_all(self) -> None:
        """Run all cells as the Run menu does."""
        self._run("runmenu:run-all")

    def run_rest(self) -> None:
        """Run the active cell and all cells below, as the Run menu does; those above were run."""
        self._run("notebook:run-all-below")

    def _run(self, command: str) -> None:
        """Run a command, and wait until all code cells were run."""
        self.ask("command => jupyterapp.commands.execute(command)", command)
        self.wait_idle()
        all_ran = """() => [...courseNotebook().content.model.cells]
            .every(cell => cell.type != 'code' || cell.executionCount !== null)"""
        self.page.wait_for_function(all_ran)

    def run_to_each(self, *endings: str, restart_before: str) -> Iterator[Locator]:
        """Run the code cells one after the other, and yield each finished cell.

        Only these are brought into view: all editors of a notebook measure themselves whenever it
        scrolls.

        Args:
            endings: The last lines of cells to yield.
            restart_before: The id of a cell. The kernel is restarted before it is run.
        """
        script = """async ([index, endings, place]) => {
            const { content, sessionContext } = courseNotebook();
            await content.scrollToItem(content.widgets.length - 1, 'end');  // no view is drawn there
            for (const cell of content.widgets.slice(index)) {
                if (cell.model.id == place) await sessionContext.session.kernel.restart();
                if (cell.model.type == 'code') await cell.constructor.execute(cell, sessionContext);
                index++;
                const lastLine = cell.model.sharedModel.getSource().split('\\n').pop();
                if (endings.includes(lastLine)) return index; } }"""
        index = 0
        while index := self.ask(script, [index, endings, restart_before]):
            yield self.cell(index - 1)

    def run_to(self, text: str) -> Locator:
        """Run all cells up to and including the first one whose source contains `text`."""
        cell = self.cell(text)
        for command in ("notebook:run-all-above", "notebook:run-cell"):
            self.ask("command => jupyterapp.commands.execute(command)", command)
        self.wait_idle()
        return cell

    def run_below(self, source: str) -> Locator:
        """Insert a cell below the active one, and run it."""
        script = """async source => {
            await jupyterapp.commands.execute('notebook:insert-cell-below');
            const cell = courseNotebook().content.activeCell;
            cell.model.sharedModel.setSource(source);
            await jupyterapp.commands.execute('notebook:run-cell'); }"""
        self.ask(script, source)
        self.wait_idle()
        return self.page.locator(".jp-Notebook .jp-Cell.jp-mod-active")

    def kernel(self, code: str) -> str:
        """Run code in the notebook's kernel, outside its cells. Return its output; it must raise no error."""
        script = """async code => {
            const kernel = courseNotebook().context.sessionContext.session.kernel;
            const future = kernel.requestExecute({ code, store_history: false });
            let text = '', error = null;
            future.onIOPub = ({ content }) => {
                text += content.text ?? '';
                error = content.traceback?.join('\\n') ?? error; };
            const { content } = await future.done;
            return [text, content.status == 'ok' ? null : error ?? content.status]; }"""
        text, error = self.ask(script, code)
        assert error is None, f"{code}\n{error}"
        return str(text)

    def outputs(self) -> list[dict[str, Any]]:
        """List the outputs of all code cells."""
        script = """() => JSON.stringify([...courseNotebook().content.model.cells]
            .filter(c => c.type == 'code').flatMap(c => c.toJSON().outputs))"""
        outputs: list[dict[str, Any]] = json.loads(self.ask(script))
        return outputs

    def errors(self) -> list[str]:
        """List the error outputs."""
        return [f"{o['ename']}: {o['evalue']}" for o in self.outputs() if o["output_type"] == "error"]

    def cell(self, wanted: str | int) -> Locator:
        """Scroll to a cell: the first code cell whose source contains a string, or the cell at an index."""
        script = """wanted => { const panel = courseNotebook().content;
            jupyterapp.shell.activateById(courseNotebook().id);
            panel.activeCellIndex = Number.isInteger(wanted) ? wanted : panel.widgets.findIndex(
                w => w.model.type == 'code' && w.model.sharedModel.getSource().includes(wanted));
            return panel.scrollToItem(panel.activeCellIndex, 'start') }"""
        self.ask(script, wanted)
        return self.page.locator(".jp-Notebook .jp-Cell.jp-mod-active")


@dataclass(frozen=True)
class Lab:
    """A JupyterLab and a browser, shared by all test files; each test file has its own folder.

    Args:
        folder: The root of the server.
        address: The server's address, as `course lab` prints it.
    """

    browser: Browser
    folder: Path
    address: str

    def student_folder(self, name: str) -> Path:
        """Return a new folder below the root, with the lessons and exercises in it."""
        folder = self.folder / name
        prepare(folder)
        return folder

    @cached_property
    def page(self) -> Page:
        """The page that shows one file's notebook after the other's."""
        return self.new_page(viewport=VIEWPORT)

    def new_page(self, **settings: Any) -> Page:
        """Return a page with a time out for busy machines."""
        page = self.browser.new_page(**settings)
        slow_down(page)
        page.set_default_timeout(PATIENCE * 1000)
        return page


@contextmanager
def opened(lab: Lab, name: str, cells: Sequence[str] = ()) -> Iterator[Notebook]:
    """Open a notebook in a new student's folder; it may be one of other cells. End its kernels afterwards."""
    folder = lab.student_folder(f"{Path(name).stem}_{len(list(lab.folder.iterdir()))}")
    if cells:
        write_notebook(folder / name, cells)
    notebook = Notebook(lab.page, lab.address, folder, name)
    yield notebook
    notebook.end()


def place_of_view(cell: Locator) -> Locator:
    """Return the element that contains the view of a cell: the cell, or the panel next to the notebook."""
    shown = cell.locator("canvas:visible, .course-elsewhere:visible").first
    shown.wait_for()
    is_here = shown.evaluate("shown => shown.tagName == 'CANVAS'")
    return cell if is_here else cell.page.locator(".jupyterlab-sidecar:has(canvas:visible)").first


def view_of(cell: Locator) -> Locator:
    """Return the first view of a cell, wherever it is shown."""
    return place_of_view(cell).locator("canvas:visible").first


# In the page: a screenshot takes seconds while nodes run live, and a PNG file five times as long as
# this.
COUNT = """canvas => {
    const { width, height } = canvas;
    if (!width || !height) return 0;
    const all = canvas.getContext("2d").getImageData(0, 0, width, height).data;
    let count = 0;
    for (let i = 0; i < all.length; i += 4) {
        const r = all[i], g = all[i + 1], b = all[i + 2];
        if (CONDITION) count++; }
    return count; }"""


def count_pixels(view: Locator, condition: str) -> int:
    """Count the pixels of a view that meet a JavaScript condition on `r`, `g` and `b`, values 0..255."""
    return int(view.evaluate(COUNT.replace("CONDITION", condition)))


def red_pixels(view: Locator) -> int:
    """Count the pixels of a view that are clearly red."""
    return count_pixels(view, "r > 90 && g < 60 && b < 60")
