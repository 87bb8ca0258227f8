"""Marks by hand count, survive every regrading, and are asked for until they are there."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.marks.by_hand import mark_by_hand
from course_lib.grading.marks.mark import results_in
from course_lib.grading.records import Course
from course_lib.grading.reports.tables import write_gradebook

WriteNotebook = Callable[..., Path]
POINTS = """
title = "A course"
time_zone = "Europe/Paris"
[weeks.week05]
title = "Kinds"
deadline = 2026-10-11T23:59:00
[weeks.week05.points]
essay = 40
layout = 30
motto = 30
"""
TASKS = """
from course_lib.grading.task import Row, Scenario, Task
from course_lib.grading import expect_text

HINTS = ("a", "b", "c")
TASKS = (
    Task("week05.essay", "Why TF?", "written", "essay", HINTS,
         rubric=(Row("names the parts", 5), Row("an example", 15))),
    Task("week05.layout", "A layout", "file", "layout", HINTS, scenarios=(
        Scenario("public", checks=(expect_text("Fixed Frame: map"),)),)),
    Task("week05.motto", "A motto", "text", "motto", HINTS, scenarios=(
        Scenario("public", checks=(expect_text("robot"),)),)),
)
"""
ANSWERS = """
essay = "Frames <b>move</b>."
layout = "views/mine.rviz"
motto = "Be kind to a robot"
"""


@pytest.fixture
def kinds(tmp_path: Path, write_notebook: WriteNotebook) -> Course:
    """A course of a written, a file and a text task, and ada's answers to it, two days late."""
    for name, text in {
        "exercises/course.toml": POINTS,
        "exercises/checks/week05.py": TASKS,
        "solutions/checks/week05.py": "HIDDEN = {}",
    }.items():
        (tmp_path / "course" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "course" / name).write_text(text)
    notebook = write_notebook(tmp_path / "in/ada/week05_exercise.ipynb", ANSWERS, student="ada")
    (notebook.parent / "views").mkdir()
    (notebook.parent / "views/mine.rviz").write_text("Global Options:\n  Fixed Frame: map\n")
    notebook.with_name("timestamp.txt").write_text("2026-10-13 12:00:00 UTC")
    course = Course(tmp_path / "course/exercises", tmp_path / "course/solutions")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    return course


def line(out: Path) -> tuple[float, float, str]:
    """Score and final mark of the one submission, and its status."""
    (result,) = results_in(out)
    return result["row"]["score"], result["row"]["final"], result["row"]["status"]


def test_file_and_text_are_judged_and_a_written_task_waits(kinds: Course, tmp_path: Path) -> None:
    assert line(tmp_path / "out") == (60, 48, "needs_marking")
    page = (tmp_path / "out/reports/ada/week05_exercise.html").read_text()
    assert "Frames &lt;b&gt;move&lt;/b&gt;." in page
    assert "A person reads and marks this task." in page


def test_rows_of_a_rubric_add_up_when_all_are_there_and_regrading_keeps_them(
    kinds: Course, tmp_path: Path
) -> None:
    out = tmp_path / "out"
    args = (out, "ada", "week05_exercise", "week05.essay")
    mark_by_hand(*args, "5", row="1", comment="clear", course=kinds)
    assert line(out)[2] == "needs_marking"
    said = mark_by_hand(*args, "7.5", row="an ex", comment="<i>short</i>", course=kinds)
    assert said == "ada week05_exercise: 7.5 for week05.essay (an example); now 68, graded"
    assert line(out) == (85, 68, "graded")
    assert "<td>needs_marking</td>" not in (out / "reports/index.html").read_text()
    assert "an example: &lt;i&gt;short&lt;/i&gt;" in (out / "reports/ada/week05_exercise.html").read_text()
    before = (out / "gradebook.csv").read_bytes()
    (out / "gradebook.csv").unlink()
    write_gradebook(out, results_in(out))
    assert (out / "gradebook.csv").read_bytes() == before
    for resume, rejudge in ((False, False), (True, False), (False, True)):
        grade(tmp_path / "in", out, jobs=1, course=kinds, resume=resume, rejudge=rejudge)
        assert (out / "gradebook.csv").read_bytes() == before


def test_the_last_word_counts_and_all_are_kept_with_who_and_when(kinds: Course, tmp_path: Path) -> None:
    out = tmp_path / "out"
    for points in ("10", "20"):
        mark_by_hand(out, "ada", "week05_exercise", "week05.essay", points, course=kinds)
    mark_by_hand(out, "ada", "week05_exercise", "week05.motto", "0", comment="copied", course=kinds)
    assert line(out) == (50, 40, "graded")
    entries = json.loads((out / "marks/ada/week05_exercise.json").read_text())
    assert [entry["points"] for entry in entries] == [10, 20, 0]
    assert all(entry["by"] and entry["at"].endswith("+00:00") for entry in entries)


