"""A small class from hand-ins to totals: collected, graded in the jail, added up, and added up again."""

from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from course_lib.course.course_file import read_course_file
from course_lib.grading.grade import grade
from course_lib.grading.handin.collect import collect
from course_lib.grading.marks.by_hand import mark_by_hand
from course_lib.grading.records import Course
from course_lib.grading.term.term import Files, write_term
from tests.grading.conftest import COURSE, RIGHT, write_course
from tests.grading.platforms import Handed, moodle_zip, notebook, table
from tests.grading.term import recompute
from tests.grading.term.test_term import lines_of

TERM = '\n[term]\ngroup_weeks = ["week01"]\n'
LATE = "Tuesday, 13 October 2026, 8:00 AM"
EARLY = "Sunday, 11 October 2026, 8:00 PM"


@pytest.fixture
def course(tmp_path: Path) -> Course:
    return write_course(tmp_path / "course", settings=COURSE + TERM)


def test_a_graded_class_gets_the_totals_that_its_records_give(tmp_path: Path, course: Course) -> None:
    wrong = RIGHT.replace("return length / 2", "return abs(length) / 2")
    codes = {"ada": RIGHT, "bob": wrong, "cleo": RIGHT, "dora": "x = 1"}
    students = [
        Handed(name, 101 + place, name, files={"week01_exercise.ipynb": notebook(code, student=name)})
        for place, (name, code) in enumerate(codes.items())
    ]
    moodle_zip(tmp_path / "moodle.zip", students)
    times = {"cleo": LATE}
    worksheet = [(f"Participant {one.number}", one.id, times.get(one.id, EARLY)) for one in students]
    table(tmp_path / "sheet.csv", ("Identifier", "ID number", "Last modified (submission)"), worksheet)
    (tmp_path / "roster.csv").write_text("id,group\nada,\nbob,b\nfay,b\ncleo,\ndora,\ngus,\n")
    (tmp_path / "exemptions.csv").write_text("id,week,reason\ndora,week01,ill\n")
    collect(tmp_path / "moodle.zip", tmp_path / "in", ZoneInfo("Europe/Paris"), tmp_path / "sheet.csv")
    out = tmp_path / "out"
    grade(tmp_path / "in", out, jobs=1, course=course)
    mark_by_hand(out, "bob", "week01_exercise", "answer", "4", course=course)
    files = Files(tmp_path / "roster.csv", tmp_path / "exemptions.csv")
    write_term(out, files, read_course_file(course.exercises / "course.toml"))
    rows = lines_of(out / "term.csv")
    toml = course.exercises / "course.toml"
    (toml.parent / "copy.toml").write_text(f"{toml.read_text()}\n[late]\npercent_per_day = 10\n")
    again = recompute.totals(out, files.roster, toml.parent / "copy.toml", files.exemptions)
    made = {student: float(row["total"]) if row["total"] else None for student, row in rows.items()}
    assert made == {
        one: total if total is None else pytest.approx(total, abs=0.01) for one, total in again.items()
    }
    assert made == {"ada": 110.0, "bob": 84.0, "fay": 84.0, "cleo": 88.0, "dora": None, "gus": 0.0}
    assert rows["fay"]["handed_in_by"] == "week01:bob"
