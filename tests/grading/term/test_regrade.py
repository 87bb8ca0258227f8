"""Requests to look at a mark again: files in, a list, an answer, and the student's report."""

import os
from pathlib import Path

import pytest

from course_lib.course.course_file import read_course_file
from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.marks.requests import open_requests
from course_lib.grading.records import Course
from course_lib.grading.term.regrade import answer, take_in, waiting
from tests.grading.conftest import RIGHT
from tests.grading.term.simulated import write_results

HOSTILE = "My cube <script>alert(1)</script> is \x1b[31mright\u202e."


@pytest.fixture
def out(tmp_path: Path, course: Course) -> Path:
    """Results of two students, without evidence."""
    settings = read_course_file(course.exercises / "course.toml")
    write_results(tmp_path / "graded", ["ada1", "bob2"], settings, seed=2)
    return tmp_path / "graded"


def write(folder: Path, name: str, text: str | bytes) -> Path:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return folder


def test_a_request_waits_until_it_is_answered_and_the_report_shows_both(
    tmp_path: Path, out: Path, course: Course
) -> None:
    folder = write(tmp_path / "in", "ADA1/week01_exercise.txt", HOSTILE)
    said = take_in(out, folder, course)
    assert said[0] == "entered: ada1 week01_exercise"
    assert said[-1] == "1 request without an answer"
    assert "\x1b" not in "".join(said)
    page = out / "reports/ada1/week01_exercise.html"
    assert "There is no answer yet." in page.read_text()
    assert "<script>alert" not in page.read_text()
    said = answer(out, "ada1", "week01", "You are right: 2 more points.", course)
    assert said == ["ada1 week01_exercise: answered; the report shows it", "0 requests without an answer"]
    assert "You are right: 2 more points." in page.read_text()
    assert "There is no answer yet." not in page.read_text()


def test_the_same_file_is_entered_once_and_a_second_request_after_the_answer(
    tmp_path: Path, out: Path, course: Course
) -> None:
    folder = write(tmp_path / "in", "ada1/week01_exercise.md", "First.")
    assert take_in(out, folder, course)[0].startswith("entered")
    assert not any(line.startswith("entered") for line in take_in(out, folder, course))
    write(folder, "ada1/week01_exercise.md", "Second.")
    assert "answer it first" in take_in(out, folder, course)[0]
    answer(out, "ada1", "week01_exercise", "No.", course)
    assert take_in(out, folder, course)[0].startswith("entered")
    assert [one.text for _, _, one in open_requests(out)] == ["Second."]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("ada1/week01_exercise.txt", "", "a request has 1 to 5000 characters"),
        ("ada1/week01_exercise.txt", "x" * 6000, "a request has 1 to 5000 characters"),
        ("ada1/week01_exercise.txt", b"\xff\xfe\x00", "it is not a text in UTF-8"),
        ("eve9/week01_exercise.txt", "Please", "no student 'eve9'"),
        ("ada1/week07_exercise.txt", "Please", "no exercise 'week07_exercise'"),
    ],
)
def test_a_file_that_is_no_request_is_refused_with_a_line(
    tmp_path: Path, out: Path, course: Course, name: str, text: str | bytes, said: str
) -> None:
    write(tmp_path / "in", "bob2/week01_exercise.txt", "A right one.")
    lines = take_in(out, write(tmp_path / "in", name, text), course)
    assert any(line.startswith("refused: ") and said in line for line in lines)
    assert "entered: bob2 week01_exercise" in lines


def test_a_link_to_a_file_of_ours_is_not_read(tmp_path: Path, out: Path, course: Course) -> None:
    (tmp_path / "secret.txt").write_text("HIDDEN")
    (tmp_path / "in/ada1").mkdir(parents=True)
    os.symlink(tmp_path / "secret.txt", tmp_path / "in/ada1/week01_exercise.txt")
    assert "it is a link" in take_in(out, tmp_path / "in", course)[0]


def test_what_cannot_be_answered_says_why(tmp_path: Path, out: Path, course: Course) -> None:
    with pytest.raises(CourseError, match="no request about this exercise that waits"):
        answer(out, "ada1", "week01_exercise", "Yes.", course)
    with pytest.raises(CourseError, match="has no student 'ada'"):
        answer(out, "ada", "week01_exercise", "Yes.", course)
    (tmp_path / "empty").mkdir()
    with pytest.raises(CourseError, match="holds no request"):
        take_in(out, tmp_path / "empty", course)
    write(out, "requests/ada1/week01_exercise.json", "{")
    with pytest.raises(CourseError, match="Restore it from a copy"):
        waiting(out)


def test_grading_again_keeps_request_and_answer_in_the_report(
    tmp_path: Path, course: Course, write_notebook: object
) -> None:
    write_notebook(tmp_path / "submissions/ada1/week01_exercise.ipynb", RIGHT, student="ada1")  # type: ignore[operator]
    out = tmp_path / "out"
    grade(tmp_path / "submissions", out, jobs=1, course=course)
    take_in(out, write(tmp_path / "in", "ada1/week01_exercise.txt", "Why?"), course)
    answer(out, "ada1", "week01_exercise", "Because.", course)
    page = out / "reports/ada1/week01_exercise.html"
    before = page.stat().st_mtime_ns
    grade(tmp_path / "submissions", out, jobs=1, course=course, resume=True)
    assert page.stat().st_mtime_ns == before  # nothing to do
    grade(tmp_path / "submissions", out, jobs=1, course=course)
    assert "Because." in page.read_text()
