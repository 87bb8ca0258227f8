"""`course verify` runs lessons: one that raises, or does not end, is not ready."""

from pathlib import Path

import pytest

from course_lib.authoring.rules import Flaw
from course_lib.authoring.verify import WeekReport, run_lesson, verify
from course_lib.course.material import lessons_dir
from course_lib.grading.store import Course, this_course
from tests.export.conftest import write_notebook

FIRST = "%load_ext course_lib"


def test_lesson_without_errors_passes(tmp_path: Path) -> None:
    (tmp_path / "week09_parts.py").write_text("SIZE = 3\n")
    write_notebook(tmp_path / "week09_maps.ipynb", [FIRST, "from week09_parts import SIZE\nprint(SIZE)"])
    assert run_lesson(tmp_path / "week09_maps.ipynb") == []
    assert {path.name for path in tmp_path.iterdir()} == {"week09_parts.py", "week09_maps.ipynb"}


@pytest.mark.sample(1)
@pytest.mark.parametrize(
    ("cells", "message"),
    [
        (["x = 1\ny = nme"], "cell 2, line 2 (y = nme) ends with NameError: name 'nme' is not defined"),
        (["def f():\n    return 1 / 0", "f()"], "cell 2, line 2 (return 1 / 0) ends with ZeroDivisionError"),
        (["for"], "ends with SyntaxError"),
        (["raise SystemExit(3)"], "ends with "),
    ],
)
def test_raising_cell_is_reported(tmp_path: Path, cells: list[str], message: str) -> None:
    path = tmp_path / "week09_maps.ipynb"
    write_notebook(path, [FIRST, *cells])
    (flaw,) = run_lesson(path)
    assert (flaw.aspect, flaw.location) == ("lesson", str(path))
    assert message in flaw.text


@pytest.mark.slow
def test_endless_lesson_is_reported(tmp_path: Path) -> None:
    write_notebook(tmp_path / "week09_maps.ipynb", ["while True:\n    x = [1]"])
    (flaw,) = run_lesson(tmp_path / "week09_maps.ipynb", 2.0)
    assert flaw.text == "it does not end within 2 s: is there an infinite loop?"


def test_verify_runs_every_lesson(monkeypatch: pytest.MonkeyPatch) -> None:
    ran = list[Path]()

    def run(path: Path) -> list[Flaw]:
        ran.append(path)
        return []

    monkeypatch.setattr("course_lib.authoring.verify.run_lesson", run)
    monkeypatch.setattr("course_lib.authoring.verify._verify_week", _nothing)
    list(verify(this_course(), jobs=1))
    assert sorted(ran) == sorted(lessons_dir().glob("*.ipynb"))


def _nothing(week: str, *_: object) -> WeekReport:
    return WeekReport(week, ())


def test_lesson_of_a_course_that_is_not_installed_is_not_run(
    course: Course, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("course_lib.authoring.verify.run_lesson", lambda _: pytest.fail("it ran"))
    monkeypatch.setattr("course_lib.authoring.verify._verify_week", _nothing)
    list(verify(course, jobs=1))
