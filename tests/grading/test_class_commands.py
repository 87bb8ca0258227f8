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


def test_collect_grade_and_export_lead_from_zip_to_csv(
    in_process: Callable[..., Typed], tmp_path: Path
) -> None:
    (tmp_path / "roster.csv").write_text(ROSTER)
    empty = json.dumps({"nbformat": 4, "cells": [], "metadata": {}})
    with zipfile.ZipFile(tmp_path / "moodle.zip", "w") as archive:
        archive.writestr(FOLDER.format("Ada", 101), empty)
        archive.writestr(FOLDER.format("Bob", 102), "<html>")
        archive.writestr("../evil.ipynb", empty)
    collected = in_process("collect", "moodle.zip", "--out", "in", "--roster", "roster.csv", cwd=tmp_path)
    assert collected.returncode == 1
    assert "refused: ../evil.ipynb: its path leads elsewhere" in collected.stdout
    assert "Collected 2 files of 2 students into in, 1 refused." in collected.stdout
    graded = in_process("grade", "in", "--out", "graded", "--jobs", "1", cwd=tmp_path)
    assert graded.returncode == 1
    assert "2 submissions: 1 graded, 1 rejected." in graded.stdout
    names = ("--exercise", "week01_exercise", "--column", "Grade", "--id-column", "ID number")
    exported = in_process("mark", "graded", "--lms", "roster.csv", *names, "--to", "filled.csv", cwd=tmp_path)
    assert exported.returncode == 0, exported.stderr
    assert exported.stdout.splitlines()[:2] == [
        "roster.csv: row 3, B2: rejected, left as it is",
        "roster.csv: row 4, C3: no mark",
    ]
    grades = [row["Grade"] for row in csv.DictReader((tmp_path / "filled.csv").read_text().splitlines())]
    assert grades == ["0", "", ""]
