"""RViz itself drew the pictures in tests/data/rviz_reference, from the same bags and layouts."""

import io
import json
from functools import cache
from pathlib import Path
from typing import Literal

import pytest
from PIL import Image

from course_lib.displays.render import scene_of
from course_lib.recording import read_bag
from course_lib.viewer.picture import find_browser, screenshot
from course_lib.viewer.scene import Scene
from tests.displays.likeness import COLOUR, SHAPE, likeness

REFERENCE = Path(__file__).parents[1] / "data" / "rviz_reference"
SCENES = sorted(path.name for path in REFERENCE.iterdir())


@cache
def replayed(name: str) -> Scene:
    at = json.loads((REFERENCE / name / "scene.json").read_text())["at"]  # [s]
    return scene_of(read_bag(REFERENCE / name / "bag"), REFERENCE / name / "view.rviz", at)


def test_all_scenes_are_here() -> None:
    assert len(SCENES) >= 12


@pytest.mark.parametrize("renderer", ["chromium", "numpy"])
@pytest.mark.parametrize("name", SCENES)
def test_what_we_draw_looks_as_in_rviz(name: str, renderer: Literal["chromium", "numpy"]) -> None:
    if renderer == "chromium" and find_browser() is None:
        pytest.skip("no Chromium or Chrome here")
    scene = replayed(name)
    with Image.open(REFERENCE / name / "rviz.png") as reference:
        png = screenshot(scene, size=(reference.width, reference.height), renderer=renderer).png
        alike = likeness(reference, Image.open(io.BytesIO(png)), scene.background)
    assert alike.shape >= SHAPE
    assert alike.colour >= COLOUR
