"""The Time panel below a viewer in a cell, and pictures that an open page draws."""

import threading
from io import BytesIO

import numpy as np
import pytest
from PIL import Image

from course_lib.ros.time.pace import speed_of
from tests.browser.bench import Bench
from tests.browser.fake_host import count
from tests.browser.test_playback import READING
from tests.browser.waiting import wait_until
from tests.patience import PATIENCE

pytestmark = pytest.mark.browser


@pytest.mark.slow
def test_time_panel_shows_robot_time_and_controls_its_speed(bench: Bench) -> None:
    speed = speed_of(bench.graph)
    assert "ROS Time: 1700000000.00" in bench.page.locator(READING).inner_text()
    bench.press("Pause (Space)")
    assert speed.is_paused
    bench.press("Step (period)")
    assert speed.step_ns == 100_000_000
    bench.page.get_by_role("combobox", name="Speed").select_option("0.5")
    bench.host.carry()
    assert speed.rate == 0.5
    bench.press("Play (Space)")
    assert not speed.is_paused
    assert bench.page.get_by_role("slider", name="Time").count() == 0  # live data cannot be scrubbed


@pytest.mark.slow
@pytest.mark.parametrize("width", [120, 160])  # [px]
def test_narrow_time_panel_shows_all_digits(bench: Bench, width: int) -> None:
    script = "(bar, width) => { bar.style.width = `${width}px`; return bar.scrollWidth - bar.clientWidth; }"
    assert bench.page.locator(".course-time").evaluate(script, width) == 0


@pytest.mark.slow
def test_focused_time_panel_is_controlled_by_keys(bench: Bench) -> None:
    bench.page.get_by_role("button", name="Pause (Space)").focus()
    bench.page.keyboard.press("Space")
    bench.host.carry()
    assert speed_of(bench.graph).is_paused
    bench.page.get_by_role("combobox", name="Speed").focus()
    bench.page.keyboard.press("ArrowDown")
    bench.host.carry()
    assert speed_of(bench.graph).rate == 2.0


@pytest.mark.slow
def test_time_panel_updates_with_robot_time(bench: Bench) -> None:
    bench.graph.call_at(bench.graph.now_ns + 2_500_000_000, lambda: None, node=0, entity=0)
    bench.graph.advance()

    def is_read() -> bool:
        bench.viewer.refresh()
        bench.host.carry()
        return "ROS Elapsed: 2.50" in bench.page.locator(READING).inner_text()

    wait_until(is_read, bench.page)


def test_screenshot_is_rendered_by_an_open_page(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.displays.panel.cell._ANSWER", PATIENCE)
    pictures = []
    asking = threading.Thread(target=lambda: pictures.append(bench.viewer.screenshot(size=(300, 200))))
    asking.start()
    while asking.is_alive():
        bench.host.carry()
    (picture,) = pictures
    assert picture.renderer == "page"
    pixels = np.asarray(Image.open(BytesIO(picture.png)).convert("RGB")).astype(np.int64)
    assert pixels.shape == (200, 300, 3)
    assert count(pixels, bench.viewer.scene.background, within=10) > 10_000


@pytest.mark.slow
def test_screenshot_falls_back_if_the_page_does_not_answer_in_time(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.displays.panel.cell._ANSWER", 0.1)
    assert bench.viewer.screenshot(size=(80, 60)).renderer in ("chromium", "numpy")
