import codecs
import csv
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from course_lib.errors import CourseError
from course_lib.grading.submissions import lms
from course_lib.grading.submissions.lms import fill_lms
from course_lib.grading.submissions.roster import LmsFile

GRADEBOOK = """\
student,exercise,score,max_score,days_late,penalty,final,status,reason,message
ada1,week01_exercise,90.5,100,1,9.05,81.45,graded,,
bob2,week01_exercise,50.0,100,0,0.0,50.0,limit,time,
cleo3,week01_exercise,,,,,,grader_error,OSError,
ghost9,week01_exercise,10.0,100,0,0.0,10.0,graded,,
ada1,week02_exercise,1.0,100,0,0.0,1.0,graded,,
"""
CANVAS = '''\
Student,ID,SIS Login ID,Section,Week 1 (1234),Week 10 (1250),Final Score
,,,,Manual Posting,,
    Points Possible,,,,100.0,100.0,(read only)
"Lovelace, Ada",11,ADA1,"R ""2""",,=1+1,
"Bobson, Bob",12,bob2,S,7,,-
"Cleo, É.",13,cleo3,S,,,
"Dora, D",14,dora4,S,3,,@x
'''
MOODLE = """\
"Identifier";"Full name";"ID number";"Email address";"Status";"Grade";"Maximum Grade"
"Participant 7";"Ada Lovelace";"ada1";"a@x.org";"Submitted
for grading";"";"100,00"
"Participant 8";"Bob; Bobson";"bob2";"b@x.org";"-";"12,00";"100,00"
"Participant 9";"Nobody";"";"n@x.org";"-";"";"100,00"
"""


@pytest.fixture
def out(tmp_path: Path) -> Path:
    (tmp_path / "gradebook.csv").write_text(GRADEBOOK)
    return tmp_path


Fill = Callable[..., tuple[bytes, list[str]]]


@pytest.fixture
def fill(out: Path) -> Fill:
    """Fills a file of these bytes and returns the new ones, and the lines."""

    def do(data: bytes, column: str, id_column: str, **more: Any) -> tuple[bytes, list[str]]:
        (out / "lms.csv").write_bytes(data)
        source, target = out / "lms.csv", out / "filled.csv"
        lines = fill_lms(
            out, source, target, exercise="week01_exercise", column=column, id_column=id_column, **more
        )
        return target.read_bytes(), lines

    return do


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1", "utf-16-be-bom", "utf-16-le", "utf-16-be"]
)
@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
def test_canvas_csv_is_unchanged_except_for_the_marks(fill: Fill, encoding: str, newline: str) -> None:
    def bytes_of(text: str) -> bytes:
        text = text.replace("\n", newline)
        if encoding == "utf-16-be-bom":
            return codecs.BOM_UTF16_BE + text.encode("utf-16-be")
        return text.encode(encoding)

    filled, lines = fill(bytes_of(CANVAS), "Week 1", "SIS Login ID")
    expected = CANVAS.replace('"R ""2""",,', '"R ""2""",81.45,').replace("bob2,S,7", "bob2,S,50")
    assert filled == bytes_of(expected)
    assert lines == [
        "lms.csv: row 6, cleo3: grader_error, row unchanged",
        "lms.csv: row 7, dora4: no mark",
        "gradebook.csv: no such ID in lms.csv: ghost9",
        lines[-1],
    ]
    assert lines[-1].endswith(
        "filled.csv: 2 marks after the late policy; turn off the platform's late policy."
    )


def test_moodle_csv_keeps_its_quotes_and_students_without_an_id_are_reported(fill: Fill) -> None:
    filled, lines = fill(MOODLE.encode("utf-8-sig"), "Grade", "ID number")
    expected = MOODLE.replace('grading";""', 'grading";"81.45"').replace('"12,00"', '"50"')
    assert filled == expected.encode("utf-8-sig")
    assert "lms.csv: row 4, no ID: no mark" in lines


def test_raw_scores_are_exported_to_a_platform_with_its_own_late_policy(fill: Fill) -> None:
    filled, lines = fill(CANVAS.encode(), "Week 1", "SIS Login ID", raw=True)
    assert b'"R ""2""",90.5,' in filled
    assert "before the late policy" in lines[-1]


def test_mismatch_between_platform_and_exercise_points_is_reported(fill: Fill) -> None:
    _, lines = fill(CANVAS.replace("100.0,100.0", "20,20").encode(), "Week 1", "SIS Login ID")
    assert any("is 20 points on the platform and 100 in gradebook.csv" in line for line in lines)


