"""The table of a term, against a script of its own that computes the totals again."""

import csv
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from course_lib.course.course_file import CourseFile, Term, read_course_file
from course_lib.course.installation import exercises_dir
from course_lib.errors import CourseError
from course_lib.grading.handin.lms import fill_lms
from course_lib.grading.term.term import Files, week_mark, write_term
from course_lib.grading.term.totals import WeekMark, add_up_term
from tests.grading.term import recompute
from tests.grading.term.simulated import write_results

TERM = """
[term]
drop_lowest = 1
group_weeks = ["week07", "week08"]
quiz_percent = 10
[term.weights]
week01 = 0.5
week05 = 0
week07 = 2
"""


@pytest.fixture
def toml(tmp_path: Path) -> Path:
    """The kit's own course.toml, with deadlines, an extension and a term."""
    lines = ['time_zone = "Europe/Paris"']
    for line in (exercises_dir() / "course.toml").read_text().splitlines():
        lines.append(line)
        if line.startswith("title") and len(lines) > 2:
            lines.append(f"deadline = 2027-03-{20 + len(lines) % 10}T23:59:00")  # clocks change on the 28th
    lines += ["[weeks.week02.extensions]", "s003 = 2027-05-01T12:00:00"]
    (tmp_path / "course.toml").write_text("\n".join(lines) + TERM)
    return tmp_path / "course.toml"


@pytest.fixture
def course(toml: Path) -> CourseFile:
    return read_course_file(toml)


def write(path: Path, headings: str, *rows: str) -> Path:
    path.write_text("\n".join([headings, *rows, ""]))
    return path


def lines_of(path: Path) -> dict[str, dict[str, str]]:
    with path.open(newline="") as file:
        return {row["student"]: row for row in csv.DictReader(file)}


@pytest.fixture
def files(tmp_path: Path) -> Files:
    """A class of 180: sections, groups of three, some exemptions, most quizzes."""
    ids = [f"s{number:03}" for number in range(180)]
    weeks = [f"week{number:02}" for number in range(1, 9)]
    roster = write(
        tmp_path / "roster.csv",
        "id,name,email,section,group,login",
        *(f"{one},Name {one},{one}@x.org,{'AB'[n % 2]},g{n // 3},hub-{one}" for n, one in enumerate(ids)),
    )
    exemptions = write(
        tmp_path / "exemptions.csv", "id,week,reason", *(f"{one},week03,ill" for one in ids[::17])
    )
    quizzes = write(
        tmp_path / "quizzes.csv",
        "id,week,percent",
        *(
            f"{one},{week},{(n * 7 + w * 13) % 101}"
            for n, one in enumerate(ids)
            for w, week in enumerate(weeks)
        ),
    )
    return Files(roster, exemptions, quizzes)


def test_the_totals_of_180_students_over_8_weeks_agree_with_a_script_of_their_own(
    tmp_path: Path, files: Files, toml: Path, course: CourseFile
) -> None:
    out = tmp_path / "graded"
    count = write_results(out, [f"s{number:03}" for number in range(180)], course)
    assert count > 1000
    said = write_term(out, files, course)
    assert "180 students, week01, week02, week03, week04, week05, week06, week07, week08" in said[-1]
    rows = lines_of(out / "term.csv")
    arguments = [out, files.roster, toml, files.exemptions, files.quizzes]
    script = [sys.executable, "-I", str(Path(recompute.__file__)), *map(str, arguments)]
    printed = subprocess.run(script, capture_output=True, text=True, check=True).stdout
    again = dict(line.split() for line in printed.splitlines())
    assert rows.keys() == again.keys()
    wrong = {
        student: (row["total"], again[student])
        for student, row in rows.items()
        if float(row["total"] or "nan") != pytest.approx(float(again[student]), abs=0.03, nan_ok=True)
    }
    assert wrong == {}
    assert len({row["total"] for row in rows.values()}) > 150
    assert any(row["handed_in_by"] for row in rows.values())
    assert any(row["open"] for row in rows.values())


MARKS = {"week01": WeekMark("graded", 80.0), "week02": WeekMark("missing", 0.0)}


