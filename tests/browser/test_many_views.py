"""Many views in real JupyterLab: twenty on a page, two tabs, a restart, hands while a node runs live."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.browser.jupyterlab import Lab, Notebook, write_notebook
from tests.browser.waiting import A_FRAME, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
MANY, ENOUGH = 20, 50  # views; [px] of the box in each
ENDED = "The kernel of this view has ended."
PAINT_BLUE = "for w in widgets: w.scene.set_object('box', Solids('box', [np.eye(4)], (0, 0, 1, 1)))"
CELLS = (
    """\
%load_ext course_lib
import numpy as np
from course_lib.viewer.drawables import Solids
from course_lib.viewer.scene import Scene
from course_lib.viewer.widget import SceneWidget
def shown(color):
    scene = Scene()
    scene.set_object("box", Solids("box", [np.eye(4)], color))
    return SceneWidget(scene, height=110)
widgets = [shown((1, 0, 0, 1)) for _ in range(20)]""",
    "for widget in widgets: display(widget)",
    """\
import ipywidgets, rclpy
from rclpy.node import Node
from course_lib import run_live
rclpy.init()
class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.count, self.heard = 0, []
        self.create_timer(0.02, self.tick)
    def tick(self):
        self.count += 1
node = Counter()
live = run_live(node)""",
    """\
slider = ipywidgets.IntSlider(description="speed")
slider.observe(lambda change: node.heard.append((change["new"], node.count)), "value")
widgets[0].link.on_click.append(lambda click: node.heard.append((click.path, node.count)))
display(slider, widgets[0])""",
)
_CONTEXTS = """
globalThis.lost = 0;
const getContext = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (...all) {
  this.addEventListener("webglcontextlost", () => lost++, { once: true });
  return getContext.apply(this, all);
};"""
# In each view, the pixels that have nothing but one of red, green and blue.
_COUNT = """(views, color) => views.map((view) => {
    const pixels = view.getContext("2d").getImageData(0, 0, view.width, view.height).data;
    let count = 0;
    for (let at = 0; at < pixels.length; at += 4)
        count += [0, 1, 2].every((i) => i === color ? pixels[at + i] > 90 : pixels[at + i] < 60);
    return count; })"""


def open_page(lab: Lab, folder: Path) -> Notebook:
    # JupyterLab draws visible cells only
    page = lab.new_page(viewport={"width": 1000, "height": 3000})
    page.add_init_script(_CONTEXTS)
    return Notebook(page, lab.address, folder, "many.ipynb")


@pytest.fixture(scope="module")
def notebook(lab: Lab) -> Iterator[Notebook]:
    folder = lab.student_folder("many_views")
    write_notebook(folder / "many.ipynb", CELLS)
    notebook = open_page(lab, folder)
    notebook.run_all()
    yield notebook
    notebook.end()
    notebook.page.close()


def are_all(notebook: Notebook, color: int) -> bool:
    """Return whether all views show a box of a colour: 0 red, 1 green, 2 blue."""
    cell = notebook.cell("for widget in")
    counts = cell.locator("canvas").evaluate_all(_COUNT, color)
    return len(counts) == MANY and min(counts) > ENOUGH


def count_heard(notebook: Notebook) -> int:
    return int(notebook.kernel("print(len(node.heard))"))


def test_twenty_views_are_drawn_without_losing_a_webgl_context(notebook: Notebook) -> None:
    wait_until(lambda: are_all(notebook, 0), notebook.page, A_FRAME)
    assert notebook.page.evaluate("lost") == 0
    assert notebook.errors() == []


def test_click_and_slider_reach_python_while_a_node_runs_live(notebook: Notebook) -> None:
    cell = notebook.cell("slider =")
    canvas = cell.locator("canvas")
    wait_until(lambda: min(canvas.evaluate_all(_COUNT, 0), default=0) > ENOUGH, notebook.page)
    canvas.first.click()
    handle = cell.locator(".noUi-handle")
    # One by one: ipywidgets merges the changes that a busy kernel has not yet taken.
    for count in range(1, 5):
        wait_until(lambda count=count: count_heard(notebook) == count, notebook.page)  # type: ignore[misc]  # mypy knows no default there
        if count < 4:
            handle.press("ArrowRight")
    kinds = notebook.kernel("print([what for what, _ in node.heard])")
    assert kinds.strip() == "['box', 1, 2, 3]"
    assert notebook.kernel("print(node.heard[0][1] < node.heard[-1][1] < node.count)").strip() == "True"


def test_second_and_reloaded_tabs_show_the_scene_of_the_first_tab(notebook: Notebook, lab: Lab) -> None:
    notebook.page.evaluate("jupyterapp.commands.execute('docmanager:save')")
    second = open_page(lab, notebook.folder)
    wait_until(lambda: are_all(second, 0), second.page, A_FRAME)
    notebook.kernel(PAINT_BLUE)
    for one in (notebook, second):
        wait_until(lambda one=one: are_all(one, 2), one.page, A_FRAME)  # type: ignore[misc]  # mypy knows no default there
    notebook.open()
    wait_until(lambda: are_all(notebook, 2), notebook.page, A_FRAME)
    assert second.page.evaluate("lost") == notebook.page.evaluate("lost") == 0
    second.page.close()


def test_kernel_restart_keeps_the_images_and_a_rerun_draws_new_views(notebook: Notebook) -> None:
    notebook.kernel(PAINT_BLUE)
    wait_until(lambda: are_all(notebook, 2), notebook.page, A_FRAME)
    notebook.page.evaluate("courseNotebook().context.sessionContext.session.kernel.restart()")
    notebook.wait_idle()
    assert are_all(notebook, 2)
    notebook.page.get_by_text(ENDED).first.wait_for()
    notebook.run_all()
    wait_until(lambda: are_all(notebook, 0), notebook.page, A_FRAME)
    expect(notebook.page.get_by_text(ENDED)).to_have_count(0)
    assert notebook.errors() == []


def test_views_report_a_killed_kernel_but_not_a_busy_one(
    notebook: Notebook,
) -> None:
    notebook.kernel("import time; time.sleep(2)")
    expect(notebook.page.get_by_text(ENDED)).to_have_count(0)
    kill = "session.kernel.requestExecute({ code: 'import os; os.kill(os.getpid(), 9)' }).done.catch(() => 0)"
    notebook.page.evaluate(f"() => void courseNotebook().context.sessionContext.{kill}")
    notebook.page.get_by_text(ENDED).first.wait_for()
    notebook.page.get_by_role("dialog").get_by_role("button", name="Ok").click()
