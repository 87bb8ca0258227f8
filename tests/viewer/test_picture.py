import json
import stat
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from IPython.core.formatters import DisplayFormatter

from course_lib.errors import CourseError
from course_lib.viewer import renderer
from course_lib.viewer.drawables import Solids
from course_lib.viewer.renderer import dump_dom, screenshot
from course_lib.viewer.scene import Scene
from tests.patience import PATIENCE

PNG = b"\x89PNG"


@pytest.fixture
def scene() -> Scene:
    scene = Scene()
    scene.set_object("box", Solids("box", [np.eye(4)], (1, 0, 0, 1)))
    return scene


@pytest.fixture
def browser_that(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    def make(code: str) -> None:
        program = tmp_path / "chromium"
        program.write_text(f"#!{sys.executable}\n{code}")
        program.chmod(program.stat().st_mode | stat.S_IEXEC)
        monkeypatch.setattr(renderer, "find_browser", lambda: str(program))

    return make


def test_without_a_browser_numpy_draws_and_a_notice_gives_the_reason(
    scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(renderer, "find_browser", lambda: None)
    image = screenshot(scene)
    assert (image.renderer, image.png[:4]) == ("numpy", PNG)
    assert "No Chromium or Chrome was found" in image.note
    with pytest.raises(CourseError, match="Use renderer='numpy'"):
        screenshot(scene, renderer="chromium")


@pytest.mark.skipif(sys.platform == "win32", reason="programs have other names there")
def test_chromium_without_windows_is_preferred(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    for name in ("chromium", "chromium-headless-shell"):
        program = tmp_path / name
        program.touch(mode=0o755)
        assert renderer.find_browser.__wrapped__() == str(program)


@pytest.mark.skipif(sys.platform == "win32", reason="the fake browser is a script with a first line")
def test_hanging_browser_is_ended_and_numpy_draws(
    scene: Scene, browser_that: Callable[[str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    browser_that("import time; time.sleep(60)")
    monkeypatch.setattr(renderer, "_TIMEOUT", 0.3)
    image = screenshot(scene)
    assert image.renderer == "numpy"
    assert "did not finish within 0.3 s" in image.note


@pytest.mark.skipif(sys.platform == "win32", reason="the fake browser is a script with a first line")
def test_browser_without_webgl_is_detected_by_its_empty_page(
    scene: Scene, browser_that: Callable[[str], None]
) -> None:
    browser_that("print('<html></html>')")
    picture = screenshot(scene)
    assert picture.renderer == "numpy"
    assert "returned no image" in picture.note


def test_browser_that_cannot_be_started_is_an_os_error(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="nothing"):
        dump_dom(str(tmp_path / "nothing"), "", 1.0)


def test_browser_that_draws_looks_up_no_host_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program = renderer.find_browser()
    if program is None:
        pytest.skip("no Chromium or Chrome on this machine")
    log = tmp_path / "net.json"
    monkeypatch.setattr(renderer, "FLAGS", [*renderer.FLAGS, f"--log-net-log={log}"])
    page = '<p>drawn</p><img src="http://picture.invalid/robot.png">'
    assert "drawn" in dump_dom(program, page, PATIENCE)
    # A job is a query to the computer's resolver. The page's request remains, but is rejected.
    records = json.loads(log.read_text())
    kinds = {number: name for name, number in records["constants"]["logEventTypes"].items()}
    seen = {kinds[event["type"]] for event in records["events"]}
    assert "HOST_RESOLVER_MANAGER_REQUEST" in seen
    assert "HOST_RESOLVER_MANAGER_JOB" not in seen


def test_image_is_written_to_the_requested_path(scene: Scene, tmp_path: Path) -> None:
    picture = screenshot(scene, tmp_path / "scene.png", size=(64, 48), renderer="numpy")
    assert (tmp_path / "scene.png").read_bytes() == picture.png
    assert picture.note == ""


def test_printed_image_shows_its_size_and_renderer_and_not_its_bytes(scene: Scene) -> None:
    picture = screenshot(scene, size=(64, 48), renderer="numpy")
    assert str(picture) == "<Picture of 64 x 48 pixels, drawn by numpy>"
    shown: Any = DisplayFormatter()
    assert shown.format(picture)[0] == {"text/plain": str(picture), "image/png": picture.png}
