"""A fault in the table of one week in course.toml stops only commands that need this week."""

from collections.abc import Callable
from pathlib import Path

import pytest

import course_lib.grading.check as check_module
from course_lib.course import release
from course_lib.course.course_file import read_course_file
from course_lib.errors import CourseError
from course_lib.grading.check import check
from course_lib.grading.grade import grade
from course_lib.grading.marks import stored_result
from course_lib.grading.platforms.gradescope import keep_one_week
from course_lib.grading.reports.report import report
from course_lib.grading.store import Course, catalog_of
from course_lib.grading.submissions.submission import find_submissions, plan_attempts
from course_lib.grading.task import load_catalog
from tests.grading.conftest import COURSE

WriteNotebook = Callable[..., Path]
TWO = """\
[weeks.week02]
title = "Two"
deadline = 2026-10-18T23:59:00
[weeks.week02.points]
post = 100
[weeks.week02.extensions]
ada = 2026-10-20T23:59:00
"""
FAULTY = TWO.replace("deadline", "deadlin")
SAID = r"course\.toml line 17: weeks: week02: deadlin: unknown key 'deadlin', known: bonus, deadline, "

# original text of the week's table, faulty text, and the reported message
FAULTS = [
    ("deadline", "deadlin", "line 17: weeks: week02: deadlin: unknown key 'deadlin'"),
    ("2026-10-18T23:59:00", '"soon"', "line 17: weeks: week02: deadline: 'soon', expected local time"),
    ("post = 100", "post = 90", "line 15: weeks: week02: points: they sum to 90, expected 100"),
    ('title = "Two"', "", "line 15: weeks: week02: the key 'title' is missing"),
    ("2026-10-20T23:59:00", "7", "line 21: weeks: week02: extensions: ada: 7, expected local time"),
    (
        "2026-10-20T23:59:00",
        "2026-01-20T23:59:00",
        "line 15: weeks: week02: extensions: ada: 2026-01-20T23:59:00 is before the week's "
        "deadline, expected a later time than 2026-10-18T23:59:00",
    ),
    ("ada =", '"../etc" =', "weeks: week02: '../etc' is not a student ID"),
    (TWO, "[weeks]\nweek02 = 3\n", "line 16: weeks: week02: 3, expected a table"),
]


def write(course: Course, text: str) -> Path:
    path = course.exercises / "course.toml"
    path.write_text(COURSE + text)
    return path


@pytest.mark.parametrize(("old", "new", "message"), FAULTS)
def test_faulty_week_is_reported_with_its_line_only_when_the_week_is_needed(
    course: Course, old: str, new: str, message: str
) -> None:
    path = write(course, TWO.replace(old, new))
    catalog = load_catalog(course.exercises, course.solutions)
    assert len(catalog.tasks_of_week("week01")) == 3
    course_file = read_course_file(path)
    course_file.require_valid("week01")
    for look in (
        lambda: catalog.tasks_of_week("week02"),
        lambda: catalog.task("week02.post"),
        lambda: course_file.deadline("week02", "ada"),
        course_file.require_valid,
    ):
        with pytest.raises(CourseError) as refusal:
            look()
        assert str(refusal.value).startswith(str(path))
        assert message in str(refusal.value)


def test_missing_points_are_not_reported_for_a_faulty_week(course: Course) -> None:
    write(course, FAULTY)
    (course.exercises / "checks/week02.py").write_text("TASKS = ()\n")
    with pytest.raises(CourseError, match=SAID):
        load_catalog(course.exercises).tasks_of_week("week02")


def test_faults_key_in_the_course_file_is_rejected(course: Course) -> None:
    with pytest.raises(CourseError, match="unknown key 'faults'"):
        read_course_file(write(course, "[faults]\nweek02 = 'none'\n"))


def test_submissions_of_a_faulty_week_are_rejected_and_others_graded(
    course: Course, write_notebook: WriteNotebook, tmp_path: Path
) -> None:
    write(course, FAULTY)
    for week in ("week01", "week02"):
        write_notebook(tmp_path / f"in/ada/{week}_exercise.ipynb", "x = 1")
    submissions = find_submissions(tmp_path / "in")
    for only in ("*", "*/week02*"):
        with pytest.raises(CourseError, match=f"nothing is graded: .*{SAID}.*Until then, --only"):
            plan_attempts(submissions, course, only)
    alone = [one for one in submissions if one.exercise.startswith("week02")]
    with pytest.raises(CourseError, match="nothing is graded: ") as refused:
        plan_attempts(alone, course, "*")
    assert "Meanwhile" not in str(refused.value)
    (attempts,) = plan_attempts(submissions, course, "*/week01*")
    assert attempts.jobs


def test_report_is_not_written_without_the_deadline_of_its_week(course: Course, tmp_path: Path) -> None:
    write(course, TWO)
    (course.exercises / "checks/week02.py").write_text("TASKS = ()\n")
    (tmp_path / "in/ada").mkdir(parents=True)
    (tmp_path / "in/ada/week01_exercise.ipynb").write_text("{")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    result = stored_result(tmp_path / "out", "ada", "week01_exercise").result
    write(course, "").write_text(COURSE.replace("deadline", "deadlin"))
    with pytest.raises(CourseError, match="unknown key 'deadlin'"):
        report(result, tmp_path / "out", load_catalog(course.exercises))


def test_autograder_is_created_only_for_weeks_without_faults(course: Course) -> None:
    path = write(course, FAULTY)
    assert b"week02" not in keep_one_week(path, "week01")
    with pytest.raises(CourseError, match=SAID):
        keep_one_week(path, "week02")


def test_course_with_a_faulty_week_is_not_released(course: Course) -> None:
    with pytest.raises(CourseError, match=SAID):
        release._without_extensions(write(course, FAULTY))


def test_check_with_no_valid_week_shows_the_correct_call(
    course: Course, monkeypatch: pytest.MonkeyPatch
) -> None:
    (course.exercises / "course.toml").write_text(COURSE.replace("deadline", "deadlin"))
    monkeypatch.setattr(check_module, "shipped_catalog", lambda: catalog_of(course))
    with pytest.raises(CourseError, match=r'pass its name first, like check\("week01\.task", MyNode\)'):
        check(7)  # type: ignore[arg-type]


def test_term_table_of_an_earlier_version_is_rejected_with_its_replacement(course: Course) -> None:
    path = write(course, "[term]\ndrop_lowest = 1\n")
    with pytest.raises(CourseError, match=r"line 15: term: the learning platform adds up the term now"):
        read_course_file(path)
