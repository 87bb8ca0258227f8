"""The late policy of course.toml: grace, maximum penalty, last accepted day, group extensions."""

from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from course_lib.course import release
from course_lib.course.course_file import read_course_file, shipped_course_file
from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.marks import results_in
from course_lib.grading.records import count_days_late
from course_lib.grading.store import Course, catalog_of, rules_of
from tests.grading.conftest import COURSE

PARIS = ZoneInfo("Europe/Paris")
GROUPS = """
[groups]
Team_A = ["ADA", "bob"]
late_team = ["bob"]
[weeks.week01.extensions]
team_a = 2026-10-13T23:59:00
late_team = 2026-10-14T23:59:00
ada = 2026-10-12T23:59:00
"""


def settings(course: Course, late: str, more: str = "") -> Path:
    path = course.exercises / "course.toml"
    path.write_text(COURSE.replace("[limits]", f"[late]\n{late}\n[limits]") + more)
    return path


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("accepted_days = 2.5", "line 5: late: accepted_days: 2.5, expected a whole number of started days"),
        ("accepted_days = -1", "line 5: late: accepted_days: -1, expected a number of at least 0"),
        ('accepted_days = "week"', "line 5: late: accepted_days: 'week', expected a number of at least 0"),
        ("max_percent = 120", "late: max_percent: 120, expected 0 to 100"),
        ("percent_per_day = 101", "late: percent_per_day: 101, expected 0 to 100"),
        ("max_percents = 50", "late: max_percents: unknown key 'max_percents', known: accepted_days"),
    ],
)
def test_invalid_late_policy_is_rejected_with_its_line(course: Course, text: str, message: str) -> None:
    with pytest.raises(CourseError) as raised:
        read_course_file(settings(course, text))
    assert message.removeprefix("line 5: ") in str(raised.value)
    assert "course.toml line" in str(raised.value)


def test_submission_after_the_last_accepted_day_gets_no_points_with_a_reason(
    course: Course, right: str, write_notebook: Callable[..., Path], tmp_path: Path
) -> None:
    settings(course, "accepted_days = 3\nmax_percent = 20")
    for student, day in (("ada", 14), ("bob", 15)):
        notebook = write_notebook(tmp_path / "in" / student / "week01_exercise.ipynb", right, student=student)
        notebook.with_name("timestamp.txt").write_text(f"2026-10-{day} 12:00:00 UTC")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    ada, bob = (one.row.cells for one in results_in(tmp_path / "out"))
    assert (ada["days_late"], ada["final"]) == (3, 88)
    assert (bob["days_late"], bob["final"], bob["status"]) == (4, 0, "graded")
    assert "not accepted: 4 started days late, at most 3 are accepted" in str(bob["message"])
    pages = [(tmp_path / f"out/reports/{name}/week01_exercise.html").read_text() for name in ("ada", "bob")]
    assert "3 \u00d7 10 % of 110 points, at most 20 %:" in pages[0]
    assert "This is not accepted: 4 started days late, at most 3" in pages[1]
    assert "so no points count:" in pages[1]


def test_default_grace_period_covers_the_last_minute_of_the_deadline() -> None:
    deadline = datetime(2026, 10, 11, 23, 59, tzinfo=PARIS)
    late = shipped_course_file().late
    assert count_days_late(deadline.replace(second=30), deadline, late) == 0
    assert count_days_late(datetime(2026, 10, 12, 0, 0, 1, tzinfo=PARIS), deadline, late) == 1


def test_group_extension_applies_to_its_members(course: Course) -> None:
    course_file = read_course_file(settings(course, "", GROUPS))
    days = {student: course_file.deadline("week01", student) for student in ("ada", "bob", "eve")}
    assert {student: day and day.day for student, day in days.items()} == {"ada": 12, "bob": 14, "eve": 11}


