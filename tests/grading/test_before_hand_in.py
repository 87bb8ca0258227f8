import json
import os
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from course_lib.course import progress
from course_lib.course.state import State
from course_lib.errors import CourseError
from course_lib.grading.catalog import load_catalog
from course_lib.grading.check import check
from course_lib.grading.check_file import check_file
from course_lib.grading.handin.submit import Receipt, submit
from course_lib.grading.records import Course

NODE, HALF, ANSWER = range(3)  # the cells of the right answer
DEFINED = "def half(length):"


@pytest.fixture
def folder(course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A student's folder; the small course is the one that is installed."""
    catalog = load_catalog(course.exercises)
    for module in ("check", "check_file", "handin.submit", "catalog"):
        monkeypatch.setattr(f"course_lib.grading.{module}.shipped_catalog", lambda: catalog)
    monkeypatch.setattr("course_lib.grading.handin.submit.exercises_dir", lambda: course.exercises)
    (tmp_path / "mine/.course").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "mine")
    State(tmp_path / "mine").put("identity", "student", "ada")
    return tmp_path / "mine"


@pytest.fixture
def write(folder: Path, right: str) -> Callable[..., Path]:
    """Write the exercise; by default the right answer, run from top to bottom."""

    def write(cells: Sequence[str] | None = None, ran: bool = True, student: str = "ada") -> Path:
        sources = right.split("# next cell\n") if cells is None else cells
        made = [
            {"cell_type": "code", "source": text, "execution_count": 1 if ran else None} for text in sources
        ]
        path = folder / "week01_exercise.ipynb"
        metadata = {"course": {"student": student}}
        path.write_text(json.dumps({"nbformat": 4, "metadata": metadata, "cells": made}))
        return path

    return write


@pytest.fixture
def checked(write: Callable[..., Path], capsys: pytest.CaptureFixture[str], right: str) -> list[str]:
    """The cells of the right answer, which were checked."""
    assert check_file(write())
    capsys.readouterr()
    return right.split("# next cell\n")


def warned(path: Path) -> list[str]:
    receipt = submit(path)
    assert receipt.file.is_file()
    for line in receipt.warnings:
        assert line in receipt.text()
    return list(receipt.warnings)


def test_what_was_checked_as_it_is_has_no_warning(checked: list[str], folder: Path) -> None:
    receipt = submit(folder / "week01_exercise.ipynb")
    assert receipt.warnings == ()
    assert "look at" not in receipt.text()


@pytest.mark.parametrize(
    ("number", "old", "new", "warnings"),
    [
        (
            HALF,
            "2",
            "2  # two",
            ["half has changed since its last check: run code cell 2 (def half(length):)"],
        ),
        (
            HALF,
            "half",
            "halve",
            ["half is missing: no cell makes half", "code cell 2 (def halve(length):) has"],
        ),
        (
            HALF,
            ":",
            "",
            ["code cell 2 (def half(length)), line 1: expected ':'", "half cannot run: code cell 2"],
        ),
        (HALF, "return length / 2", "raise NotImplementedError()", ["half is not complete: code cell 2"]),
        (ANSWER, "2 *", "3 *", ["answer has changed"]),
        (NODE, "import check", "import check as check", ["red_cube has changed"]),
    ],
)
def test_a_task_that_is_not_as_checked_is_named(
    checked: list[str], write: Callable[..., Path], number: int, old: str, new: str, warnings: list[str]
) -> None:
    checked[number] = checked[number].replace(old, new)
    found = warned(write(checked))
    for warning in warnings:
        assert any(warning in line for line in found), found


def test_a_deleted_cell_makes_its_task_missing(checked: list[str], write: Callable[..., Path]) -> None:
    del checked[HALF]
    assert warned(write(checked)) == ["half is missing: no cell makes half"]


def test_a_cell_that_was_never_run_is_named_and_one_behind_the_last_check_is_not(
    checked: list[str], write: Callable[..., Path]
) -> None:
    found = warned(write(["HEIGHT = 3\n", *checked, "live.stop()"], ran=False))
    assert found == ["code cell 1 (HEIGHT = 3) was never run"]
    found = warned(write(["HEIGHT = 3\n", *checked]))
    assert found == ["code cell 1 (HEIGHT = 3) has changed since the last check"]


