"""The panel next to the notebook, in real JupyterLab."""

import os
from base64 import b64decode
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Locator, expect

from tests.browser.jupyterlab import (
    VIEWPORT,
    Lab,
    Notebook,
    count_pixels,
    opened,
    red_pixels,
    view_of,
    write_notebook,
)
from tests.browser.waiting import A_FRAME, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
TAB = ".lm-TabBar-tab:has-text('RViz: ')"
ENOUGH = 5000  # [px] of the cube
FILE_BROWSER = ".jp-FileBrowser"
READABLE = 79  # columns of code
NARROWEST = 400  # [px]
WHITE = (255, 255, 255)
OTHER = """\
other = Viewer()
other"""
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


def ask_for_view_beside(notebook: Notebook) -> None:
    """Open the panel with the first viewer, unless it is open."""
    notebook.cell("publisher.publish")
    opener = notebook.page.get_by_role("button", name="Beside the notebook", exact=True)
    # Neither is visible while the panel opens.
    panel(notebook).or_(opener).first.wait_for()
    if not panel(notebook).count():
        opener.first.click()
    expect(panel(notebook)).to_have_count(1)


def columns(notebook: Notebook) -> float:
    """Return the number of columns of code that the notebook shows."""
    script = """() => {
        const code = courseNotebook().node.querySelector(".cm-content");
        const pen = document.createElement("canvas").getContext("2d");
        pen.font = getComputedStyle(code).font;
        return code.closest(".cm-scroller").clientWidth / pen.measureText("0").width; }"""
    return float(notebook.page.evaluate(script))


def in_cells(notebook: Notebook) -> Locator:
    return notebook.page.locator(".jp-Notebook canvas:visible")


def test_view_is_docked_and_later_cells_show_one_line_instead_of_it(notebook: Notebook) -> None:
    expect(panel(notebook)).to_have_count(1)
    wait_until(lambda: columns(notebook) >= READABLE, notebook.page)
    wait_until(lambda: red_pixels(panel(notebook)) > ENOUGH, notebook.page, A_FRAME)
    box, sheet = panel(notebook).bounding_box(), notebook.page.locator(".jp-Notebook").bounding_box()
    assert box is not None
    assert sheet is not None
    assert box["x"] >= sheet["x"] + sheet["width"]
    assert box["height"] > 2 / 3 * VIEWPORT["height"]  # it fills the panel
    expect(in_cells(notebook)).to_have_count(0)
    expect(notebook.page.locator(".course-elsewhere:visible")).to_have_count(2)
    for cell in (1, 2):
        assert red_pixels(view_of(notebook.cell(cell))) > ENOUGH
    active = notebook.page.evaluate("document.activeElement.closest('.jp-Notebook') !== null")
    assert active, "the next Shift+Enter would not run a cell"
    assert notebook.errors() == []
    docked = notebook.page.locator(".jupyterlab-sidecar")
    docked.get_by_role("button", name="Displays panel").click()
    # The options, the status and the first display: with 18 % of the height, four rows were visible.
    rows = docked.get_by_role("row").evaluate_all("""rows => { const dock = rows[0].closest(".course-dock");
        const end = dock.getBoundingClientRect().bottom;
        return rows.filter((row) => row.getBoundingClientRect().bottom <= end).length; }""")
    assert rows >= 7
    docked.get_by_role("button", name="Views panel").click()
    left = panel(notebook).bounding_box()
    assert left is not None
    assert left["height"] > box["height"] / 2
    if PICTURES:
        notebook.page.screenshot(path=Path(PICTURES) / "beside.png")


def test_cells_keep_the_picture_of_a_view_beside_the_notebook(notebook: Notebook) -> None:
    script = """() => [...document.querySelectorAll(".jp-Notebook .course-keeps")]
        .map((element) => element.courseKeeps()?.["image/png"] ?? "")"""
    wait_until(lambda: red_pixels(panel(notebook)) > ENOUGH, notebook.page, A_FRAME)
    for content in notebook.page.evaluate(script):
        image = Image.open(BytesIO(b64decode(content))).convert("RGB")
        assert image.getpixel((image.width - 1, 0)) != WHITE, "the view is narrower than its picture"
    # A coarse picture may still be replaced once. Then nothing has changed since the last one.
    wait_until(lambda: notebook.page.evaluate(script) == ["", ""], notebook.page)


def test_buttons_move_the_view_between_its_cells_and_the_side_panel(notebook: Notebook) -> None:
    notebook.page.get_by_role("button", name="Show the view in this cell again").first.click()
    expect(panel(notebook)).to_have_count(0)
    expect(in_cells(notebook)).to_have_count(2)
    wait_until(lambda: red_pixels(in_cells(notebook).first) > ENOUGH, notebook.page, A_FRAME)
    notebook.page.get_by_role("button", name="Beside the notebook", exact=True).first.click()
    expect(panel(notebook)).to_have_count(1)
    notebook.page.locator(f"{TAB} .lm-TabBar-tabCloseIcon").click()
    expect(in_cells(notebook)).to_have_count(2)


