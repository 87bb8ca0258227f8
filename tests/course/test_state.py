import errno
import json
import os
from pathlib import Path

import pytest

from course_lib.course import state as state_module
from course_lib.course.state import State, find_student_folder, student_state
from course_lib.errors import CourseError
from course_lib.files import write_atomically


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / ".course").mkdir()
    return tmp_path


def test_stored_values_are_available_to_the_next_process(folder: Path) -> None:
    State(folder).put("hints", "week01.red_cube", 2)
    State(folder).put("hints", "week01.blue_cylinder", 1)
    assert State(folder).section("hints") == {"week01.red_cube": 2, "week01.blue_cylinder": 1}


def test_state_without_a_folder_is_kept_in_memory() -> None:
    state = State(None)
    state.put("hints", "a", 1)
    assert state.get("hints", "a") == 1
    assert State(None).get("hints", "a") is None


def test_course_folder_is_found_from_a_subfolder(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "notes" / "deep").mkdir(parents=True)
    assert find_student_folder(folder / "notes" / "deep") == folder
    monkeypatch.chdir(folder / "notes")
    assert student_state().folder == folder


def test_broken_state_file_is_reported_with_a_remedy(folder: Path) -> None:
    (folder / ".course" / "hints.json").write_text("{half")
    with pytest.raises(CourseError, match=r"hints\.json is broken .* Delete it"):
        State(folder).section("hints")


def test_failed_write_keeps_the_old_file(folder: Path) -> None:
    State(folder).put("hints", "a", 1)
    with pytest.raises(TypeError):
        State(folder).put("hints", "b", object())
    assert State(folder).section("hints") == {"a": 1}


def test_atomic_write_leaves_no_temporary_file(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    for text in ("one", "two"):
        write_atomically(path, text.encode())
    assert [file.name for file in tmp_path.iterdir()] == ["page.md"]
    assert path.read_text() == "two"


def test_write_error_reports_the_file_not_its_temporary_name(tmp_path: Path) -> None:
    with pytest.raises(IsADirectoryError) as refusal:
        write_atomically(tmp_path, b"")
    assert refusal.value.filename == str(tmp_path)


def test_state_files_are_readable_json(folder: Path) -> None:
    State(folder).put("identity", "student", "zoë")
    assert json.loads((folder / ".course" / "identity.json").read_text(encoding="utf-8")) == {
        "student": "zoë"
    }


def test_state_of_a_read_only_folder_is_kept_in_memory_with_one_notice(
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


@pytest.mark.parametrize(
    ("is_notebook", "span"), [(True, "while this kernel lives"), (False, "until this command ends")]
)
def test_notice_about_a_read_only_folder_mentions_a_kernel_only_in_a_notebook(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    is_notebook: bool,
    span: str,
) -> None:
    State(folder)
    monkeypatch.setattr(os, "access", lambda *_: False)
    monkeypatch.setattr(state_module, "in_notebook", lambda: is_notebook)
    monkeypatch.chdir(folder)
    student_state()
    assert f"what you enter here is kept only {span}." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("code", "advice"), [(errno.ENOSPC, "Delete files"), (errno.EACCES, "course lab ~/my_course")]
)
def test_unwritable_values_are_kept_and_written_when_it_is_possible_again(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], code: int, advice: str
) -> None:
    def fail(path: Path, data: bytes) -> None:
        raise OSError(code, os.strerror(code), str(path))

    state = State(folder)
    state.put("checks", "week01.red_cube", 1)
    with monkeypatch.context() as full_disk:
        full_disk.setattr(state_module, "write_atomically", fail)
        state.put("checks", "week01.blue_cylinder", 2)
        state.put("checks", "week01.red_cube", 3)
    assert not state.is_saved("checks")
    # Also for another object: each check asks for the state again.
    assert State(folder).get("checks", "week01.red_cube") == 3
    (line,) = capsys.readouterr().out.splitlines()
    assert f"{folder / '.course'} cannot be written: {os.strerror(code)}." in line
    assert advice in line
    state.put("checks", "week01.post", 4)
    assert state.is_saved("checks")
    stored = json.loads((folder / ".course" / "checks.json").read_text())
    assert stored == {"week01.blue_cylinder": 2, "week01.red_cube": 3, "week01.post": 4}
