import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from course_lib.viewer.html import bundle_code, save_html, scene_fragment
from course_lib.viewer.scene import Scene
from course_lib.viewer.scene_recording import SceneRecording
from tests.browser.fake_host import count
from tests.browser.test_page import BLUE, RED, colored, pixels_of
from tests.browser.waiting import at_rest
from tests.patience import PATIENCE
from tests.viewer.test_scene_recording import Clock
from tests.viewer.test_stream import RED_BOX

pytestmark = pytest.mark.browser

TIME = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
READING = ".course-time output"
# The complete text, because the recording may end before the test reads it.
WATCH = f"""() => {{
    const reading = document.querySelector("{READING}");
    globalThis.seen = [];
    const see = () => seen.push(parseFloat(reading.textContent.split(": ")[2]));
    const all = {{ childList: true, characterData: true, subtree: true }};
    new MutationObserver(see).observe(reading, all); }}"""


def at_x(x: float) -> np.ndarray:
    transform_node_to_parent = np.eye(4)
    transform_node_to_parent[0, 3] = x  # [m]
    return transform_node_to_parent


def recorded_scene(background: tuple[int, int, int] = (0, 0, 0)) -> SceneRecording:
    """A red box moves from left to right in 4 s; a blue one is visible from 1 to 2 s."""
    scene, clock = colored(RED), Clock()
    scene.background = background
    scene.set_transform("box", at_x(-2))
    recording = SceneRecording(scene, clock)
    for number in range(1, 401):
        clock.now = 100 + number / 100
        scene.set_transform("box", at_x(-2 + number / 100))
        if number == 100:
            scene.set_object("blue/box", colored(BLUE).objects()["box"])
            scene.set_transform("blue", at_x(0))
            scene.set_visible("box", False)
        if number == 200:
            scene.delete("blue")
            scene.set_visible("box", True)
    return recording


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    page = browser.new_page(viewport={"width": 400, "height": 330})
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.set_default_timeout(PATIENCE * 1000)
    yield page
    page.close()
    assert errors == []


@pytest.fixture
def playing(page: Page, tmp_path: Path) -> Page:
    file = save_html(recorded_scene(), tmp_path / "recording.html")
    page.goto(file.as_uri())
    page.wait_for_selector(READING)
    page.evaluate(TIME)
    return page


def scrub(page: Page, seconds: float) -> None:
    page.get_by_role("slider", name="Time").evaluate(
        "(range, value) => { range.value = value; range.dispatchEvent(new Event('input')); }", seconds
    )
    page.evaluate(TIME)


def test_replay_on_a_page_starts_by_itself_and_repeats(page: Page, tmp_path: Path) -> None:
    file = save_html(recorded_scene(), tmp_path / "recording.html")
    html = file.read_text("utf-8")
    assert html.count("data-alone=") == 1
    file.write_text(html.replace("data-alone=", 'data-plays="true" data-alone='), "utf-8")
    page.goto(file.as_uri())
    page.wait_for_selector(READING)
    page.evaluate(WATCH)
    # The recording has 4 s: a smaller time after a larger one is its second run.
    page.wait_for_function("() => seen.length > 2 && seen.at(-1) < Math.max(...seen) - 1")


def reds(page: Page) -> tuple[int, int, int]:
    """Count red pixels left and right, and blue ones."""
    pixels = pixels_of(page.screenshot())[:290]
    return count(pixels[:, :200], RED), count(pixels[:, 200:], RED), count(pixels, BLUE)


def elapsed(page: Page) -> float:
    return float((page.text_content(READING) or "").split("ROS Elapsed: ")[1].split()[0])


