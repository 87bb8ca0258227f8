"""Selection of the counted files of a download: one exercise, independently for each student."""

import csv
import io
import json
from collections.abc import Mapping
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from course_lib.course.material import exercises_dir, lessons_dir
from course_lib.errors import CourseError
from course_lib.grading.grade import grade
from course_lib.grading.store import Course
from course_lib.grading.submissions import notebook as notebooks
from course_lib.grading.submissions.collect import Collection, collect
from course_lib.grading.submissions.notebook import MAX_BYTES, parse_notebook, without_outputs
from course_lib.grading.submissions.submission import find_submissions
from tests.grading.platforms import NAME, Handed, moodle_zip, notebook, zipped
from tests.test_cli import course as run_course

UTC = ZoneInfo("UTC")


def work(week: int, code: str = "mine = 1", student: str = "") -> bytes:
    return notebook(code, exercise=f"week0{week}_exercise", **({"student": student} if student else {}))


def released(week: int) -> bytes:
    return (exercises_dir() / f"week0{week}_exercise.ipynb").read_bytes()


def lesson(week: int) -> bytes:
    return next(lessons_dir().glob(f"week0{week}_*.ipynb")).read_bytes()


def whole_course(**files: bytes) -> bytes:
    """A zip of a student's folder, with work for weeks 1 and 2 and all else as it was released."""
    untouched = {f"my_course/week0{n}_exercise.ipynb": released(n) for n in range(3, 9)}
    mine = {f"my_course/week0{n}_exercise.ipynb": work(n, "whole = 1") for n in (1, 2)}
    return zipped({**untouched, **mine, "my_course/week02_lesson.ipynb": lesson(2), **files})


def collected(
    tmp_path: Path, files: Mapping[str, Mapping[str, bytes]], out: str = "out", **more: str
) -> Collection:
    students = [
        Handed(name, 4100001 + number, name, files=one) for number, (name, one) in enumerate(files.items())
    ]
    moodle_zip(tmp_path / "in.zip", students)
    return collect(tmp_path / "in.zip", tmp_path / out, UTC, **more)  # type: ignore[arg-type]


def exercises_by_student(out: Path) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for one in find_submissions(out):
        found.setdefault(one.student.removeprefix("participant410000"), []).append(one.exercise)
    return found


def rejected_in(out: Path) -> dict[str, str]:
    submissions = find_submissions(out, with_rejected=True)
    return {
        one.student.removeprefix("participant410000"): f"{one.exercise}: {one.problem}"
        for one in submissions
        if one.problem
    }


def test_other_weeks_in_a_zip_are_ignored_and_listed(tmp_path: Path) -> None:
    collected(tmp_path, {"Ada": {NAME: work(1, "on_time = 1")}, "Bob": {NAME: work(1)}})
    before = (tmp_path / "out/participant4100001" / NAME).read_bytes()
    collection = collected(
        tmp_path,
        {"Ada": {"all.zip": whole_course()}, "Bob": {"week02_exercise.ipynb": work(2)}},
    )
    assert exercises_by_student(tmp_path / "out") == {
        "1": ["week01_exercise", "week02_exercise"],
        "2": ["week01_exercise", "week02_exercise"],
    }
    assert (tmp_path / "out/participant4100001" / NAME).read_bytes() == before
    assert sorted(path.name for path in (tmp_path / "out/participant4100001").rglob("*.ipynb")) == [
        "week01_exercise.ipynb",
        "week02_exercise.ipynb",
    ]
    (set_aside, other), ignored = collection.set_aside[:2], collection.set_aside[2]
    assert (
        "week01_exercise.ipynb: it is week01_exercise, but this download counts for week02_exercise"
        in set_aside
    )
    assert "week02_lesson.ipynb: it is not an exercise" in other
    assert ", 2 set aside." in collection.summary(tmp_path)
    assert ignored == (
        "ignored: Ada: 6 exercises as released: week03_exercise, week04_exercise, week05_exercise, "
        "week06_exercise, week07_exercise, week08_exercise"
    )


