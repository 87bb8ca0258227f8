import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from course_lib.viewer.film import Film
from course_lib.viewer.html import bundle_script, save_html, scene_fragment
from course_lib.viewer.scene import Scene
from tests.browser.fake_host import count
from tests.browser.test_page import BLUE, RED, colored, pixels_of
from tests.patience import PATIENCE
from tests.viewer.test_film import Clock
from tests.viewer.test_stream import RED_BOX

pytestmark = pytest.mark.browser

TIME = "() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
READING = ".course-time output"
# All that the reading says, as a film may be over before anybody looks.
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


def filmed(background: tuple[int, int, int] = (0, 0, 0)) -> Film:
    """A red box goes from left to right in 4 s; a blue one is there from second 1 to 2, in its place."""
    scene, clock = colored(RED), Clock()
    scene.background = background
    scene.set_transform("box", at_x(-2))
    film = Film(scene, clock)
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
    return film


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
    file = save_html(filmed(), tmp_path / "film.html")
    page.goto(file.as_uri())
    page.wait_for_selector(READING)
    page.evaluate(TIME)
    return page


def scrub(page: Page, seconds: float) -> None:
    page.get_by_role("slider", name="Time").evaluate(
        "(range, value) => { range.value = value; range.dispatchEvent(new Event('input')); }", seconds
    )
    page.evaluate(TIME)


def reds(page: Page) -> tuple[int, int, int]:
    """Count red pixels left and right, and blue ones."""
    pixels = pixels_of(page.screenshot())[:290]
    return count(pixels[:, :200], RED), count(pixels[:, 200:], RED), count(pixels, BLUE)


def elapsed(page: Page) -> float:
    return float((page.text_content(READING) or "").split("ROS Elapsed: ")[1].split()[0])


def test_a_saved_page_shows_the_scene_of_the_time_it_is_scrubbed_to_also_back(playing: Page) -> None:
    seen: dict[float, list[tuple[int, int, int]]] = {}
    for seconds in (4.0, 0.0, 1.5, 4.0, 1.5, 0.5):
        scrub(playing, seconds)
        seen.setdefault(seconds, []).append(reds(playing))
    assert seen[0.0][0][0] > 3000
    assert seen[0.0][0][1:] == (0, 0)
    assert seen[1.5][0][:2] == (0, 0)
    assert seen[1.5][0][2] > 3000
    assert seen[4.0][0][0] == seen[4.0][0][2] == 0
    assert seen[4.0][0][1] > 3000
    assert all(len(set(pictures)) == 1 for pictures in seen.values())


def test_it_begins_at_the_end_plays_from_the_start_and_stops_there_again(playing: Page) -> None:
    assert elapsed(playing) == pytest.approx(4.0)
    playing.get_by_role("combobox", name="Speed").select_option("4")
    playing.evaluate(WATCH)
    playing.get_by_role("button", name="Play").click()
    playing.wait_for_function("seen.some((seconds) => seconds < 3.9) && seen.at(-1) == 4")
    playing.get_by_role("button", name="Play").wait_for()
    assert elapsed(playing) == pytest.approx(4.0)


def test_the_loop_goes_on_until_somebody_pauses(playing: Page) -> None:
    playing.keyboard.press("l")
    assert playing.get_by_role("button", name="Loop").get_attribute("aria-pressed") == "true"
    scrub(playing, 3.99)
    playing.keyboard.press("Space")
    playing.wait_for_function(
        f"parseFloat(document.querySelector('{READING}').textContent.split(': ')[2]) < 3"
    )
    playing.keyboard.press("Space")
    playing.get_by_role("button", name="Play").wait_for()


def test_keys_step_frame_by_frame_and_go_to_the_ends(playing: Page) -> None:
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


def test_every_control_has_a_name_and_is_reached_by_tab(playing: Page) -> None:
    names = []
    for _ in range(8):
        playing.keyboard.press("Tab")
        names.append(playing.evaluate("document.activeElement.ariaLabel ?? ''"))
    short = [re.split(r"\. | \(", name)[0] for name in names]
    assert short == ["3D view", "Full screen", "Play", "Step back", "Step", "Time", "Loop", "Speed"]


def test_a_page_with_a_film_is_small_and_asks_for_nothing(page: Page, tmp_path: Path) -> None:
    file = save_html(filmed(), tmp_path / "film.html")
    assert file.stat().st_size < 350_000
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.goto(file.as_uri())
    page.wait_for_selector(READING)
    assert [url for url in requests if not url.startswith("blob:")] == [file.as_uri()]


def test_two_films_stand_side_by_side_with_one_script_and_a_still_scene_has_no_bar(page: Page) -> None:
    still = Scene()
    still.set_object("box", RED_BOX)
    parts = [scene_fragment(what) for what in (filmed(), filmed((0, 60, 0)), still)]
    html = f"<body style='margin:0'>{''.join(parts)}{bundle_script()}"
    assert len(html) < 400_000
    page.set_content(html)
    page.wait_for_function("document.querySelectorAll('canvas').length === 3")
    assert page.locator(".course-time").count() == 2
    page.get_by_role("slider", name="Time").first.press("Home")
    assert "Elapsed: 0.00" in page.locator(READING).nth(0).inner_text()
    assert "Elapsed: 4.00" in page.locator(READING).nth(1).inner_text()
