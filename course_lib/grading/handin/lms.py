"""Marks into the CSV that a learning platform exported, Canvas, Moodle or another."""

import csv
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from course_lib.course.identity import normalise
from course_lib.course.state import write_whole
from course_lib.errors import CourseError, counted
from course_lib.grading.handin.platform_files import LmsFile
from course_lib.grading.reports.table import printable

TERM, TERM_TABLE = "term", "term.csv"  # instead of an exercise, and what `course term` writes
POINTS_POSSIBLE = "Points Possible"  # Canvas's row with the most that each column gives
MAXIMUM = "maximum grade"  # Moodle's column of it, in English
FINAL = ("graded", "limit")
NO_MARK = (
    "no ID in column {!r} of {} has a mark for {}; gradebook.csv has IDs like {}. Name another --id-column."
)
KINDS = {
    "score": "scores before the late policy",
    "final": "marks after the late policy; switch the platform's off",
}


def fill_lms(
    out: Path,
    lms: Path,
    target: Path,
    *,
    exercise: str,
    column: str,
    id_column: str,
    raw: bool = False,
    cap: bool = False,
) -> list[str]:
    """Fill one column with the marks of an exercise and write the file again, otherwise unchanged.

    Args:
        out: The folder with gradebook.csv.
        lms: The platform's export.
        target: The file to write.
        exercise: "week01_exercise", or "term" for the totals of the term.
        column: Its heading there.
        id_column: The heading of the students' IDs.
        raw: Use the score before the late policy.
        cap: Reduce a mark above the platform's maximum to that maximum.

    Returns:
        A line for each row or mark without a counterpart, and a summary.

    Raises:
        CourseError: A file can't be read, a column is not there, or no row fits.
    """
    file, marks, what = LmsFile.read(lms), _marks(out, exercise), "score" if raw else "final"
    place, id_place = _places(file, column, id_column)
    ids, most = _ids(file, id_place), _maxima(file, place)
    marks = {key: _capped(mark, what, most) for key, mark in marks.items()} if cap else marks
    left = _fill(file, place, ids, marks, what)
    if len(left) == len(ids):
        raise CourseError(NO_MARK.format(id_column, lms.name, exercise, next(iter(marks))))
    write_whole(target, file.encoded())
    rows = (f"row {row + 1}, {file.text(row, id_place) or 'no ID'}: {why}" for row, why in left.items())
    lines = [*_points_lines(most, marks.values(), what), *_unmatched(lms.name, rows, marks, ids)]
    return [*map(printable, lines), f"Wrote {target}: {len(ids) - len(left)} {KINDS[what]}."]


def _unmatched(
    name: str, rows: Iterable[str], marks: Mapping[str, dict[str, str]], ids: Mapping[int, str]
) -> Iterator[str]:
    """Yield a line for each row that is left as it is, and for each student without a row."""
    yield from (f"{name}: {row}" for row in rows)
    missing = (mark["student"] for key, mark in marks.items() if key not in ids.values())
    yield from (f"gradebook.csv: {student}: no such ID in {name}" for student in missing)


def _places(file: LmsFile, column: str, id_column: str) -> tuple[int, int]:
    """Return where the marks go and where the IDs are.

    Raises:
        CourseError: A column is not there, or both are the same.
    """
    place, id_place = file.column(column), file.column(id_column)
    if place == id_place:
        raise CourseError(f"--column and --id-column are both {column!r}; the marks would replace the IDs.")
    return place, id_place


def _ids(file: LmsFile, place: int) -> dict[int, str]:
    """Return the students' IDs by row; Canvas's row of points and empty rows are skipped."""
    students = [row for row in range(1, len(file.rows)) if file.text(row, 0) != POINTS_POSSIBLE]
    given = ((row, file.text(row, place)) for row in students)
    return {row: _key(text) for row, text in given if text or file.text(row, 0)}


def _fill(
    file: LmsFile, place: int, ids: dict[int, str], marks: dict[str, dict[str, str]], what: str
) -> dict[int, str]:
    """Put what there is into the column; returns why a row was left as it is."""
    count, left = Counter(ids.values()), dict[int, str]()
    for row, key in ids.items():
        if problem := _problem(key, marks.get(key), count[key], len(file.rows[row]) <= place):
            left[row] = problem
        else:
            file.put(row, place, f"{float(marks[key][what]):.10g}")
    return left


