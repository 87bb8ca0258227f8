"""Each lesson is resumed in a new kernel: at its first place, up to the last one, and at its last place.

These tests take minutes. `tests/tools/test_resume.py` is among the last files of a run:
with them, one worker would have much left to do, and the others nothing.
"""

import re
from pathlib import Path

import pytest

from tests.tools.test_resume import LESSONS, kernel_of


@pytest.mark.slow
@pytest.mark.parametrize("place", [0, -1], ids=["first", "last"])
@pytest.mark.parametrize("lesson", LESSONS, ids=lambda p: p.stem)
def test_lesson_resumes_from_its_stopping_points_in_a_new_kernel(
    lesson: Path, place: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COURSE_PACE", "fast")
    (tmp_path / ".course").mkdir()
    path = tmp_path / lesson.name
    path.write_text(lesson.read_text("utf-8"), "utf-8")
    for beside in lesson.parent.glob("*.py"):
        (tmp_path / beside.name).write_text(beside.read_text("utf-8"), "utf-8")
    with kernel_of(path) as kernel:
        places = [i for i, cell in enumerate(kernel.cells) if cell["id"].startswith("go-on-here")]
        middle = places[place]
        # What follows the last place is run after it was resumed there; nbmake runs it after the cells above.
        end = len(kernel.cells) if place == -1 else places[-1] + 1
        printed, error = kernel.run(middle)
        assert (printed.splitlines()[0].startswith("Ran "), error) == (True, "")
        failed = [int(number) - 1 for number in re.findall(r"^  In \[(\d+)\]", printed, re.M)]
        assert [
            i for i in failed if "raises-exception" not in kernel.cells[i]["metadata"].get("tags", [])
        ] == []
        faults = {
            cell["id"]: fault
            for index, cell in enumerate(kernel.cells[middle + 1 : end], middle + 1)
            if "raises-exception" not in cell["metadata"].get("tags", []) and (fault := kernel.run(index)[1])
        }
        assert faults == {}
