"""gradebook.csv, derived from the results and from what persons gave."""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from course_lib.course.state import write_whole
from course_lib.grading.result import COLUMNS, read_result

FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n")


def results_in(out: Path) -> Iterator[dict[str, Any]]:
    """All results, by student and exercise, one at a time: together they may be large."""
    return map(read_result, sorted((out / "results").glob("*/*.json")))


def write_gradebook(out: Path) -> Path:
    """Write OUT/gradebook.csv from all that OUT/results and OUT/marks hold."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for result in results_in(out):
        writer.writerow(map(harmless, result["row"].values()))
    path = out / "gradebook.csv"
    write_whole(path, text.getvalue().encode())
    return path


def harmless(value: Any) -> Any:
    """A text that a spreadsheet would take for a formula gets an apostrophe in front."""
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA_STARTS) else value