@pytest.mark.parametrize(
    ("marks", "term", "total", "dropped"),
    [
        (MARKS, Term(), 40.0, ()),
        (MARKS, Term(weights={"week01": 3}), 60.0, ()),
        (MARKS, Term(weights={"week02": 0}), 80.0, ()),
        (MARKS, Term(drop_lowest=1), 80.0, ("week02",)),
        (MARKS, Term(drop_lowest=9), 80.0, ("week02",)),
        (MARKS, Term(quiz_percent=50), 20.0 + 25.0, ()),
        ({"week01": WeekMark("exempt"), "week02": WeekMark("missing", 0.0)}, Term(), 0.0, ()),
        ({"week01": WeekMark("exempt")}, Term(), None, ()),
        ({"week01": WeekMark("open")}, Term(drop_lowest=1), None, ()),
        ({}, Term(), None, ()),
        ({"week01": WeekMark("graded", 110.0)}, Term(), 110.0, ()),
    ],
)
def test_weights_exemptions_and_the_lowest_weeks(
    marks: dict[str, WeekMark], term: Term, total: float | None, dropped: tuple[str, ...]
) -> None:
    made = add_up_term(marks, dict.fromkeys(marks, 0.0) | {"week01": 100.0}, term)
    assert (made.percent, made.dropped) == (total, dropped)


def row(final: float, received: str = "", status: str = "graded") -> dict[str, object]:
    return {"status": status, "final": final, "max_score": 100.0, "received": received}


@pytest.mark.parametrize(
    ("rows", "counts", "mark"),
    [
        ({}, "last", WeekMark("missing", 0.0)),
        ({"ada": row(70)}, "last", WeekMark("graded", 70.0)),
        ({"bob": row(70)}, "last", WeekMark("graded", 70.0, "bob")),
        (
            {"ada": row(90, "2027-01-01"), "bob": row(50, "2027-01-02")},
            "last",
            WeekMark("graded", 50.0, "bob"),
        ),
        ({"ada": row(90, "2027-01-01"), "bob": row(50, "2027-01-02")}, "best", WeekMark("graded", 90.0)),
        ({"ada": row(0, status="rejected"), "bob": row(50)}, "last", WeekMark("graded", 50.0, "bob")),
        ({"ada": row(0, status="rejected")}, "last", WeekMark("missing", 0.0)),
        ({"ada": row(0, status="grader_error")}, "last", WeekMark("open")),
        ({"ada": row(40, status="needs_marking")}, "last", WeekMark("open", 40.0)),
    ],
)
def test_one_hand_in_counts_for_all_of_a_group(
    rows: dict[str, dict[str, object]], counts: str, mark: WeekMark
) -> None:
    assert week_mark("ada", rows, counts) == mark


def test_who_has_not_handed_in_and_who_is_a_stranger_is_named(tmp_path: Path, course: CourseFile) -> None:
    write_results(tmp_path / "graded", ["s000", "eve"], course, seed=5)
    roster = write(tmp_path / "roster.csv", "id;name;group", "S000;Ada;a", "s001;=cmd();a")
    plain = replace(course, term=Term())
    said = write_term(tmp_path / "graded", Files(roster), plain)
    assert any(line.startswith("week01: ") and "s001" in line for line in said)
    assert any("1 student with results, but not in the class list: eve" in line for line in said)
    assert any("groups, but course.toml no group_weeks" in line for line in said)
    rows = lines_of(tmp_path / "graded/term.csv")
    assert rows["s001"]["name"] == "'=cmd()"
    assert "week01" in rows["s001"]["missing"].split()


def test_totals_go_into_the_platforms_csv_where_no_week_is_open(tmp_path: Path, course: CourseFile) -> None:
    out = tmp_path / "graded"
    write_results(out, [f"s{number:03}" for number in range(30)], course)
    roster = write(tmp_path / "roster.csv", "id,name", *(f"s{number:03},N" for number in range(30)))
    write_term(out, Files(roster), replace(course, term=Term(drop_lowest=1)))
    rows = lines_of(out / "term.csv")
    lms = write(tmp_path / "lms.csv", "Name,ID number,Total", *(f"N,s{number:03}," for number in range(30)))

    def fill() -> list[str]:
        target = tmp_path / "filled.csv"
        return fill_lms(out, lms, target, exercise="term", column="Total", id_column="ID number")

    said = fill()
    filled = {line["ID number"]: line["Total"] for line in csv.DictReader((tmp_path / "filled.csv").open())}
    assert filled == {one: "" if line["open"] else line["total"] for one, line in rows.items()}
    assert {line["open"] != "" for line in rows.values()} == {True, False}
    assert any("open, left as it is" in line for line in said)
    (out / "gradebook.csv").touch()  # somebody has marked since
    os.utime(out / "term.csv", (1, 1))
    with pytest.raises(CourseError, match=r"term.csv is older than .*gradebook.csv: first type course term"):
        fill()
    (out / "term.csv").unlink()
    with pytest.raises(CourseError, match="course term"):
        fill()


