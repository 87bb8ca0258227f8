import errno
import io
import os
import re
import stat
import struct
import subprocess
import sys
import zipfile
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest

from course_lib.course.exercise import normalise
from course_lib.errors import CourseError
from course_lib.grading.reports.rendering import replace_controls
from course_lib.grading.submissions import archives
from course_lib.grading.submissions.collect import Collection, collect
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.submissions.submission import find_submissions, unfinished_lines
from tests.grading.platforms import notebook, zipped

AMMAN = ZoneInfo("Asia/Amman")
NAME = "week01_exercise.ipynb"
Bytes = Mapping[str | zipfile.ZipInfo, bytes]


@pytest.fixture
def sort(tmp_path: Path) -> Callable[[Bytes], Collection]:
    def do(files: Bytes) -> Collection:
        (tmp_path / "in.zip").write_bytes(zipped(files))
        return collect(tmp_path / "in.zip", tmp_path / "out", AMMAN)

    return do


Sort = Callable[[Bytes], Collection]


def collected_files(out: Path) -> list[str]:
    return sorted(path.relative_to(out).as_posix() for path in out.rglob("*") if path.is_file())


def test_moodle_zip_is_collected_with_both_naming_schemes(sort: Sort, tmp_path: Path) -> None:
    collection = sort({
        f"Ada Lovelace_12345_assignsubmission_file_/{NAME}": notebook("a = 1"),
        f"Bob O'Neil_777_assignsubmission_file_{NAME}": notebook("b = 1"),
        "Bob O'Neil_777_assignsubmission_onlinetext_/onlinetext.html": b"<p>",
    })  # fmt: skip
    assert collected_files(tmp_path / "out") == [
        f"participant12345/{NAME}",
        f"participant777/{NAME}",
        "received.csv",
    ]
    assert len(collection.rejected_lines) == 1
    by_student = {s.student: s.received for s in find_submissions(tmp_path / "out")}
    assert {(r.time, r.source) for r in by_student.values()} == {
        (None, "unknown")
    }  # members have download times
    assert any("add --roster" in note for note in collection.notes)
    assert "Ada Lovelace" in (tmp_path / "out/received.csv").read_text()


def test_canvas_names_with_late_marker_and_second_attempt_are_collected(sort: Sort, tmp_path: Path) -> None:
    collection = sort({
        f"lovelaceada_11_900_{NAME}": notebook("a = 1"),
        f"bobsonbob_LATE_12_901_{NAME}": notebook("b = 1"),
        "bobsonbob_12_902_week01_exercise-1.ipynb": notebook("b = 2"),
    })  # fmt: skip
    assert not collection.rejected_lines
    assert collected_files(tmp_path / "out") == [
        f"11/{NAME}",
        "12/week01_exercise-1.ipynb",
        f"12/{NAME}",
        "received.csv",
    ]
    late = [row["file"] for row in collection.rows.values() if row["late"] == "yes"]
    assert late == [f"12/{NAME}"]
    assert "1 late according to the platform" in collection.summary(tmp_path)
    first, second = (one.received for one in find_submissions(tmp_path / "out"))
    assert (first.time, first.late, second.late) == (None, False, False)  # of the second try
    assert len(collection.notes) == 1
    assert "Canvas's zip has no times" in min(collection.notes)


def test_student_with_hidden_files_only_is_rejected_with_the_reason(sort: Sort, tmp_path: Path) -> None:
    files: dict[str | zipfile.ZipInfo, bytes] = {
        f"Ada_1_assignsubmission_file_/.{NAME}": notebook("a = 1"),
        f"Bob_2_assignsubmission_file_/.ipynb_checkpoints/{NAME}": notebook("b = 1"),
        f"Eve_3_assignsubmission_file_/{NAME}": notebook("c = 1"),
        f"Eve_3_assignsubmission_file_/.git/{NAME}": notebook("c = 2"),
        "Eve_3_assignsubmission_file_/a.zip": zipped({"b.py": b"", ".c.py": b"", "._b.py": b""}),
        f"__MACOSX/Joe_4_assignsubmission_file_/._{NAME}": b"",
        ".DS_Store": b"",
    }
    (tmp_path / "folder").mkdir()
    with zipfile.ZipFile(io.BytesIO(zipped(files))) as archive:
        archive.extractall(tmp_path / "folder")
    for collection in (sort(files), collect(tmp_path / "folder", tmp_path / "out2", AMMAN)):
        assert [owner for owner, _ in collection.skipped] == ["Ada (1)", "Bob (2)"]
        assert "begins with a dot" in collection.rejected_lines[0]
        assert collection.rejected_students == {"participant1", "participant2"}


