"""`course mark` in a terminal: a single task, work without a file, and the reports after marks.

Marks appear in gradebook, index and report. The page for marking (`server.py`) runs this module in
a process of its own, which updates them.
"""

import os
import sys
from collections.abc import Callable, Collection
from contextlib import suppress
from pathlib import Path

from course_lib.course.course_file import POINTS_PER_WEEK, CourseFile
from course_lib.course.exercise import normalise
from course_lib.errors import CourseError, did_you_mean, format_count
from course_lib.grading import store
from course_lib.grading.marks import MarkEntry, add_marks, mark, read_result, require_results, stored_result
from course_lib.grading.records import UNKNOWN, ReceiptTime, Result, Submission, TaskResult
from course_lib.grading.reports.rendering import print_line
from course_lib.grading.reports.report import has_page, report
from course_lib.grading.reports.tables import write_tables

GENTLE = 10  # niceness of the process that writes reports
Place = tuple[str, str]  # student and exercise


def mark_by_hand(
    out: Path,
    student: str,
    exercise: str,
    task: str,
    points: str = "",
    *,
    row: str = "",
    comment: str = "",
    withdraw: bool = False,
    course: store.Course | None = None,
) -> str:
    """Store the points of a grader, and return a line with the new mark.

    Args:
        out: The folder that `course grade` wrote.
        student: The student as in the gradebook.
        exercise: "week01_exercise".
        task: "week01.essay", or "essay".
        points: A number, for the row if one is given, else for the whole task instead of the
            checks' points.
        row: A row of the rubric: its number from 1, or the beginning of its text.
        comment: A comment for the student; "" keeps the existing one.
        withdraw: Withdraw earlier marks instead of giving points; the checks' points count again.
        course: The course with the tasks; default: this checkout.

    Raises:
        CourseError: The student, exercise, task or row does not exist; too many points; or no mark
            to withdraw.
    """
    entry = (
        MarkEntry(None, row, withdraw=True) if withdraw else MarkEntry(_number(points), row, comment or None)
    )
    catalog = store.catalog_of(course or store.this_course())
    student = _find_name(student, out / "results", "student")
    exercise = _find_name(exercise, out / "results" / student, "exercise")
    path = store.result_path(out, student, exercise)
    with store.lock_folder(out, print_line), store.writing(out):
        result, file = read_result(path).result, store.marks_path(out, student, exercise)
        tasks = {task_result.task: task_result for task_result in result.tasks}
        task = _find_task(task, tasks, f"{exercise} of {student}")
        (stored_mark,) = add_marks(file, tasks[task], [entry], sha256=result.submission.sha256)
        report(result, out, catalog)
        write_tables(out, catalog.course.zone)
    now, target = read_result(path).row, f"{task} ({stored_mark.row})" if stored_mark.row else task
    change = f"mark for {target} withdrawn" if withdraw else f"{stored_mark.points:g} for {target}"
    points_now = f"{now.mark.final:g}, " if now.mark else ""
    return f"{student} {exercise}: {change}; now {points_now}{now.status}"


def mark_without_file(
    out: Path,
    student: str,
    exercise: str,
    points: str = "",
    *,
    comment: str = "",
    withdraw: bool = False,
    course: store.Course | None = None,
) -> str:
    """Store a grader's points for work without a gradable file, such as an oral exam.

    Return a line for the terminal.

    Args:
        out: The folder of records, in which the student may be new.
        student: The student's ID.
        exercise: "week01_exercise", or "week01".
        points: Points for the whole exercise, without the late policy.
        comment: A comment for the student; "" keeps the existing one.
        withdraw: Withdraw such a mark.
        course: The course with the tasks; default: this checkout.

    Raises:
        CourseError: The exercise does not exist, a file of it has been graded, or the points are
            invalid.
    """
    entry = MarkEntry(None, withdraw=True) if withdraw else MarkEntry(_number(points), "", comment or None)
    catalog = store.catalog_of(course or store.this_course())
    weeks = {week: settings for week, settings in catalog.course.weeks.items() if settings.points}
    week = normalise(exercise).removesuffix("_exercise")
    if week not in weeks:
        known_exercises = ", ".join(f"{week}_exercise" for week in weeks)
        raise CourseError(f"there is no exercise {exercise!r}; exercises with points: {known_exercises}")
    student, exercise = normalise(student), f"{week}_exercise"
    path = store.result_path(out, student, exercise)
    with store.lock_folder(out, print_line), store.writing(out):
        is_new = not path.is_file()
        result = _result_without_file(student, exercise) if is_new else read_result(path).result
        if result.judgement is not None and not withdraw:
            raise CourseError(
                f"{exercise} of {student} has a file that was graded: enter points for its tasks, "
                f"course mark {out} {student} {exercise} TASK POINTS"
            )
        max_points = POINTS_PER_WEEK + sum(weeks[week].bonus.values())
        exercise_result = TaskResult("", f"{exercise} of {student}", max_points, False, ())
        (stored_mark,) = add_marks(
            store.marks_path(out, student, exercise), exercise_result, [entry], sha256=""
        )
        if is_new:
            result.write(out)
        report(result, out, catalog)
        write_tables(out, catalog.course.zone)
    if stored_mark.withdrawn:
        return f"{student} {exercise}: mark without a file withdrawn; now {read_result(path).row.status}"
    new = ", who is new in the gradebook" if is_new else ""
    return f"{student} {exercise}{new}: {stored_mark.points:g} without a file; now graded"