def test_grading_reports_extensions_of_unknown_groups_and_students(
    course: Course, write_notebook: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    settings(course, "", GROUPS + "teem_a = 2026-10-13T23:59:00\neve = 2026-10-13T23:59:00\n")
    write_notebook(tmp_path / "in/eve/week01_exercise.ipynb", "x = 1", student="eve")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    lines = [line for line in capsys.readouterr().out.splitlines() if "extensions" in line]
    assert lines == [
        "note: the extensions of week01 in course.toml contain teem_a: there is no such group, "
        "and no such student has submitted anything."
    ]


def test_group_with_the_name_of_a_member_is_rejected(course: Course) -> None:
    with pytest.raises(CourseError, match="groups: ada is both the name of a group and the ID of a student"):
        read_course_file(settings(course, "", '[groups]\nada = ["ada", "bob"]\n'))


def test_released_course_contains_no_groups(course: Course) -> None:
    text = release._without_extensions(settings(course, "", GROUPS))
    assert "team" not in text.lower()
    path = settings(course, "")
    path.write_text('groups.team = ["ada"]\n' + path.read_text())
    with pytest.raises(CourseError, match=r"write the students' groups as a table, \[groups\]"):
        release._without_extensions(path)


def test_rejected_submission_never_replaces_an_accepted_one(
    course: Course, right: str, write_notebook: Callable[..., Path], tmp_path: Path
) -> None:
    settings(course, "accepted_days = 3")
    for name in ("week01_exercise", "week01_exercise-2"):
        write_notebook(tmp_path / f"in/ada/{name}.ipynb", right, student="ada")
    (tmp_path / "in/received.csv").write_text(
        "file,received\n"
        "ada/week01_exercise.ipynb,2026-10-13T12:00:00Z\n"
        "ada/week01_exercise-2.ipynb,2026-10-15T12:00:00Z\n"
    )
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    (ada,) = (one.row.mark for one in results_in(tmp_path / "out"))
    assert ada is not None
    assert ada.days_late == 2
    assert ada.final > 0


@pytest.mark.slow
def test_extension_for_one_student_updates_only_one_result_without_rejudging(
    course: Course,
    right: str,
    write_notebook: Callable[..., Path],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    path = settings(course, "percent_per_day = 10")
    out = tmp_path / "out"
    for student in ("ada", "bob"):
        notebook = write_notebook(tmp_path / "in" / student / "week01_exercise.ipynb", right, student=student)
        notebook.with_name("timestamp.txt").write_text("2026-10-13 12:00:00 UTC")
    grade(tmp_path / "in", out, jobs=1, course=course)
    written = {one: one.stat().st_mtime_ns for one in out.glob("results/*/*.json")}
    judged = []
    monkeypatch.setattr("course_lib.grading.grade.judge", lambda *given: judged.append(given))

    def marks_after(text: str) -> dict[str, tuple[float, int]]:
        path.write_text(text)
        catalog_of.cache_clear()  # as in a new grader process
        rules_of.cache_clear()
        grade(tmp_path / "in", out, jobs=1, resume=True, course=course)
        marks = {one.student: one.row.mark for one in results_in(out)}
        return {student: (mark.final, mark.days_late) for student, mark in marks.items() if mark}

    extended = path.read_text() + "\n[weeks.week01.extensions]\nada = 2026-10-13T23:59:00\n"
    assert marks_after(extended) == {"ada": (110, 0), "bob": (88, 2)}
    assert [one.parent.name for one, at in written.items() if one.stat().st_mtime_ns != at] == ["ada"]
    assert "2026-10-13 23:59" in (out / "reports/ada/week01_exercise.html").read_text()
    halved = extended.replace("percent_per_day = 10", "percent_per_day = 5")
    assert marks_after(halved) == {"ada": (110, 0), "bob": (99, 2)}
    assert not judged


def test_changed_points_of_a_task_rejudge_the_evidence(
    course: Course, right: str, write_notebook: Callable[..., Path], tmp_path: Path
) -> None:
    path, out = settings(course, ""), tmp_path / "out"
    write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", right.replace("length / 2", "length / 3"))
    grade(tmp_path / "in", out, jobs=1, course=course)
    before = [one.row.mark for one in results_in(out)]
    text = path.read_text()
    path.write_text(text.replace("red_cube = 60", "red_cube = 50").replace("half = 40", "half = 50"))
    catalog_of.cache_clear()
    rules_of.cache_clear()
    grade(tmp_path / "in", out, jobs=1, resume=True, course=course)
    assert [one.row.mark for one in results_in(out)] != before
