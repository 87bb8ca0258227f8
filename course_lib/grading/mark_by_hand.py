"""`course mark`: points and comments of a person, at once in gradebook, index and report."""

from pathlib import Path

from course_lib.course.files import exercises_dir, solutions_dir
from course_lib.errors import CourseError
from course_lib.grading.grade_one import Course, catalog_of, renew_report
from course_lib.grading.hand_marks import add_mark, marks_path
from course_lib.grading.out_folder import sole_use, writing
from course_lib.grading.report_index import write_tables
from course_lib.grading.result import read_result, result_path
from course_lib.grading.submission import Submission


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
    """Keep what a person gives; says what the mark is now.

    Args:
        out: The folder that `course grade` wrote.
        student: As it stands in the gradebook.
        exercise: "week05_exercise".
        task: "week05.essay".
        points: A number: for the row, else for the whole task instead of what the checks give.
        row: Of the rubric: its number from 1, or how it begins.
        comment: For the student.
        course: Where the tasks are; default: this checkout.

    Raises:
        CourseError: No such student, exercise, task or row; too many points; or `out` is in use.
    """
    try:
        number = float(points)
    except ValueError as error:
        raise CourseError(f"{points!r} are no points: expected a number") from error
    path = result_path(out, student, exercise)
    if not path.is_file():
        raise CourseError(f"{path} is not there: see {out / 'gradebook.csv'} for students and exercises")
    with sole_use(out), writing(out):
        result = read_result(path)
        tasks = {known["task"]: known for known in result.get("tasks", ())}
        if task not in tasks:
            raise CourseError(
                f"{exercise} of {student} has no task {task!r}, only {', '.join(tasks) or 'none'}"
            )
        given = add_mark(marks_path(out, student, exercise), tasks[task], number, row, comment)
        course = course or Course(exercises_dir(), solutions_dir())
        renew_report(Submission.from_plain(result), course, out)
        write_tables(out, catalog_of(course).course.zone)
    now = read_result(path)["row"]
    what = f"{task} ({given.row})" if given.row else task
    return f"{student} {exercise}: {number:g} for {what}; now {now['final']:g}, {now['status']}"
