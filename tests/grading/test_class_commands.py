"""An instructor's way from the platform's zip to the platform's CSV, typed as commands."""

import csv
import json
import zipfile
from collections.abc import Callable
from pathlib import Path

from tests.conftest import Typed

FOLDER = "{}_{}_assignsubmission_file_/week01_exercise.ipynb"
ROSTER = """\
Identifier,Full name,ID number,Grade
Participant 101,Ada,A1,
Participant 102,Bob,B2,
Participant 103,Cleo,C3,
"""


def test_collecting_in_a_course_that_is_not_installed_is_rejected(
    in_process: Callable[..., Typed], tmp_path: Path
) -> None:
    (tmp_path / "solutions").mkdir()
    (tmp_path / "exercises").mkdir()
    (tmp_path / "exercises" / "course.toml").write_text('time_zone = "Asia/Amman"')
    collected = in_process("collect", "moodle.zip", "--out", "in", cwd=tmp_path)
    assert collected.returncode == 2
    assert f"{tmp_path} is a course that is not installed" in collected.stderr


def test_collect_grade_and_export_commands_convert_a_zip_to_a_csv(
    in_process: Callable[..., Typed], tmp_path: Path
) -> None:
    (tmp_path / "roster.csv").write_text(ROSTER)
    cells = [{"cell_type": "code", "source": "x = 1"}]
    started = json.dumps({"nbformat": 4, "cells": cells, "metadata": {}})
    with zipfile.ZipFile(tmp_path / "moodle.zip", "w") as archive:
        archive.writestr(FOLDER.format("Ada", 101), started)
        archive.writestr(FOLDER.format("Bob", 102), "<html>")
        archive.writestr("../evil.ipynb", started)
    collected = in_process("collect", "moodle.zip", "--out", "in", "--roster", "roster.csv", cwd=tmp_path)
    assert collected.returncode == 1
    assert "rejected: ../evil.ipynb: its path leads out of the folder" in collected.stdout
    assert "Collected 2 files of 2 students into in, 1 file rejected." in collected.stdout
    graded = in_process("grade", "in", "--out", "graded", "--jobs", "1", cwd=tmp_path)
    assert graded.returncode == 1
    assert "2 submissions: 1 graded, 1 rejected." in graded.stdout
    names = ("--exercise", "week01_exercise", "--column", "Grade", "--id-column", "ID number")
    short = in_process(
        "mark", "graded", "--lms", "roster.csv", *names[:4], "--to", "filled.csv", cwd=tmp_path
    )
    assert short.returncode == 2
    assert "--lms also needs --id-column, the heading of the students' IDs" in short.stderr
    assert "'Full name', 'ID number', 'Grade'" in short.stderr
    exported = in_process("mark", "graded", "--lms", "roster.csv", *names, "--to", "filled.csv", cwd=tmp_path)
    assert exported.returncode == 0, exported.stderr
    assert exported.stdout.splitlines()[:2] == [
        "roster.csv: row 3, B2: rejected, row unchanged",
        "roster.csv: row 4, C3: no mark",
    ]
    grades = [row["Grade"] for row in csv.DictReader((tmp_path / "filled.csv").read_text().splitlines())]
    assert grades == ["0", "", ""]
    return_with_comments(in_process, tmp_path)


def return_with_comments(in_process: Callable[..., Typed], tmp_path: Path) -> None:
    """Enter points for a rejected file and an oral exam. Return marks, comments and reports of a section."""

    def course(*words: str) -> str:
        process = in_process(*words, cwd=tmp_path)
        assert process.returncode == 0, process.stderr
        return process.stdout

    without = ("--without-file", "--comment")
    output = course("mark", "graded", "b2", "week01", "70.5", *without, "On paper, <b>clear</b>")
    assert output == "b2 week01_exercise: 70.5 without a file; now graded\n"
    output = course("mark", "graded", "C3", "week01_exercise", "90", *without, 'Oral exam, "good"')
    assert output == "c3 week01_exercise, who is new in the gradebook: 90 without a file; now graded\n"
    page = (tmp_path / "graded/reports/b2/week01_exercise.html").read_text()
    assert "70.5 points" in page
    assert "On paper, &lt;b&gt;clear&lt;/b&gt;" in page
    course("mark", "graded", "a1", "week01_exercise", "red_cube", "5", "--comment", "Nearly.")
    course("grade", "in", "--out", "graded", "--jobs", "1", "--resume")  # keeps the marks
    rows = ROSTER.replace("Grade\n", "Grade,Feedback comments\n").replace(",\n", ",,\n")
    (tmp_path / "worksheet.csv").write_text(rows)
    (tmp_path / "class.csv").write_text("id,section\na1,A\nb2,B\nc3,B\n")
    names = ("--exercise", "week01_exercise", "--column", "Grade", "--id-column", "ID number")
    comments = ("--comment-column", "Feedback comments", "--to", "filled.csv")
    course("mark", "graded", "--lms", "worksheet.csv", *names, *comments)
    filled = list(csv.DictReader((tmp_path / "filled.csv").read_text().splitlines(keepends=True)))
    assert [(row["Grade"], row["Feedback comments"]) for row in filled] == [
        ("5", "A red cube on the ground: Nearly."),
        ("70.5", "On paper, <b>clear</b>"),
        ("90", 'Oral exam, "good"'),
    ]
    section = ("--section", "b", "--roster", "class.csv")
    output = course("mark", "graded", "--lms", "worksheet.csv", *names, *comments, *section)
    assert output == "Wrote filled.csv: 2 marks after the late policy; turn off the platform's late policy.\n"
    filled = list(csv.DictReader((tmp_path / "filled.csv").read_text().splitlines(keepends=True)))
    assert [row["Grade"] for row in filled] == ["", "70.5", "90"]
    output = course("feedback", "graded", "--lms", "moodle", "--exercise", "week01_exercise", *section)
    assert "a1" not in output
    with zipfile.ZipFile(tmp_path / "graded/feedback/week01_exercise_moodle.zip") as archive:
        assert archive.namelist() == ["Bob_102_assignfeedback_file_week01_exercise.html"]
    output = course("mark", "graded", "c3", "week01", "--without-file", "--withdraw")
    assert output == "c3 week01_exercise: mark without a file withdrawn; now rejected\n"
