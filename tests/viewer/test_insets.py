from io import BytesIO
from itertools import pairwise
from typing import Literal, TypeAlias

import numpy as np
import pytest
from PIL import Image

from course_lib.viewer.drawables import Camera, Inset, Solids
from course_lib.viewer.renderer import find_browser, placed_insets, screenshot
from course_lib.viewer.scene import Scene

Renderer: TypeAlias = Literal["chromium", "numpy"]

SIZE = (300, 240)
RED, BLUE = (255, 0, 0), (0, 0, 255)
AHEAD = Camera(eye=(4.0, 0.0, 0.0), target=(0.0, 0.0, 0.0))


def pixels(scene: Scene, renderer: Renderer = "numpy") -> np.ndarray:
    picture = Image.open(BytesIO(screenshot(scene, size=SIZE, renderer=renderer).png))
    return np.asarray(picture.convert("RGB")).astype(int)


def plain(color: tuple[int, int, int], columns: int = 4, rows: int = 3) -> np.ndarray:
    return np.full((rows, columns, 3), color, np.uint8)


def at_middle(scene: Scene, renderer: Renderer = "numpy") -> list[tuple[int, ...]]:
    """Return the colour in the middle of each picture."""
    drawn = pixels(scene, renderer)
    return [
        tuple(drawn[top + height // 2, left + width // 2].tolist())
        for _, (left, top, width, height) in placed_insets(scene, SIZE)
    ]


def red_box() -> Scene:
    scene = Scene()
    scene.camera = Camera(eye=(40.0, 0.0, 0.0), target=(0.0, 0.0, 0.0))
    scene.set_object("box", Solids("box", [np.eye(4)], (1, 0, 0, 1)))
    return scene


@pytest.mark.parametrize("count", [1, 2, 7])
def test_insets_are_inside_the_view_and_do_not_overlap(count: int) -> None:
    scene = Scene()
    for number in range(count):
        scene.set_object(f"picture/{number}", Inset(plain(BLUE, rows=2 + number)))
    boxes = [box for _, box in placed_insets(scene, SIZE)]
    assert len(boxes) == count
    for left, top, width, height in boxes:
        assert 0 <= left < left + width <= SIZE[0]
        assert 0 <= top < top + height <= SIZE[1]
    for (_, top, _, height), (_, below, _, _) in pairwise(boxes):
        assert top + height <= below


@pytest.mark.browser
def test_name_of_the_display_is_written_into_its_picture() -> None:
    if find_browser() is None:
        pytest.skip("no Chromium or Chrome on this machine")
    scene = Scene()
    scene.set_object("displays/Image/picture", Inset(plain(BLUE)))
    ((_, (left, top, width, height)),) = placed_insets(scene, SIZE)
    drawn = pixels(scene, "chromium")[top : top + height, left : left + width]
    letters = np.asarray(drawn.min(axis=2) > 150)
    assert letters[:20].sum() > 20
    assert letters[20:].sum() == 0


def test_hidden_inset_frees_its_space() -> None:
    scene = Scene()
    scene.set_object("first", Inset(plain(RED)))
    scene.set_object("second", Inset(plain(BLUE)))
    scene.set_visible("first", False)
    assert at_middle(scene) == [BLUE]


@pytest.mark.sample(1)
@pytest.mark.parametrize("renderer", ["numpy", "chromium"])
def test_camera_inset_shows_the_scene_over_its_image(renderer: Renderer) -> None:
    if renderer == "chromium" and find_browser() is None:
        pytest.skip("no Chromium or Chrome here")
    scene = red_box()
    scene.set_object("a", Inset(plain(BLUE), camera=AHEAD))
    scene.set_object("b", Inset(plain(BLUE), camera=AHEAD, hidden_paths=("box",)))
    scene.set_object("c", Inset(plain(BLUE), camera=AHEAD, is_behind=False, hidden_paths=("box",)))
    scene.set_object("d", Inset(plain(BLUE), camera=AHEAD, overlay_alpha=1.0))
    assert at_middle(scene, renderer) == [RED, BLUE, scene.background, BLUE]


def test_object_beyond_the_far_distance_of_the_camera_is_not_drawn() -> None:
    scene = red_box()
    scene.set_object("a", Inset(plain(BLUE), camera=Camera(eye=(4.0, 0.0, 0.0), far=2.0)))
    assert at_middle(scene) == [BLUE]


def test_camera_shift_moves_the_target_by_fractions_of_the_image_height() -> None:
    scene = red_box()
    scene.set_object("a", Inset(plain(BLUE), camera=Camera(eye=(9.0, 0.0, 0.0), shift=(0.25, -0.25))))
    ((_, (left, top, width, height)),) = placed_insets(scene, SIZE)
    inside = pixels(scene)[top : top + height, left : left + width]
    rows, columns = np.nonzero(inside[..., 0] > 128)
    assert columns.mean() == pytest.approx(width / 2 + height / 4, abs=1)
    assert rows.mean() == pytest.approx(height / 2 - height / 4, abs=1)


@pytest.mark.sample(1)
@pytest.mark.parametrize("renderer", ["numpy", "chromium"])
def test_image_covers_only_its_area_of_the_picture(renderer: Renderer) -> None:
    if renderer == "chromium" and find_browser() is None:
        pytest.skip("no Chromium or Chrome here")
    scene = Scene()
    away = Camera(eye=(4.0, 0.0, 0.0), target=(8.0, 0.0, 0.0))
    area = (0.5, -0.5, 1.0, 1.0)
    scene.set_object("a", Inset(plain(BLUE), camera=away, overlay_alpha=0.5, area=area))
    ((_, (left, top, width, height)),) = placed_insets(scene, SIZE)
    inside = pixels(scene, renderer)[top : top + height, left : left + width]
    corners = inside[[3, 3, -4, -4], [3, -4, 3, -4]].tolist()
    background = [*scene.background]
    assert corners == [background, [*BLUE], background, background]


@pytest.mark.slow
def test_both_renderers_agree_on_insets() -> None:
    if find_browser() is None:
        pytest.skip("no Chromium or Chrome here")
    scene = red_box()
    ramp = np.zeros((60, 80, 3), np.uint8)
    ramp[..., 1] = np.arange(80)
    scene.set_object("a", Inset(ramp))
    scene.set_object("b", Inset(ramp, camera=AHEAD, overlay_alpha=0.5))
    numpy_pixels, browser_pixels = pixels(scene), pixels(scene, "chromium")
    assert (np.abs(numpy_pixels - browser_pixels).max(axis=2) > 40).mean() < 0.002
