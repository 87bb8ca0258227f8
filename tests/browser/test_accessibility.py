"""The view, its panels and the results of checks have no serious fault that axe-core finds."""

from pathlib import Path
from typing import Literal

import pytest
from playwright.sync_api import Page

from course_lib.displays.statuses import Level, StatusRow, StatusTable
from course_lib.grading.records import CheckResult, TaskResult
from course_lib.grading.reports.rendering import Table
from course_lib.ros.graph.graph import Graph
from course_lib.tools.rqt.monitors import ConsoleView
from course_lib.viewer.html import save_html
from course_lib.viewer.visualizer import Visualizer
from tests.browser.axe import faults
from tests.browser.bench import Bench
from tests.browser.fake_host import Host
from tests.browser.test_page import RED, colored
from tests.browser.test_playback import recorded_scene

pytestmark = pytest.mark.browser
BUTTONS = {  # that are pressed to open a panel or a window
    "closed": (),
    "displays": ("Displays panel",),
    "views": ("Views panel",),
    "add": ("Displays panel", "Add a display"),
    "save": ("Displays panel", "Save the layout (Ctrl+S)"),
    "open": ("Displays panel", "Open a layout (Ctrl+O)"),
}


@pytest.mark.slow
@pytest.mark.sample(3)
@pytest.mark.parametrize("opened", BUTTONS)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_panels_and_windows_are_accessible_by_keyboard_and_screen_reader(
    opened: str, scheme: Literal["light", "dark"], bench: Bench
) -> None:
    bench.page.emulate_media(color_scheme=scheme)
    for name in BUTTONS[opened]:
        bench.press(name)
    if opened == "displays":
        for label in ("Global Options", "Marker", "Grid", "Offset"):
            bench.row(label).press("ArrowRight")
    assert faults(bench.page, ".course-viewer") == []
    bench.page.emulate_media(color_scheme=None)


def test_check_result_is_accessible_to_a_screen_reader(one_page: Page) -> None:
    checks = (
        CheckResult("The topic is /cube", "public", False, 1.0, 1.0, "", ""),
        CheckResult("The cube stands on the ground", "public", False, 1.0, 0.0, "expected 0.25 m", "height"),
    )
    result = TaskResult("week01.cube", "A cube", 10.0, False, checks, ("line 3: NameError",))
    table = Table(result, ("Hint: look up.",), ("hello",))
    one_page.set_content(table._repr_mimebundle_()["text/html"])
    assert one_page.get_by_role("row").count() >= 2
    assert faults(one_page, "body > *") == []


@pytest.mark.parametrize("ground", ["#fff; color: #111", "#ced6dd; color: #000", "#121212; color: #ddd"])
def test_status_table_has_sufficient_contrast_on_every_page_background(one_page: Page, ground: str) -> None:
    levels: tuple[Level, ...] = ("ok", "warn", "error", "hint")
    table = StatusTable(StatusRow("Marker", "Topic", level, "text") for level in levels)
    one_page.set_content(f"<!doctype html><main style='background: {ground}'>{table._repr_html_()}</main>")
    assert faults(one_page, "main") == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_rqt_view_on_a_page_without_widgets_is_accessible(
    one_page: Page, scheme: Literal["light", "dark"]
) -> None:
    view = ConsoleView(Graph(), [])
    lines = "".join(f"<p class='rqt-dim'>{number}</p>" for number in range(100))
    view.picture = lambda: lines  # type: ignore[method-assign]  # what scrolls
    one_page.emulate_media(color_scheme=scheme)
    one_page.set_content(
        f"<!doctype html><style>:root {{ color-scheme: light dark }} main "
        f"{{ background: #ced6dd }}</style><main>{view.static_html()}</main>"
    )
    assert faults(one_page, "main") == []
    one_page.emulate_media(color_scheme=None)


def test_saved_scene_is_accessible_to_a_screen_reader(one_page: Page, tmp_path: Path) -> None:
    one_page.goto(save_html(colored(RED), tmp_path / "scene.html").as_uri())
    one_page.wait_for_selector("canvas")
    assert faults(one_page) == []


@pytest.mark.slow
def test_scene_without_panels_has_a_text_description(host: Host) -> None:
    visualizer = Visualizer(colored(RED))
    widget = visualizer.jupyter_cell()
    host.open(widget)
    host.show(widget)
    host.page.get_by_role("img", name="3D view. box: 1 box at (0, 0, 0)").wait_for()


@pytest.mark.slow
def test_recording_does_not_play_automatically_with_reduced_motion(one_page: Page, tmp_path: Path) -> None:
    one_page.emulate_media(reduced_motion="reduce")
    one_page.goto(save_html(recorded_scene(), tmp_path / "recording.html").as_uri())
    one_page.wait_for_selector("canvas")
    bar = one_page.get_by_role("slider", name="Time")
    before = bar.input_value()
    one_page.wait_for_timeout(300)
    assert bar.input_value() == before
    assert one_page.evaluate("document.getAnimations().length") == 0
    one_page.emulate_media(reduced_motion=None)


def test_unnamed_button_and_low_contrast_text_are_accessibility_faults(one_page: Page) -> None:
    one_page.set_content("<button></button><p style='color: #ccc; background: #fff'>Pale</p>")
    assert {fault.split(":")[0] for fault in faults(one_page, "body > *")} == {
        "button-name",
        "color-contrast",
    }
