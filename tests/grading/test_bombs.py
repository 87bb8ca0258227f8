"""Archives that unpack to more than they seem to hold."""

import struct
import tracemalloc
import zipfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import pytest

from course_lib.errors import CourseError
from course_lib.grading.submissions import archives
from course_lib.grading.submissions.archives import MAX_UNPACKED_BYTES, MAX_UNPACKED_FILES
from course_lib.grading.submissions.collect import Collection, collect
from course_lib.grading.submissions.copies import select_code
from course_lib.grading.submissions.notebook import MAX_BRACKETS, parse_notebook, without_outputs
from course_lib.grading.submissions.submission import UTC, find_submissions
from course_lib.grading.task import time_limit
from tests.grading.platforms import NAME, notebook, zipped

MEGABYTE = 1_000_000


def zips_in_a_zip(zips: int = 6, files: int = 10, size: int = 19 * MEGABYTE) -> bytes:
    inner = zipped({f"{n}.py": b"\0" * size for n in range(files)})
    return zipped({f"{n}.zip": inner for n in range(zips)})


def lying_size(size: int) -> bytes:
    """A file that claims another size than it has, in both of an archive's directories."""
    data = bytearray(zipped({"a.py": b"\0" * 30 * MEGABYTE}))
    struct.pack_into("<I", data, data.index(b"PK\x03\x04") + 22, size)
    struct.pack_into("<I", data, data.index(b"PK\x01\x02") + 24, size)
    return bytes(data)


def overlapping(count: int) -> bytes:
    """Many entries of the directory that lead to the same data."""
    data = zipped({"a.py": b"\0" * 15 * MEGABYTE})
    place, end = data.index(b"PK\x01\x02"), data.index(b"PK\x05\x06")
    entry = data[place:end]
    body = data[:place] + b"".join(entry.replace(b"a.py", f"{n:03}y".encode()) for n in range(count))
    return body + struct.pack("<4sHHHHIIH", b"PK\x05\x06", 0, 0, count, count, len(body) - place, place, 0)


def compressed_by(method: int) -> bytes:
    data = BytesIO()
    with zipfile.ZipFile(data, "w", method) as archive:
        archive.writestr("a.py", b"\0" * 60 * MEGABYTE)
    return data.getvalue()


BOMBS: dict[str, Callable[[], bytes]] = {
    "zips in a zip": zips_in_a_zip,
    "many files": lambda: zipped({f"{n}.zip": zipped({f"{m}.py": b"" for m in range(90)}) for n in range(5)}),
    "a long directory": lambda: zipped({f"{n}.py": b"" for n in range(25_000)}),
    "a size too small": lambda: lying_size(10),
    "a size too large": lambda: lying_size(2**31),
    "overlapping entries": lambda: overlapping(300),
    "bzip2": lambda: compressed_by(zipfile.ZIP_BZIP2),
    "LZMA": lambda: compressed_by(zipfile.ZIP_LZMA),
}