def test_wheel_zooms_the_view_beside_the_notebook_without_a_click(notebook: Notebook) -> None:
    ask_for_view_beside(notebook)
    distance = "print(viewer.view['Distance'])"
    before = float(notebook.kernel(distance))
    notebook.cell("publisher.publish")  # the notebook has the focus
    panel(notebook).hover()
    notebook.page.mouse.wheel(0, 100)
    wait_until(lambda: float(notebook.kernel(distance)) > before, notebook.page)
    notebook.page.mouse.wheel(0, -100)


def test_code_beside_a_view_is_readable_and_the_view_is_wide_enough(notebook: Notebook) -> None:
    ask_for_view_beside(notebook)
    wait_until(lambda: columns(notebook) >= READABLE, notebook.page)
    box = panel(notebook).bounding_box()
    assert box is not None
    assert box["width"] >= NARROWEST
    assert not notebook.page.locator(FILE_BROWSER).is_visible(), "both need its place in this window"


def test_text_outputs_break_their_lines_between_words(notebook: Notebook) -> None:
    ask_for_view_beside(notebook)
    text = notebook.run_below("print('callbacks ' * 50)").locator(".jp-RenderedText pre")
    script = """pre => [...pre.textContent.matchAll(/\\S+/g)].filter(word => {
        const range = document.createRange();
        range.setStart(pre.firstChild, word.index);
        range.setEnd(pre.firstChild, word.index + word[0].length);
        return range.getClientRects().length > 1; }).length"""
    assert text.evaluate("pre => pre.clientHeight / parseFloat(getComputedStyle(pre).lineHeight)") > 3
    assert text.evaluate(script) == 0
    notebook.page.keyboard.press("Escape")
    notebook.ask("() => jupyterapp.commands.execute('notebook:delete-cell')")


def test_next_viewer_takes_the_panel_and_the_first_one_takes_it_back(notebook: Notebook) -> None:
    ask_for_view_beside(notebook)
    notebook.cell("publisher.publish")
    cell = notebook.run_below(OTHER)
    expect(panel(notebook)).to_have_count(1)
    cell.get_by_text("The view is beside the notebook.").wait_for()
    wait_until(lambda: red_pixels(panel(notebook)) < ENOUGH, notebook.page, A_FRAME)
    first = notebook.cell("publisher.publish")
    first.get_by_text("Another view is beside the notebook.").wait_for()
    first.get_by_role("button", name="Show this view beside the notebook").click()
    wait_until(lambda: red_pixels(panel(notebook)) > ENOUGH, notebook.page, A_FRAME)
    expect(panel(notebook)).to_have_count(1)
    assert notebook.errors() == []


def test_closed_panel_restores_the_file_browser_and_later_views_stay_in_cells(
    notebook: Notebook,
) -> None:
    ask_for_view_beside(notebook)
    notebook.page.locator(f"{TAB} .lm-TabBar-tabCloseIcon").click()
    notebook.page.locator(FILE_BROWSER).wait_for()
    expect(panel(notebook)).to_have_count(0)
    notebook.cell("publisher.publish")
    cell = notebook.run_below("viewer")
    expect(cell.locator("canvas:visible")).to_have_count(1)
    assert notebook.errors() == []


@pytest.mark.parametrize("reason", ["narrow window", "simple mode"])
def test_view_stays_in_its_cell_without_room_for_a_panel(notebook: Notebook, reason: str) -> None:
    notebook.kernel("from course_lib.viewer.widget import side_panel; side_panel.close()")
    expect(panel(notebook)).to_have_count(0)
    if reason == "narrow window":
        notebook.page.set_viewport_size({"width": 1100, "height": 700})
    else:
        notebook.page.evaluate("jupyterapp.commands.execute('application:toggle-mode')")
    notebook.cell("publisher.publish")
    cell = notebook.run_below("viewer.beside()")
    expect(cell.locator("canvas:visible")).to_have_count(1)
    notebook.page.wait_for_timeout(1000)
    expect(panel(notebook)).to_have_count(0)
    assert notebook.errors() == []
    notebook.kernel("from course_lib.viewer.widget import side_panel; side_panel.close()")
    notebook.page.set_viewport_size(VIEWPORT)
    if reason == "simple mode":
        notebook.page.evaluate("jupyterapp.commands.execute('application:toggle-mode')")


def test_closed_viewer_leaves_its_last_picture_in_its_cell(notebook: Notebook) -> None:
    ask_for_view_beside(notebook)
    notebook.cell("publisher.publish")
    notebook.run_below(OTHER)
    grid = "Math.min(r, g, b) > 100"
    wait_until(lambda: count_pixels(panel(notebook), grid) > 100, notebook.page, A_FRAME)
    notebook.run_below("other.close()")
    cell = notebook.cell(OTHER)
    cell.get_by_text("The view was closed.").wait_for()
    expect(cell.locator("img")).to_be_visible()
    assert notebook.errors() == []