def find_stale(out: Path) -> list[Place]:
    """Return the students and exercises whose reports do not contain all graders' marks."""
    files = sorted((out / "marks").glob("[!.]*/[!.]*.json"))
    places = [(path.parent.name, path.stem) for path in files]
    graded_places = [place for place in places if store.result_path(out, *place).is_file()]
    return [place for place in graded_places if not has_page(stored_result(out, *place).result, out)]


def update_reports(
    out: Path, course: store.Course | None = None, waiting: Callable[[str], None] | None = None
) -> str:
    """Write the tables and the reports without all graders' marks, and return a line for the terminal.

    Args:
        out: The folder that `course grade` wrote.
        course: The course with the tasks; default: this checkout.
        waiting: Called with a line of text before waiting for another process; None raises instead
            of waiting.

    Raises:
        RecordsWriteError: The folder can't be written.
        CourseError: The folder is in use, or a file in it is damaged.
    """
    require_results(out)
    course = course or store.this_course()
    with store.lock_folder(out, waiting), store.writing(out):
        places, catalog = find_stale(out), store.catalog_of(course)
        # The tables come first, because they matter more than the pages.
        write_tables(out, catalog.course.zone)
        for place in places:
            report(stored_result(out, *place).result, out, catalog)
    reports = format_count(len(places), "report")
    return f"Wrote {reports}, {out / 'reports/index.html'} and {out / 'gradebook.csv'}"


def _result_without_file(student: str, exercise: str) -> Result:
    """Return the result of a student who has not submitted a file."""
    nothing = Submission(
        student,
        exercise,
        Path(f"{student}/{exercise}.ipynb"),
        ReceiptTime(None, UNKNOWN),
        problem="no file was submitted",
        reason="no file",
    )
    return mark([nothing], [None], CourseFile("", {}), "")


def _number(points: str) -> float:
    try:
        return float(points)
    except ValueError as error:
        raise CourseError(f"{points!r} is not a number of points, expected one like 12.5") from error


def _find_name(name: str, folder: Path, kind: str) -> str:
    """Return the name of a student or an exercise as it is spelled in the results.

    Raises:
        CourseError: It does not exist; the message suggests similar names.
    """
    names = sorted(path.stem if path.is_file() else path.name for path in folder.glob("[!.]*"))
    by_spelling = {_normalize(spelling): spelling for spelling in names}
    for spelling in (_normalize(name), _normalize(f"{name}_{kind}")):
        if spelling in by_spelling:
            return by_spelling[spelling]
    suggestion = (
        did_you_mean(_normalize(name), by_spelling, 3) or f"; it has {', '.join(names[:10]) or 'none'}."
    )
    raise CourseError(f"{folder} has no {kind} {name!r}{suggestion}")


def _normalize(name: str) -> str:
    try:
        return normalise(name)
    except CourseError:
        return name


def _find_task(name: str, tasks: Collection[str], of: str) -> str:
    """Return a task's id, given the id or its part after the dot.

    Raises:
        CourseError: It does not exist; the message suggests similar names.
    """
    if not tasks:
        raise CourseError(
            f"{of} has no graded tasks; gradebook.csv states the reason. Points for the "
            "whole exercise, for paper or an oral exam: course mark OUT STUDENT EXERCISE POINTS "
            "--without-file"
        )
    short = {task.split(".", 1)[-1]: task for task in tasks}
    task_id = name if name in tasks else short.get(name)
    if task_id is None:
        suggestion = did_you_mean(name, [*short, *tasks], 3) or f"; it has {', '.join(short) or 'none'}."
        raise CourseError(f"{of} has no task {name!r}{suggestion}")
    return task_id


def main() -> None:
    """Update once. The program's arguments are the folders of records, exercises and solutions."""
    out, exercises, solutions = map(Path, sys.argv[1:])
    with suppress(OSError):
        os.nice(GENTLE)
    try:
        update_reports(out, store.Course(exercises, solutions))
    except CourseError as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