def test_marks_above_the_maximum_of_the_platform_are_reported(fill: Fill) -> None:
    _, lines = fill(MOODLE.replace("100,00", "60,50").encode(), "Grade", "ID number")
    assert any("is 60.5 points on the platform and 100 in gradebook.csv" in line for line in lines)
    assert (
        "note: 1 mark above the platform's 60.5: it may reject them; --cap reduces them to the maximum"
        in lines
    )


GERMAN = MOODLE.replace("Maximum Grade", "Bestwertung").replace('"Grade"', '"Bewertung"')


@pytest.mark.parametrize(
    ("text", "column", "id_column"),
    [
        (MOODLE.replace("100,00", "60,50"), "Grade", "ID number"),
        (MOODLE.replace("100,00", "60,50").replace("Maximum Grade", "Maximum grade"), "Grade", "ID number"),
        (GERMAN.replace("100,00", "60,50"), "Bewertung", "ID number"),
        (CANVAS.replace("100.0,100.0", "60.5,20"), "Week 1", "SIS Login ID"),
    ],
)
def test_cap_option_limits_marks_to_the_platform_maximum(
    fill: Fill, text: str, column: str, id_column: str
) -> None:
    filled, lines = fill(text.encode(), column, id_column, cap=True)
    assert b"81.45" not in filled
    assert filled.count(b"60.5") == 1 + text.count("60.5")
    assert not any("may refuse" in line for line in lines)


def test_cap_option_uses_the_exercise_maximum_if_the_csv_has_none(fill: Fill, out: Path) -> None:
    book = (out / "gradebook.csv").read_text().replace("81.45", "110.0")
    (out / "gradebook.csv").write_text(book)
    filled, _ = fill(b"id,mark\nada1,\nbob2,\n", "mark", "id", cap=True)
    assert filled == b"id,mark\nada1,100\nbob2,50\n"


def test_id_in_two_rows_gets_no_mark_in_either(fill: Fill) -> None:
    filled, lines = fill(CANVAS.replace("dora4", "ADA 1").encode(), "Week 1", "SIS Login ID")
    assert b"81.45" not in filled
    assert sum("more than one row has this ID" in line for line in lines) == 2


@pytest.mark.parametrize(
    ("data", "column", "id_column", "message"),
    [
        (CANVAS, "Week 7", "SIS Login ID", "no columns are named 'Week 7'; expected one of 'Student', 'ID'"),
        (CANVAS, "Week 1", "Section", "no ID in column 'Section'"),
        (CANVAS, "ID", "ID", "the marks would replace the IDs"),
        ("", "a", "b", "is not a CSV"),
        ("P\0\0,", "a", "b", "is not a CSV"),
        ("PK\x03\x04\0\0,", "a", "b", "is an Excel workbook, expected CSV. Open it and save it as CSV"),
        ("a,a,b\n", "a", "b", "2 columns are named 'a'"),
    ],
)
def test_mismatched_platform_csv_is_rejected_and_nothing_is_written(
    fill: Fill, out: Path, data: str, column: str, id_column: str, message: str
) -> None:
    with pytest.raises(CourseError, match=message):
        fill(data.encode(), column, id_column)
    assert not (out / "filled.csv").exists()


@pytest.mark.parametrize(
    ("cell", "reason"),
    [
        (
            "7",
            "row 2, 7: no mark, but 0007 has one. A spreadsheet has changed this number: export",
        ),
        ("1.2E+05", "row 2, 1.2E+05: no mark: A spreadsheet has changed this number"),
        ("", "row 2, no ID: no mark"),
    ],
)
def test_id_that_a_spreadsheet_has_changed_is_reported_with_its_row(
    fill: Fill, out: Path, cell: str, reason: str
) -> None:
    (out / "gradebook.csv").write_text(GRADEBOOK.replace("bob2", "0007"))
    _, lines = fill(f"name,id,mark\nBob,{cell},\nAda,ada1,\n".encode(), "mark", "id")
    assert any(reason in line for line in lines)


