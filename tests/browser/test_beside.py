"""The panel beside the notebook, in real JupyterLab."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from tests.browser.jupyterlab import VIEWPORT, Lab, Notebook, opened, red_pixels
from tests.browser.waiting import A_FRAME, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
TAB = ".lm-TabBar-tab:has-text('RViz view')"
ENOUGH = 5000  # [px] of the cube
CELLS = (
    """\
%load_ext course_lib
import rclpy
from rclpy.node import Node
from visualization_msgs.msg import Marker
from course_lib import Viewer, spin_for
rclpy.init()
publisher = Node("talker").create_publisher(Marker, "/cube", 10)
viewer = Viewer()
viewer.add("Marker", "/cube")
cube = Marker(type=Marker.CUBE)
cube.header.frame_id = "map"
cube.scale.x = cube.scale.y = cube.scale.z = 2.0
cube.color.r = cube.color.a = 1.0""",
    "viewer.beside()",
    "publisher.publish(cube)\nspin_for(0.5)\nviewer",
)


@pytest.fixture(scope="module")
def notebook(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "beside.ipynb", CELLS) as notebook:
        notebook.run_all()
        yield notebook


def panel(notebook: Notebook) -> Locator:
    return notebook.page.locator(".jupyterlab-sidecar canvas:visible")


def in_cells(notebook: Notebook) -> Locator:
    return notebook.page.locator(".jp-Notebook canvas:visible")


def test_the_view_docks_and_later_cells_change_it_while_their_own_hold_a_line(notebook: Notebook) -> None:
    expect(panel(notebook)).to_have_count(1)
    wait_until(lambda: red_pixels(panel(notebook)) > ENOUGH, notebook.page, A_FRAME)
    box, sheet = panel(notebook).bounding_box(), notebook.page.locator(".jp-Notebook").bounding_box()
    assert box is not None
    assert sheet is not None
    assert box["x"] >= sheet["x"] + sheet["width"]
    assert box["height"] > 2 / 3 * VIEWPORT["height"]  # it fills the panel
    expect(in_cells(notebook)).to_have_count(0)
    expect(notebook.page.locator(".course-elsewhere:visible")).to_have_count(2)
    active = notebook.page.evaluate("document.activeElement.closest('.jp-Notebook') !== null")
    assert active, "the next Shift+Enter would not run a cell"
    assert notebook.errors() == []
    docked = notebook.page.locator(".jupyterlab-sidecar")
    for name in ("Displays panel", "Views panel"):
        docked.get_by_role("button", name=name).click()
    left = panel(notebook).bounding_box()
    assert left is not None
    assert left["height"] > box["height"] / 2
    if PICTURES:
        notebook.page.screenshot(path=Path(PICTURES) / "beside.png")


def test_buttons_move_the_view_into_its_cells_and_back(notebook: Notebook) -> None:
    notebook.page.get_by_role("button", name="Show the view in this cell again").first.click()
    expect(panel(notebook)).to_have_count(0)
    expect(in_cells(notebook)).to_have_count(2)
    wait_until(lambda: red_pixels(in_cells(notebook).first) > ENOUGH, notebook.page, A_FRAME)
    notebook.page.get_by_role("button", name="Beside the notebook").first.click()
    expect(panel(notebook)).to_have_count(1)
    notebook.page.locator(f"{TAB} .lm-TabBar-tabCloseIcon").click()
    expect(in_cells(notebook)).to_have_count(2)


def test_after_a_restart_the_panel_goes_and_running_again_opens_one(notebook: Notebook) -> None:
    notebook.page.get_by_role("button", name="Beside the notebook").first.click()
    expect(panel(notebook)).to_have_count(1)
    notebook.cell(0)
    notebook.page.evaluate(
        """async () => { const all = [...jupyterapp.shell.widgets('main')];
        await all.find((one) => one.context).context.sessionContext.restartKernel(); }"""
    )
    expect(panel(notebook)).to_have_count(0)
    expect(in_cells(notebook)).to_have_count(2)
