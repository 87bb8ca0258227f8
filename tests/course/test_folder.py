import json
import sys
from pathlib import Path

import pytest

from course_lib.course import student_folder
from course_lib.course.exercise import notebook_text, read_notebook
from course_lib.course.material import PACKAGE
from course_lib.course.state import State
from course_lib.course.student_folder import prepare, shipped_files
from course_lib.errors import CourseError


def notebook(text: str, output: str = "") -> str:
    outputs = [{"output_type": "stream", "name": "stdout", "text": output}] if output else []
    cell = {"cell_type": "code", "id": "a", "metadata": {}, "source": text, "outputs": outputs}
    return notebook_text({"cells": [cell], "metadata": {}, "nbformat": 4, "nbformat_minor": 5})


@pytest.fixture
def release(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A small release of two files that tests may change."""
    shipped = tmp_path / "kit"
    shipped.mkdir()
    (shipped / "week01_exercise.ipynb").write_text(notebook("first"))
    (shipped / "map.txt").write_text("map 1")
    files = {
        "week01_exercise.ipynb": shipped / "week01_exercise.ipynb",
        "assets/map.txt": shipped / "map.txt",
    }
    monkeypatch.setattr(student_folder, "shipped_files", lambda: files)
    return shipped


def test_package_contains_lessons_and_exercises_without_checks_and_solutions() -> None:
    names = set(shipped_files())
    assert {"week00_welcome.ipynb", "week01_first_marker.ipynb", "week01_exercise.ipynb"} <= names
    assert {"week04_your_review.ipynb", "week08_your_review.ipynb"} <= names
    assert not [name for name in names if "solution" in name or name.endswith(".toml")]
    assert [name for name in names if name.endswith(".py")] == ["week07_parts.py"]  # read in lesson 7


def test_folder_for_lesson_files_is_created(tmp_path: Path, release: Path) -> None:
    prepare(tmp_path / "course")
    assert (tmp_path / "course" / "my_files").is_dir()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no limit on the size of files")
def test_file_that_does_not_fit_on_the_disk_is_copied_by_the_next_call(tmp_path: Path, release: Path) -> None:
    import resource

    place = tmp_path / "course"
    prepare(place)
    (release / "week01_exercise.ipynb").write_text(notebook("second" * 1000))
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(CourseError, match="can't write into"):
            prepare(place)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert "first" in (place / "week01_exercise.ipynb").read_text()
    assert prepare(place).lines() == ["updated: week01_exercise.ipynb"]


def test_missing_files_are_copied_and_a_second_call_changes_nothing(tmp_path: Path, release: Path) -> None:
    own_file = tmp_path / "new" / "course"
    assert prepare(own_file).added == ("week01_exercise.ipynb", "assets/map.txt")
    assert prepare(own_file).lines() == []
    (own_file / "assets" / "map.txt").unlink()
    assert prepare(own_file).added == ("assets/map.txt",)


def test_newer_release_replaces_files_that_were_only_run(tmp_path: Path, release: Path) -> None:
    prepare(tmp_path / "mine")
    (tmp_path / "mine" / "week01_exercise.ipynb").write_text(notebook("first", output="ran"))
    (release / "week01_exercise.ipynb").write_text(notebook("second"))
    assert prepare(tmp_path / "mine").updated == ("week01_exercise.ipynb",)
    assert (tmp_path / "mine" / "week01_exercise.ipynb").read_text() == notebook("second")


def test_newer_version_is_written_once_next_to_an_edited_file(tmp_path: Path, release: Path) -> None:
    own_file = tmp_path / "mine" / "week01_exercise.ipynb"
    prepare(own_file.parent)
    own_file.write_text(notebook("my answer"))
    (release / "week01_exercise.ipynb").write_text(notebook("second"))
    report = prepare(own_file.parent)
    assert report.kept == ("week01_exercise_new.ipynb",)
    assert "the new version is next to yours: week01_exercise_new.ipynb" in "\n".join(report.lines())
    assert own_file.read_text() == notebook("my answer")
    assert (own_file.parent / "week01_exercise_new.ipynb").read_text() == notebook("second")
    assert prepare(own_file.parent).lines() == []
    (release / "week01_exercise.ipynb").write_text(notebook("third"))
    assert prepare(own_file.parent).kept == ("week01_exercise_new2.ipynb",)


def test_manually_damaged_notebook_counts_as_edited(tmp_path: Path, release: Path) -> None:
    own_file = tmp_path / "mine" / "week01_exercise.ipynb"
    prepare(own_file.parent)
    own_file.write_text("{ half a notebook")
    (release / "week01_exercise.ipynb").write_text(notebook("second"))
    assert prepare(own_file.parent).kept == ("week01_exercise_new.ipynb",)
    assert own_file.read_text() == "{ half a notebook"


def test_new_exercises_get_the_stored_id(tmp_path: Path, release: Path) -> None:
    (tmp_path / "mine" / ".course").mkdir(parents=True)
    State(tmp_path / "mine").put("identity", "student", "s1")
    prepare(tmp_path / "mine")
    exercise = read_notebook(tmp_path / "mine" / "week01_exercise.ipynb")
    assert exercise["metadata"]["course"]["student"] == "s1"
    assert prepare(tmp_path / "mine").lines() == [], "the stamp is no edit"


def test_path_that_is_not_a_folder_is_rejected_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(CourseError, match="is a file, not a folder"):
        prepare(tmp_path / "file")
    with pytest.raises(CourseError, match="is the kit's own folder"):
        prepare(PACKAGE.parent)
    with pytest.raises(CourseError, match="can't write into"):
        prepare(tmp_path / "file" / "below")


def test_shipped_files_are_recorded(tmp_path: Path, release: Path) -> None:
    prepare(tmp_path / "mine")
    kept = json.loads((tmp_path / "mine" / ".course" / "shipped.json").read_text())
    assert set(kept) == {"week01_exercise.ipynb", "assets/map.txt"}
