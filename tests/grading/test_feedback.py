"""The zips of reports, read by the rules of Moodle's and Canvas's importers."""

import io
import json
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.marking.by_hand import mark_by_hand
from course_lib.grading.reports import report
from course_lib.grading.reports.report import feedback
from course_lib.grading.store import Course
from course_lib.grading.submissions.archives import RECEIPT
from course_lib.grading.submissions.collect import collect
from tests.grading.platforms import NAME, Handed, canvas_zip, moodle_zip, notebook, zipped

PARIS = ZoneInfo("Europe/Paris")


def members(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def moodle_import(name: str) -> tuple[int, str] | None:
    """Return participant and file as Moodle's importer of feedback files reads a path."""
    parts = ["", "import", *name.split("/")]
    while parts:
        info = parts.pop(0).split("_", 4)
        if len(info) >= 4 and info[1].isdigit() and (info[2], info[3]) == ("assignfeedback", "file"):
            return int(info[1]), "/".join([info[4] if len(info) > 4 else "", *parts])
    return None


def canvas_import(name: str) -> tuple[str, str] | None:
    """Return student and attachment as Canvas infers them from the name of a file."""
    parts = [part for part in name.rsplit("/", 1)[-1].split("_") if part != "LATE"]
    if parts[-1].startswith("link") or name.startswith("._"):
        return None
    if parts[0] == "anon":
        return parts[1], parts[2]
    numbers = [part for part in parts if re.fullmatch(r"\d+", part)]
    return (numbers[0], numbers[1]) if len(numbers) > 1 else None


def code(right: str, *changes: str) -> bytes:
    cells = [{"cell_type": "code", "source": cell} for cell in right.split("# next cell\n")]
    return json.dumps({"nbformat": 4, "metadata": {}, "cells": [*cells, *changes]}).encode()


Graded = Callable[..., Path]


@pytest.fixture
def graded(tmp_path: Path, course: Course) -> Graded:
    """Collects and grades a download."""

    def do(download: Path) -> Path:
        collect(download, tmp_path / "in", PARIS)
        grade(tmp_path / "in", tmp_path / "out", jobs=1, course=course)
        return tmp_path / "out"

    return do


def test_moodle_feedback_assigns_each_report_to_its_submitter(
    tmp_path: Path, graded: Graded, course: Course, right: str
) -> None:
    students = [
        Handed("Ada Lovelace", 101, "ada", files={NAME: code(right)}),
        Handed("René d'Août-Müller", 102, "rene", files={NAME: b"<html>"}),
        # As some systems write it, with a letter and a combining mark.
        Handed("Zoe\u0308", 104, "zoe", files={NAME: code("x = 1")}),
        Handed("=cmd|evil _7_", 103, "cleo", files={NAME: notebook("x = 1")}),
    ]
    moodle_zip(tmp_path / "moodle.zip", students)
    lines = feedback(graded(tmp_path / "moodle.zip"), "moodle", course=course)
    files = members(tmp_path / "out/feedback/week01_exercise_moodle.zip")
    assert {moodle_import(name): b"viewer" in page for name, page in files.items()}.keys() == {
        (number, "week01_exercise.html") for number in (101, 102, 103, 104)
    }
    assert "Zoë_104_assignfeedback_file_week01_exercise.html" in files
    assert "4 reports" in lines[-1]
    assert "Upload multiple feedback files in a zip" in lines[-1]
    pages = {moodle_import(name): page for name, page in files.items()}
    page = pages[101, "week01_exercise.html"]
    assert b"110 of 100 points" in page
    assert page.count(b'class="course-scene"') == 2
    assert b"<script src" not in page
    assert len(page) <= report.MAX_ALONE
    assert b"Not marked (rejected)" in pages[102, "week01_exercise.html"]


@pytest.mark.slow
def test_identical_reports_give_an_identical_zip(
    tmp_path: Path, graded: Graded, course: Course, right: str
) -> None:
    moodle_zip(tmp_path / "moodle.zip", [Handed("Ada", 101, "ada", files={NAME: code(right)})])
    out, made = graded(tmp_path / "moodle.zip"), []
    for _ in range(2):
        feedback(out, "moodle", course=course)
        made.append((out / "feedback/week01_exercise_moodle.zip").read_bytes())
    assert made[0] == made[1]


@pytest.mark.slow
def test_canvas_feedback_matches_student_and_attachment_and_replaces_a_zip_by_a_zip(
    tmp_path: Path, graded: Graded, course: Course, right: str
) -> None:
    receipt = json.dumps({"exercise": "week01_exercise", "student": "bob"}).encode()
    packed = zipped({NAME: code(right), RECEIPT: receipt})
    students = [
        Handed("adalovelace", 1001, "ada", files={NAME: code(right)}, late=True),
        Handed("team_7_bob", 1002, "bob", files={"week01_exercise_bob.zip": packed}),
    ]
    canvas_zip(tmp_path / "canvas.zip", students)
    lines = feedback(graded(tmp_path / "canvas.zip"), "canvas", course=course)
    files = members(tmp_path / "out/feedback/week01_exercise_canvas.zip")
    read = {canvas_import(name): (name, data) for name, data in files.items()}
    assert read.keys() == {("1001", "100100"), ("1002", "100200")}
    assert read["1001", "100100"][0].endswith(".html")
    with zipfile.ZipFile(io.BytesIO(read["1002", "100200"][1])) as inner:
        assert inner.namelist() == ["week01_exercise.html"]
        assert b"110 of 100 points" in inner.read("week01_exercise.html")
    assert "under the name of the submitted file" in lines[-1]


@pytest.mark.slow
def test_canvas_feedback_matches_an_anonymous_student_by_the_anonymous_id(
    tmp_path: Path, graded: Graded, course: Course
) -> None:
    (tmp_path / "canvas.zip").write_bytes(zipped({f"anon_Xy9z_4401_{NAME}": notebook()}))
    feedback(graded(tmp_path / "canvas.zip"), "canvas", course=course)
    files = members(tmp_path / "out/feedback/week01_exercise_canvas.zip")
    assert [canvas_import(name) for name in files] == [("Xy9z", "4401")]


@pytest.mark.slow
def test_report_that_needs_marking_is_withheld_until_it_is_marked(
    tmp_path: Path, graded: Graded, course: Course, right: str
) -> None:
    named = json.loads(code(right)) | {"metadata": {"course": {"student": "somebody"}}}
    moodle_zip(
        tmp_path / "moodle.zip",
        [
            Handed("Ada", 101, "ada", files={NAME: code(right)}),
            Handed("Bob", 102, "bob", files={"x/week01_exercise.ipynb": json.dumps(named).encode()}),
        ],
    )
    (tmp_path / "in").mkdir()
    worksheet = "Identifier,Full name,ID number\nParticipant 101,Ada,ada1\nParticipant 102,Bob,bob2\n"
    (tmp_path / "worksheet.csv").write_text(worksheet)
    collect(tmp_path / "moodle.zip", tmp_path / "in", PARIS, tmp_path / "worksheet.csv")
    out = tmp_path / "out"
    grade(tmp_path / "in", out, jobs=1, course=course)
    lines = feedback(out, "moodle", course=course)
    assert lines[0] == "left out: bob2 week01_exercise: it is needs_marking"
    assert len(members(out / "feedback/week01_exercise_moodle.zip")) == 1
    mark_by_hand(out, "bob2", "week01_exercise", "half", "7", comment="Well <b>done</b>", course=course)
    feedback(out, "moodle", course=course)
    files = members(out / "feedback/week01_exercise_moodle.zip")
    (bob,) = [page for name, page in files.items() if (moodle_import(name) or (0, ""))[0] == 102]
    assert b"Well &lt;b&gt;done&lt;/b&gt;" in bob


def test_results_with_a_duplicate_platform_number_are_not_returned(
    tmp_path: Path, graded: Graded, course: Course
) -> None:
    moodle_zip(tmp_path / "moodle.zip", [Handed("Ada", 101, "a"), Handed("Bob", 102, "b")])
    out = graded(tmp_path / "moodle.zip")
    copy = out / "results/eve/week01_exercise.json"
    copy.parent.mkdir()
    content = json.loads((out / "results/participant101/week01_exercise.json").read_text())
    copy.write_text(json.dumps(content))
    lines = feedback(out, "moodle", course=course)
    assert sum("2 results have the platform's number of this student" in line for line in lines) == 2
    assert len(members(out / "feedback/week01_exercise_moodle.zip")) == 1


def test_invalid_feedback_request_is_an_error_with_the_reason(
    tmp_path: Path, graded: Graded, course: Course
) -> None:
    with pytest.raises(CourseError, match="expected one of moodle, canvas"):
        feedback(tmp_path, "ilias", course=course)
    with pytest.raises(CourseError, match="has no results"):
        feedback(tmp_path, "moodle", course=course)
    moodle_zip(tmp_path / "moodle.zip", [Handed("Ada", 101, "a")])
    out = graded(tmp_path / "moodle.zip")
    with pytest.raises(CourseError, match=r"no result in .* is from a download of Canvas.* course collect"):
        feedback(out, "canvas", course=course)
    (out / "feedback").write_text("a file in the way")
    with pytest.raises(CourseError, match="can't be written"):
        feedback(out, "moodle", course=course)


@pytest.mark.parametrize(("sizes", "room"), [([10, 20, 900], 300), ([900, 900], 100), ([5], 0), ([1, 2], 9)])
def test_scenes_share_the_size_limit_and_small_scenes_are_kept_whole(sizes: list[int], room: int) -> None:
    share = report._max_scene_size(sizes, room)
    assert sum(min(size, share) for size in sizes) <= max(room, 0)
    assert all(size <= share for size in sizes if size <= room // len(sizes))


@pytest.mark.slow
def test_long_scenes_are_downsampled_to_the_report_size_limit(
    tmp_path: Path, graded: Graded, course: Course, right: str
) -> None:
    fast = right.replace("create_timer(1.0", "create_timer(0.001").replace(
        "position.z = 0.5", "position.z = __import__('random').random()"
    )
    moodle_zip(tmp_path / "moodle.zip", [Handed("Ada", 101, "ada", files={NAME: code(fast)})])
    feedback(graded(tmp_path / "moodle.zip"), "moodle", course=course)
    (page,) = members(tmp_path / "out/feedback/week01_exercise_moodle.zip").values()
    assert len(page) <= report.MAX_ALONE
    assert b'class="course-scene"' in page
