"""`course report --final`, marks without a file, and options that choose an exercise or section."""

from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.marking.by_hand import mark_by_hand, mark_without_file
from course_lib.grading.marks import results_in
from course_lib.grading.reports.report import feedback, show_hidden_checks
from course_lib.grading.store import Course
from course_lib.grading.submissions.lms import fill_lms
from course_lib.grading.submissions.roster import ids_of_section

WriteNotebook = Callable[..., Path]
HIDDEN_VALUE = "3.5"  # which only the hidden check of half() expects
EXERCISE = "week01_exercise"


@pytest.fixture
def graded(course: Course, tmp_path: Path, right: str, write_notebook: WriteNotebook) -> Path:
    """The results of ada, whose hidden check fails."""
    wrong = right.replace("return length / 2", "return abs(length) / 2")
    write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", wrong, student="ada")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    return tmp_path / "out"


def page(out: Path, student: str = "ada") -> str:
    return (out / f"reports/{student}/{EXERCISE}.html").read_text()


@pytest.mark.slow
def test_final_reports_show_hidden_checks_until_reverted(
    course: Course, tmp_path: Path, graded: Path
) -> None:
    assert HIDDEN_VALUE not in page(graded)
    message = show_hidden_checks(graded, EXERCISE, course=course)
    assert message.startswith("1 report of week01_exercise: they show hidden checks")
    assert HIDDEN_VALUE in page(graded)
    assert "(hidden)" in page(graded)
    mark_by_hand(graded, "ada", EXERCISE, "half", "1", course=course)
    assert HIDDEN_VALUE in page(graded)
    grade(tmp_path / "in", graded, jobs=1, course=course, resume=True)
    assert HIDDEN_VALUE in page(graded)
    show_hidden_checks(graded, EXERCISE, is_final=False, course=course)
    assert HIDDEN_VALUE not in page(graded)


@pytest.mark.slow
def test_reports_are_not_final_while_a_mark_is_open(
    course: Course, tmp_path: Path, graded: Path, right: str, write_notebook: WriteNotebook
) -> None:
    write_notebook(tmp_path / "in/bob/week01_exercise.ipynb", right, student="eve")
    grade(tmp_path / "in", graded, jobs=1, course=course, resume=True)
    with pytest.raises(CourseError, match=r"1 open mark of week01_exercise \(bob\): mark or grade"):
        show_hidden_checks(graded, EXERCISE, course=course)
    with pytest.raises(CourseError, match="no results for --exercise week09_exercise; it has"):
        show_hidden_checks(graded, "week09", course=course)


@pytest.mark.slow
def test_file_submitted_after_a_mark_without_a_file_needs_review(
    course: Course, tmp_path: Path, graded: Path, right: str, write_notebook: WriteNotebook
) -> None:
    mark_without_file(graded, "BOB", "week01", "80", comment="Paper", course=course)
    row = [one.row.cells for one in results_in(graded)][1]
    assert (row["student"], row["final"], row["max_score"], row["status"]) == ("bob", 80, 100, "graded")
    write_notebook(tmp_path / "in/bob/week01_exercise.ipynb", right, student="bob")
    grade(tmp_path / "in", graded, jobs=1, course=course, resume=True)
    row = [one.row.cells for one in results_in(graded)][1]
    assert (row["status"], row["final"]) == ("needs_marking", 110)
    assert "80 points were given without a file before" in str(row["message"])
    mark_without_file(graded, "bob", "week01", withdraw=True, course=course)
    assert [one.row.status for one in results_in(graded)] == ["graded", "graded"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("ada", "week01", "5"),
            "week01_exercise of ada has a file that was graded: enter points for its tasks",
        ),
        (("bob", "week9", "5"), "there is no exercise 'week9'; exercises with points: week01_exercise"),
        (("bob", "week01", "111"), "111 points for week01_exercise of bob: expected 0 to 110"),
        (("bob", "week01", "many"), "'many' is not a number of points"),
        (("../bob", "week01", "5"), "is not a student ID"),
    ],
)
def test_invalid_mark_without_a_file_is_rejected_and_not_stored(
    course: Course, graded: Path, words: tuple[str, str, str], message: str
) -> None:
    with pytest.raises(CourseError, match=message):
        mark_without_file(graded, *words, course=course)
    assert not (graded / "results/bob").exists()


def test_section_is_read_from_the_class_list(tmp_path: Path) -> None:
    roster = tmp_path / "roster.csv"
    roster.write_text("id,section\nA1,Mo\nb2,Tu\n")
    assert ids_of_section(roster, "mo") == frozenset({"a1"})
    assert ids_of_section(None, "") is None
    for path, section, said in (
        (roster, "We", "has no section 'We'. Sections in its column 'section': Mo, Tu"),
        (None, "Mo", "needed together"),
        (roster, "", "needed together"),
    ):
        with pytest.raises(CourseError, match=said):
            ids_of_section(path, section)


def test_feedback_of_an_unknown_exercise_or_an_empty_section_is_rejected(
    course: Course, graded: Path
) -> None:
    with pytest.raises(CourseError, match="no results for --exercise week02_exercise; it has"):
        feedback(graded, "moodle", exercise="week02", course=course)
    with pytest.raises(CourseError, match="no results of week01_exercise of this section's students"):
        feedback(graded, "moodle", exercise=EXERCISE, students={"eve"}, course=course)


@pytest.mark.sample(1)
@pytest.mark.parametrize("short", ["week01", "week01_exercise.ipynb", " week01"])
def test_exercise_is_accepted_by_its_week_or_its_file(
    course: Course, graded: Path, tmp_path: Path, short: str
) -> None:
    assert show_hidden_checks(graded, short, course=course).startswith("1 report of week01_exercise")
    with pytest.raises(CourseError, match="is from a download of Moodle"):
        feedback(graded, "moodle", exercise=short, course=course)
    (tmp_path / "lms.csv").write_text("ID number,Grade\nada,\n")
    fill_lms(
        graded,
        tmp_path / "lms.csv",
        tmp_path / "to.csv",
        exercise=short,
        column="Grade",
        id_column="ID number",
    )
    assert (tmp_path / "to.csv").read_text() != "ID number,Grade\nada,\n"
