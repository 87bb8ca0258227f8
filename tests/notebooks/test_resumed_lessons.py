"""Each lesson is resumed in a new kernel at its last place.

`tests/browser/test_lessons.py` resumes the lessons from week 2 on at their first place.

These tests take minutes. `tests/tools/test_resume.py` is among the last files of a run:
with them, one worker would have much left to do, and the others nothing.
"""

from pathlib import Path

import pytest

from tests.tools.test_resume import FIRST_PLACE, LESSONS, kernel_of, may_raise, unexpected_failures


@pytest.mark.slow
@pytest.mark.parametrize(
    ("lesson", "place"),
    [(LESSONS[0], 0), *((lesson, -1) for lesson in LESSONS)],
    ids=["week01-first", *(f"{lesson.stem}-last" for lesson in LESSONS)],
)
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
        places = [i for i, cell in enumerate(kernel.cells) if cell["id"].startswith(FIRST_PLACE)]
        middle = places[place]
        # What follows the last place is run after it was resumed there; nbmake runs it after the
        # cells above.
        end = len(kernel.cells) if place == -1 else places[-1] + 1
        printed, error = kernel.run(middle)
        assert (printed.splitlines()[0].startswith("Ran "), error) == (True, "")
        assert unexpected_failures(printed, kernel.cells) == []
        faults = {
            cell["id"]: fault
            for index, cell in enumerate(kernel.cells[middle + 1 : end], middle + 1)
            if not may_raise(cell) and (fault := kernel.run(index)[1])
        }
        assert faults == {}