def test_a_failed_and_an_unchecked_task_are_named(
    write: Callable[..., Path], right: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    check_file(write([text.replace("/ 2", "/ 3") for text in right.split("# next cell\n")]))
    assert warned(folder / "week01_exercise.ipynb") == ["half failed its last check"]
    (folder / ".course/checks.json").unlink()
    assert warned(folder / "week01_exercise.ipynb") == [
        "it was never checked here: type course check week01_exercise.ipynb first"
    ]


def test_what_is_as_it_was_handed_out_is_empty(
    checked: list[str], write: Callable[..., Path], folder: Path, course: Course
) -> None:
    broken = [*checked[:HALF], f"{DEFINED}\n    return length\n", *checked[ANSWER:]]
    (course.exercises / "week01_exercise.ipynb").write_bytes(write(broken).read_bytes())
    assert warned(write(broken)) == [f"half is empty: code cell 2 ({DEFINED}) is as it was handed out"]


def test_a_notebook_that_was_saved_before_the_last_check_may_lack_what_was_checked(
    write: Callable[..., Path], right: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    history = [*right.split("# next cell\n")[:1], f"{DEFINED}\n    return length * 0.5"]
    shell = SimpleNamespace(history_manager=SimpleNamespace(input_hist_raw=history))
    with monkeypatch.context() as kernel:
        kernel.setattr("IPython.get_ipython", lambda: shell)
        check("week01.half", lambda length: length * 0.5)
    path, early = write(), datetime(2020, 1, 1, 12, tzinfo=UTC).timestamp()
    os.utime(path, (early, early))
    found = [line for line in submit(path).warnings if "saved" in line or "half" in line]
    assert found[0].startswith("half has changed since its last check")
    assert found[1].startswith("the notebook was saved at")
    assert "press Ctrl+S and submit again" in found[1]


def test_an_id_that_is_not_the_folders_is_named(checked: list[str], write: Callable[..., Path]) -> None:
    (warning,) = warned(write(student="eve"))
    assert "names the student eve, but your ID is ada" in warning


@pytest.mark.parametrize("content", ["{", "[]", '{"week01.half": 3}', '{"week01.half": {"time": "x"}}'])
def test_a_broken_memory_does_not_stop_packing(checked: list[str], folder: Path, content: str) -> None:
    for name in ("checks", "packed_files"):
        (folder / f".course/{name}.json").write_text(content)
    assert warned(folder / "week01_exercise.ipynb")
    assert (folder / "week01_exercise_ada.zip").is_file()


@pytest.mark.parametrize("cell", ["%%time\nx = 1", "!ls\nawait y", "x?", "%ros2 topic list | wc", ""])
def test_what_ipython_understands_is_no_syntax_error(
    checked: list[str], write: Callable[..., Path], cell: str
) -> None:
    assert warned(write([*checked, cell])) == []


def test_status_says_what_the_packed_file_holds_and_whether_it_is_up_to_date(
    checked: list[str], write: Callable[..., Path], folder: Path
) -> None:
    def told() -> Any:
        return progress.status(folder)[1].splitlines()

    packed: Receipt = submit(folder / "week01_exercise.ipynb")
    assert told()[0] == (
        "week01_exercise_ada.zip holds 3 tasks of week01_exercise.ipynb, when packed "
        "passed: red_cube, half, answer."
    )
    checked[HALF] += "# changed"
    write(checked)
    assert told()[0].endswith("week01_exercise.ipynb has changed since: course submit week01_exercise.ipynb")
    submit(folder / "week01_exercise.ipynb")
    assert "when packed passed: red_cube, answer; changed since its check: half." in told()[0]
    packed.file.unlink()
    assert "It is no longer at" in told()[0]


@pytest.mark.parametrize("typed", ["week01_exercise", "week01_exercise.ipynb"])
def test_a_notebook_may_be_typed_without_its_ending(checked: list[str], folder: Path, typed: str) -> None:
    assert submit(Path(typed)).content["exercise"] == "week01_exercise"
    assert check_file(Path(typed))


@pytest.mark.parametrize("typed", ["week01", "week1_exercise", "week01_exercise.ipyn", "../week01_exercise"])
def test_a_name_that_is_nearly_right_is_answered_with_the_right_one(
    checked: list[str], folder: Path, typed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(CourseError, match=r"Did you mean .*week01_exercise\.ipynb"):
        submit(Path(typed))
    monkeypatch.chdir(folder.parent)
    with pytest.raises(CourseError, match=r"Did you mean mine/week01_exercise\.ipynb"):
        submit(Path("week01_exercise"))