@pytest.mark.parametrize(
    "cell",
    ["#0007", "'0007", '=""0007""', '="0007"', "\u200f0007\u200f", "\u200b0007", "\u0660\u0660\u0660\u0667"],
)
def test_id_with_signs_for_spreadsheets_is_identified(fill: Fill, out: Path, cell: str) -> None:
    (out / "gradebook.csv").write_text(GRADEBOOK.replace("bob2", "0007"))
    quoted = f'"{cell}"' if '""' in cell else cell
    filled, _ = fill(f"id,mark\n{quoted},\n".encode(), "mark", "id")
    assert filled == f"id,mark\n{quoted},50\n".encode()


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_gradebook_saved_by_a_spreadsheet_is_read(fill: Fill, out: Path, encoding: str) -> None:
    saved = GRADEBOOK.replace(",", ";").replace("81.45", "81,45").replace("\n", "\r\n")
    (out / "gradebook.csv").write_bytes(saved.encode(encoding))
    assert fill(b"id,mark\nada1,\n", "mark", "id")[0] == b"id,mark\nada1,81.45\n"


@pytest.mark.parametrize("number", ["", "nan", "inf", "abc", "1.2.3"])
def test_invalid_number_in_the_gradebook_is_reported_with_its_row(fill: Fill, out: Path, number: str) -> None:
    (out / "gradebook.csv").write_text(GRADEBOOK.replace("81.45", number))
    with pytest.raises(CourseError, match=f"gradebook.csv, row 2: final is '{number}', expected a number"):
        fill(b"id,mark\nada1,\n", "mark", "id")


def test_class_without_a_final_mark_is_reported_with_the_status(fill: Fill, out: Path) -> None:
    (out / "gradebook.csv").write_text(GRADEBOOK.replace(",graded,", ",needs_marking,"))
    with pytest.raises(CourseError, match=r"no mark was written into lms\.csv: row 2, ada1: needs_m"):
        fill(b"id,mark\nada1,\n", "mark", "id")


def test_comment_that_the_encoding_of_the_csv_lacks_is_reported_with_its_row(
    fill: Fill, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lms, "_comments", lambda *_: {"ada1": 'at most "5", \u2264'})
    book, columns = "id;mark;note\nada1;;\nM\u00fcller;;\n", ("mark", "id")
    with pytest.raises(
        CourseError, match=r"lms\.csv, row 2: its encoding latin-1 lacks the character '\u2264'"
    ):
        fill(book.encode("latin-1"), *columns, comment_column="note")
    assert not (out / "filled.csv").exists()
    filled, _ = fill(book.encode(), *columns, comment_column="note")
    assert '\nada1;81.45;"at most ""5"", \u2264"\n'.encode() in filled


ANY_TEXT = st.text(st.sampled_from('ab,;"\t\r\n |é=+-@ 7'), max_size=60).map(lambda text: "a,b" + text)


@pytest.mark.slow
@settings(max_examples=300)
@given(text=ANY_TEXT, encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "latin-1"]))
def test_csv_file_is_unchanged_after_reading_and_writing(
    tmp_path_factory: pytest.TempPathFactory, text: str, encoding: str
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.csv"
    path.write_bytes(text.encode(encoding))
    assert LmsFile.read(path).to_bytes() == text.encode(encoding)


CELLS = st.text(st.sampled_from('ab,;"\n é='), max_size=8)


@pytest.mark.slow
@settings(max_examples=200)
@given(
    rows=st.lists(st.tuples(CELLS, CELLS, CELLS), min_size=1, max_size=5),
    delimiter=st.sampled_from(",;\t"),
    quoting=st.sampled_from([csv.QUOTE_ALL, csv.QUOTE_MINIMAL]),
)
def test_cells_match_the_csv_module_and_only_the_edited_cell_changes(
    tmp_path_factory: pytest.TempPathFactory,
    rows: list[tuple[str, str, str]],
    delimiter: str,
    quoting: Literal[0, 1],
) -> None:
    text = io.StringIO(newline="")
    csv.writer(text, delimiter=delimiter, quoting=quoting).writerows([("who", "id", "mark"), *rows])
    path = tmp_path_factory.getbasetemp() / "cells.csv"
    path.write_text(text.getvalue(), encoding="utf-8", newline="")
    file = LmsFile.read(path)
    file.put(len(rows), 2, "42")
    expected = [["who", "id", "mark"], *map(list, rows)]
    expected[-1][2] = "42"
    text = io.StringIO(file.to_bytes().decode(), newline="")
    assert list(csv.reader(text, delimiter=delimiter)) == expected
    assert [file.text(row, 0) for row in range(1, len(rows) + 1)] == [row[0].strip() for row in rows]