def test_kernel_restart_closes_the_side_panel_and_a_rerun_opens_it(notebook: Notebook) -> None:
    ask_for_view_beside(notebook)
    notebook.cell(0)
    notebook.page.evaluate(
        """async () => { const all = [...jupyterapp.shell.widgets('main')];
        await all.find((one) => one.context).context.sessionContext.restartKernel(); }"""
    )
    expect(panel(notebook)).to_have_count(0)
    expect(notebook.page.locator(".course-elsewhere:visible")).to_have_count(0)
    in_cells(notebook).first.wait_for()


def test_run_all_cells_opens_the_panel_though_no_view_is_in_sight(lab: Lab) -> None:
    far_away = ["# JupyterLab skips the cells that are far out of sight." + "\n" * 30] * 70
    with opened(lab, "beside_far.ipynb", [*CELLS, *far_away]) as notebook:
        notebook.run_all()
        expect(panel(notebook)).to_have_count(1)
        wait_until(lambda: red_pixels(panel(notebook)) > ENOUGH, notebook.page, A_FRAME)


def test_panels_of_two_notebooks_are_tabs_that_follow_them_and_code_stays_readable(lab: Lab) -> None:
    with opened(lab, "beside_two.ipynb", CELLS) as notebook:
        notebook.run_all()
        wait_until(lambda: red_pixels(panel(notebook)) > ENOUGH, notebook.page, A_FRAME)
        write_notebook(notebook.folder / "blue.ipynb", [cell.replace("color.r", "color.b") for cell in CELLS])
        script = """async path => {
            const opened = await jupyterapp.commands.execute('docmanager:open', { path });
            await opened.context.ready; }"""
        notebook.ask(script, f"{notebook.folder.name}/blue.ipynb")
        notebook.wait_idle()
        # A notebook without a view has the whole width.
        wait_until(lambda: panel(notebook).count() == 0, notebook.page)
        notebook.page.locator(".lm-TabBar-tab:has-text('beside_two.ipynb')").click()
        wait_until(lambda: panel(notebook).count() == 1, notebook.page)
        notebook.page.locator(".lm-TabBar-tab:has-text('blue.ipynb')").click()
        wait_until(lambda: panel(notebook).count() == 0, notebook.page)
        notebook.run_all()
        tab = notebook.page.locator(TAB)
        expect(tab).to_have_text(["RViz: beside_two", "RViz: blue"])
        wait_until(lambda: panel(notebook).count() == 1, notebook.page)
        wait_until(lambda: red_pixels(panel(notebook)) == 0, notebook.page, A_FRAME)
        wait_until(lambda: columns(notebook) >= READABLE, notebook.page)
        notebook.page.locator(".lm-TabBar-tab:has-text('beside_two.ipynb')").click()
        wait_until(lambda: panel(notebook).count() == 1, notebook.page)
        wait_until(lambda: red_pixels(panel(notebook)) > ENOUGH, notebook.page, A_FRAME)
        assert columns(notebook) >= READABLE
        # The file browser returns with the last panel.
        for remaining in (1, 0):
            assert not notebook.page.locator(FILE_BROWSER).is_visible()
            tab.first.locator(".lm-TabBar-tabCloseIcon").click()
            expect(tab).to_have_count(remaining)
        notebook.page.locator(FILE_BROWSER).wait_for()


WIDTHS = """() => [...jupyterapp.shell.widgets('main')].filter((one) => one.context)
    .map((one) => one.node.offsetWidth)"""


@pytest.mark.parametrize("neighbor", [0, 1], ids=["right of the notebook", "right of its view"])
def test_view_of_a_second_notebook_leaves_both_the_width_that_they_had(lab: Lab, neighbor: int) -> None:
    with opened(lab, "left.ipynb", CELLS) as notebook:
        notebook.run_all()
        expect(panel(notebook)).to_have_count(1)
        write_notebook(notebook.folder / "right.ipynb", CELLS)
        script = """async ([path, neighbor]) => {
            const options = { mode: 'split-right', ref: [...jupyterapp.shell.widgets('main')][neighbor].id };
            const opened = await jupyterapp.commands.execute('docmanager:open', { path, options });
            await opened.context.ready;
            await opened.sessionContext.ready; }"""
        notebook.ask(script, [f"{notebook.folder.name}/right.ipynb", neighbor])
        notebook.page.wait_for_timeout(1000)  # [ms]; some frames
        before = notebook.page.evaluate(WIDTHS)
        notebook.ask("() => jupyterapp.commands.execute('runmenu:run-all')")
        expect(notebook.page.locator(TAB)).to_have_text(["RViz: left", "RViz: right"])
        expect(panel(notebook)).to_have_count(1)
        is_kept = pytest.approx(before, abs=9)  # [px] of handles
        wait_until(lambda: notebook.page.evaluate(WIDTHS) == is_kept, notebook.page)
