from io import BytesIO
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Browser

from course_lib.viewer.drawables import Camera, Inset, Lines, Mesh, Points, Shape, Solids, Text
from course_lib.viewer.html import bundle_code, save_html, scene_fragment
from course_lib.viewer.renderer import screenshot
from course_lib.viewer.scene import Scene
from tests.browser.fake_host import Pixels, count
from tests.browser.waiting import wait_until

pytestmark = pytest.mark.browser

RED, BLUE = (255, 0, 0), (0, 0, 255)


def colored(rgb: tuple[int, int, int]) -> Scene:
    scene = Scene()
    scene.camera = Camera(eye=(0, 0, 6), target=(0, 0, 0), up=(0, 1, 0))
    scene.set_object("box", Solids("box", [np.eye(4)], (*np.divide(rgb, 255), 1)))
    return scene


def of_all_kinds() -> Scene:
    scene = Scene()
    scene.camera = Camera(eye=(5, 3, 4), target=(0, 0, 0.5))
    for number, shape in enumerate(get_args(Shape)):
        transform_unit_to_node = np.diag([1.0, 0.7, 0.9, 1.0])
        transform_unit_to_node[:2, 3] = number - 1.5, (number % 2) * 1.2  # [m]
        scene.set_object(
            shape, Solids(shape, [transform_unit_to_node], (1, 0.2 * number, 0, 1 - 0.2 * number))
        )
    grid = [[x, y, 0] for a in range(-3, 4) for x, y in ((a, -3), (a, 3), (-3, a), (3, a))]
    scene.set_object("grid", Lines(grid, (0.6, 0.6, 0.6, 0.5), strip=False))
    scene.set_object("strip", Lines([[-2, -2, 0], [0, -2, 1], [2, -2, 0]], (0, 1, 1, 1), width=0.1))
    scene.set_object("points", Points(np.mgrid[0:3, 0:3, 2:3].reshape(3, -1).T, (1, 1, 1, 1), (0.1, 0.1)))
    scene.set_object("text", Text("Tag 7", 0.4, (1, 1, 0, 1)))
    scene.set_transform("text", np.block([[np.eye(3), np.array([[0], [0], [1.5]])], [np.zeros((1, 3)), 1]]))
    scene.set_object(
        "mesh", Mesh([[2, 1, 0], [3, 1, 0], [2, 2, 1]], None, np.eye(4)[[0, 1, 2]] + [0, 0, 0, 1])
    )
    return scene


def pixels_of(png: bytes) -> Pixels:
    return np.asarray(Image.open(BytesIO(png)).convert("RGB")).astype(np.int64)


@pytest.mark.slow
def test_both_renderers_draw_the_same_image(browser: Browser) -> None:
    scene = of_all_kinds()
    shots = [screenshot(scene, size=(400, 300), renderer=renderer) for renderer in ("chromium", "numpy")]
    ours, theirs = (pixels_of(shot.png) for shot in shots)
    assert ours.shape == (300, 400, 3)
    assert (np.abs(ours - theirs).max(axis=-1) < 40).mean() > 0.98
    assert (np.abs(ours - scene.background).max(axis=-1) > 30).mean() > 0.1


@pytest.mark.slow
def test_saved_page_shows_the_scene_without_network_requests(browser: Browser, tmp_path: Path) -> None:
    file = save_html(colored(RED), tmp_path / "scene.html", title="The <red> box")
    assert file.stat().st_size < 350_000
    page = browser.new_page(viewport={"width": 400, "height": 300})
    errors: list[str] = []
    requests: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("request", lambda request: requests.append(request.url))
    page.goto(file.as_uri())
    page.wait_for_selector("canvas")
    wait_until(lambda: count(pixels_of(page.screenshot()), RED) > 4000, page)
    label = "The <red> box. box: 1 box at (0, 0, 0)"
    assert (page.title(), page.get_by_role("img").get_attribute("aria-label")) == (label[:13], label)
    assert errors == []
    assert [url for url in requests if not url.startswith("blob:")] == [file.as_uri()]
    page.close()


@pytest.mark.slow
def test_two_scenes_on_one_page_share_one_script(browser: Browser) -> None:
    left, right = (scene_fragment(colored(rgb), height="300px", label="box") for rgb in (RED, BLUE))
    page = browser.new_page(viewport={"width": 400, "height": 300})
    page.set_content(
        '<body style="margin:0"><div style="display:grid;grid-template-columns:1fr 1fr">'
        f"{left}{right}</div><script>{bundle_code()}</script>"
    )
    page.wait_for_function("document.querySelectorAll('canvas').length === 2")

    def is_drawn() -> bool:
        pixels = pixels_of(page.screenshot())
        return min(count(pixels[:, :200], RED), count(pixels[:, 200:], BLUE)) > 2000

    wait_until(is_drawn, page)
    pixels = pixels_of(page.screenshot())
    assert max(count(pixels[:, :200], BLUE), count(pixels[:, 200:], RED)) == 0
    page.close()


def test_buttons_of_a_view_do_not_cover_its_pictures(browser: Browser, tmp_path: Path) -> None:
    page = browser.new_page(viewport={"width": 400, "height": 300})
    scene = colored(RED)
    distances = []  # [px] of the button from the right edge
    for _ in range(2):
        page.goto(save_html(scene, tmp_path / "scene.html").as_uri())
        wait_until(lambda: count(pixels_of(page.screenshot()), RED) > 1000, page)
        place = page.get_by_role("button", name="Full screen").bounding_box()
        assert place is not None
        distances.append(400 - place["x"] - place["width"])
        scene.set_object("picture", Inset(np.full((3, 4, 3), BLUE, np.uint8)))
    assert distances == [0, pytest.approx(0.31 * 400, abs=1)]
    page.close()
