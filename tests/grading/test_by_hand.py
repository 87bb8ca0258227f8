"""Manual marks count, survive every regrading, and are requested until they exist."""

import json
import shutil
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.marking.by_hand import mark_by_hand
from course_lib.grading.marking.server import submitted_code
from course_lib.grading.marks import read_result, results_in
from course_lib.grading.reports.tables import write_gradebook
from course_lib.grading.store import Course, catalog_of, lock_folder, result_path
from course_lib.grading.submissions.submission import PLACES
from tests.patience import PATIENCE

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
    assert result.row.mark is not None
    return result.row.mark.score, result.row.mark.final, result.row.status


def test_file_and_text_tasks_are_judged_and_written_task_needs_marking(kinds: Course, tmp_path: Path) -> None:
    assert line(tmp_path / "out") == (60, 48, "needs_marking")
    page = (tmp_path / "out/reports/ada/week05_exercise.html").read_text()
    assert "Frames &lt;b&gt;move&lt;/b&gt;." in page
    assert "A person reads and marks this task." in page


def test_complete_rubric_rows_are_summed_and_kept_when_regrading(kinds: Course, tmp_path: Path) -> None:
    out = tmp_path / "out"
    args = (out, "ada", "week05_exercise", "week05.essay")
    mark_by_hand(*args, "5", row="1", comment="clear", course=kinds)
    assert line(out)[2] == "needs_marking"
    message = mark_by_hand(*args, "7.5", row="an ex", comment="<i>short</i>", course=kinds)
    assert message == "ada week05_exercise: 7.5 for week05.essay (an example); now 68, graded"
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


def test_last_mark_counts_and_all_marks_keep_author_and_time(kinds: Course, tmp_path: Path) -> None:
    out = tmp_path / "out"
    for points in ("10", "20"):
        mark_by_hand(out, "ada", "week05_exercise", "week05.essay", points, course=kinds)
    mark_by_hand(out, "ada", "week05_exercise", "week05.motto", "0", comment="copied", course=kinds)
    assert line(out) == (50, 40, "graded")
    entries = json.loads((out / "marks/ada/week05_exercise.json").read_text())
    assert [entry["points"] for entry in entries] == [10, 20, 0]
    assert all(entry["by"] and entry["at"].endswith("+00:00") for entry in entries)


def test_points_for_a_replaced_submission_need_confirmation(
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
    assert "week05.essay, week05.motto: marked in another submission: mark it again" in result.row.message
    mark_by_hand(*args, "motto", "30", course=kinds)
    assert line(out) == (100, 80, "needs_marking")
    mark_by_hand(*args, "essay", "40", course=kinds)
    assert line(out) == (100, 80, "graded")


@pytest.mark.slow
def test_accepted_id_mismatch_is_reviewed_again_in_a_new_submission(
    kinds: Course, tmp_path: Path, write_notebook: WriteNotebook, capsys: pytest.CaptureFixture[str]
) -> None:
    notebook, out = tmp_path / "in/ada/week05_exercise.ipynb", tmp_path / "out"
    for number, name in enumerate(("bob", "cleo")):
        capsys.readouterr()
        write_notebook(notebook, f"{ANSWERS}\nnumber = {number}", student=name)
        grade(tmp_path / "in", out, jobs=1, course=kinds, resume=True)
        assert line(out)[2] == "needs_marking"
        assert "Please review: ID mismatch: 1 submission" in capsys.readouterr().out
        mark_by_hand(out, "ada", "week05_exercise", "essay", "40", course=kinds)
        grade(tmp_path / "in", out, jobs=1, course=kinds, resume=True)
        assert line(out)[2] == "graded"
        assert "Look at" not in capsys.readouterr().out


def test_mark_without_its_submission_file_is_reported(
    kinds: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in/ada").rename(tmp_path / "in/bob")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=kinds)
    message = "Please review: the file is gone, but its mark counts: ada week05_exercise. Moved or withdrawn?"
    assert message in capsys.readouterr().out
    (tmp_path / "out/results/ada/week05_exercise.json").unlink()
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=kinds, resume=True)
    assert message not in capsys.readouterr().out
    assert "ada,week05" not in (tmp_path / "out/gradebook.csv").read_text()


def test_marking_a_rejected_file_is_an_error(kinds: Course, tmp_path: Path) -> None:
    (tmp_path / "in/ada/week05_exercise.ipynb").write_text("{")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=kinds)
    with pytest.raises(CourseError, match=r"week05_exercise of ada has no graded tasks; .* --without-file"):
        mark_by_hand(tmp_path / "out", "ada", "week05_exercise", "essay", "1", course=kinds)