@pytest.mark.parametrize(
    ("roster", "said"),
    [
        (
            "name,email\nAda,a@x\n",
            "has no column 'id', it has 'name', 'email'. Expected a first line id,name",
        ),
        ("id,name\n", "has no student"),
        ("id,name\nada,A\nADA,B\n", "id 'ada' is there 2 times (ada, ada)"),
        ("id,email\nada,a@x\nbob,A@X\n", "email 'a@x' is there 2 times (ada, bob)"),
        ("id,name\n,Ada\n", "row 2: no id, but 'Ada'"),
        ("id,name\n../etc,Ada\n", "row 2: '../etc' is not a student ID"),
        ("id,grup\nada,1\n", "has a column 'grup'. Did you mean group?"),
        (
            "id,name,group\nada,Lovelace, Ada,1\n",
            "row 2: 4 cells below 3 headings. A text with ',' in it needs double quotes",
        ),
        ("id,id\nada,ada\n", "has the column 'id' twice"),
        ("name\nAda\n", "has no column 'id', it has 'name'. Expected a first line id,name"),
        ("id\nada,Ada\n", "row 2: 2 cells below 1 heading. "),
        ("id\n\n", "has no student"),
        ("\nid\nada\n", "is not a CSV"),
        ("", "is not a CSV"),
    ],
)
def test_a_wrong_class_list_is_named_by_its_row_and_heading(
    tmp_path: Path, course: CourseFile, roster: str, said: str
) -> None:
    (tmp_path / "roster.csv").write_text(roster)
    write_results(tmp_path / "graded", ["ada"], course)
    with pytest.raises(CourseError) as caught:
        write_term(tmp_path / "graded", Files(tmp_path / "roster.csv"), replace(course, term=Term()))
    assert said in str(caught.value)


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        (
            "exemptions",
            "id,week\nada,week01\n",
            "has no column 'reason'. Expected a first line id,week,reason",
        ),
        (
            "exemptions",
            "id,week,reason\nadda,week01,ill\n",
            "row 2: no student 'adda' in the class list. Did you mean ada?",
        ),
        (
            "exemptions",
            "id,week,reason\nada,week1,ill\n",
            "row 2: no week 'week1' with points. Did you mean week01",
        ),
        ("exemptions", "id,week,reason\nada,week01,a\nada,week01,b\n", "row 3: ada week01 is there twice"),
        ("quizzes", "id,week,percent\nada,week01,much\n", "row 2: 'much', expected a number from 0 to 100"),
        ("quizzes", "id,week,percent\nada,week01,nan\n", "expected a number from 0 to 100"),
        ("quizzes", "id,week,percent\nada,week01,101\n", "expected a number from 0 to 100"),
    ],
)
def test_a_wrong_list_is_named_by_its_row(
    tmp_path: Path, course: CourseFile, name: str, text: str, said: str
) -> None:
    roster = write(tmp_path / "roster.csv", "id,name", "ada,Ada")
    (tmp_path / f"{name}.csv").write_text(text)
    write_results(tmp_path / "graded", ["ada"], course)
    files = Files(roster, **{name: tmp_path / f"{name}.csv"})
    with pytest.raises(CourseError) as caught:
        write_term(tmp_path / "graded", files, replace(course, term=Term()))
    assert said in str(caught.value)


def test_quizzes_that_count_must_be_there(tmp_path: Path, course: CourseFile) -> None:
    roster = write(tmp_path / "roster.csv", "id,name", "ada,Ada")
    with pytest.raises(CourseError, match="has no results"):
        write_term(tmp_path / "graded", Files(roster), course)
    write_results(tmp_path / "graded", ["ada"], course)
    with pytest.raises(CourseError, match="--quizzes"):
        write_term(tmp_path / "graded", Files(roster), course)


@pytest.mark.parametrize(
    ("term", "said"),
    [
        ("drop_lowest = 1.5", "drop_lowest: 1.5, expected a whole number of weeks"),
        ("quiz_percent = 120", "quiz_percent: 120, expected 0 to 100"),
        ('group_weeks = ["week99"]', "'week99' is not a week with points"),
        ('group_weeks = "week01"', "expected a list of texts"),
        ("weights = { week00 = 1 }", "'week00' is not a week with points"),
        ("drop = 1", "unknown key 'drop'"),
    ],
)
def test_a_wrong_term_in_course_toml_is_named(tmp_path: Path, term: str, said: str) -> None:
    text = (exercises_dir() / "course.toml").read_text()
    (tmp_path / "course.toml").write_text(f"{text}\n[term]\n{term}\n")
    with pytest.raises(CourseError) as caught:
        read_course_file(tmp_path / "course.toml")
    assert said in str(caught.value)
