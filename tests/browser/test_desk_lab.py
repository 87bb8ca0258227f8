"""RViz's panels in real JupyterLab, while nodes run live."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import expect

from tests.browser.jupyterlab import Lab, Notebook, opened
from tests.browser.waiting import wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
LIVE, SHOW = "live = run_live(node)", "viewer.add("
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
HEAR = """
from geometry_msgs.msg import PointStamped, PoseStamped
heard, clicks = [], []
for kind, topic in ((PointStamped, "/clicked_point"), (PoseStamped, "/goal_pose")):
    node.create_subscription(kind, topic, heard.append, 5)
_ = viewer.on_click(clicks.append)
"""


@pytest.fixture(scope="module")
def lesson(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "week01_first_marker.ipynb") as notebook:
        notebook.run_to(LIVE)
        notebook.kernel(HEAR)
        yield notebook


def test_tools_publish_to_nodes_that_run_live(lesson: Notebook) -> None:
    cell = lesson.cell(SHOW)
    cell.get_by_role("button", name="2D Goal Pose (g)").click()
    canvas = cell.locator("canvas").first
    box = canvas.bounding_box()
    assert box is not None
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    lesson.page.mouse.move(*middle)
    lesson.page.mouse.down()
    lesson.page.mouse.move(middle[0] + 60, middle[1])
    if PICTURES:
        lesson.page.screenshot(path=Path(PICTURES) / "desk_lab_goal.png")
    lesson.page.mouse.up()
    expect(cell.locator(".course-notice")).to_contain_text("Setting goal pose: Frame:map")
    wait_until(lambda: "geometry_msgs.msg.PoseStamped" in lesson.kernel("print(heard)"), lesson.page)


def test_clicks_reach_python_while_another_cell_waits_for_one(lesson: Notebook) -> None:
    lesson.cell(LIVE)
    lesson.page.evaluate(
        """async () => {
            await jupyterapp.commands.execute('notebook:insert-cell-below');
            const cell = jupyterapp.shell.currentWidget.content.activeCell;
            cell.model.sharedModel.setSource(
                'print("ready, " + "waiting")\\nprint("picked:", (await viewer.pick()).button)');
            jupyterapp.commands.execute('notebook:run-cell'); }"""
    )
    said = "() => JSON.stringify(jupyterapp.shell.currentWidget.content.model.toJSON()).includes('%s')"
    lesson.page.wait_for_function(said % "ready, waiting")
    lesson.cell(SHOW).locator("canvas").first.click()
    lesson.page.wait_for_function(said % "picked: 0")
    wait_until(lambda: lesson.kernel("print(len(clicks))").strip() == "1", lesson.page)


def test_displays_are_edited_in_both_themes(lesson: Notebook) -> None:
    cell = lesson.cell(SHOW)
    cell.get_by_role("button", name="Displays panel").click()
    cell.get_by_role("row").filter(has_text="Grid").first.press("ArrowRight")
    cell.get_by_role("spinbutton", name="Cell Size").fill("0.5")
    lesson.page.keyboard.press("Enter")
    cell.get_by_role("button", name="Views panel").click()
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        lesson.page.evaluate("theme => jupyterapp.commands.execute('apputils:change-theme', {theme})", theme)
        lesson.page.wait_for_function("theme => document.body.dataset.jpThemeName == theme", arg=theme)
        if PICTURES:
            lesson.page.screenshot(path=Path(PICTURES) / f"desk_lab_{theme[11:].lower()}.png")
    wait_until(lambda: lesson.kernel("print(viewer['Grid']['Cell Size'])").strip() == "0.5", lesson.page)


def test_keys_in_the_panels_leave_the_notebook_alone(lesson: Notebook) -> None:
    cells = "() => jupyterapp.shell.currentWidget.content.widgets.length"
    before = lesson.page.evaluate(cells)
    cell = lesson.cell(SHOW)
    add = cell.get_by_role("button", name="Add a display")
    for place in (cell.locator("canvas").first, add, cell.get_by_role("combobox", name="Type of view")):
        for key in ("a", "b", "d", "d", "x", "m", "s", "c", "g", "Escape"):
            place.press(key)
    add.press("Enter")
    lesson.page.keyboard.type("Axes")
    lesson.page.keyboard.press("Enter")
    expect(cell.get_by_role("row").filter(has_text="Axes")).to_be_visible()
    assert lesson.page.evaluate(cells) == before
    assert lesson.errors() == []