def test_task_is_matched_by_short_name_or_id_and_student_by_any_spelling(
    kinds: Course, tmp_path: Path
) -> None:
    message = mark_by_hand(tmp_path / "out", "ADA", "week05", "essay", "40", course=kinds)
    assert message == "ada week05_exercise: 40 for week05.essay; now 80, graded"


@pytest.mark.parametrize(
    ("student", "task", "points", "row", "message"),
    [
        ("bob", "week05.essay", "1", "", "has no student 'bob'; it has ada"),
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
def test_invalid_mark_is_rejected(
    kinds: Course, tmp_path: Path, student: str, task: str, points: str, row: str, message: str
) -> None:
    with pytest.raises(CourseError, match=message):
        mark_by_hand(tmp_path / "out", student, "week05_exercise", task, points, row=row, course=kinds)
    assert not (tmp_path / "out/marks").exists()


def test_withdrawing_a_mark_restores_the_points_of_the_checks(kinds: Course, tmp_path: Path) -> None:
    out = tmp_path / "out"
    args = (out, "ada", "week05_exercise")
    before = line(out)
    mark_by_hand(*args, "motto", "3", comment="copied", course=kinds)
    mark_by_hand(*args, "essay", "40", course=kinds)
    message = mark_by_hand(*args, "motto", withdraw=True, course=kinds)
    assert message == "ada week05_exercise: mark for week05.motto withdrawn; now 80, graded"
    assert "copied" not in (out / "reports/ada/week05_exercise.html").read_text()
    mark_by_hand(*args, "essay", withdraw=True, course=kinds)
    assert line(out) == before
    grade(tmp_path / "in", out, jobs=1, course=kinds, resume=True)
    assert line(out) == before
    with pytest.raises(CourseError, match=r"week05\.essay has no mark by hand, so none can be withdrawn"):
        mark_by_hand(*args, "essay", withdraw=True, course=kinds)
    mark_by_hand(*args, "essay", "10", course=kinds)
    assert line(out) == (70, 56, "graded")


def test_withdrawn_rubric_row_needs_marking_again(kinds: Course, tmp_path: Path) -> None:
    out = tmp_path / "out"
    args = (out, "ada", "week05_exercise", "essay")
    for row in ("1", "2"):
        mark_by_hand(*args, "5", row=row, course=kinds)
    assert line(out)[2] == "graded"
    message = mark_by_hand(*args, row="2", withdraw=True, course=kinds)
    assert message.startswith("ada week05_exercise: mark for week05.essay (an example) withdrawn")
    assert line(out)[2] == "needs_marking"


@pytest.mark.slow
def test_withdrawing_the_mark_of_an_accepted_id_mismatch_requires_a_new_review(
    kinds: Course, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    out = tmp_path / "out"
    write_notebook(tmp_path / "in/ada/week05_exercise.ipynb", ANSWERS, student="bob")
    grade(tmp_path / "in", out, jobs=1, course=kinds)
    mark_by_hand(out, "ada", "week05_exercise", "essay", "40", course=kinds)
    assert line(out)[2] == "graded"
    mark_by_hand(out, "ada", "week05_exercise", "essay", withdraw=True, course=kinds)
    assert line(out)[2] == "needs_marking"


@pytest.mark.slow
def test_concurrent_marks_are_serialized(
    kinds: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    # As the marking page does before it serves: check files are not read by several threads.
    catalog_of(kinds)
    points = ("1", "2", "3", "4", "5", "6")
    with ThreadPoolExecutor(len(points)) as pool:
        with lock_folder(out):
            args = (out, "ada", "week05_exercise", "essay")
            waiting = [pool.submit(mark_by_hand, *args, one, course=kinds) for one in points]
            end, output = time.monotonic() + PATIENCE, ""
            while output.count(f"{out} is in use by process") < len(waiting):
                assert time.monotonic() < end, output
                time.sleep(0.01)
                output += capsys.readouterr().out
            assert not any(one.done() for one in waiting)
        messages = [one.result(timeout=PATIENCE) for one in waiting]
    assert len(messages) == len(points)
    entries = json.loads((out / "marks/ada/week05_exercise.json").read_text())
    assert sorted(entry["points"] for entry in entries) == [1, 2, 3, 4, 5, 6]


def move_class(top: Path, *, place: str, rename: bool = True) -> tuple[Path, Path]:
    """Copy submissions and records to another folder, and rename ada's folder."""
    submissions, out = top / "elsewhere" / place, top / "elsewhere/records"
    shutil.copytree(top / "in", submissions)
    shutil.copytree(top / "out", out)
    if rename:
        (submissions / "ada").rename(submissions / "ben")
    return submissions, out


def make_old(out: Path, submissions: Path) -> None:
    """Rewrite the results as earlier versions wrote them, with absolute paths."""
    for path in (out / "results").glob("*/*.json"):
        content = json.loads(path.read_text())
        submission = content["submission"]
        submission["path"] = str(submissions / submission["path"])
        path.write_text(json.dumps(content))
    (out / PLACES).unlink()


@pytest.mark.parametrize("place", ["in", "somewhere/else/files"])
@pytest.mark.parametrize("is_old", [False, True])
def test_missing_submission_with_a_mark_is_reported_after_a_move(
    kinds: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str], place: str, is_old: bool
) -> None:
    if is_old:
        make_old(tmp_path / "out", tmp_path / "in")
    submissions, out = move_class(tmp_path, place=place)
    (tmp_path / "in").rename(tmp_path / "forgotten")
    grade(submissions, out, jobs=1, course=kinds, resume=True)
    assert "the file is gone, but its mark counts: ada week05_exercise." in capsys.readouterr().out


@pytest.mark.slow
def test_results_contain_relative_paths_and_can_be_moved_with_the_submissions(
    kinds: Course, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "in/cleo").mkdir()
    (tmp_path / "in/cleo/week05_exercise.ipynb").write_text("{")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=kinds, resume=True)
    for path in (tmp_path / "out").glob("*/*/*.json"):
        assert str(tmp_path) not in path.read_text()
    submissions, out = move_class(tmp_path, place="files", rename=False)
    (tmp_path / "in").rename(tmp_path / "forgotten")
    path = result_path(out, "ada", "week05_exercise")
    assert "can't be shown" in submitted_code(read_result(path).result.submission, out, None)["problem"]
    judged = path.read_text()
    grade(submissions, out, jobs=1, course=kinds, resume=True)
    assert "no file any more" not in capsys.readouterr().out
    assert path.read_text() == judged
    assert submitted_code(read_result(path).result.submission, out, None)["problem"] == ""


def test_results_of_another_submission_folder_are_not_reported_as_missing(
    kinds: Course, tmp_path: Path, write_notebook: WriteNotebook, capsys: pytest.CaptureFixture[str]
) -> None:
    write_notebook(tmp_path / "in_b/dora/week05_exercise.ipynb", ANSWERS, student="dora")
    grade(tmp_path / "in_b", tmp_path / "out", jobs=1, course=kinds)
    assert "no file any more" not in capsys.readouterr().out
    assert "ada,week05" in (tmp_path / "out/gradebook.csv").read_text()
