"""Personal values are determined by the submitting student; files with another ID are detected."""

import csv
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from course_lib.grading.grade import grade
from course_lib.grading.inputs import personal_values
from course_lib.grading.marking.by_hand import mark_by_hand
from course_lib.grading.records import MISMATCH, NO_ID, UNVERIFIED
from course_lib.grading.run.run import Job, plan_scenarios
from course_lib.grading.store import Course, catalog_of
from course_lib.grading.submissions.collect import collect
from course_lib.grading.submissions.lms import fill_lms
from course_lib.grading.submissions.submission import find_submissions, resolve_ids

WriteNotebook = Callable[..., Path]
NAME = "week01_exercise.ipynb"


def ids_by_student(top: Path) -> dict[str, tuple[str | None, str]]:
    """By student: whose personal values count, and the flag."""
    return {one.student: (one.values_of, one.id_flag) for one in resolve_ids(find_submissions(top), top)}


def rows(out: Path) -> dict[str, dict[str, str]]:
    with (out / "gradebook.csv").open(newline="") as file:
        return {row["student"]: row for row in csv.DictReader(file)}


def answer(number: int) -> str:
    return f"answer = {2 * number}"


def own_number(course: Course, student: str | None) -> int:
    return int(personal_values(catalog_of(course).task("week01.answer"), student)["n"])


@pytest.fixture
def strangers(course: Course) -> tuple[str, str]:
    """Two students whose personal values differ."""
    names = [f"s{number}" for number in range(20)]
    other = next(name for name in names if own_number(course, name) != own_number(course, names[0]))
    return names[0], other


