from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading.catalog import load_catalog
from course_lib.grading.check_file import check_file
from course_lib.grading.grade_one import Course

WriteNotebook = Callable[..., Path]


@pytest.fixture(autouse=True)
def installed(course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The small course is the one that is installed."""
    catalog = load_catalog(course.exercises)
    monkeypatch.setattr("course_lib.grading.check_file.shipped_catalog", lambda: catalog)
    monkeypatch.chdir(tmp_path)


def test_a_right_notebook_passes_its_public_checks(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert check_file(write_notebook(tmp_path / "week01_exercise.ipynb", right, student="ada"))
    assert capsys.readouterr().out.count("hidden checks run at grading") == 3


def test_a_wrong_notebook_shows_why_and_the_errors_of_its_cells(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = right.replace("length / 2", "length") + "# next cell\nnothing\n"
    assert not check_file(write_notebook(tmp_path / "week01_exercise.ipynb", code))
    said = capsys.readouterr().out
    assert "NameError: name 'nothing' is not defined" in said
    assert "expected 2.00 m: 2.00 m too much" in said
    assert "Hint 1 of 3" in said


def test_a_notebook_of_no_exercise_is_refused(write_notebook: WriteNotebook, tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="no exercise of this course"):
        check_file(write_notebook(tmp_path / "week08_exercise.ipynb", "x = 1"))