def total(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


PLACES = ("ada/bomb.zip", "Ada_7_assignsubmission_file_/bomb.zip", "ada_7_70_bomb.zip")
CASES = [(PLACES[0], kind) for kind in BOMBS] + [(place, "zips in a zip") for place in PLACES[1:]]


@pytest.mark.sample(1)
@pytest.mark.parametrize(("place", "kind"), CASES)
def test_zip_bomb_is_limited_and_affects_only_its_student(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str, kind: str
) -> None:
    monkeypatch.setattr(archives, "MAX_UNPACKED_BYTES", 40 * MEGABYTE)
    monkeypatch.setattr(archives, "MAX_UNPACKED_FILES", 100)
    (tmp_path / "in.zip").write_bytes(zipped({place: BOMBS[kind](), f"zoe/{NAME}": notebook()}))
    collection = collect(tmp_path / "in.zip", tmp_path / "out", UTC)
    assert collection.rejected_lines
    assert total(tmp_path / "out") < 45 * MEGABYTE
    assert sum(1 for path in (tmp_path / "out").rglob("*") if path.is_file()) <= 103
    assert [one.student for one in find_submissions(tmp_path / "out")] == ["zoe"]


def test_zip_bomb_in_one_of_several_inner_folders_does_not_hide_the_layout(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folders may be students, so the limit must not apply to all of them together."""
    monkeypatch.setattr(archives, "MAX_UNPACKED_BYTES", MEGABYTE)
    files = {"class/ada/bomb.zip": zips_in_a_zip(1, 3, MEGABYTE)}
    files |= {f"class/{name}/{NAME}": notebook(name, student=name) for name in ("bob", "zoe")}
    (tmp_path / "in.zip").write_bytes(zipped(files))
    with pytest.raises(
        CourseError, match="class holds 2 files of week01_exercise with different student IDs"
    ):
        collect(tmp_path / "in.zip", tmp_path / "out", UTC)
    assert not (tmp_path / "out").exists()


def test_many_rejected_files_of_one_student_are_summed_up_in_a_line(tmp_path: Path) -> None:
    inner = zipped({f"{n}.exe": b"" for n in range(900)})
    (tmp_path / "in.zip").write_bytes(zipped({"ada/files.zip": inner, "zoe/a.exe": b"1"}))
    collection = collect(tmp_path / "in.zip", tmp_path / "out", UTC)
    assert len(collection.rejected_lines) == 12
    assert collection.rejected_lines[10] == "rejected: 890 more files of ada"
    assert ", 901 files rejected" in collection.summary(tmp_path / "out")


def test_archive_entries_of_one_file_are_rejected_once(tmp_path: Path) -> None:
    """A small archive can have a thousand entries for one large file."""
    data = zipped({NAME: notebook()})
    start, end = data.index(b"PK\1\2"), data.index(b"PK\5\6")
    entries = data[start:end] * 900
    tail = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 900, 900, len(entries), start, 0)
    (tmp_path / "in.zip").write_bytes(zipped({"ada/files.zip": data[:start] + entries + tail}))
    collection = collect(tmp_path / "in.zip", tmp_path / "out", UTC)
    assert [line.split(": ")[-1] for line in collection.rejected_lines] == [
        "the archive contains this name twice"
    ]


@pytest.mark.parametrize("name", ["", "\0", "\0/x", "a//"])
def test_archive_member_with_an_unusual_name_does_not_affect_other_members(tmp_path: Path, name: str) -> None:
    inner = zipped({name: b"1", NAME: notebook()})
    (tmp_path / "in.zip").write_bytes(zipped({"ada/files.zip": inner, f"zoe/{NAME}": notebook(), name: b"1"}))
    collect(tmp_path / "in.zip", tmp_path / "out", UTC)
    assert [one.student for one in find_submissions(tmp_path / "out")] == ["ada", "zoe"]


def test_zip_with_undecodable_names_is_rejected(tmp_path: Path) -> None:
    data = zipped({"ada/ü.ipynb": notebook()}).replace("ü".encode(), b"\xd9\xff")
    (tmp_path / "in.zip").write_bytes(data)
    with pytest.raises(CourseError, match="damaged or incomplete \\('utf-8' codec can't decode"):
        collect(tmp_path / "in.zip", tmp_path / "out", UTC)


def test_unpack_limit_applies_to_all_archives_of_a_student_together(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archives, "MAX_UNPACKED_BYTES", 10 * MEGABYTE)
    bombs = {f"Ada_7_assignsubmission_file_/{n}.zip": zips_in_a_zip(1, 3, MEGABYTE) for n in range(9)}
    (tmp_path / "in.zip").write_bytes(zipped(bombs))
    collection = collect(tmp_path / "in.zip", tmp_path / "out", UTC)
    assert total(tmp_path / "out") < 11 * MEGABYTE
    (line,) = collection.rejected_lines
    assert "all archives of Ada (7) together unpack to more than 10,000,000 bytes" in line


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_submission_package_with_an_unsupported_compression_method_is_rejected(
    tmp_path: Path, method: int
) -> None:
    with zipfile.ZipFile(tmp_path / "a.zip", "w", method) as archive:
        archive.writestr("receipt.json", '{"exercise": "week01_exercise"}')
        archive.writestr(NAME, notebook())
    (submission,) = find_submissions(tmp_path)
    assert f"compression method {method}, expected stored or deflated" in submission.problem


def test_paths_that_cannot_be_created_are_rejected_individually(tmp_path: Path) -> None:
    inner = zipped(
        {"x.py": b"1", "x.py/y.py": b"2", "/".join(["d" * 150] * 9) + "/z.py": b"3", "ok.py": b"4"}
    )
    (tmp_path / "in.zip").write_bytes(zipped({"ada/a.zip": inner, f"zoe/{NAME}": notebook()}))
    collection = collect(tmp_path / "in.zip", tmp_path / "out", UTC)
    assert len(collection.rejected_lines) == 2
    assert (tmp_path / "out/ada/ok.py").is_file()


def test_unpack_limits_exceed_the_size_of_normal_submissions() -> None:
    assert MAX_UNPACKED_BYTES >= 50 * MEGABYTE
    assert min(MAX_UNPACKED_FILES, archives.MAX_MEMBERS) >= 1000


def test_zip_bomb_is_rejected_with_one_line_messages(tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in/bomb.zip").write_bytes(zips_in_a_zip(6, 2))
    collection: Collection = collect(tmp_path / "in", tmp_path / "out", UTC)
    assert all("\n" not in line for line in collection.rejected_lines)
    assert total(tmp_path / "out") <= MAX_UNPACKED_BYTES


@pytest.mark.parametrize(
    ("data", "is_closed"),
    [
        (b'{"outputs": [{"text": "' + rb"\n" * MEGABYTE + b'"}]}', True),
        (b'"' + rb"\"" * MEGABYTE, False),
        (b'"' + b"\\" * (2 * MEGABYTE + 1), False),
    ],
    ids=["escapes", "escaped quotes without an end", "an escape without an end"],
)
def test_outputs_are_removed_in_bounded_time_and_memory(data: bytes, is_closed: bool) -> None:
    tracemalloc.start()
    try:
        with time_limit(20):
            kept = without_outputs(data)
        assert tracemalloc.get_traced_memory()[1] < 4 * len(data)
    finally:
        tracemalloc.stop()
    assert kept == (b'{"outputs": []}' if is_closed else data)


def test_notebook_of_millions_of_json_objects_is_rejected_except_in_outputs() -> None:
    objects = b"{}," * MAX_BRACKETS + b"{}]"
    with pytest.raises(CourseError, match="1,000,003 opening brackets, expected at most 1,000,000"):
        parse_notebook(b'{"cells": [' + objects + b"}", NAME)
    cell = b'{"cell_type": "code", "source": "x", "outputs": [' + objects + b"}"
    assert parse_notebook(b'{"cells": [' + cell + b"]}", NAME).cells == ("x",)


def test_code_of_a_million_empty_lines_is_compared_in_bounded_time() -> None:
    with time_limit(20):
        compared = select_code(["\n" * MEGABYTE + " \t%run a.py", "\n" * MEGABYTE], ["RedCube"], ())
    assert compared.remarks[1:] == ("uses a magic that runs code",)
