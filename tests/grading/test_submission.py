import errno
import json
import os
import re
import zipfile
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from course_lib.course.course_file import LatePolicy
from course_lib.errors import CourseError
from course_lib.grading.records import RECEIPT_TIME, ReceiptTime
from course_lib.grading.submissions.collect import collect
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.submissions.submission import find_submissions, skipped_files
from course_lib.grading.submissions.submit import submit

WriteNotebook = Callable[..., Path]


def test_submission_package_is_read_with_its_receipt(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    exercise = write_notebook(tmp_path / "work/week01_exercise.ipynb", "x = 1", student="ada")
    receipt = submit(exercise)
    assert receipt.file.name == "week01_exercise_ada.zip"
    assert "sha256" in receipt.text()
    (tmp_path / "in").mkdir()
    receipt.file.rename(tmp_path / "in/renamed by the LMS.zip")
    (submission,) = find_submissions(tmp_path / "in")
    assert (submission.student, submission.exercise, submission.received.source) == (
        "ada",
        "week01_exercise",
        "receipt",
    )
    assert submission.sha256 == receipt.content["sha256"]
    assert submission.notebook is not None
    assert submission.notebook.cells == ("x = 1",)


def test_missing_student_id_is_reported_at_submission(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    exercise = write_notebook(tmp_path / "week01_exercise.ipynb", "x = 1")
    assert "it has no student ID" in submit(exercise, tmp_path / "out.zip").text()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("none.ipynb", None, "can't be read: No such file"),
        ("folder", None, "can't be read: Is a directory"),
        ("week01_exercise.ipynb", b"", "it is empty"),
        ("week01_exercise.ipynb", b"{]", "it is not JSON"),
        ("week01_exercise.ipynb", b"[" * 100_000, "it is not JSON"),
        ("week01_exercise.ipynb", b"[]", "not a notebook of format 3 or 4"),
        ("week01_exercise.ipynb", b'{"cells": [1]}', "not a notebook of format 3 or 4"),
        ("homework.ipynb", b'{"cells": []}', "not an exercise of this course"),
        ("week01.zip", b"PK", "not a file that `course submit` wrote"),
    ],
)
def test_invalid_submission_is_rejected_with_one_line(
    tmp_path: Path, name: str, content: bytes | None, message: str
) -> None:
    (tmp_path / "folder").mkdir()
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(CourseError) as refusal:
        submit(tmp_path / name)
    assert message in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_unwritable_out_file_is_reported(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    exercise = write_notebook(tmp_path / "week01_exercise.ipynb", "x = 1")
    with pytest.raises(CourseError, match="can't be written"):
        submit(exercise, exercise / "out.zip")


def test_full_disk_leaves_the_former_packed_file_unchanged(
    tmp_path: Path, write_notebook: WriteNotebook, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    exercise = write_notebook(tmp_path / "week01_exercise.ipynb", "x = 1")
    out = submit(exercise).file
    before = out.read_bytes()
    monkeypatch.setattr("os.fsync", fail)
    with pytest.raises(CourseError, match="can't be written: No space left on device"):
        submit(exercise)
    assert out.read_bytes() == before
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([exercise.name, out.name])


@pytest.mark.parametrize("code", ["", " \n"])
def test_notebook_without_code_is_rejected(tmp_path: Path, write_notebook: WriteNotebook, code: str) -> None:
    path = write_notebook(tmp_path / "ada/week01_exercise.ipynb", code)
    (submission,) = find_submissions(tmp_path)
    assert (submission.reason, submission.notebook) == ("no code", None)
    assert submission.problem.startswith(f"{path.name} has no code in its code cells. Open it")


def test_notebook_source_may_be_a_list_of_lines_and_metadata_arbitrary() -> None:
    cells = [{"cell_type": "code", "source": ["a = 1\n", "b = 2", 3]}, {"cell_type": "markdown"}]
    notebook = parse_notebook(json.dumps({"cells": cells, "metadata": {"course": 7}}).encode(), "n")
    assert notebook.cells == ("a = 1\nb = 2",)
    assert (notebook.exercise, notebook.student) == (None, None)


def test_older_notebook_formats_and_other_encodings_are_read() -> None:
    cells = [{"cell_type": "code", "input": ["x = 1\n", "y = 2"]}, {"cell_type": "markdown", "source": "é"}]
    old = json.dumps({"nbformat": 3, "worksheets": [{"cells": cells}], "metadata": {}}, ensure_ascii=False)
    for encoding in ("utf-8", "utf-8-sig", "utf-16", "utf-32"):
        assert parse_notebook(old.encode(encoding), "week01_exercise.ipynb").cells == ("x = 1\ny = 2",)


def test_folder_determines_the_student(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    write_notebook(tmp_path / "ada/deep/week01_exercise.ipynb", "x = 1", student="bob")
    write_notebook(tmp_path / "cleo/week01_exercise (1).ipynb", "x = 1")
    write_notebook(tmp_path / "cleo/.ipynb_checkpoints/week01_exercise-checkpoint.ipynb", "x = 2")
    ada, cleo = find_submissions(tmp_path)
    assert (ada.student, ada.claimed_id) == ("ada", "bob")
    assert (cleo.student, cleo.exercise, cleo.claimed_id) == ("cleo", "week01_exercise", None)


def test_path_as_student_id_is_not_used_as_a_folder(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    write_notebook(tmp_path / "week01_exercise.ipynb", "x = 1", student="../../etc")
    assert find_submissions(tmp_path)[0].student == "week01_exercise"


def test_file_modification_time_is_not_the_time_of_receipt(
    tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    for name, second in (("week01_exercise.ipynb", 100), ("week01_exercise_v2.ipynb", 50)):
        path = write_notebook(tmp_path / "ada" / name, "x = 1")
        os.utime(path, (second, second))
    (submission,) = find_submissions(tmp_path)
    assert submission.path.name == "week01_exercise_v2.ipynb"
    assert (submission.received.time, submission.received.source) == (None, "unknown")


def test_symlinks_are_not_followed(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    secret = write_notebook(tmp_path / "secret/week01_exercise.ipynb", "x = 1")
    write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", "x = 1")
    (tmp_path / "in/bob").mkdir()
    (tmp_path / "in/bob/week01_exercise.ipynb").symlink_to(secret)
    (tmp_path / "in/cleo").symlink_to(secret.parent)
    assert [found.student for found in find_submissions(tmp_path / "in")] == ["ada"]


def test_skipped_symlinks_and_pipes_are_listed(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    ada = write_notebook(tmp_path / "ada/week01_exercise.ipynb", "x = 1")
    (tmp_path / "bob").mkdir()
    (tmp_path / "bob/week01_exercise.ipynb").symlink_to(ada)
    (tmp_path / "cleo").symlink_to(ada.parent)
    os.mkfifo(tmp_path / "ada/week02_exercise.ipynb")
    assert skipped_files(tmp_path) == [
        "skipped: cleo: it is a link, not a file",
        "skipped: ada/week02_exercise.ipynb: it is a pipe or a device, not a file",
        "skipped: bob/week01_exercise.ipynb: it is a link, not a file",
    ]


def test_folder_without_a_notebook_is_listed(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    write_notebook(tmp_path / "ada/week01_exercise.ipynb", "x = 1")
    (tmp_path / "bob/late").mkdir(parents=True)
    (tmp_path / "bob/late/week01_exercise.7z").write_bytes(b"7z\xbc\xaf\x27\x1c")
    (tmp_path / "empty").mkdir()
    assert skipped_files(tmp_path) == [
        "skipped: bob: no notebook, and no zip of `course submit`, among week01_exercise.7z"
    ]


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (b"Rar!\x1a\x07\x01\x00", "it is a RAR archive"),
        (b"7z\xbc\xaf\x27\x1c", "it is a 7z archive"),
        (b'{"cells": []}', "it looks like a notebook"),
        (b"<!DOCTYPE html>", "it looks like a web page"),
        (b"PK\x03\x04 cut off", "it is damaged or incomplete (File is not a zip file)"),
        (b"", "it is empty"),
        (b"hello", "File is not a zip file"),
    ],
)
def test_file_with_the_name_of_a_zip_file_is_described(data: bytes, kind: str, tmp_path: Path) -> None:
    path = tmp_path / "ada/week01_exercise.zip"
    path.parent.mkdir()
    path.write_bytes(data)
    (submission,) = find_submissions(tmp_path)
    assert f"(it is not a readable zip file: {kind})" in submission.problem
    with pytest.raises(CourseError, match=re.escape(f"it is not a readable zip file: {kind}")):
        collect(path, tmp_path / "out", zone=ZoneInfo("UTC"))


def test_symlinks_are_rejected_submissions_of_their_students(
    tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    top = tmp_path / "in"
    ada = write_notebook(top / "ada/week01_exercise.ipynb", "x = 1")
    (top / "bob").mkdir()
    (top / "bob/week01_exercise.ipynb").symlink_to(ada)
    (top / "cleo").symlink_to(ada.parent)
    (top / "ada/week01_exercise (1).ipynb").symlink_to(ada)
    submissions = {one.student: one for one in find_submissions(top, with_rejected=True)}
    assert {name: (one.exercise, one.reason) for name, one in submissions.items()} == {
        "ada": ("week01_exercise", ""),
        "bob": ("week01_exercise", "not collected"),
        "cleo": ("week01_exercise", "not collected"),
    }
    assert submissions["ada"].rejected_files == ("ada/week01_exercise (1).ipynb",)
    assert submissions["cleo"].problem.startswith("it is a link, not a file. Copy the file")


@pytest.mark.parametrize(("day", "message"), [(10, "on time"), (12, "late")])
def test_time_known_only_from_the_receipt_has_a_remark(day: int, message: str) -> None:
    deadline = datetime(2026, 10, 11, tzinfo=UTC)
    received = ReceiptTime(datetime(2026, 10, day, tzinfo=UTC), RECEIPT_TIME)
    expected = f"{message} according to the receipt only, which the student's machine wrote"
    assert received.remark(deadline, LatePolicy()) == expected


@pytest.mark.slow
def test_zip_bomb_is_not_unpacked(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "bomb.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("receipt.json", json.dumps({"exercise": "week01_exercise"}))
        archive.writestr("week01_exercise.ipynb", b" " * 50_000_000)
    (submission,) = find_submissions(tmp_path)
    assert "larger than" in submission.problem


@pytest.mark.parametrize(
    ("files", "time", "source"),
    [
        (
            {"received.csv": "file,received\nada/week01_exercise.ipynb,2026-10-11T10:00:00+02:00\n"},
            8,
            "received.csv",
        ),
        ({"ada/timestamp.txt": "2026-10-11 10:00:00.5 Europe/Paris"}, 8, "timestamp.txt"),
        ({"ada/timestamp.txt": "2026-10-11 10:00:00 UTC"}, 10, "timestamp.txt"),
    ],
)
def test_receipt_time_and_its_source_are_recorded(
    tmp_path: Path, write_notebook: WriteNotebook, files: dict[str, str], time: int, source: str
) -> None:
    write_notebook(tmp_path / "ada/week01_exercise.ipynb", "x = 1")
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    (submission,) = find_submissions(tmp_path)
    assert submission.received.time is not None
    assert submission.received.time.replace(microsecond=0) == datetime(2026, 10, 11, time, tzinfo=UTC)
    assert submission.received.source == source


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("received.csv", "file,received\nada/week01_exercise.ipynb,yesterday\n"),
        ("received.csv", "file,received\nada/week01_exercise.ipynb,03/08/2026 23:59\n"),
        ("ada/timestamp.txt", "haha"),
        ("ada/timestamp.txt", "2026-10-11 10:00:00 Mars/Base"),
        ("ada/timestamp.txt", "9999-12-31 23:59:59 UTC"),
        ("ada/timestamp.txt", "\0" * 500),
        ("ada/received.csv", "file,received\nweek01_exercise.ipynb,2020-01-01T00:00:00Z\n"),
        ("ada/received.csv", "\0broken"),
    ],
)
def test_invalid_receipt_time_is_reported_for_its_submission_only(
    tmp_path: Path, write_notebook: WriteNotebook, name: str, text: str
) -> None:
    for student in ("ada", "bob"):
        write_notebook(tmp_path / student / "week01_exercise.ipynb", "x = 1", student=student)
    (tmp_path / name).write_text(text)
    ada, bob = find_submissions(tmp_path)
    assert (ada.received.time, ada.received.source, ada.problem) == (None, "unknown", "")
    assert len(ada.notes) == 1
    assert Path(name).name in ada.notes[0]
    assert not bob.notes


def test_symlinked_timestamp_file_is_not_followed(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    write_notebook(tmp_path / "in/ada/week01_exercise.ipynb", "x = 1", student="ada")
    (tmp_path / "stamp").write_text("2026-10-11 10:00:00 UTC")
    (tmp_path / "in/ada/timestamp.txt").symlink_to(tmp_path / "stamp")
    (submission,) = find_submissions(tmp_path / "in")
    assert submission.received.time is None
    assert "it is a link" in submission.notes[0]


def test_received_csv_without_required_columns_is_rejected(
    tmp_path: Path, write_notebook: WriteNotebook
) -> None:
    write_notebook(tmp_path / "ada/week01_exercise.ipynb", "x = 1")
    (tmp_path / "received.csv").write_text("name,time\na,b\n")
    with pytest.raises(CourseError, match=r"received.csv has no column 'file'"):
        find_submissions(tmp_path)


@pytest.mark.parametrize("written", ["2026-10-11T10:00:00+02:00", "2026-10-11 10:00", "11.10.2026 10:00"])
def test_local_times_in_spreadsheet_format_are_accepted_in_received_csv(
    tmp_path: Path, write_notebook: WriteNotebook, written: str
) -> None:
    write_notebook(tmp_path / "ada/week01_exercise.ipynb", "x = 1")
    (tmp_path / "received.csv").write_text(f"file;received\nada/week01_exercise.ipynb;{written}\n")
    (submission,) = find_submissions(tmp_path, zone=ZoneInfo("Europe/Paris"))
    assert submission.received.time == datetime(2026, 10, 11, 8, tzinfo=UTC)


def test_folder_names_and_claimed_ids_are_normalized(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    write_notebook(tmp_path / "Ada 1/week01_exercise.ipynb", "x = 1", student="ADA1")
    (submission,) = find_submissions(tmp_path)
    assert (submission.student, submission.claimed_id, submission.notes) == ("ada1", "ada1", [])


@pytest.mark.parametrize("damage", ["encrypted", "bytes"])
def test_damaged_archive_affects_only_its_student(
    tmp_path: Path, write_notebook: WriteNotebook, damage: str
) -> None:
    write_notebook(tmp_path / "ada/week01_exercise.ipynb", "x = 1", student="ada")
    packed = submit(write_notebook(tmp_path / "week01_exercise.ipynb", "y = 2 " * 500)).file
    packed.with_name("week01_exercise.ipynb").unlink()
    data = bytearray(packed.read_bytes())
    if damage == "bytes":
        data[60:80] = b"\xff" * 20
    else:
        for header, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
            data[data.index(header) + flags] |= 1
            data[data.rindex(header) + flags] |= 1
    packed.write_bytes(data)
    problems = {found.student: found.problem for found in find_submissions(tmp_path)}
    assert problems.pop("ada") == ""
    assert all("not a file that `course submit` wrote" in problem for problem in problems.values())
    assert len(problems) == 1


def test_named_pipe_is_not_a_submission(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    write_notebook(tmp_path / "ada/week01_exercise.ipynb", "x = 1")
    os.mkfifo(tmp_path / "ada/week02_exercise.ipynb")
    assert len(find_submissions(tmp_path)) == 1


def test_receipt_with_an_impossible_time_is_ignored(tmp_path: Path, write_notebook: WriteNotebook) -> None:
    packed = submit(write_notebook(tmp_path / "week01_exercise.ipynb", "x = 1")).file
    with zipfile.ZipFile(packed) as archive:
        content = {name: archive.read(name) for name in archive.namelist()}
    receipt = json.loads(content["receipt.json"]) | {"time": "0001-01-01T00:00:00+14:00"}
    (tmp_path / "in").mkdir()
    with zipfile.ZipFile(tmp_path / "in/a.zip", "w") as archive:
        archive.writestr("week01_exercise.ipynb", content["week01_exercise.ipynb"])
        archive.writestr("receipt.json", json.dumps(receipt))
    assert find_submissions(tmp_path / "in")[0].received.source == "unknown"