def test_exercise_submitted_by_every_student_is_detected(tmp_path: Path) -> None:
    collection = collected(tmp_path, {"Ada": {"all.zip": whole_course()}, "Bob": {NAME: work(1)}})
    assert exercises_by_student(tmp_path / "out") == {"1": ["week01_exercise"], "2": ["week01_exercise"]}
    assert any(
        "it is week02_exercise, but this download counts for week01_exercise" in line
        for line in collection.set_aside
    )


def test_ambiguous_exercise_is_an_error_and_nothing_is_collected(tmp_path: Path) -> None:
    files = {"Ada": {NAME: work(1)}, "Bob": {NAME: work(1)}, "Cleo": {"week02_exercise.ipynb": work(2)}}
    with pytest.raises(CourseError) as asked:
        collected(tmp_path, files)
    assert str(asked.value) == (
        "this download contains week01_exercise (2 students), week02_exercise (1 student). Which "
        "exercise is it for? Add --exercise week01_exercise"
    )
    assert not (tmp_path / "out").exists()
    files["Ada"]["week02_exercise.ipynb"] = released(2)
    with pytest.raises(CourseError, match=r"week02_exercise \(1 student\)"):
        collected(tmp_path, files)
    del files["Ada"]["week02_exercise.ipynb"]
    collected(tmp_path, files, exercise="week01")
    assert exercises_by_student(tmp_path / "out") == {"1": ["week01_exercise"], "2": ["week01_exercise"]}
    assert rejected_in(tmp_path / "out") == {
        "3": "week01_exercise: week02_exercise.ipynb: it is week02_exercise, not week01_exercise. Submit "
        "week01_exercise.ipynb, or the zip that `course submit` writes"
    }


def test_rejection_is_kept_when_the_same_file_is_accepted_for_another_exercise(tmp_path: Path) -> None:
    wrong = {"Ada": {"week02_exercise.ipynb": work(2)}, "Bob": {"notes.pdf": b"1"}}
    collected(tmp_path, wrong, exercise="week01")
    collected(tmp_path, wrong, exercise="week02")
    assert exercises_by_student(tmp_path / "out")["1"] == ["week02_exercise"]
    refused = {one.exercise for one in find_submissions(tmp_path / "out", with_rejected=True) if one.problem}
    assert rejected_in(tmp_path / "out")["1"].startswith("week01_exercise: week02_exercise.ipynb")
    assert refused == {"week01_exercise", "week02_exercise"}
    collected(tmp_path, {"Ada": {NAME: work(1)}}, exercise="week01")
    assert "1" not in rejected_in(tmp_path / "out")


@pytest.mark.parametrize("exercise", ["week99", "week01_lesson", "../week01"])
def test_unknown_exercise_is_rejected_with_a_list_of_the_exercises(tmp_path: Path, exercise: str) -> None:
    with pytest.raises(CourseError, match="is not an exercise of this course: expected one of week01_"):
        collected(tmp_path, {"Ada": {NAME: work(1)}}, exercise=exercise)


def test_unchanged_copy_does_not_replace_edited_work_in_the_same_submission(tmp_path: Path) -> None:
    files = {"a/week01_exercise.ipynb": work(1), "z/week01_exercise (2).ipynb": released(1)}
    collection = collected(tmp_path, {"Ada": files})
    (one,) = find_submissions(tmp_path / "out")
    assert one.notebook is not None
    assert one.notebook.cells == ("mine = 1",)
    assert collection.set_aside == ["ignored: Ada: 1 exercise as released: week01_exercise"]


def test_unchanged_exercise_alone_is_a_submission(tmp_path: Path) -> None:
    collected(tmp_path, {"Ada": {NAME: released(1)}, "Bob": {NAME: released(1)}})
    ada, bob = find_submissions(tmp_path / "out")
    assert ada.is_untouched
    assert "the unchanged exercise: nothing was written into it" in bob.notes


