import json
import os
import re
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from course_lib.course import progress
from course_lib.course.state import State, cell_digest
from course_lib.errors import CourseError
from course_lib.grading.check import check
from course_lib.grading.check_file import check_file
from course_lib.grading.store import Course
from course_lib.grading.submissions.submit import Receipt, submit
from course_lib.grading.task import Catalog, load_catalog

NODE, HALF, ANSWER = range(3)  # the cells of the right answer
DEFINED = "def half(length):"


@pytest.fixture
def folder(course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A student's folder; the small course is the one that is installed."""
    catalog = load_catalog(course.exercises)
    for module in ("check", "check_file", "submissions.submit", "task"):
        monkeypatch.setattr(f"course_lib.grading.{module}.shipped_catalog", lambda: catalog)
    monkeypatch.setattr("course_lib.grading.submissions.submit.exercises_dir", lambda: course.exercises)
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


def test_unchanged_checked_notebook_has_no_submission_warning(checked: list[str], folder: Path) -> None:
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
            ["half is missing: no cell defines half", "code cell 2 (def halve(length):) has"],
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
def test_task_changed_since_its_check_is_reported(
    checked: list[str], write: Callable[..., Path], number: int, old: str, new: str, warnings: list[str]
) -> None:
    checked[number] = checked[number].replace(old, new)
    found = warned(write(checked))
    for warning in warnings:
        assert any(warning in line for line in found), found


def test_task_of_a_deleted_cell_is_reported_as_missing(
    checked: list[str], write: Callable[..., Path]
) -> None:
    del checked[HALF]
    assert warned(write(checked)) == ["half is missing: no cell defines half"]


def test_unrun_cell_is_reported_except_after_the_last_check(
    checked: list[str], write: Callable[..., Path]
) -> None:
    values = "my_values = dict\n"
    found = warned(write([values, *checked, "live.stop()"], ran=False))
    assert found == ["code cell 1 (my_values = dict) was never run"]
    found = warned(write([values, *checked]))
    assert found == ["code cell 1 (my_values = dict) has changed since the last check"]


def test_cells_that_tasks_depend_on_are_reported_and_measurements_are_not(
    checked: list[str], write: Callable[..., Path]
) -> None:
    own = ["%ros2 topic hz /cube", "live = run_live(Node('two'))\nlive.rate = 2.0", "print(half(3.0))"]
    assert warned(write([*own, *checked])) == []
    assert warned(write([*own, *checked], ran=False)) == []
    indirect = ["FACTOR = 2\n", "def my_values(task):\n    return {'n': FACTOR}\n", "Marker.CUBE = 3\n"]
    assert warned(write([*own, *indirect, *checked])) == [
        "code cell 4 (FACTOR = 2) has changed since the last check",
        "code cell 5 (def my_values(task):) has changed since the last check",
        "code cell 6 (Marker.CUBE = 3) has changed since the last check",
    ]


def test_failed_and_unchecked_tasks_are_reported(
    write: Callable[..., Path], right: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    check_file(write([text.replace("/ 2", "/ 3") for text in right.split("# next cell\n")]))
    assert warned(folder / "week01_exercise.ipynb") == ["half failed its last check"]
    (folder / ".course/checks.json").unlink()
    assert warned(folder / "week01_exercise.ipynb") == [
        "it was never checked here: run course check week01_exercise.ipynb first"
    ]


def test_commands_in_warnings_contain_the_typed_name(write: Callable[..., Path], folder: Path) -> None:
    (folder / "old work").mkdir()
    path = write().rename(folder / "old work/week01_exercise.ipynb")
    text = submit(path).text()
    assert 'run course check "old work/week01_exercise.ipynb" first' in text
    assert text.endswith('run again: course submit "old work/week01_exercise.ipynb"')


def test_copy_of_the_notebook_in_which_more_tasks_passed_is_reported(
    checked: list[str], write: Callable[..., Path], folder: Path
) -> None:
    (folder / "notes.ipynb").write_text("not a notebook")
    answered = write(checked).rename(folder / "week01_exercise-Copy1.ipynb")
    assert warned(answered) == []
    stub = f"{DEFINED}\n    raise NotImplementedError()\n"
    found = warned(write([*checked[:HALF], stub, *checked[ANSWER:]]))
    assert found[-1] == (
        "week01_exercise-Copy1.ipynb has 3 tasks that passed, this notebook 2: "
        "to submit that one, type course submit week01_exercise-Copy1.ipynb"
    )


def test_unchanged_stub_of_a_task_is_reported_as_empty(
    checked: list[str], write: Callable[..., Path], folder: Path, course: Course
) -> None:
    broken = [*checked[:HALF], f"{DEFINED}\n    return length\n", *checked[ANSWER:]]
    (course.exercises / "week01_exercise.ipynb").write_bytes(write(broken).read_bytes())
    assert warned(write(broken)) == [f"half is empty: code cell 2 ({DEFINED}) is unchanged"]


def test_unchanged_stub_of_a_bonus_task_is_not_reported(
    checked: list[str],
    write: Callable[..., Path],
    folder: Path,
    course: Course,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    broken = [*checked[:HALF], f"{DEFINED}\n    return length\n", *checked[ANSWER:]]
    (course.exercises / "week01_exercise.ipynb").write_bytes(write(broken).read_bytes())
    monkeypatch.setattr(Catalog, "points", lambda catalog, task: (10.0, task.id == "week01.half"))
    assert warned(write(broken)) == []
    tried = [*checked[:HALF], f"{DEFINED}\n    return length + 1\n", *checked[ANSWER:]]
    assert "half has changed since its last check" in warned(write(tried))[0]


def test_notebook_saved_before_the_last_check_is_reported_as_outdated(
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
    assert re.match(r"the notebook was saved at \S+ on \d+ \w+ 2020, before", found[1])
    assert "press Ctrl+S and submit again" in found[1]


def test_saved_version_that_was_run_before_the_checked_one_is_reported(
    write: Callable[..., Path], right: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    cells = right.split("# next cell\n")
    first, checked = f"{DEFINED}\n    return length", f"{DEFINED}\n    return length * 0.5"
    history = [cells[NODE], first, "half(1.0)", checked]
    shell = SimpleNamespace(history_manager=SimpleNamespace(input_hist_raw=history))
    with monkeypatch.context() as kernel:
        kernel.setattr("IPython.get_ipython", lambda: shell)
        check("week01.half", lambda length: length * 0.5)
    cells[HALF] = first
    assert any(line.startswith("half has changed since its last check") for line in warned(write(cells)))
    cells[HALF] = checked
    assert not any(line.startswith("half") for line in warned(write(cells)))


def test_last_check_in_the_future_is_reported_as_a_changed_clock(
    checked: list[str], write: Callable[..., Path], folder: Path
) -> None:
    checks = folder / ".course" / "checks.json"
    year = datetime.now(UTC).year
    checks.write_text(checks.read_text().replace(f'"time": "{year}', f'"time": "{year + 1}'))
    path = write([*checked[:HALF], f"{DEFINED}\n    return length * 0.5", *checked[ANSWER:]])
    (warning,) = [line for line in submit(path).warnings if "last check was at" in line]
    assert f"{year + 1}, in the future: the clock of this computer was changed." in warning
    assert warning.endswith("Run: course check week01_exercise.ipynb")


def test_student_id_mismatch_with_the_folder_is_reported(
    checked: list[str], write: Callable[..., Path]
) -> None:
    (warning,) = warned(write(student="eve"))
    assert "has the student ID eve, but yours is ada" in warning


@pytest.mark.parametrize("content", ["{", "[]", '{"week01.half": 3}', '{"week01.half": {"time": "x"}}'])
def test_damaged_check_history_does_not_prevent_packing(
    checked: list[str], folder: Path, content: str
) -> None:
    for name in ("checks", "packed_files"):
        (folder / f".course/{name}.json").write_text(content)
    assert warned(folder / "week01_exercise.ipynb")
    assert (folder / "week01_exercise_ada.zip").is_file()


def test_module_of_the_student_is_reported_as_missing_from_the_submission(
    checked: list[str], write: Callable[..., Path], folder: Path
) -> None:
    (folder / "my_nodes.py").write_text("a = 1\n")
    warnings = warned(write([*checked, "from my_nodes import a"]))
    assert [line.split(":")[0] for line in warnings] == [
        "my_nodes.py is not part of your submission, and your code will not find it at grading"
    ]


@pytest.mark.parametrize(("student", "whose"), [("bob", "for the ID bob"), ("", "without an ID")])
def test_check_with_the_numbers_of_another_id_is_reported(
    write: Callable[..., Path], folder: Path, student: str, whose: str
) -> None:
    State(folder).put("identity", "student", student or None)
    check_file(write(student=student))
    State(folder).put("identity", "student", "ada")
    text = f"answer was last checked {whose}, with other numbers than yours: check it again"
    assert text in warned(write(student="ada"))


@pytest.mark.parametrize("cell", ["%%time\nx = 1", "!ls\nawait y", "x?", "%ros2 topic list | wc", ""])
def test_ipython_syntax_is_not_a_syntax_error(
    checked: list[str], write: Callable[..., Path], cell: str
) -> None:
    assert warned(write([*checked, cell])) == []


@pytest.mark.slow
def test_status_reports_the_packed_tasks_and_whether_the_package_is_current(
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
def test_notebook_name_is_accepted_without_extension(checked: list[str], folder: Path, typed: str) -> None:
    assert submit(Path(typed)).content["exercise"] == "week01_exercise"
    assert check_file(Path(typed))


@pytest.mark.parametrize("typed", ["week01", "week1_exercise", "week01_exercise.ipyn", "../week01_exercise"])
def test_misspelled_notebook_name_is_reported_with_the_closest_match(
    checked: list[str], folder: Path, typed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(CourseError, match=r"Did you mean .*week01_exercise\.ipynb"):
        submit(Path(typed))
    monkeypatch.chdir(folder.parent)
    with pytest.raises(CourseError, match=r"Did you mean mine/week01_exercise\.ipynb"):
        submit(Path("week01_exercise"))


def test_stub_that_was_run_before_the_right_answer_is_empty(
    checked: list[str], write: Callable[..., Path], folder: Path
) -> None:
    stub = f"{DEFINED}\n    raise NotImplementedError"
    assert check_file(write([*checked, f"# {stub}"]))
    state = State(folder)
    state.put("checks", "week01.half", {**state.get("checks", "week01.half"), "cells": [cell_digest(stub)]})
    checked[HALF] = stub
    assert any(line.startswith("half is not complete") for line in warned(write(checked)))


def test_renamed_exercise_is_suggested(write: Callable[..., Path], folder: Path) -> None:
    path = write()
    content = json.loads(path.read_text())
    content["metadata"]["course"]["exercise"] = "week01_exercise"
    (folder / "mine.ipynb").write_text(json.dumps(content))
    path.rename(folder / "week02_exercise.ipynb")
    with pytest.raises(CourseError, match=r"there is no week01_exercise\.ipynb.*mine\.ipynb"):
        submit(Path("week01_exercise.ipynb"))