def _marks(out: Path, exercise: str) -> dict[str, dict[str, str]]:
    is_term = exercise == TERM
    path = out / (TERM_TABLE if is_term else "gradebook.csv")
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = [_of_term(row) if is_term else row for row in csv.DictReader(file)]
        marks = {_key(row["student"]): row for row in rows if row["exercise"] == exercise}
    except (OSError, UnicodeError, KeyError, csv.Error) as error:
        command = f"term {out} --roster roster.csv" if is_term else f"grade SUBMISSIONS --out {out}"
        raise CourseError(f"{path} can't be read: {error!r}. Type: course {command}") from error
    gradebook = out / "gradebook.csv"
    if is_term and gradebook.is_file() and gradebook.stat().st_mtime > path.stat().st_mtime:
        raise CourseError(f"{path} is older than {gradebook}: first type course term {out}")
    if not marks:
        known = ", ".join(sorted({row["exercise"] for row in rows})) or "none"
        raise CourseError(f"{path} has no marks for --exercise {exercise}; it has {known}.")
    return marks


def _of_term(row: Mapping[str, str]) -> dict[str, str]:
    """Return a line of the term as one of the gradebook; a total is final when no week is open."""
    total, is_final = row["total"], row["total"] and not row["open"]
    same = {"student": row["student"], "exercise": TERM, "score": total, "final": total, "max_score": "100"}
    return {**same, "status": "graded" if is_final else "open"}


def _key(text: str) -> str:
    """Return an ID in the spelling that both sides share."""
    try:
        return normalise(text)
    except CourseError:
        return text.strip().casefold()


def _problem(key: str, mark: dict[str, str] | None, count: int, is_short: bool) -> str:
    """Return why a row is left as it is, or ""."""
    if key and count > 1:
        return "more than one row has this ID, left as they are"
    if mark is None:
        return "no mark"
    if mark["status"] not in FINAL:
        return f"{mark['status']}, left as it is"
    return "the row is too short" if is_short else ""


def _maxima(file: LmsFile, place: int) -> set[float]:
    """Return the most points that the platform gives: Canvas's in a row, Moodle's in a column.

    In other languages Moodle's column is known by its place behind the marks, with one number in all rows.
    """
    rows = range(1, len(file.rows))
    most = {file.text(row, place) for row in rows if file.text(row, 0) == POINTS_POSSIBLE}
    headings = [heading.casefold() for heading in file.headings]
    if MAXIMUM in headings:
        most |= {file.text(row, headings.index(MAXIMUM)) for row in rows}
    elif not most:
        behind = {file.text(row, place + 1) for row in rows if any(file.rows[row])}
        most = behind if len(behind) == 1 else set()
    return {float(text.replace(",", ".")) for text in most if re.fullmatch(r"\d+([.,]\d+)?", text)}


def _capped(mark: dict[str, str], what: str, most: set[float]) -> dict[str, str]:
    """Return a mark of at most the platform's maximum; the exercise's where the CSV does not have it."""
    if mark["status"] not in FINAL:
        return mark
    limit = max(most) if most else float(mark["max_score"])
    return {**mark, what: str(min(float(mark[what]), limit))}


def _points_lines(there: set[float], marks: Iterable[dict[str, str]], what: str) -> list[str]:
    """Return notes if the platform counts other points than the exercise, or if a bonus leads beyond them."""
    rated = [mark for mark in marks if mark["status"] in FINAL]
    ours = {float(mark["max_score"]) for mark in rated}
    lines = []
    if there and not there & ours:
        given, own = (", ".join(f"{points:g}" for points in sorted(each)) for each in (there, ours))
        lines.append(f"note: the platform gives {given} points, gradebook.csv {own}")
    if there and (above := sum(float(mark[what]) > max(there) for mark in rated)):
        lines.append(
            f"note: {counted(above, 'mark')} above the platform's {max(there):g}: it may refuse them; "
            "--cap makes each the maximum"
        )
    return lines