def test_nbgrader_folder_with_several_assignments_is_sorted_by_assignment(tmp_path: Path) -> None:
    for student in ("ada", "bob"):
        for week in (1, 2):
            folder = tmp_path / f"in/submitted/{student}/week0{week}"
            folder.mkdir(parents=True)
            (folder / f"week0{week}_exercise.ipynb").write_bytes(work(week))
    (tmp_path / "in/submitted/bob/week02/week01_exercise.ipynb").write_bytes(work(1, "late = 1"))
    collection = collect(tmp_path / "in", tmp_path / "out", UTC)
    both = ["week01_exercise", "week02_exercise"]
    assert exercises_by_student(tmp_path / "out") == {"ada": both, "bob": both}
    assert len(collection.set_aside) == 1
    bobs = {one.exercise: one.path for one in find_submissions(tmp_path / "out") if one.student == "bob"}
    assert bobs["week01_exercise"].parent.name == "week01"
    collect(tmp_path / "in", tmp_path / "2", UTC, exercise="week02")
    assert exercises_by_student(tmp_path / "2") == {"ada": both[1:], "bob": both[1:]}


def stripped(data: bytes) -> bytes:
    return json.dumps({**json.loads(data), "metadata": {}}).encode()


@pytest.mark.parametrize("metadata", [True, False])
def test_lesson_with_the_name_of_an_exercise_is_rejected(tmp_path: Path, metadata: bool) -> None:
    for week in range(1, 9):
        path = tmp_path / f"in/ada/week0{week}_exercise.ipynb"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(lesson(week) if metadata else stripped(lesson(week)))
    for one in find_submissions(tmp_path / "in"):
        assert "is the lesson week" in one.problem
        assert f"not the exercise. Submit {one.exercise}.ipynb" in one.problem
        assert (one.reason, one.notebook) == ("a lesson", None)


def test_exercises_and_solutions_are_not_classified_as_lessons(tmp_path: Path) -> None:
    for week in range(1, 9):
        path = tmp_path / f"ada/week0{week}_exercise.ipynb"
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(stripped(released(week)))
    assert [one.problem for one in find_submissions(tmp_path)] == [""] * 8


