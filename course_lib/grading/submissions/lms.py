"""Write marks into the CSV that a learning platform (Canvas, Moodle or another) exported."""

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path

from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically
from course_lib.grading.marks import COLUMNS, results_in, standing_marks
from course_lib.grading.reports.rendering import escape_formula, join_few, replace_controls
from course_lib.grading.submissions.notebook import full_exercise_name
from course_lib.grading.submissions.roster import LmsFile, read_id

POINTS_POSSIBLE = "Points Possible"  # Canvas's row with the maximum points of each column
MAXIMUM = "maximum grade"  # Moodle's column with the maximum points, in English
OPTIONS = {
    "exercise": "whose marks: week01_exercise",
    "column": "the heading of the column to fill",
    "id_column": "the heading of the students' IDs",
    "to": "the file to write",
}
FINAL = ("graded", "limit")
MOST_SHOWN = 3  # number of rows in an error
NO_MARK = (
    "no ID in column {!r} of {}, like {!r}, has a mark for {}; gradebook.csv has IDs like {}. "
    "Pass another --id-column."
)
EXPORT_AGAIN = "A spreadsheet has changed this number: export the file again, don't save it there"
KINDS = {
    "score": "scores before the late policy",
    "final": "marks after the late policy; turn off the platform's late policy",
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
    comment_column: str = "",
    students: Collection[str] | None = None,
) -> list[str]:
    """Fill one column with the marks of an exercise, and write the file otherwise unchanged.

    Args:
        out: The folder with gradebook.csv.
        lms: The platform's export.
        target: The file to write.
        exercise: "week01_exercise".
        column: The heading of the column to fill.
        id_column: The heading of the students' IDs.
        raw: Use the score before the late policy.
        cap: Reduce marks above the platform's maximum to the maximum.
        comment_column: The heading of a column for graders' comments; "" fills none.
        students: The IDs of the students whose rows are filled; None for all.

    Returns:
        A line for each row or mark without a counterpart, and a summary.

    Raises:
        CourseError: A file can't be read, a column is missing, or no row matches.
    """
    exercise = full_exercise_name(exercise)
    file, marks, mark_column = LmsFile.read(lms), _marks(out, exercise), "score" if raw else "final"
    place, id_place = file.column(column), file.column(id_column)
    if place == id_place:
        raise CourseError(f"--column and --id-column are both {column!r}; the marks would replace the IDs.")
    ids, max_points = _ids(file, id_place), _maxima(file, place)
    if students is not None:
        marks = {key: mark for key, mark in marks.items() if key in students}
        ids = {row: key for row, key in ids.items() if key in students}
        if not marks or not ids:
            raise CourseError(f"{lms} or gradebook.csv has no student of this section in {exercise}")
    for mark in (mark for mark in marks.values() if cap and mark["status"] in FINAL):
        # The limit is the platform's maximum or, without one, the exercise's maximum.
        limit = max(max_points) if max_points else float(mark["max_score"])
        mark[mark_column] = str(min(float(mark[mark_column]), limit))
    unfilled = _fill(file, place, ids, marks, mark_column)
    ids_by_row = {row: file.text(row, id_place) or "no ID" for row in unfilled}
    rows = [f"row {row + 1}, {ids_by_row[row]}: {why}" for row, why in unfilled.items()]
    if ids.keys() <= unfilled.keys():
        if marks.keys() & ids.values():
            reasons = "; ".join(rows[:MOST_SHOWN])
            raise CourseError(f"no mark was written into {lms.name}: {reasons}")
        example = next(filter(None, ids.values()), "")
        raise CourseError(NO_MARK.format(id_column, lms.name, example, exercise, next(iter(marks))))
    comments = _comments(out, exercise) if comment_column else {}
    comment_place = file.column(comment_column) if comment_column else 0
    if comment_column and comment_place in (place, id_place):
        raise CourseError(f"--comment-column {comment_column!r} is the column of the marks or of the IDs.")
    for row, key in ids.items():
        if row not in unfilled and key in comments and comment_place < len(file.rows[row]):
            quoted = comments[key].replace('"', '""')
            try:
                quoted.encode(file.encoding, "surrogatepass" if file.bom else "strict")
            except UnicodeEncodeError as error:
                raise CourseError(
                    f"{lms.name}, row {row + 1}: its encoding {file.encoding} lacks the character "
                    f"{quoted[error.start]!r} of the comment. Export {lms.name} again as UTF-8, or "
                    "open it in an editor and save it as UTF-8, then repeat the command"
                ) from error
            file.rows[row][comment_place] = f'"{quoted}"'
    write_atomically(target, file.to_bytes())
    # A CSV of one section lacks most students.
    elsewhere = [mark["student"] for key, mark in marks.items() if key not in ids.values()]
    lines = [
        *_points_lines(max_points, marks.values(), mark_column),
        *(f"{lms.name}: {row}" for row in rows),
        *([f"gradebook.csv: no such ID in {lms.name}: {join_few(elsewhere)}"] if elsewhere else []),
    ]
    return [
        *map(replace_controls, lines),
        f"Wrote {target}: {len(ids) - len(unfilled)} {KINDS[mark_column]}.",
    ]


def require_options(lms: Path, options: Mapping[str, object]) -> None:
    """Require all options of `course mark --lms`, by their names in Python.

    Raises:
        CourseError: Options are missing. The message contains them and the headings of the CSV.
    """
    missing = [name for name in OPTIONS if not options[name]]
    if missing:
        needs = "; ".join(f"--{name.replace('_', '-')}, {OPTIONS[name]}" for name in missing)
        headings = ", ".join(map(repr, LmsFile.read(lms).headings))
        raise CourseError(f"--lms also needs {needs}. {lms} has the headings {headings}")


