"""Broken and unusual files from honest students and from attackers."""

import io
import json
import zipfile
from dataclasses import dataclass
from typing import Any

from tests.grading.conftest import RIGHT
from tests.hostile.entry import FULL

RIGHT_CELLS = RIGHT.split("# next cell\n")


@dataclass(frozen=True)
class Sent:
    """One file.

    Args:
        student: In whose folder it lies.
        data: What it holds.
        file: Its name.
        final: The mark it must get; None if it is rejected.
        says: What the gradebook's message, or the errors of cells, must hold.
    """

    student: str
    data: bytes
    file: str = "week01_exercise.ipynb"
    final: float | None = None
    says: str = ""


def book(cells: Any = None, **more: Any) -> bytes:
    """A notebook; by default the right one."""
    if cells is None:
        cells = [{"cell_type": "code", "source": cell} for cell in RIGHT_CELLS]
    return json.dumps({"nbformat": 4, "metadata": {}, "cells": cells, **more}).encode()


def packed(**members: bytes) -> bytes:
    """A zip file; two underscores stand for a dot."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(name.replace("__", "."), data)
    return buffer.getvalue()


def linked() -> bytes:
    """A zip file whose notebook is a symbolic link."""
    member = zipfile.ZipInfo("week01_exercise.ipynb")
    member.external_attr = 0o120777 << 16
    buffer = io.BytesIO(packed(receipt__json=RECEIPT))
    with zipfile.ZipFile(buffer, "a") as archive:
        archive.writestr(member, "/etc/passwd")
    return buffer.getvalue()


def understated() -> bytes:
    """A zip file whose directory states that 30 MB are 1 kB."""
    data = bytearray(packed(receipt__json=RECEIPT, week01_exercise__ipynb=book() + b" " * 30_000_000))
    entry = data.rfind(b"PK\x01\x02")
    data[entry + 24 : entry + 28] = (1000).to_bytes(4, "little")
    return bytes(data)


AS_LINES = [{"cell_type": "code", "source": cell.splitlines(keepends=True)} for cell in RIGHT_CELLS]
FORMAT_3 = [{"cell_type": "code", "language": "python", "input": cell} for cell in RIGHT_CELLS]
OUTPUTS = [{"output_type": "stream", "text": "x" * 5_000_000}]
ODD = [None, 1, {"cell_type": "code"}, {"cell_type": 7, "source": {}}, {"source": [1, None]}]
RECEIPT = json.dumps({"exercise": "week01_exercise", "student": "x"}).encode()
FILES = (
    Sent("f_empty", b"", says="it is empty"),
    Sent("f_cut", book()[:300], says="it is not JSON"),
    Sent("f_login_page", b"<!DOCTYPE html><html>Log in", says="it looks like a web page"),
    Sent("f_pdf", b"%PDF-1.7\n%\xe2\xe3", says="it is a PDF"),
    Sent("f_zip_as_notebook", packed(a=b"x"), says="it is a zip archive"),
    Sent("f_bytes", b"\xff\xfe\xfd\x00\x80" * 20, says="is not a notebook"),
    Sent("f_deep", b"[" * 100_000, says="it is not JSON"),
    Sent("f_long_number", b'{"cells": ' + b"1" * 5000 + b"}", says="is not a notebook"),
    Sent("f_list", b"[]", says="no list of cells"),
    Sent("f_odd_cells", book(ODD), says="no list of cells"),
    Sent("f_large", book(outputs="x" * 20_000_000), says="Clear its outputs"),
    Sent("f_utf16", book().decode().encode("utf-16"), final=FULL),
    Sent("f_byte_order_mark", b"\xef\xbb\xbf" + book(), final=FULL),
    Sent("f_lines", book(AS_LINES), final=FULL),
    Sent("f_format_3", book(worksheets=[{"cells": FORMAT_3}], cells=FORMAT_3, nbformat=3), final=FULL),
    Sent("f_format_5", book(nbformat=5, nbformat_minor=99), final=FULL),
    Sent("f_outputs", book([*AS_LINES, {**AS_LINES[0], "outputs": OUTPUTS}]), final=FULL),
    Sent("f_format_2", book(nbformat=2), final=FULL),
    Sent("f_format_text", book(nbformat="four"), final=FULL),
    Sent("f_equal_cell_ids", book([{**cell, "id": "same"} for cell in AS_LINES]), final=FULL),
    Sent("f_odd_cell_ids", book([{**cell, "id": {"<b>": "../.."}} for cell in AS_LINES]), final=FULL),
    Sent("f_cells_twice", book().replace(b'"cells":', b'"cells": [], "cells":'), final=FULL),
    Sent("f_nul_in_code", book([*AS_LINES, {"cell_type": "code", "source": "x = 'a\0b'"}]), final=FULL),
    Sent("f_nested_code", book([*AS_LINES, {"cell_type": "code", "source": "-" * 200_000}]), final=FULL),
    Sent("f_no_code", book([{"cell_type": "markdown", "source": RIGHT}]), says="has no code"),
    Sent("f_no_cells", book([]), says="has no code"),
    Sent("f_odd_metadata", book(metadata=[{"course": 1}]), final=FULL),
    Sent("f_huge_id", book(metadata={"course": {"student": "x" * 100_000}}), final=FULL),
    Sent("f_renamed", book(), file="week01_exercise (1) Kopie.ipynb", final=FULL),
    Sent("f_long_name", book(), file=f"week01_exercise_{'x' * 230}.ipynb", final=FULL),
    Sent("f_other_week", book(), file="week77_exercise.ipynb", says="the course has no week77_exercise"),
    Sent("f_any_name", book(), file="homework.ipynb", says="is not an exercise of this course"),
    Sent("f_bomb", packed(receipt__json=RECEIPT, week01_exercise__ipynb=b" " * 30_000_000), "week01.zip",
         says="is larger than"),
    Sent("f_receipt_bomb", packed(receipt__json=b" " * 30_000_000), "week01.zip", says="is larger than"),
    Sent("f_link", linked(), "week01.zip", says="is not a notebook"),
    Sent("f_understated", understated(), "week01.zip", says="can't be unpacked"),
    Sent("f_any_zip", packed(a=packed(b=b"x")), "week01.zip", says="is not a file that"),
    Sent("f_path_in_receipt", packed(receipt__json=b'{"exercise": "../../secret"}'), "week01.zip",
         says="is not a file that `course submit` wrote"),
    Sent("f_odd_receipt", packed(receipt__json=b'["exercise"]'), "week01.zip", says="is not a file that"),
)  # fmt: skip
