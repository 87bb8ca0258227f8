"""`course new week09 "Occupancy maps"`: a week that runs, and whose rules all hold."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from course_lib import cli
from course_lib.authoring.new import new_week
from course_lib.authoring.rules import ASPECTS
from course_lib.authoring.verify import lines, verify
from course_lib.course.course_file import read_course_file
from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.grading.store import Course
from tests.patience import PATIENCE
from tests.test_house import PUBLIC


def test_interrupted_new_week_is_completed_by_the_same_command(
    course: Course, monkeypatch: pytest.MonkeyPatch
) -> None:
    count = 0

    def write_some(path: Path, data: bytes) -> None:
        nonlocal count
        count += 1
        if count > 4:
            raise KeyboardInterrupt
        write_atomically(path, data)

    with monkeypatch.context() as patch:
        patch.setattr("course_lib.authoring.new.write_atomically", write_some)
        with pytest.raises(KeyboardInterrupt):
            new_week("week10", "Planning", course)
    with pytest.raises(CourseError, match=r"week10_solution\.ipynb already exists"):
        new_week("week10", "Other title", course)
    assert all(path.is_file() for path in new_week("week10", "Planning", course))
    assert "week10" in read_course_file(course.exercises / "course.toml").weeks


@pytest.mark.slow
def test_new_week_passes_every_verification(course: Course) -> None:
    (report,) = verify(course, ["week09"], jobs=2)
    assert [str(flaw) for flaw in report.flaws] == []
    assert {report.cell(aspect) for aspect in ASPECTS} == {"✔"}
    assert f"week09: {report.placeholder_count} places of the template left, look for REPLACE" in lines(
        [report], course
    )
    assert report.placeholder_count >= 8
    lesson = "notebooks/week09_occupancy_maps.ipynb, in its metadata: 1 REPLACE"
    assert lesson in lines([report], course)


def test_new_week_has_lesson_solution_exercise_checks_quizzes_hints_answers_and_points(
    course: Course,
) -> None:
    root = course.exercises.parent
    names = {path.relative_to(root).as_posix() for path in root.rglob("*09*")}
    assert names == {
        "notebooks/week09_occupancy_maps.ipynb",
        "solutions/week09_solution.ipynb",
        "solutions/checks/week09.py",
        "solutions/answers/week09.toml",
        "exercises/week09_exercise.ipynb",
        "exercises/checks/week09.py",
        "exercises/quizzes/week09.toml",
        "exercises/quizzes/week09_recall.toml",
        "exercises/mistakes/week09.toml",
    }
    week = read_course_file(course.exercises / "course.toml").weeks["week09"]
    assert (week.title, week.points) == ("Occupancy maps", {"post": 100.0})


def test_python_files_of_a_new_week_are_formatted_and_import_public_modules(course: Course) -> None:
    files = [str(path) for path in course.exercises.parent.rglob("checks/*.py")]
    for words in (["format", "--check"], ["check"]):
        command = [sys.executable, "-m", "ruff", *words, "--line-length", "110", *files]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE)
        assert done.returncode == 0, done.stdout
    for path in files:
        text = Path(path).read_text("utf-8")
        assert {line.split()[1] for line in text.splitlines() if line.startswith("from course_lib")} <= PUBLIC


@pytest.mark.parametrize(
    ("week", "title", "message"),
    [
        ("week9", "Maps", "'week9' is not the name of a week: expected one like week09"),
        ("week09", "Maps", "week09 is already in .*: 'Occupancy maps'"),
        ("week10", 'Maps"', "expected 1 to 60 letters"),
        ("week10", "a\nb", "expected 1 to 60 letters"),
        ("week10", "../../up", "expected 1 to 60 letters"),
        ("week10", "x" * 61, "expected 1 to 60 letters"),
    ],
)
def test_invalid_week_name_or_title_is_rejected_and_nothing_is_written(
    course: Course, week: str, title: str, message: str
) -> None:
    before = sorted(course.exercises.parent.rglob("*"))
    with pytest.raises(CourseError, match=message):
        new_week(week, title, course)
    assert sorted(course.exercises.parent.rglob("*")) == before


def test_release_reports_template_placeholders(
    course: Course, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr("course_lib.grading.store.this_course", lambda: course)
    monkeypatch.setattr("course_lib.authoring.verify.reject_broken", lambda *_: None)  # takes minutes
    monkeypatch.setattr("course_lib.course.release.release", lambda out, solutions: [out])
    cli.release(tmp_path / "out")
    note, done = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r"note: week09: \d+ places of the template left, look for REPLACE", note)
    assert done.startswith("Released 1 parts")


def test_week_with_a_faulty_table_is_not_overwritten_and_another_week_is_created(
    course: Course,
) -> None:
    settings = course.exercises / "course.toml"
    settings.write_text(settings.read_text().replace("post = 100", "post = 90"))
    with pytest.raises(CourseError, match="weeks: week09: points: they sum to 90"):
        new_week("week09", "Maps", course)
    new_week("week10", "Planning", course)
    assert list(read_course_file(settings).weeks) == ["week10"]


def test_existing_file_is_not_overwritten(course: Course) -> None:
    mine = course.solutions / "week10_solution.ipynb"
    mine.write_text("mine")
    with pytest.raises(CourseError, match="already exists"):
        new_week("week10", "Maps", course)
    assert mine.read_text() == "mine"
    assert not (course.exercises / "checks/week10.py").exists()


def test_lesson_of_a_later_week_refers_to_the_previous_week(course: Course) -> None:
    new_week("week10", "Planning", course)
    assert "do `week09_occupancy_maps.ipynb`." in (course.lessons / "week10_planning.ipynb").read_text()