def _comments(out: Path, exercise: str) -> dict[str, str]:
    """Return graders' comments on the tasks of each student, one line per task."""
    comments: dict[str, str] = {}
    for result in (marked for marked in results_in(out) if marked.exercise == exercise):
        exercise_comments = [
            mark.comment for mark in standing_marks(result.marks) if not mark.task and mark.comment
        ][-1:]
        tasks = [f"{task.title}: {'; '.join(task.comments)}" for task in result.tasks if task.comments]
        if lines := [*exercise_comments, *tasks]:
            comments[result.student] = str(escape_formula("\n".join(lines)))
    return comments


def _ids(file: LmsFile, place: int) -> dict[int, str]:
    """Return the students' IDs by row, skipping empty rows and Canvas's row of points."""
    students = [row for row in range(1, len(file.rows)) if file.text(row, 0) != POINTS_POSSIBLE]
    id_texts = ((row, file.text(row, place)) for row in students)
    return {row: _key(text) for row, text in id_texts if text or file.text(row, 0)}


def _fill(
    file: LmsFile, place: int, ids: dict[int, str], marks: dict[str, dict[str, str]], column: str
) -> dict[int, str]:
    """Fill the column with the marks, and return the reason for each row that is left unchanged."""
    count, unfilled = Counter(ids.values()), dict[int, str]()
    for row, key in ids.items():
        mark = marks.get(key)
        if key and count[key] > 1:
            unfilled[row] = "more than one row has this ID; they are unchanged"
        elif mark is None:
            # 0042 becomes 42, and 4100001 becomes 4.1E+06, when a spreadsheet saves the file.
            similar = [known for known in marks if key and known.lstrip("0") == key.lstrip("0")]
            advice = f", but {join_few(similar)} has one. {EXPORT_AGAIN}" if similar else ""
            advice = f": {EXPORT_AGAIN}" if re.fullmatch(r"\d([.,]\d+)?e\+\d+", key) else advice
            unfilled[row] = f"no mark{advice}"
        elif mark["status"] not in FINAL:
            unfilled[row] = f"{mark['status']}, row unchanged"
        elif len(file.rows[row]) <= place:
            unfilled[row] = "the row is too short"
        else:
            file.put(row, place, f"{float(mark[column]):.10g}")
    return unfilled


def _marks(out: Path, exercise: str) -> dict[str, dict[str, str]]:
    """Return the lines of gradebook.csv about an exercise by student, with decimal points in numbers.

    The file may have been saved by a spreadsheet, with semicolons and decimal commas.
    """
    path, command = out / "gradebook.csv", f"course grade SUBMISSIONS --out {out} --resume"
    try:
        file = LmsFile.read(path)
        places = {name: file.column(name) for name in COLUMNS}
    except CourseError as error:
        raise CourseError(f"{error}. To write {path} again, type: {command}") from error
    marks, rows = dict[str, dict[str, str]](), list[dict[str, str]]()
    for number in range(1, len(file.rows)):
        row = {name: file.text(number, place) for name, place in places.items()}
        rows.append(row)
        for name in ("score", "max_score", "final") if row["status"] in FINAL else ():
            row[name] = row[name].replace(",", ".")
            if not re.fullmatch(r"-?\d+(\.\d+)?(e-?\d+)?", row[name]):
                raise CourseError(
                    f"{path}, row {number + 1}: {name} is {row[name]!r}, expected a number. "
                    f"To write the file again, type: {command}"
                )
        if row["exercise"] == exercise:
            marks[_key(row["student"])] = row
    if not marks:
        known_exercises = ", ".join(sorted({row["exercise"] for row in rows})) or "none"
        raise CourseError(f"{path} has no marks for --exercise {exercise}; it has {known_exercises}.")
    return marks


def _key(text: str) -> str:
    """Return an ID in normalized spelling."""
    try:
        return read_id(text)
    except CourseError:
        return text.strip().casefold()


def _maxima(file: LmsFile, place: int) -> set[float]:
    """Return the platform's maximum points, from a row of Canvas's CSV or a column of Moodle's CSV.

    In languages other than English, Moodle's column is recognized because it follows the column of
    the marks and contains the same number in each row.
    """
    rows = range(1, len(file.rows))
    maxima = {file.text(row, place) for row in rows if file.text(row, 0) == POINTS_POSSIBLE}
    headings = [heading.casefold() for heading in file.headings]
    if MAXIMUM in headings:
        maxima |= {file.text(row, headings.index(MAXIMUM)) for row in rows}
    elif not maxima:
        next_column = {file.text(row, place + 1) for row in rows if any(file.rows[row])}
        maxima = next_column if len(next_column) == 1 else set()
    return {float(text.replace(",", ".")) for text in maxima if re.fullmatch(r"\d+([.,]\d+)?", text)}


def _points_lines(there: set[float], marks: Iterable[dict[str, str]], column: str) -> list[str]:
    """Return notes if the maximum differs between platform and exercise, or a bonus exceeds it."""
    rated = [mark for mark in marks if mark["status"] in FINAL]
    own_points = {float(mark["max_score"]) for mark in rated}
    lines = []
    if there and not there & own_points:
        platform_text, own_text = (
            ", ".join(f"{points:g}" for points in sorted(each)) for each in (there, own_points)
        )
        lines.append(
            f"note: the maximum is {platform_text} points on the platform and {own_text} in "
            "gradebook.csv: correct one of them if this is not intended"
        )
    if there and (above := sum(float(mark[column]) > max(there) for mark in rated)):
        lines.append(
            f"note: {format_count(above, 'mark')} above the platform's {max(there):g}: it may "
            "reject them; --cap reduces them to the maximum"
        )
    return lines
