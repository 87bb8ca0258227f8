"""The level of detail of moving views, chosen by the times that drawing takes, in Node.js."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from course_lib.viewer import html
from tests.patience import PATIENCE

NODE = shutil.which("node")
pytestmark = pytest.mark.skipif(NODE is None, reason="no Node.js on this machine")
SCRIPT = (Path(html.__file__).parent / "js" / "quality.js").read_text("utf-8")
# Level 3 is the first one of a view that software draws.
TEST = """
expectSpeed({ getExtension: () => null, getParameter: () => "SwiftShader" });
const quality = new MotionQuality();
quality.paint(() => {}, () => {}, false);
const levels = TIMES.map((time) => {
  if (time === "rest") quality.rest();
  else quality.level = quality.levelAfter(quality.level, time[quality.level] ?? time);
  return quality.level;
});
console.log(JSON.stringify(levels));
"""


def levels(tmp_path: Path, times: list[object]) -> list[int]:
    """Return the level after each picture that took a time [ms], or a time that depends on the level."""
    module = tmp_path / "quality.mjs"
    module.write_text(SCRIPT + TEST.replace("TIMES", json.dumps(times)), "utf-8")
    command = [str(NODE), str(module)]
    result = subprocess.run(command, capture_output=True, text=True, check=True, timeout=PATIENCE)
    answer: list[int] = json.loads(result.stdout)
    return answer


def test_single_slow_pictures_do_not_make_a_view_coarser(tmp_path: Path) -> None:
    assert max(levels(tmp_path, [10, 300, 10, 10, 90, 80, 70, 10])) == 3


def test_view_whose_pictures_are_all_slow_becomes_coarser(tmp_path: Path) -> None:
    assert levels(tmp_path, [20] * 8)[-1] == 5
    assert levels(tmp_path, [90] * 2)[-1] == 5


def test_view_on_a_busy_machine_becomes_coarser_until_drawing_is_fast(tmp_path: Path) -> None:
    """Other programs delay most pictures; the least time is what drawing itself costs."""
    assert levels(tmp_path, [7, 40, 35, 30] * 8)[-1] == 5
    assert levels(tmp_path, [3, 40, 35, 30] * 8)[-1] == 3
    answer = levels(tmp_path, [*[7, 40, 35, 30] * 8, *[5] * 60])
    assert answer[-1] == 1


def test_view_becomes_finer_again_after_a_slow_period(tmp_path: Path) -> None:
    costs = [40, 9, 6, 5, 4, 4]
    answer = levels(tmp_path, [*[50] * 4, *[costs] * 60])
    assert (max(answer), answer[-1]) == (5, 1)


def test_finer_level_that_is_too_slow_is_tried_less_and_less_often(tmp_path: Path) -> None:
    costs = [900, 800, 700, 60, 7, 6]
    answer = levels(tmp_path, [costs] * 600)
    tries = [index for index, level in enumerate(answer) if level == 3 and answer[index - 1] == 4]
    assert 2 <= len(tries) <= 6
    assert tries[-1] - tries[-2] > 4 * (tries[1] - tries[0])


def test_view_returns_from_a_much_too_slow_finer_level_to_the_level_before(tmp_path: Path) -> None:
    costs = [900, 800, 700, 60, 7, 6]
    assert 5 not in levels(tmp_path, [costs] * 600)[20:]


def test_finer_level_is_tried_soon_after_a_rest(tmp_path: Path) -> None:
    costs = [900, 800, 700, 60, 7, 6]
    answer = levels(tmp_path, [*[costs] * 600, "rest", *[costs] * 8])
    assert 3 in answer[601:]
