"""RViz's panels in real JupyterLab, while nodes run live."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.browser.jupyterlab import Lab, Notebook, opened, place_of_view, view_of
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

FAIL = """
def fail():
    raise ValueError("too fast")
timer = node.create_timer(0.1, fail)
"""


@pytest.fixture(scope="module")
def lesson(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "week01_first_marker.ipynb") as notebook:
        notebook.run_to(LIVE)
        notebook.kernel(HEAR)
        yield notebook


def test_tools_publish_to_live_nodes(lesson: Notebook) -> None:
    place = place_of_view(lesson.cell(SHOW))
    place.get_by_role("button", name="2D Goal Pose (g)").click()
    canvas = place.locator("canvas").first
    box = canvas.bounding_box()
    assert box is not None
    middle = (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    lesson.page.mouse.move(*middle)
    lesson.page.mouse.down()
    lesson.page.mouse.move(middle[0] + 60, middle[1])
    if PICTURES:
        lesson.page.screenshot(path=Path(PICTURES) / "panels_lab_goal.png")
    lesson.page.mouse.up()
    expect(place.locator(".course-notice")).to_contain_text("Setting goal pose: Frame:map")
    wait_until(lambda: "geometry_msgs.msg.PoseStamped" in lesson.kernel("print(heard)"), lesson.page)


def test_clicks_reach_python_while_another_cell_waits_for_one(lesson: Notebook) -> None:
    lesson.cell(LIVE)
    lesson.page.evaluate(
        """async () => {
            await jupyterapp.commands.execute('notebook:insert-cell-below');
            const cell = courseNotebook().content.activeCell;
            cell.model.sharedModel.setSource(
                'print("ready, " + "waiting")\\nprint("picked:", (await viewer.pick()).button)');
            jupyterapp.commands.execute('notebook:run-cell'); }"""
    )
    said = "() => JSON.stringify(courseNotebook().content.model.toJSON()).includes('%s')"
    lesson.page.wait_for_function(said % "ready, waiting")
    view_of(lesson.cell(SHOW)).click()
    lesson.page.wait_for_function(said % "picked: 0")
    wait_until(lambda: lesson.kernel("print(len(clicks))").strip() == "1", lesson.page)


def open_panel(place: Locator, name: str) -> None:
    """Open a panel, unless an earlier test has opened it."""
    button = place.get_by_role("button", name=name)
    if button.get_attribute("aria-expanded") != "true":
        button.click()
    expect(button).to_have_attribute("aria-expanded", "true")


def change_theme(page: Page, theme: str) -> None:
    """Change JupyterLab's theme, and wait until its window is shown again."""
    page.evaluate("theme => jupyterapp.commands.execute('apputils:change-theme', {theme})", theme)
    page.wait_for_function(
        "theme => document.body.dataset.jpThemeName == theme && jupyterapp.shell.isVisible", arg=theme
    )


def test_displays_can_be_edited_in_both_themes(lesson: Notebook) -> None:
    place = place_of_view(lesson.cell(SHOW))
    open_panel(place, "Displays panel")
    place.get_by_role("row").filter(has_text="Grid").first.press("ArrowRight")
    place.get_by_role("spinbutton", name="Cell Size").fill("0.5")
    lesson.page.keyboard.press("Enter")
    open_panel(place, "Views panel")
    for theme in ("JupyterLab Light", "JupyterLab Dark"):
        change_theme(lesson.page, theme)
        if PICTURES:
            lesson.page.screenshot(path=Path(PICTURES) / f"panels_lab_{theme[11:].lower()}.png")
    wait_until(lambda: lesson.kernel("print(viewer['Grid']['Cell Size'])").strip() == "0.5", lesson.page)


def test_keys_pressed_in_panels_do_not_reach_the_notebook(lesson: Notebook) -> None:
    cells = "() => courseNotebook().content.widgets.length"
    before = lesson.page.evaluate(cells)
    place = place_of_view(lesson.cell(SHOW))
    for name in ("Displays panel", "Views panel"):
        open_panel(place, name)
    add = place.get_by_role("button", name="Add a display")
    for control in (place.locator("canvas").first, add, place.get_by_role("combobox", name="Type of view")):
        for key in ("a", "b", "d", "d", "x", "m", "s", "c", "g", "Escape"):
            control.press(key)
    axes = place.get_by_role("row").filter(has_text="Axes")
    axes_before = axes.count()
    add.press("Enter")
    lesson.page.keyboard.type("Axes")
    lesson.page.keyboard.press("Enter")
    expect(axes).to_have_count(axes_before + 1)
    assert lesson.page.evaluate(cells) == before
    assert lesson.errors() == []


def test_error_of_a_live_node_is_shown_at_its_view(lesson: Notebook) -> None:
    lesson.kernel(FAIL)
    line = place_of_view(lesson.cell(SHOW)).locator(".course-line").first
    expect(line).to_contain_text("stopped by an error, ValueError: too fast", timeout=30_000)
    expect(line).to_have_attribute("data-level", "error")