def test_attempt_with_the_higher_number_counts_at_equal_times(sort: Sort, tmp_path: Path) -> None:
    for code in ("x = 1", "x = 2"):
        sort({f"ada/{NAME}": notebook(code)})
    assert [one.path.name for one in find_submissions(tmp_path / "out")] == ["week01_exercise-2.ipynb"]


def test_name_that_a_spreadsheet_would_evaluate_is_escaped(sort: Sort, tmp_path: Path) -> None:
    sort({f"=cmd|A1_12345_assignsubmission_file_/{NAME}": notebook()})
    assert ",'=cmd|A1," in (tmp_path / "out/received.csv").read_text()


@pytest.mark.parametrize("name", ["..", ". Ada", ".NET Ada"])
def test_moodle_folder_of_a_name_that_begins_with_a_dot_is_collected(
    name: str, sort: Sort, tmp_path: Path
) -> None:
    sort({f"{name}_12345_assignsubmission_file_/{NAME}": notebook()})
    assert collected_files(tmp_path / "out") == [f"participant12345/{NAME}", "received.csv"]


@pytest.mark.parametrize(
    "person",
    [
        "\u0639\u0644\u06cc\u200c\u0631\u0636\u0627 B",  # Persian, with a zero-width non-joiner
        "\u5c71\u7530\u3000\u592a\u90ce",  # Japanese, with an ideographic space
        "Ana\u00a0Maria Lopez",
        "\u200f\u05d3\u05d5\u05d3 K",  # Hebrew, with a direction mark
        "\u0d9a\u0dca\u200d\u0dbb P",  # Sinhala, with a joiner
        "\u0e2a" * 70,  # Thai, 3 bytes for each letter
    ],
)
@pytest.mark.parametrize(
    "path",
    [
        f"{{}}_8_assignsubmission_file_/{NAME}",
        f"8-64 - {{}} - Mar 8, 2026 1159 PM/{NAME}",
        f"Week 1/{{}}(u8)/Submission attachment(s)/{NAME}",
        "Ada_8_assignsubmission_file_/{}.ipynb",
    ],
)
def test_name_with_invisible_characters_of_its_language_is_collected(
    path: str, person: str, tmp_path: Path
) -> None:
    (tmp_path / "in.zip").write_bytes(zipped({path.format(person): notebook(exercise="week01_exercise")}))
    collection = collect(tmp_path / "in.zip", tmp_path / "out", AMMAN)
    assert (collection.count, collection.skipped) == (1, [])
    (found,) = find_submissions(tmp_path / "out")
    assert (found.exercise, found.problem) == ("week01_exercise", "")


