"""gradebook.csv, derived from the results."""

import csv
import io
from pathlib import Path
from typing import Any

from course_lib.course.whole_file import write_whole
from course_lib.grading.result import COLUMNS, read_result

FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n")


def write_gradebook(out: Path) -> Path:
    """Write OUT/gradebook.csv from all that OUT/results holds, by student and exercise."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for path in sorted((out / "results").glob("*/*.json")):
        writer.writerow(map(harmless, read_result(path)["row"].values()))
    path = out / "gradebook.csv"
    write_whole(path, text.getvalue().encode())
    return path


def harmless(value: Any) -> Any:
    """A text that a spreadsheet would take for a formula gets an apostrophe in front."""
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA_STARTS) else value