REFUSED = {
    "report.pdf": (b"%PDF", "report.pdf: unsupported file type; expected one of .ipynb"),
    "week01_exercise.docx": (b"PK", "week01_exercise.docx: unsupported file type; expected one of .ipynb"),
    "hw.zip": (zipped({"notes.docx": b"1"}), "notes.docx: unsupported file type; expected one of"),
    "bad.zip": (b"PK\x03\x04 broken", "bad.zip: it is not a readable zip file"),
    "empty.ipynb": (b"", "empty.ipynb is not a notebook: it is empty"),
    "lamp.rviz": (b"1", "lamp.rviz: a file without a notebook"),
    "big.ipynb": (b'{"a": "' + b"x" * MAX_BYTES + b'"}', "more than 20,000,000 bytes without its outputs"),
    "config.json": (b"{}", "config.json: unsupported file type; expected one of"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_student_with_only_rejected_files_has_a_row_with_reason_and_advice(tmp_path: Path, name: str) -> None:
    data, why = REFUSED[name]
    collection = collected(tmp_path, {"Ada": {NAME: work(1)}, "Bob": {name: data}})
    (row,) = rejected_in(tmp_path / "out").values()
    assert row.startswith("week01_exercise: ")
    assert why in row
    assert row.endswith("Submit week01_exercise.ipynb, or the zip that `course submit` writes")
    assert collection.rejected_students == {"participant4100002"}
    assert "1 student rejected" in collection.summary(tmp_path)


def test_resubmission_clears_an_earlier_rejection(tmp_path: Path) -> None:
    collected(tmp_path, {"Ada": {NAME: work(1)}, "Bob": {"report.pdf": b"1"}})
    assert {*rejected_in(tmp_path / "out")} == {"2"}
    collected(tmp_path, {"Ada": {NAME: work(1)}, "Bob": {NAME: work(1)}})
    assert rejected_in(tmp_path / "out") == {}


def test_rejection_in_a_list_of_an_earlier_version_is_read_and_kept(tmp_path: Path) -> None:
    collected(tmp_path, {"Ada": {NAME: work(1)}, "Bob": {"report.pdf": b"1"}})
    path = tmp_path / "out/received.csv"
    text = path.read_text().replace(",rejected\n", ",refused\n", 1)
    path.write_text(text.replace(",download_path,", ",handed_in_as,", 1))
    ada, bob = find_submissions(tmp_path / "out", with_rejected=True)
    assert "unsupported file type" in bob.problem
    assert ada.received.download_path.endswith(NAME)
    collected(tmp_path, {"Ada": {NAME: work(1)}})
    _, bob = find_submissions(tmp_path / "out", with_rejected=True)
    assert "unsupported file type" in bob.problem


def test_rejected_file_of_a_student_with_an_earlier_submission_is_a_note(tmp_path: Path) -> None:
    collected(tmp_path, {"Ada": {NAME: work(1)}, "Bob": {NAME: work(1)}})
    collected(tmp_path, {"Ada": {NAME: work(1)}, "Bob": {"report.pdf": b"1"}})
    _, bob = find_submissions(tmp_path / "out", with_rejected=True)
    assert (bob.problem, bob.notes) == ("", ["not collected: participant4100002/report.pdf"])


def test_rejected_submission_is_found_in_a_folder_given_relative_to_its_parent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    collected(tmp_path, {"Ada": {NAME: work(1)}, "Bob": {"report.pdf": b"1"}})
    (tmp_path / "course").mkdir()
    monkeypatch.chdir(tmp_path / "course")
    _, bob = find_submissions(Path("../out"), with_rejected=True)
    assert "unsupported file type" in bob.problem


def test_rejected_submission_is_listed_in_gradebook_and_index(
    course: Course, tmp_path: Path, right: str
) -> None:
    collected(tmp_path, {"Ada": {NAME: notebook(right)}, "Bob": {"report.pdf": b"1"}})
    assert not grade(tmp_path / "out", tmp_path / "graded", jobs=1, course=course)
    rows = {
        row["student"]: row
        for row in csv.DictReader(io.StringIO((tmp_path / "graded/gradebook.csv").read_text()))
    }
    bob = rows["participant4100002"]
    assert (bob["exercise"], bob["status"], bob["reason"], bob["final"]) == (
        "week01_exercise",
        "rejected",
        "not collected",
        "",
    )
    assert "report.pdf: unsupported file type; expected one of .ipynb" in bob["message"]
    assert "Submit week01_exercise.ipynb" in bob["message"]
    assert "participant4100002" in (tmp_path / "graded/reports/index.html").read_text()
    assert (tmp_path / "graded/reports/participant4100002/week01_exercise.html").is_file()


NAMES = ("week01_exercise.ipynb.txt", "week01_exercise.json", "week01_exercise.ipynb.json", "WEEK01.IPYNB")


@pytest.mark.parametrize("name", NAMES)
def test_notebook_renamed_by_the_operating_system_is_accepted(tmp_path: Path, name: str) -> None:
    collection = collected(tmp_path, {"Ada": {name: work(1)}})
    assert (collection.rejected_lines, exercises_by_student(tmp_path / "out")) == (
        [],
        {"1": ["week01_exercise"]},
    )


@pytest.mark.parametrize("name", NAMES[:3])
def test_renamed_notebook_in_a_manually_created_folder_is_graded(tmp_path: Path, name: str) -> None:
    (tmp_path / "ada").mkdir()
    (tmp_path / "ada" / name).write_bytes(work(1))
    (tmp_path / "ada/settings.json").write_text("{}")
    (one,) = find_submissions(tmp_path)
    assert (one.student, one.exercise, one.problem) == ("ada", "week01_exercise", "")


def with_outputs(size: int) -> bytes:
    content = json.loads(work(1, 'text = "outputs"'))
    content["cells"][0]["outputs"] = [{"text": ['a \\ " ] } {\n', "b"], "data": {"image/png": "A" * size}}]
    content["cells"][0]["execution_count"] = 3
    content["cells"].append(
        {"cell_type": "markdown", "attachments": {"a.png": {"image/png": "B" * size}}, "source": "![a]"}
    )
    content["metadata"]["widgets"] = {"state": {"x": "C" * 100}}
    return json.dumps(content).encode()


@pytest.mark.slow
def test_large_outputs_are_removed_while_reading(tmp_path: Path) -> None:
    large = with_outputs(15_000_000)
    collected(tmp_path, {"Ada": {NAME: large}, "Bob": {"hw.zip": zipped({NAME: large})}})
    assert exercises_by_student(tmp_path / "out") == {"1": ["week01_exercise"], "2": ["week01_exercise"]}
    assert (tmp_path / "out/participant4100001" / NAME).stat().st_size < 1000
    (tmp_path / "hand/ada").mkdir(parents=True)
    (tmp_path / "hand/ada" / NAME).write_bytes(large)
    (one,) = find_submissions(tmp_path / "hand")
    assert one.notebook is not None
    assert (one.notebook.cells, one.notebook.was_run) == (('text = "outputs"',), (True,))


def test_removing_outputs_keeps_all_other_content() -> None:
    small = json.loads(without_outputs(with_outputs(10)))
    expected = json.loads(with_outputs(10))
    expected["cells"][0]["outputs"], expected["cells"][1]["attachments"] = [], {}
    expected["metadata"]["widgets"] = {}
    assert small == expected
    for broken in (b"", b'{"outputs": [', b'"outputs": [[[', b'{"cells": ["outputs": {]', b"\xff" * 100):
        assert isinstance(without_outputs(broken), bytes)


def test_notebook_with_too_many_json_tokens_keeps_its_outputs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(notebooks, "MAX_TOKENS", 100)
    data = b'{"outputs": [' + b"[]," * 200 + b"[]]}"
    assert without_outputs(data) == data


def test_released_exercises_are_recognized_by_their_cells() -> None:
    digests = {parse_notebook(released(week), "x").digest for week in range(1, 9)}
    stamped = json.loads(released(1))
    stamped["metadata"]["course"]["student"] = "ada"
    assert len(digests) == 8
    assert parse_notebook(json.dumps(stamped).encode(), "x").digest in digests


def test_late_files_of_an_earlier_download_are_not_counted_again(tmp_path: Path) -> None:
    (tmp_path / "canvas.zip").write_bytes(zipped({f"ada_LATE_11_900_{NAME}": work(1)}))
    assert "1 late" in collect(tmp_path / "canvas.zip", tmp_path / "out", UTC).summary(tmp_path)
    (tmp_path / "in/submitted/bob/week01").mkdir(parents=True)
    (tmp_path / "in/submitted/bob/week01" / NAME).write_bytes(work(1))
    assert "late by" not in collect(tmp_path / "in", tmp_path / "out", UTC).summary(tmp_path)


def test_note_lists_all_files_if_the_best_attempt_counts(tmp_path: Path) -> None:
    for name in (NAME, "week01_exercise (1).ipynb"):
        path = tmp_path / "ada" / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(work(1, name))
    *_, last = find_submissions(tmp_path, "best")
    assert f"the best of these counts: ada/{NAME}, ada/week01_exercise (1).ipynb" in last.notes


@pytest.mark.slow
def test_command_accepts_exercise_and_layout_and_exits_with_1_if_a_file_is_rejected(tmp_path: Path) -> None:
    moodle_zip(
        tmp_path / "m.zip", [Handed("Ada", 1, "", files={NAME: work(1), "week02_exercise.ipynb": work(2)})]
    )
    command = ("collect", "m.zip", "--out", "in")
    process = run_course(*command, cwd=tmp_path)
    assert (process.returncode, "Add --exercise week01_exercise" in process.stderr) == (2, True)
    completed = run_course(*command, "--exercise", "week02", "--layout", "moodle", cwd=tmp_path)
    assert completed.returncode == 0, completed.stderr
    assert (
        "set aside: Ada_1_assignsubmission_file_/week01_exercise.ipynb: it is week01_exercise"
        in completed.stdout
    )
    moodle_zip(tmp_path / "m.zip", [Handed("Ada", 1, "", files={NAME: work(1), "a.pdf": b"1"})])
    assert run_course(*command, cwd=tmp_path).returncode == 1
