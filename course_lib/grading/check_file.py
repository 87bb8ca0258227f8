"""`course check FILE`: the public checks of a whole notebook, in a process of its own, as at grading."""

import sys
from pathlib import Path

from course_lib.course.identity import current_identity
from course_lib.errors import CourseError
from course_lib.grading.catalog import shipped_catalog
from course_lib.grading.check import table_of
from course_lib.grading.exercise_run import run_exercise
from course_lib.grading.notebook import parse_notebook
from course_lib.grading.submission import exercise_of, unpack


def check_file(path: Path) -> bool:
    """Run a notebook from top to bottom, show a table per task; says whether everything passed.

    Raises:
        CourseError: It can't be read, or is no exercise of the course.
    """
    data, _ = unpack(path)
    notebook, catalog = parse_notebook(data, str(path)), shipped_catalog()
    tasks = catalog.of_week((exercise_of(notebook, path) or "").split("_")[0])
    if not tasks:
        raise CourseError(f"{path} is no exercise of this course. Name one like week01_exercise.ipynb")
    student = notebook.student or current_identity()
    run = run_exercise(notebook.cells, tasks, catalog, student, hidden=False)
    lines = [f"{error}\n" for error in run.cell_errors]
    lines += [f"{table_of(task, result)}\n" for task, result in zip(tasks, run.results, strict=True)]
    sys.stdout.write("\n".join(lines))
    return all(result.passed for result in run.results)
