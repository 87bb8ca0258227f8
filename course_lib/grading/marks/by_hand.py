"""`course mark`: points and comments of a person, which gradebook, index and report show."""

from collections.abc import Collection
from pathlib import Path

from course_lib.course.identity import normalise
from course_lib.errors import CourseError, did_you_mean
from course_lib.grading.marks.mark import Result, read_result
from course_lib.grading.marks.marks import Given, add_marks
from course_lib.grading.records import (
    Course,
    catalog_of,
    marks_path,
    result_path,
    sole_use,
    this_course,
    writing,
)
from course_lib.grading.reports.report import report
from course_lib.grading.reports.tables import write_tables


def mark_by_hand(
    out: Path,
    student: str,
    exercise: str,
    task: str,
    points: str,
    *,
    row: str = "",
    comment: str = "",
    course: Course | None = None,
) -> str:
    """Store the points of a person, and return a line with the new mark.

    Args:
        out: The folder that `course grade` wrote.
        student: As it stands in the gradebook.
        exercise: "week01_exercise".
        task: "week01.essay", or "essay".
        points: A number: for the row, else for the whole task instead of what the checks give.
        row: Of the rubric: its number from 1, or how it begins.
        comment: For the student; "" keeps the one that is there.
        course: Where the tasks are; default: this checkout.

    Raises:
        CourseError: No such student, exercise, task or row; too many points; or `out` is in use.
    """
    number, catalog = _number(points), catalog_of(course or this_course())
    student = known_name(student, out / "results", "student")
    exercise = known_name(exercise, out / "results" / student, "exercise")
    path = result_path(out, student, exercise)
    with sole_use(out), writing(out):
        result, file = Result.from_plain(read_result(path)), marks_path(out, student, exercise)
        judged, seen = result.judgement, result.submission.sha256
        tasks = {known.task: known for known in (judged.tasks if judged else ())}
        task = _task(task, tasks, f"{exercise} of {student}")
        (given,) = add_marks(file, tasks[task], [Given(number, row, comment or None)], sha256=seen)
        report(result, out, catalog)
        write_tables(out, catalog.course.zone)
    now, what = read_result(path)["row"], f"{task} ({given.row})" if given.row else task
    return f"{student} {exercise}: {number:g} for {what}; now {now['final']:g}, {now['status']}"


def _number(points: str) -> float:
    try:
        return float(points)
    except ValueError as error:
        raise CourseError(f"{points!r} is not a number of points") from error


def known_name(name: str, folder: Path, what: str) -> str:
    """Return the name of a student or an exercise as the results have it.

    Raises:
        CourseError: There is none; names the nearest.
    """
    known = sorted(path.stem if path.is_file() else path.name for path in folder.glob("[!.]*"))
    spelled = {_spelled(one): one for one in known}
    for spelling in (_spelled(name), _spelled(f"{name}_{what}")):
        if spelling in spelled:
            return spelled[spelling]
    meant = did_you_mean(_spelled(name), spelled, 3) or f"; there is {', '.join(known[:10]) or 'none'}."
    raise CourseError(f"{folder} has no {what} {name!r}{meant}")


def _spelled(name: str) -> str:
    try:
        return normalise(name)
    except CourseError:
        return name


def _task(name: str, tasks: Collection[str], of: str) -> str:
    """Return a task's id, also by what follows its dot.

    Raises:
        CourseError: There is none; names the nearest.
    """
    if not tasks:
        raise CourseError(f"{of} has no mark to change: gradebook.csv says why")
    short = {task.split(".", 1)[-1]: task for task in tasks}
    found = name if name in tasks else short.get(name)
    if found is None:
        meant = did_you_mean(name, [*short, *tasks], 3) or f"; there is {', '.join(short) or 'none'}."
        raise CourseError(f"{of} has no task {name!r}{meant}")
    return found