def test_points_for_another_hand_in_wait_for_a_second_look(
    kinds: Course, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    out, notebook = tmp_path / "out", tmp_path / "in/ada/week05_exercise.ipynb"
    args = (out, "ada", "week05_exercise")
    mark_by_hand(*args, "essay", "40", course=kinds)
    mark_by_hand(*args, "motto", "0", course=kinds)
    write_notebook(notebook, ANSWERS.replace("Be kind", "Listen"), student="ada")
    grade(tmp_path / "in", out, jobs=1, course=kinds, resume=True)
    assert line(out) == (70, 56, "needs_marking")
    (result,) = results_in(out)
    assert (
        "week05.essay, week05.motto: marked in another hand-in: mark it again" in (result["row"]["message"])
    )
    mark_by_hand(*args, "motto", "30", course=kinds)
    assert line(out) == (100, 80, "needs_marking")
    mark_by_hand(*args, "essay", "40", course=kinds)
    assert line(out) == (100, 80, "graded")


def test_an_accepted_id_is_looked_at_again_in_another_hand_in(
    kinds: Course, tmp_path: Path, write_notebook: WriteNotebook, capsys: pytest.CaptureFixture[str]
) -> None:
    notebook, out = tmp_path / "in/ada/week05_exercise.ipynb", tmp_path / "out"
    for number, name in enumerate(("bob", "cleo")):
        capsys.readouterr()
        write_notebook(notebook, f"{ANSWERS}\nnumber = {number}", student=name)
        grade(tmp_path / "in", out, jobs=1, course=kinds, resume=True)
        assert line(out)[2] == "needs_marking"
        assert "Look at: ID mismatch: 1 submission" in capsys.readouterr().out
        mark_by_hand(out, "ada", "week05_exercise", "essay", "40", course=kinds)
        grade(tmp_path / "in", out, jobs=1, course=kinds, resume=True)
        assert line(out)[2] == "graded"
        assert "Look at" not in capsys.readouterr().out


def test_a_mark_whose_file_is_gone_is_named(
    kinds: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in/ada").rename(tmp_path / "in/bob")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=kinds)
    said = "Look at: no file any more, but its mark counts: ada week05_exercise. Moved or withdrawn?"
    assert said in capsys.readouterr().out
    (tmp_path / "out/results/ada/week05_exercise.json").unlink()
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=kinds, resume=True)
    assert said not in capsys.readouterr().out
    assert "ada,week05" not in (tmp_path / "out/gradebook.csv").read_text()


def test_a_rejected_file_has_no_mark_to_change(kinds: Course, tmp_path: Path) -> None:
    (tmp_path / "in/ada/week05_exercise.ipynb").write_text("{")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=kinds)
    with pytest.raises(
        CourseError, match=r"week05_exercise of ada has no mark to change: gradebook\.csv says why"
    ):
        mark_by_hand(tmp_path / "out", "ada", "week05_exercise", "essay", "1", course=kinds)


def test_a_task_goes_by_its_short_name_and_a_student_by_any_spelling(kinds: Course, tmp_path: Path) -> None:
    said = mark_by_hand(tmp_path / "out", "ADA", "week05", "essay", "40", course=kinds)
    assert said == "ada week05_exercise: 40 for week05.essay; now 80, graded"


@pytest.mark.parametrize(
    ("student", "task", "points", "row", "message"),
    [
        ("bob", "week05.essay", "1", "", "has no student 'bob'; there is ada"),
        ("adda", "week05.essay", "1", "", "has no student 'adda'. Did you mean ada"),
        ("../out", "week05.essay", "1", "", "has no student '../out'"),
        ("ada", "week05.poem", "1", "", "has no task 'week05.poem'. Did you mean week05"),
        ("ada", "esay", "1", "", "has no task 'esay'. Did you mean essay"),
        ("ada", "week05.essay", "41", "", "expected 0 to 40"),
        ("ada", "week05.essay", "nan", "", "expected 0 to 40"),
        ("ada", "week05.essay", "many", "", "is not a number of points"),
        ("ada", "week05.essay", "16", "2", "16 points for an example: expected 0 to 15"),
        ("ada", "week05.essay", "1", "3", r"the rubric has 1 names the parts \(5\); 2 an example"),
        ("ada", "week05.motto", "1", "1", "no rows: leave out --row"),
    ],
)
def test_what_cannot_be_given_is_refused(
    kinds: Course, tmp_path: Path, student: str, task: str, points: str, row: str, message: str
) -> None:
    with pytest.raises(CourseError, match=message):
        mark_by_hand(tmp_path / "out", student, "week05_exercise", task, points, row=row, course=kinds)
    assert not (tmp_path / "out/marks").exists()