@pytest.mark.slow
def test_saved_page_shows_the_scene_at_the_seek_time_in_both_directions(playing: Page) -> None:
    seen: dict[float, list[tuple[int, int, int]]] = {}
    for seconds in (4.0, 0.0, 1.5, 4.0, 1.5, 0.5):
        scrub(playing, seconds)
        seen.setdefault(seconds, []).append(at_rest(lambda: reds(playing), playing))
    assert seen[0.0][0][0] > 3000
    assert seen[0.0][0][1:] == (0, 0)
    assert seen[1.5][0][:2] == (0, 0)
    assert seen[1.5][0][2] > 3000
    assert seen[4.0][0][0] == seen[4.0][0][2] == 0
    assert seen[4.0][0][1] > 3000
    assert all(len(set(pictures)) == 1 for pictures in seen.values())


@pytest.mark.slow
def test_playback_opens_at_the_end_and_plays_once_from_the_start(playing: Page) -> None:
    assert elapsed(playing) == pytest.approx(4.0)
    playing.get_by_role("combobox", name="Speed").select_option("4")
    playing.evaluate(WATCH)
    playing.get_by_role("button", name="Play").click()
    playing.wait_for_function("seen.some((seconds) => seconds < 3.9) && seen.at(-1) == 4")
    playing.get_by_role("button", name="Play").wait_for()
    assert elapsed(playing) == pytest.approx(4.0)


@pytest.mark.slow
def test_loop_continues_until_paused(playing: Page) -> None:
    playing.keyboard.press("l")
    assert playing.get_by_role("button", name="Loop").get_attribute("aria-pressed") == "true"
    scrub(playing, 3.99)
    playing.keyboard.press("Space")
    playing.wait_for_function(
        f"parseFloat(document.querySelector('{READING}').textContent.split(': ')[2]) < 3"
    )
    playing.keyboard.press("Space")
    playing.get_by_role("button", name="Play").wait_for()


@pytest.mark.slow
def test_keys_step_by_frame_and_jump_to_start_and_end(playing: Page) -> None:
    playing.keyboard.press("Home")
    assert elapsed(playing) == 0
    playing.keyboard.press("Period")
    playing.keyboard.press("Period")
    there = elapsed(playing)
    assert 0.025 <= there <= 0.1
    playing.keyboard.press("Comma")
    assert 0 < elapsed(playing) < there
    playing.keyboard.press("End")
    assert elapsed(playing) == pytest.approx(4.0)


@pytest.mark.slow
def test_every_playback_control_has_a_label_and_is_focused_by_tab(playing: Page) -> None:
    names = []
    for _ in range(8):
        playing.keyboard.press("Tab")
        names.append(playing.evaluate("document.activeElement.ariaLabel ?? ''"))
    short = [re.split(r"\. | \(", name)[0] for name in names]
    assert short == ["3D view", "Full screen", "Play", "Step back", "Step", "Time", "Loop", "Speed"]


@pytest.mark.slow
def test_page_with_a_recording_is_small_and_makes_no_requests(page: Page, tmp_path: Path) -> None:
    file = save_html(recorded_scene(), tmp_path / "recording.html")
    assert file.stat().st_size < 350_000
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.goto(file.as_uri())
    page.wait_for_selector(READING)
    assert [url for url in requests if not url.startswith("blob:")] == [file.as_uri()]


@pytest.mark.slow
def test_two_recordings_on_one_page_share_one_script_and_a_static_scene_has_no_time_bar(page: Page) -> None:
    still = Scene()
    still.set_object("box", RED_BOX)
    parts = [scene_fragment(what) for what in (recorded_scene(), recorded_scene((0, 60, 0)), still)]
    html = f"<body style='margin:0'>{''.join(parts)}<script>{bundle_code()}</script>"
    assert len(html) < 400_000
    page.set_content(html)
    page.wait_for_function("document.querySelectorAll('canvas').length === 3")
    assert page.locator(".course-time").count() == 2
    page.get_by_role("slider", name="Time").first.press("Home")
    assert "Elapsed: 0.00" in page.locator(READING).nth(0).inner_text()
    assert "Elapsed: 4.00" in page.locator(READING).nth(1).inner_text()