@pytest.mark.parametrize(
    ("environment", "rejected"),
    [
        ({"PYTHONIOENCODING": "latin-1"}, 0),
        ({"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "PYTHONIOENCODING": "ascii"}, 1),
    ],
)
def test_names_without_characters_in_the_locale_do_not_stop_collecting(
    environment: dict[str, str], rejected: int, tmp_path: Path
) -> None:
    files = {
        f"\u5c71_8_assignsubmission_file_/\u5c71_{NAME}": notebook(exercise="week01_exercise"),
        "\u5c71_8_assignsubmission_file_/\u5c71.exe": b"",
        f"Ada_9_assignsubmission_file_/{NAME}": notebook(exercise="week01_exercise"),
    }
    (tmp_path / "in.zip").write_bytes(zipped(files))
    command = [sys.executable, "-m", "course_lib", "collect", "in.zip", "--out", "out"]
    env = os.environ | environment
    done = subprocess.run(
        command, cwd=tmp_path, env=env, capture_output=True, check=False, timeout=120, text=True
    )
    assert (done.returncode, done.stderr) == (1, "")
    assert done.stdout.count("_8_assignsubmission_file_/") == 1 + rejected
    assert done.stdout.count("names of files on this system lack its characters") == rejected
    assert (tmp_path / f"out/participant9/{NAME}").is_file()


def test_names_that_differ_in_vowel_signs_have_their_own_folders(sort: Sort, tmp_path: Path) -> None:
    names = ("\u0915\u092e\u0932", "\u0915\u093e\u092e\u093f\u0932")  # Kamal and Kamil
    sort({f"{name}/{NAME}": notebook(f"x = {len(name)}") for name in names})
    expected = ["received.csv", *(f"{name}/{NAME}" for name in names)]
    assert collected_files(tmp_path / "out") == expected


@pytest.mark.parametrize("below", ["", "/"])
def test_student_whose_name_has_a_directional_override_is_collected(
    sort: Sort, tmp_path: Path, below: str
) -> None:
    collection = sort({f"\u202eAda\u202c_8_assignsubmission_file_{below}{NAME}": notebook()})
    assert not collection.rejected_lines
    assert collected_files(tmp_path / "out") == [f"participant8/{NAME}", "received.csv"]


def test_control_characters_are_replaced_but_spaces_and_joiners_kept() -> None:
    name = "\u5c71\u3000\u592a \u0639\u200c\u0631"
    assert replace_controls(f"{name}\u202e\x1b[31m\u200f") == f"{name}\ufffd\ufffd[31m\ufffd"


@pytest.mark.parametrize("cell", ["4100001.0", "\u0664\u0661\u0660.0"])
def test_id_that_a_program_has_read_as_a_number_is_rejected(cell: str) -> None:
    with pytest.raises(CourseError, match="A program has read the ID as a number: read the column as text"):
        normalise(cell)


@pytest.mark.parametrize("cell", ["4,1E+06", "4.10e+06", "2E+7"])
def test_id_that_a_spreadsheet_has_shortened_is_reported_with_its_row(
    cell: str, sort: Sort, tmp_path: Path
) -> None:
    (tmp_path / "in.zip").write_bytes(zipped({f"Ada L_8_assignsubmission_file_/{NAME}": notebook()}))
    (tmp_path / "grades.csv").write_text(f"Identifier;ID number\nParticipant 9;9\nParticipant 8;{cell}\n")
    expected = rf"grades\.csv, row 3, column 'ID number': '{re.escape(cell)}' .*A spreadsheet has shortened"
    with pytest.raises(CourseError, match=expected):
        collect(tmp_path / "in.zip", tmp_path / "out", AMMAN, tmp_path / "grades.csv", "ID number")
    assert not (tmp_path / "out").exists()


def test_platform_csv_maps_numbers_to_student_ids(sort: Sort, tmp_path: Path) -> None:
    (tmp_path / "in.zip").write_bytes(zipped({f"Ada L_12345_assignsubmission_file_/{NAME}": notebook()}))
    (tmp_path / "grades.csv").write_text("Identifier,ID number\nParticipant 12345,A 7\nParticipant 8,b\n")
    collection = collect(tmp_path / "in.zip", tmp_path / "out", AMMAN, tmp_path / "grades.csv", "ID number")
    assert collected_files(tmp_path / "out") == [f"a7/{NAME}", "received.csv"]
    note = "note: student IDs are from the column 'ID number' of grades.csv, which has no times of submission"
    assert note in collection.notes


def test_student_missing_in_the_platform_csv_is_reported(sort: Sort, tmp_path: Path) -> None:
    files: Bytes = {
        f"{name}_assignsubmission_file_/{NAME}": notebook(name) for name in ("Ada L_12345", "Bob_8")
    }
    (tmp_path / "in.zip").write_bytes(zipped(files))
    (tmp_path / "grades.csv").write_text("Identifier,ID number\nParticipant 8,b\n")
    collection = collect(tmp_path / "in.zip", tmp_path / "out", AMMAN, tmp_path / "grades.csv", "ID number")
    assert "note: Ada L is not in the roster, and gets the ID participant12345" in collection.notes


@pytest.mark.parametrize("rows", ["Participant 8,b\nParticipant 9,B", "Participant 8,b\nParticipant 8,c"])
def test_platform_csv_with_duplicate_ids_is_rejected(sort: Sort, tmp_path: Path, rows: str) -> None:
    (tmp_path / "in.zip").write_bytes(zipped({f"Ada L_8_assignsubmission_file_/{NAME}": notebook()}))
    (tmp_path / "grades.csv").write_text(f"Identifier,ID number\n{rows}\n")
    with pytest.raises(
        CourseError, match=r"twice in .*correct one of the rows, or select the ID column with --id-column"
    ):
        collect(tmp_path / "in.zip", tmp_path / "out", AMMAN, tmp_path / "grades.csv", "ID number")
    assert not (tmp_path / "out").exists()


def test_attempts_in_nbgrader_inbound_keep_their_times_and_the_newest_counts(tmp_path: Path) -> None:
    for hour, code in (("08", "x = 1"), ("17", "x = 2"), ("12", "x = 3")):
        time = f"2026-03-09 {hour}:30:00.123456 UTC"
        folder = tmp_path / f"in/inbound/Ada1+week01+{time}+c2VjcmV0"
        folder.mkdir(parents=True)
        (folder / NAME).write_bytes(notebook(code))
        (folder / "timestamp.txt").write_text(time)
    (tmp_path / "in/inbound/+week01+2026-03-09 17:30:00 UTC").mkdir()
    (tmp_path / f"in/inbound/+week01+2026-03-09 17:30:00 UTC/{NAME}").write_bytes(notebook())
    collection = collect(tmp_path / "in", tmp_path / "out", AMMAN)
    assert (collection.students, len(collection.rejected_lines)) == ({"ada1"}, 1)
    (one,) = find_submissions(tmp_path / "out")
    assert (one.student, one.notebook and one.notebook.cells) == ("ada1", ("x = 2",))
    assert one.received.time is not None
    assert one.received.time.hour == 17


def test_nbgrader_folders_keep_their_timestamps(tmp_path: Path) -> None:
    folder = tmp_path / "in/submitted/ada/week01"
    folder.mkdir(parents=True)
    (folder / NAME).write_bytes(notebook())
    (folder / "timestamp.txt").write_text("2026-10-11 10:00:00 UTC")
    collection = collect(tmp_path / "in", tmp_path / "out", AMMAN)
    (submission,) = find_submissions(tmp_path / "out")
    assert (submission.student, submission.received.source, collection.count) == ("ada", "timestamp.txt", 1)


def test_repeated_collect_changes_nothing_and_a_new_version_is_added(sort: Sort, tmp_path: Path) -> None:
    for code in ("x = 1", "x = 1", "x = 2"):
        sort({f"ada/{NAME}": notebook(code)})
    assert collected_files(tmp_path / "out") == ["ada/week01_exercise-2.ipynb", f"ada/{NAME}", "received.csv"]


def test_nested_archives_belong_to_the_student_of_the_outer_archive(sort: Sort, tmp_path: Path) -> None:
    forged = zipped(
        {f"Bob_99_assignsubmission_file_/{NAME}": notebook(), "timestamp.txt": b"2020-01-01 0:00 UTC"}
    )
    collection = sort(
        {
            "ada/homework.zip": zipped({"again.zip": forged}),
            f"Bob_99_assignsubmission_file_/{NAME}": notebook("b"),
        }
    )
    mine = f"ada/Bob_99_assignsubmission_file_/{NAME}"
    assert collected_files(tmp_path / "out") == [mine, f"participant99/{NAME}", "received.csv"]
    assert "timestamp.txt: unsupported file type; expected one of" in collection.rejected_lines[0]


def special(name: str, mode: int) -> zipfile.ZipInfo:
    info = zipfile.ZipInfo(name)
    info.create_system, info.external_attr = 3, mode << 16
    return info


def many(count: int) -> bytes:
    return zipped({f"{number}.py": b"" for number in range(count)})


HOSTILE: dict[str, tuple[Bytes, str]] = {
    "slip": ({f"ada/../../{NAME}": b""}, "its path leads out of the folder"),
    "absolute": ({f"/etc/{NAME}": b""}, "its path leads out of the folder"),
    "drive": ({f"C:/{NAME}": b""}, "its path leads out of the folder"),
    "backslash": ({f"ada\\..\\{NAME}": b""}, "its path leads out of the folder"),
    "control": ({f"ada/\x1b[31m{NAME}": b""}, "the invisible character U+001B. Rename the file"),
    "right to left": ({f"ada/\u202e{NAME}": b""}, "the invisible character U+202E. Rename the file"),
    "long": ({f"ada/{'w' * 300}.ipynb": b""}, "its name is longer than"),
    "link": ({special(f"ada/{NAME}", stat.S_IFLNK | 0o777): b"/etc/passwd"}, "it is a link or a device"),
    "device": ({special(f"ada/{NAME}", stat.S_IFCHR | 0o777): b""}, "it is a link or a device"),
    "bomb": ({f"ada/{NAME}": b" " * 50_000_000}, "it has more than 20,000,000 bytes"),
    "many": ({"ada/a.zip": many(1001)}, "1001 files"),
    "deep": ({"ada/a.zip": zipped({"b.zip": zipped({"c.zip": zipped({"d.zip": many(1)})})})}, "too deep"),
    "broken zip": ({"ada/a.zip": b"PK\x03\x04 broken"}, "is not a readable zip file"),
    "kind": ({"ada/virus.exe": b""}, "unsupported file type; expected one of .ipynb"),
    "folder": ({f"../{NAME}": b""}, "its path leads out of the folder"),
    "odd folder": ({f"a b;rm/{NAME}": b""}, "is not a student ID"),
}


@pytest.mark.sample(1)
@pytest.mark.parametrize("kind", HOSTILE)
def test_unsafe_files_are_rejected_and_the_rest_is_collected(sort: Sort, tmp_path: Path, kind: str) -> None:
    files, why = HOSTILE[kind]
    collection = sort({**files, f"zoe/{NAME}": notebook()})
    assert why in collection.rejected_lines[0]
    assert len(collection.rejected_lines) == 1
    assert all(line.isprintable() for line in collection.rejected_lines)
    assert collected_files(tmp_path) == ["in.zip", "out/received.csv", f"out/zoe/{NAME}"]


@pytest.mark.parametrize(
    ("files", "why"),
    [
        ({}, "it contains no files"),
        ({"work/": b""}, "it contains no files"),
        (
            {f".ipynb_checkpoints/{NAME}": notebook("a = 1")},
            f"it contains no files except .ipynb_checkpoints/{NAME}, which a program has added",
        ),
    ],
)
def test_student_with_an_archive_without_files_is_rejected(
    sort: Sort, tmp_path: Path, files: Mapping[str, bytes], why: str
) -> None:
    collection = sort({f"ada/{NAME}": notebook("a = 1"), "bob/work.zip": zipped(files)})
    assert collection.rejected_lines == [f"rejected: bob/work.zip: {why}"]
    assert collection.rejected_students == {"bob"}
    assert why in collection.rows["bob/work.zip"]["rejected"]


def test_first_of_two_archive_members_with_one_name_counts(sort: Sort, tmp_path: Path) -> None:
    second = BytesIO(zipped({f"ada/{NAME}": notebook("first")}))
    with pytest.warns(UserWarning, match="Duplicate"), zipfile.ZipFile(second, "a") as archive:
        archive.writestr(f"ada/{NAME}", notebook("second"))
    (tmp_path / "in.zip").write_bytes(second.getvalue())
    collection = collect(tmp_path / "in.zip", tmp_path / "out", AMMAN)
    assert "twice" in collection.rejected_lines[0]
    assert b"first" in (tmp_path / "out/ada" / NAME).read_bytes()


def test_name_with_a_null_byte_and_locked_file_are_rejected(sort: Sort, tmp_path: Path) -> None:
    data = bytearray(
        zipped({"ada/a.ipynb": notebook(), f"bob/{NAME}": notebook(), f"zoe/{NAME}": notebook()})
    )
    data = data.replace(b"ada/a.ipynb", b"ada/a\0ipynb")
    for header, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        second = data.index(header, data.index(header) + 1)
        struct.pack_into("<H", data, second + flags, 1)
    (tmp_path / "in.zip").write_bytes(data)
    collection = collect(tmp_path / "in.zip", tmp_path / "out", AMMAN)
    assert len(collection.rejected_lines) == 2
    assert "it is encrypted. Submit it without a password" in collection.rejected_lines[1]
    assert collected_files(tmp_path / "out") == ["received.csv", f"zoe/{NAME}"]


def test_grading_reports_a_collection_that_did_not_finish(
    sort: Sort, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as full:
        full.setattr("course_lib.grading.submissions.collect.write_list", fail)
        with pytest.raises(OSError, match="No space left"):
            sort({f"zoe/{NAME}": notebook()})
    (line,) = unfinished_lines(tmp_path / "out")
    assert "course collect in.zip" in line
    sort({f"zoe/{NAME}": notebook()})
    assert unfinished_lines(tmp_path / "out") == []


def test_nested_archive_exceeding_the_size_limit_is_not_unpacked_further(
    sort: Sort, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archives, "MAX_UNPACKED_BYTES", 1000)
    collection = sort(
        {"ada/a.zip": zipped({f"{n}.py": b"#" * 250 for n in range(9)}), f"zoe/{NAME}": notebook()}
    )
    assert "more than 1,000 bytes" in collection.rejected_lines[0]
    assert len(collection.rejected_lines) == 1
    assert "ada/4.py" not in collected_files(tmp_path / "out")
    assert f"zoe/{NAME}" in collected_files(tmp_path / "out")


def test_folders_without_files_are_listed(tmp_path: Path) -> None:
    for folder in ("ada", "bob/.ipynb_checkpoints", "cleo/work", "eve"):
        (tmp_path / "in" / folder).mkdir(parents=True)
    (tmp_path / "in/ada" / NAME).write_bytes(notebook())
    (tmp_path / "in/bob/.ipynb_checkpoints" / NAME).write_bytes(notebook())
    (tmp_path / "in/eve" / NAME).symlink_to("../ada")
    collection = collect(tmp_path / "in", tmp_path / "out", AMMAN)
    assert "note: folders without files: bob, cleo" in collection.notes


def test_symlinks_and_pipes_in_a_folder_are_rejected(tmp_path: Path) -> None:
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / NAME).write_bytes(notebook())
    (tmp_path / "in/zoe").mkdir(parents=True)
    (tmp_path / "in/zoe" / NAME).write_bytes(notebook())
    (tmp_path / "in/bob").symlink_to(tmp_path / "secret")
    (tmp_path / "in/zoe/week02_exercise.ipynb").symlink_to(tmp_path / "secret" / NAME)
    os.mkfifo(tmp_path / "in/zoe/week03_exercise.ipynb")
    collection = collect(tmp_path / "in", tmp_path / "out", AMMAN)
    assert len(collection.rejected_lines) == 3
    assert collected_files(tmp_path / "out") == ["received.csv", f"zoe/{NAME}"]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        ("none", "it is not a readable zip file: there is no such file"),
        ("text", "it is not a readable zip file: "),
        ("empty", "contains no files"),
        ("inside", "is inside"),
    ],
)
def test_invalid_source_or_destination_is_an_error(tmp_path: Path, make: str, message: str) -> None:
    source, out = tmp_path / "in", tmp_path / "out"
    if make == "text":
        source.write_text("hello")
    elif make in ("empty", "inside"):
        source.mkdir()
    with pytest.raises(CourseError, match=message):
        collect(source, source / "out" if make == "inside" else out, AMMAN)