def test_folder_name_takes_precedence_over_the_id_in_the_file(
    tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    for folder, claims in {"ada": "ada", "bob": "ada", "cleo": " CLEO ", "dora": "nobody"}.items():
        write_notebook(tmp_path / folder / NAME, "x = 1", student=claims)
    write_notebook(tmp_path / "emil" / NAME, "x = 1")
    assert ids_by_student(tmp_path) == {
        "ada": ("ada", ""),
        "bob": ("bob", MISMATCH),
        "cleo": ("cleo", ""),
        "dora": ("dora", MISMATCH),
        "emil": ("emil", NO_ID),
    }


def test_platform_number_is_not_a_student_id(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    write_notebook(tmp_path / "participant4101" / NAME, "x = 1", student="ada")
    write_notebook(tmp_path / "Participant_4102" / NAME, "x = 1")
    write_notebook(tmp_path / "Cleo M_4103_assignsubmission_file_" / NAME, "x = 1", student="cleo")
    assert ids_by_student(tmp_path) == {
        "participant4101": ("ada", UNVERIFIED),
        "participant_4102": (None, NO_ID),
        "cleom_4103_assignsubmission_file_": ("cleo", UNVERIFIED),
    }


def test_two_platform_numbers_with_one_id_are_reported_as_a_mismatch(
    tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    for folder, claims in {"participant1": "ada", "participant2": "ada", "participant3": "cleo"}.items():
        write_notebook(tmp_path / folder / NAME, "x = 1", student=claims)
    assert ids_by_student(tmp_path) == {
        "participant1": ("ada", MISMATCH),
        "participant2": ("ada", MISMATCH),
        "participant3": ("cleo", UNVERIFIED),
    }


@pytest.mark.parametrize("name", ["{}_{}_assignsubmission_file_", "{0}_{1}_99_week01_exercise.ipynb"])
def test_roster_maps_platform_numbers_to_student_ids(
    tmp_path: Path, write_notebook: WriteNotebook, name: str
) -> None:
    with zipfile.ZipFile(tmp_path / "class.zip", "w") as archive:
        for number, claims in {4101: "ada", 4102: "ada", 4103: "cleo"}.items():
            path = name.format(f"name{number}", number)
            notebook = write_notebook(tmp_path / "one" / NAME, f"x = {number}", student=claims)
            archive.write(notebook, path if path.endswith(".ipynb") else f"{path}/{NAME}")
    known = "Identifier,ID number\nParticipant 4101,ada\nParticipant 4102,bob\n"
    if name.endswith(".ipynb"):  # Canvas
        known = known.replace("Identifier", "ID").replace("Participant ", "")
    (tmp_path / "roster.csv").write_text(known)
    collect(tmp_path / "class.zip", tmp_path / "in", ZoneInfo("UTC"), tmp_path / "roster.csv", "ID number")
    found = ids_by_student(tmp_path / "in")
    assert {key: found[key] for key in ("ada", "bob")} == {"ada": ("ada", ""), "bob": ("bob", MISMATCH)}
    (unknown,) = found.keys() - {"ada", "bob"}
    assert unknown.endswith("4103")
    assert found[unknown] == ("cleo", UNVERIFIED)


@pytest.mark.slow
def test_submission_with_a_foreign_id_is_judged_with_the_values_of_its_submitter(
    course: Course,
    right: str,
    strangers: tuple[str, str],
    tmp_path: Path,
    write_notebook: WriteNotebook,
    capsys: pytest.CaptureFixture[str],
) -> None:
    ada, bob = strangers
    constant = re.sub("answer = .*", answer(own_number(course, ada)), right)
    for folder in strangers:
        path = write_notebook(tmp_path / "in" / folder / NAME, constant, student=ada)
        path.with_name("timestamp.txt").write_text("2026-10-01 12:00:00 UTC")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    made = rows(tmp_path / "out")
    assert (made[ada]["final"], made[ada]["status"], made[ada]["reason"]) == ("110.0", "graded", "")
    assert (made[bob]["final"], made[bob]["status"], made[bob]["reason"]) == (
        "100.0",
        "needs_marking",
        MISMATCH,
    )
    assert f"the file has the ID {ada}, but {bob} submitted it" in made[bob]["message"]
    lines = capsys.readouterr().out.splitlines()
    assert any(
        line.startswith(f"Please review: {MISMATCH}: 1 submission ({bob} week01_exercise)") for line in lines
    )
    index = (tmp_path / "out/reports/index.html").read_text()
    assert index.count(f"<strong>{MISMATCH}</strong>") == 1


def test_second_folder_with_the_same_id_is_listed_for_review(
    course: Course,
    tmp_path: Path,
    write_notebook: WriteNotebook,
    capsys: pytest.CaptureFixture[str],
) -> None:
    write_notebook(tmp_path / "in/ada" / NAME, "x = 1", student="ada")
    write_notebook(tmp_path / "in" / NAME, "x = 2", student="ADA")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    (line,) = [line for line in capsys.readouterr().out.splitlines() if "same ID" in line]
    assert line.startswith("Please review: same ID: 1 submission (ada week01_exercise): several folders")
    index = (tmp_path / "out/reports/index.html").read_text()
    assert f"<strong>same ID: ada, {NAME}</strong>" in index


@pytest.mark.slow
def test_withheld_mark_is_released_after_manual_marking(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    out, lms = tmp_path / "out", tmp_path / "lms.csv"
    write_notebook(tmp_path / "in/bob" / NAME, right, student="ada")
    write_notebook(tmp_path / "in/cleo" / NAME, right, student="cleo")
    grade(tmp_path / "in", out, jobs=1, course=course)
    lms.write_text("Name,ID,Grade\nBob,bob,\nCleo,cleo,\n")

    def filled() -> list[str]:
        fill_lms(out, lms, tmp_path / "to.csv", exercise="week01_exercise", column="Grade", id_column="ID")
        return [line.rsplit(",", 1)[1] for line in (tmp_path / "to.csv").read_text().splitlines()[1:]]

    assert filled()[0] == ""
    message = mark_by_hand(out, "bob", "week01_exercise", "week01.half", "40", comment="typo", course=course)
    assert message.endswith("graded")
    assert filled()[0] != ""
    assert f"<strong>{MISMATCH}</strong>" in (out / "reports/index.html").read_text()


def test_identical_files_with_equal_personal_values_run_once(
    course: Course, strangers: tuple[str, str]
) -> None:
    tasks = list(catalog_of(course).tasks.values())
    steps = plan_scenarios(tasks, catalog_of(course), with_hidden=True)
    limits = catalog_of(course).course.limits
    same = next(
        name
        for name in (f"t{number}" for number in range(99))
        if own_number(course, name) == own_number(course, strangers[0])
    )
    keys = [Job(("x = 1",), student, steps, limits).key for student in (*strangers, same)]
    assert keys[0] == keys[2] != keys[1]


def test_corrected_student_id_is_detected_by_resume(
    course: Course, right: str, tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    path = write_notebook(tmp_path / "in/bob" / NAME, right, student="ada")
    (tmp_path / "in/received.csv").write_text(f"file,received\nbob/{NAME},2026-10-01T12:00:00+02:00\n")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    write_notebook(path, right, student="bob")
    grade(tmp_path / "in", tmp_path / "out", jobs=1, resume=True, course=course)
    assert rows(tmp_path / "out")["bob"]["status"] == "graded"
