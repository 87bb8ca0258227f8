"""RViz itself drew the pictures in tests/data/rviz_reference, from the same bags and layouts."""

import base64
import io
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from PIL import Image
from playwright.sync_api import Page

from course_lib.displays.render import scene_of
from course_lib.recording import read_bag
from course_lib.viewer import encoding, html
from course_lib.viewer.renderer import find_browser, screenshot
from course_lib.viewer.scene import Scene
from tests.browser.fake_host import chromium
from tests.displays.likeness import COLOUR, SHAPE, likeness

REFERENCE = Path(__file__).parents[1] / "data" / "rviz_reference"
SCENES = sorted(path.name for path in REFERENCE.iterdir())
DRAW = "([key, scene, width, height]) => globalThis[key].picture(scene, width, height)"


@pytest.fixture(scope="module")
def page() -> Iterator[Page]:
    """Open a page that draws all scenes, because a browser for each would take 3 s."""
    if find_browser() is None:
        pytest.skip("no Chromium or Chrome here")
    with chromium() as browser:
        page = browser.new_page()
        page.add_script_tag(content=html.bundle().script)
        yield page


@cache
def replayed(name: str) -> Scene:
    at = json.loads((REFERENCE / name / "scene.json").read_text())["at"]  # [s]
    return scene_of(read_bag(REFERENCE / name / "bag"), REFERENCE / name / "view.rviz", at)


def test_all_reference_scenes_are_present() -> None:
    assert len(SCENES) >= 12


def assert_like_rviz(name: str, png: bytes) -> None:
    with Image.open(REFERENCE / name / "rviz.png") as reference:
        alike = likeness(reference, Image.open(io.BytesIO(png)), replayed(name).background)
    assert alike.shape >= SHAPE
    assert alike.colour >= COLOUR


def size_of(name: str) -> tuple[int, int]:
    with Image.open(REFERENCE / name / "rviz.png") as reference:
        return reference.size


@pytest.mark.parametrize("name", SCENES)
def test_browser_rendering_agrees_with_rviz(name: str, page: Page) -> None:
    scene = base64.b64encode(encoding.snapshot(replayed(name))).decode()
    address = page.evaluate(DRAW, [html.bundle().name, scene, *size_of(name)])
    assert_like_rviz(name, base64.b64decode(address.removeprefix("data:image/png;base64,")))


@pytest.mark.parametrize("name", SCENES)
def test_numpy_rendering_agrees_with_rviz(name: str) -> None:
    assert_like_rviz(name, screenshot(replayed(name), size=size_of(name), renderer="numpy").png)