@pytest.mark.parametrize("kind", ["UTF-8 that is not declared", "backslashes"])
def test_file_names_in_a_student_archive_are_decoded(tmp_path: Path, kind: str) -> None:
    inner: Bytes = {"sub/week01_exercise.ipynb": notebook(), "sub/Größe.yaml": b"a: 1"}
    data = zipped(inner)
    if kind == "backslashes":
        data = data.replace(b"sub/", b"sub\\")
    else:
        undeclared = zipped({str(name).replace("öß", "####"): one for name, one in inner.items()})
        data = undeclared.replace(b"####", "öß".encode())
    (tmp_path / "in/ada").mkdir(parents=True)
    (tmp_path / "in/ada/work.zip").write_bytes(data)
    collection = collect(tmp_path / "in", tmp_path / "out", AMMAN)
    names = sorted(path.name for path in (tmp_path / "out/ada/sub").iterdir())
    assert (names, collection.rejected_lines) == (["Größe.yaml", "week01_exercise.ipynb"], [])


@pytest.mark.parametrize(
    "name", ["..\\..\\bob\\week01_exercise.ipynb", "C:\\week01_exercise.ipynb", "\\x.ipynb"]
)
def test_backslashes_in_a_student_archive_do_not_lead_elsewhere(tmp_path: Path, name: str) -> None:
    (tmp_path / "in/ada").mkdir(parents=True)
    (tmp_path / "in/ada/work.zip").write_bytes(zipped({name: notebook()}))
    collection = collect(tmp_path / "in", tmp_path / "out", AMMAN)
    assert (collection.count, [line.split(": ")[-1] for line in collection.rejected_lines]) == (
        0,
        ["its path leads out of the folder"],
    )


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", "a pointer of Git LFS"),
        (b'{"cells": [\n<<<<<<< HEAD\n]}', "markers of a merge conflict"),
        (b'<<<<<<< HEAD\n{"cells": []}\n>>>>>>> main\n', "markers of a merge conflict"),
        (b"Rar!\x1a\x07", "a RAR archive"),
        (b"7z\xbc\xaf\x27\x1c", "a 7z archive"),
    ],
)
def test_rejection_states_the_type_of_a_file_that_is_not_a_notebook(data: bytes, reason: str) -> None:
    with pytest.raises(CourseError, match=reason) as raised:
        parse_notebook(data, "week01_exercise.ipynb")
    advice = "git checkout --ours week01_exercise.ipynb" if b"<<<<<<<" in data else "Save it again"
    assert advice in str(raised.value)


@pytest.mark.parametrize(
    ("name", "code", "exercise"),
    [
        ("Copy of week01_exercise.ipynb", 'check("week01.red_cube", Node)', "week01_exercise"),
        (
            "mueller_Week01_Exercise (1).ipynb",
            "x = 1\ncheck(\n    'week01.red_cube', Node)",
            "week01_exercise",
        ),
        ("notes on week01_exercise.ipynb", "x = 1", None),
        ("notes on week01_exercise.ipynb", 'check("week02.joint_wave", Node)', None),
        ("Untitled.ipynb", 'check("week01.red_cube", Node)', None),
        ("myweek01_exercise.ipynb", 'check("week01.red_cube", Node)', None),
    ],
)
def test_exercise_without_metadata_is_identified_by_its_name_and_checks(
    name: str, code: str, exercise: str | None
) -> None:
    assert parse_notebook(notebook(code), name).exercise == exercise
