import json
import os
from pathlib import Path

import pytest

from course_lib.course import state as state_module
from course_lib.course.state import State, find_student_folder, student_state, write_whole
from course_lib.errors import CourseError


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / ".course").mkdir()
    return tmp_path


def test_what_is_put_is_there_for_the_next_process(folder: Path) -> None:
    State(folder).put("hints", "week01.red_cube", 2)
    State(folder).put("hints", "week01.blue_cylinder", 1)
    assert State(folder).section("hints") == {"week01.red_cube": 2, "week01.blue_cylinder": 1}


def test_without_a_folder_it_lives_in_memory() -> None:
    state = State(None)
    state.put("hints", "a", 1)
    assert state.get("hints", "a") == 1
    assert State(None).get("hints", "a") is None


def test_the_folder_is_found_from_below(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "notes" / "deep").mkdir(parents=True)
    assert find_student_folder(folder / "notes" / "deep") == folder
    monkeypatch.chdir(folder / "notes")
    assert student_state().folder == folder


def test_a_broken_file_is_named_with_what_to_do(folder: Path) -> None:
    (folder / ".course" / "hints.json").write_text("{half")
    with pytest.raises(CourseError, match=r"hints\.json is broken .* Delete it"):
        State(folder).section("hints")


def test_a_failed_write_leaves_the_old_file(folder: Path) -> None:
    State(folder).put("hints", "a", 1)
    with pytest.raises(TypeError):
        State(folder).put("hints", "b", object())
    assert State(folder).section("hints") == {"a": 1}


def test_an_atomic_write_leaves_no_draft_behind(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    for text in ("one", "two"):
        write_whole(path, text.encode())
    assert [file.name for file in tmp_path.iterdir()] == ["page.md"]
    assert path.read_text() == "two"


def test_what_cannot_be_written_is_named_itself_not_its_draft(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError) as refusal:
        write_whole(tmp_path, b"")
    assert refusal.value.filename == str(tmp_path)


def test_files_are_readable_json(folder: Path) -> None:
    State(folder).put("identity", "student", "zoë")
    assert json.loads((folder / ".course" / "identity.json").read_text(encoding="utf-8")) == {
        "student": "zoë"
    }


def test_in_a_shared_folder_that_is_read_only_the_kernel_keeps_the_state_and_says_so_once(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    State(folder).put("identity", "student", "instructor")
    monkeypatch.setattr(state_module, "_of_this_process", State(None))
    monkeypatch.setattr(os, "access", lambda *_: False)  # permissions do not bind root
    monkeypatch.chdir(folder)
    for student in ("ada", "grace"):
        student_state().put("identity", "student", student)
    assert student_state().get("identity", "student") == "grace"
    assert State(folder).get("identity", "student") == "instructor"
    (line,) = capsys.readouterr().out.splitlines()
    assert f"{folder} cannot be written" in line
    assert "course lab ~/my_course" in line
