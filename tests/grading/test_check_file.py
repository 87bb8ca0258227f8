from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.course.state import student_state
from course_lib.errors import CourseError
from course_lib.grading.check import check
from course_lib.grading.check_file import check_file
from course_lib.grading.store import Course
from course_lib.grading.task import load_catalog

WriteNotebook = Callable[..., Path]


@pytest.fixture(autouse=True)
def installed(course: Course, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The small course is the one that is installed."""
    catalog = load_catalog(course.exercises)
    monkeypatch.setattr("course_lib.grading.check_file.shipped_catalog", lambda: catalog)
    monkeypatch.chdir(tmp_path)


def test_correct_notebook_passes_its_public_checks(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert check_file(write_notebook(tmp_path / "week01_exercise.ipynb", right, student="ada"))
    assert capsys.readouterr().out.count("hidden checks run at grading") == 3


def test_incorrect_notebook_shows_failure_reasons_and_cell_errors(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = right.replace("length / 2", "length") + "# next cell\nnothing\n"
    assert not check_file(write_notebook(tmp_path / "week01_exercise.ipynb", code))
    output = capsys.readouterr().out
    assert "NameError: name 'nothing' is not defined" in output
    assert "expected 2.00 m: 2.00 m too much" in output
    assert "Hint: Compute one case by hand" in output


def test_notebook_that_is_not_an_exercise_is_rejected(write_notebook: WriteNotebook, tmp_path: Path) -> None:
    with pytest.raises(CourseError, match="not an exercise of this course"):
        check_file(write_notebook(tmp_path / "homework.ipynb", "x = 1", exercise="homework"))


def test_exercise_of_an_unknown_week_lists_the_known_weeks(
    write_notebook: WriteNotebook, tmp_path: Path
) -> None:
    with pytest.raises(
        CourseError, match=r"belongs to week08, but course\.toml has no \[weeks\.week08\]; it has week01"
    ):
        check_file(write_notebook(tmp_path / "week08_exercise.ipynb", "x = 1"))


@pytest.mark.slow
def test_missing_or_different_student_id_is_reported(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    check_file(write_notebook(tmp_path / "week01_exercise.ipynb", right))
    assert "Your student ID is not set" in capsys.readouterr().out
    (tmp_path / ".course").mkdir()
    student_state().put("identity", "student", "bob")
    assert check_file(write_notebook(tmp_path / "week01_exercise.ipynb", right))
    assert "bob" not in capsys.readouterr().out
    assert check_file(write_notebook(tmp_path / "week01_exercise.ipynb", right, student="Ada"))
    assert "has the student ID ada, but yours is bob" in capsys.readouterr().out


def test_notebook_and_command_line_show_equal_tables(
    course: Course,
    right: str,
    write_notebook: WriteNotebook,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    wrong = right.replace("length / 2", "length").replace("position.z = 0.5", "position.z = 0.2")
    (tmp_path / "one/.course").mkdir(parents=True)
    (tmp_path / "two/.course").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "one")
    check_file(write_notebook(tmp_path / "week01_exercise.ipynb", wrong))
    on_the_command_line = capsys.readouterr().out.split("\n\n")
    monkeypatch.chdir(tmp_path / "two")
    monkeypatch.setattr("course_lib.grading.check.shipped_catalog", lambda: load_catalog(course.exercises))
    monkeypatch.setattr("course_lib.grading.task.shipped_catalog", lambda: load_catalog(course.exercises))
    names: dict[str, object] = {}
    code = wrong.replace("%load_ext course_lib", "").replace('check("week01.answer", answer)', "")
    exec(code, names)
    capsys.readouterr()
    for task, name in (("red_cube", "RedCubeNode"), ("half", "half"), ("answer", "answer")):
        check(f"week01.{task}", names[name])
    output = capsys.readouterr().out.strip()
    # After a task that passes, a notebook also shows the points so far and the next task.
    output = "\n".join(line for line in output.splitlines() if "points so far" not in line)
    assert output.split("\nweek01.")[1:] == [
        table.strip().removeprefix("week01.") for table in on_the_command_line[1:]
    ]


def test_missing_import_is_reported_once_for_all_cells(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = right.replace("from rclpy.node import Node\n", "")
    more = "# next cell\nclass Other(Node): ...\n# next cell\nOther()\n# next cell\nRedCubeNode()\n"
    assert not check_file(write_notebook(tmp_path / "week01_exercise.ipynb", code + more))
    output = capsys.readouterr().out
    assert output.count("NameError") == 1
    assert "name 'Node' is not defined" in output
    assert "hint: import it: `from rclpy.node import Node`" in output
    assert "3 more cells cannot run for the same reason." in output
    assert (
        "week01.red_cube (A red cube): not checked, because RedCubeNode cannot run; the reason is above."
        in output
    )
    assert "week01.half (Half of it): 1 of 1 checks passed" in output
    assert student_state().get("progress", "week01.red_cube")["score"] == 0
    assert "Hint" not in output


def test_errors_with_independent_causes_are_all_reported(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = "# next cell\nx = 1 / 0\n# next cell\ny = x\n# next cell\nz = w\n# next cell\n{}['k']\n"
    check_file(write_notebook(tmp_path / "week01_exercise.ipynb", right + more))
    output = capsys.readouterr().out
    for cause in ("ZeroDivisionError", "name 'w' is not defined", "KeyError"):
        assert cause in output
    assert "name 'x'" not in output
    assert "1 more cell cannot run" in output


def test_output_printed_in_the_sandbox_is_shown(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = right.replace("    return length / 2", "    print('got', length)\n    return length / 2")
    check_file(write_notebook(tmp_path / "week01_exercise.ipynb", code))
    assert "It printed:\n  | got 4.0\n" in capsys.readouterr().out


def test_missing_import_cell_is_reported_once_for_all_undefined_names(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = "# next cell\n".join(["class RedCubeNode(Node): ...\n", "rclpy.init()\n", "x = math.pi\n", "x\n"])
    half = "# next cell\ndef half(length):\n    return np.divide(length, 2)\n"
    check_file(write_notebook(tmp_path / "week01_exercise.ipynb", code + half))
    output = capsys.readouterr().out
    assert output.count("NameError") == 1
    assert "No cell imports or defines Node, rclpy, math: is the cell with the imports missing?" in output
    assert "3 more cells cannot run for the same reason." in output
    assert "week01.half (Half of it): not checked, because half cannot run; the reason is above." in output


OWN_FILE = "my_half.py is not part of your submission"


@pytest.mark.parametrize("line", ["from my_half import half", "import my_half", "%run my_half.py"])
def test_module_of_the_student_is_reported_because_it_is_not_submitted(
    line: str,
    right: str,
    write_notebook: WriteNotebook,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "my_half.py").write_text("def half(length):\n    return length / 2\n")
    code = f"{right}# next cell\n{line}\n"
    check_file(write_notebook(tmp_path / "week01_exercise.ipynb", code))
    assert OWN_FILE in capsys.readouterr().out
    (tmp_path / "my_half.py").unlink()
    check_file(write_notebook(tmp_path / "week01_exercise.ipynb", code))
    assert OWN_FILE not in capsys.readouterr().out


def test_hint_for_a_slip_is_shown_on_the_command_line(
    right: str, write_notebook: WriteNotebook, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = right.replace("return length / 2", "length == length / 2\n    return length")
    assert not check_file(write_notebook(tmp_path / "week01_exercise.ipynb", code))
    assert 'Hint: "length == length / 2" compares and changes nothing' in capsys.readouterr().out
