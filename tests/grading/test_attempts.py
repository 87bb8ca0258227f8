"""Several files of one student: the file that counts, and its owner."""

import os
from collections.abc import Mapping
from pathlib import Path

import pytest

from course_lib.grading.grade import grade
from course_lib.grading.store import Course
from course_lib.grading.submissions.submission import find_submissions
from tests.grading.platforms import NAME, notebook, packed


def put(top: Path, files: Mapping[str, bytes]) -> None:
    for name, data in files.items():
        (top / name).parent.mkdir(parents=True, exist_ok=True)
        (top / name).write_bytes(data)


@pytest.mark.parametrize(
    ("older", "newer"),
    [
        ("week01_exercise.ipynb", "week01_exercise (1).ipynb"),
        ("week01_exercise (2).ipynb", "week01_exercise (10).ipynb"),
        ("week01_exercise.ipynb", "week01_exercise-2.ipynb"),
        ("week01_exercise-2.ipynb", "week01_exercise-3.ipynb"),
        ("week01_exercise.ipynb", "week01_exercise copy.ipynb"),
        ("week01_exercise copy 2.ipynb", "week01_exercise copy 3.ipynb"),
        ("week01_exercise - Copy.ipynb", "week01_exercise - Copy (2).ipynb"),
        ("week01_exercise-Copy1.ipynb", "week01_exercise-Copy2.ipynb"),
        ("week01_exercise.ipynb", "week01_exercise - Kopie.ipynb"),
        ("week01_exercise.ipynb", "week01_exercise_v2.ipynb"),
        ("week01_exercise_ada7.ipynb", "week01_exercise_ada7 (1).ipynb"),
        ("attempt 2/week01_exercise.ipynb", "attempt 10/week01_exercise.ipynb"),
        ("first/week01_exercise.ipynb", "week01_exercise (1).ipynb"),
    ],
)
def test_file_numbering_of_the_platform_determines_the_newest_attempt(
    tmp_path: Path, older: str, newer: str
) -> None:
    put(tmp_path, {f"ada7/{older}": notebook("x = 1"), f"ada7/{newer}": notebook("x = 2")})
    os.utime(tmp_path / "ada7" / newer, (1, 1))  # the time of a copy has no meaning
    (submission,) = find_submissions(tmp_path)
    assert submission.path == tmp_path / "ada7" / newer
    assert f"ada7/{newer} counts, not ada7/{older}" in submission.notes


def test_id_that_equals_the_number_of_an_attempt_stays_in_the_name(tmp_path: Path) -> None:
    names = [f"week01_exercise{end}.ipynb" for end in ("_11", "-2", "-10", "-11")]
    put(tmp_path, {f"11/{name}": notebook(f"x = {n}") for n, name in enumerate(names)})
    assert find_submissions(tmp_path)[0].path.name == names[-1]


def test_trusted_submission_times_take_precedence_over_file_numbering(tmp_path: Path) -> None:
    put(tmp_path, {f"ada/{NAME}": notebook("x = 1"), "ada/week01_exercise (1).ipynb": notebook("x = 2")})
    (tmp_path / "received.csv").write_text(
        f"file,received\nada/{NAME},2026-03-02 10:00\nada/week01_exercise (1).ipynb,2026-03-01 10:00\n"
    )
    assert find_submissions(tmp_path)[0].path.name == NAME


@pytest.mark.parametrize("bad", [b"", b"{]", b"<html>", b"PK", notebook(" \n"), b'{"cells": [1]}'])
def test_newer_file_of_another_type_does_not_replace_the_exercise_and_is_reported(
    tmp_path: Path, bad: bytes
) -> None:
    put(tmp_path, {f"ada/{NAME}": notebook(), "ada/week01_exercise (1).ipynb": bad})
    (submission,) = find_submissions(tmp_path)
    assert (submission.path.name, submission.problem) == (NAME, "")
    assert any("not ada/week01_exercise (1).ipynb" in note for note in submission.notes)


def test_newest_file_is_reported_if_the_exercise_is_missing(tmp_path: Path) -> None:
    put(tmp_path, {f"ada/{NAME}": b"{]", "ada/week01_exercise (1).ipynb": b"<html>"})
    assert "web page" in find_submissions(tmp_path)[0].problem


def test_receipt_with_the_id_of_another_student_replaces_no_submission(tmp_path: Path) -> None:
    late = "2026-03-09T00:00:00+00:00"
    put(tmp_path, {
        f"ada/{NAME}": notebook("mine"),
        "bob/week01_exercise_ada.zip": packed("stolen", "ada", late),
        "week01_exercise_ada (1).zip": packed("forged", "ada", late),
    })  # fmt: skip
    ada, bob = find_submissions(tmp_path)
    assert (ada.student, ada.path.parent.name, bob.student, bob.claimed_id) == ("ada", "ada", "bob", "ada")
    assert any("not week01_exercise_ada (1).zip" in note for note in ada.notes)


def test_files_claiming_the_same_student_id_do_not_replace_each_other(course: Course, tmp_path: Path) -> None:
    put(tmp_path / "in", {"a.zip": packed("x = 1", "ada"), "b.zip": packed("x = 2", "ada")})
    assert not grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
    _, row = (tmp_path / "out/gradebook.csv").read_text().splitlines()
    assert row.startswith("ada,week01_exercise,,,,,,rejected,claimed twice,")
    assert "a.zip and b.zip have the ID ada" in row


def test_newest_attempt_of_a_student_counts_without_a_platform(tmp_path: Path) -> None:
    names = ("week01_exercise_ada.zip", "week01_exercise_ada (1).zip")
    put(tmp_path, {name: packed(f"x = {n}", "ada") for n, name in enumerate(names)})
    (submission,) = find_submissions(tmp_path)
    assert (submission.path.name, submission.problem) == (names[1], "")
    assert len(submission.rivals) == 2


def test_all_attempts_at_the_exercise_are_judged_if_the_best_counts(tmp_path: Path) -> None:
    put(tmp_path, {f"ada/{NAME}": notebook("x = 1"), "ada/week01_exercise (1).ipynb": b"{]",
                   "ada/week01_exercise (2).ipynb": notebook("x = 2")})  # fmt: skip
    names = [one.path.name for one in find_submissions(tmp_path, "best")]
    assert names == ["week01_exercise (1).ipynb", NAME, "week01_exercise (2).ipynb"]
