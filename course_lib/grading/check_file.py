"""`course check FILE`: the public checks of a whole notebook, in a process of its own, as at grading."""

from pathlib import Path

from course_lib.course.exercise import find_notebook
from course_lib.course.identity import current_identity
from course_lib.errors import CourseError
from course_lib.grading.catalog import shipped_catalog
from course_lib.grading.check import remember, table_of
from course_lib.grading.exercise_run import run_exercise
from course_lib.grading.first_causes import Causes
from course_lib.grading.handin.notebook import parse_notebook
from course_lib.grading.handin.submission import NO_EXERCISE, unpack
from course_lib.grading.handin.working_files import working_files

NOT_CHECKED = "{0.id} ({0.title}): not checked, as {0.name} cannot run for a reason above."


def check_file(path: Path) -> bool:
    """Run a notebook from top to bottom, print a table per task; says whether everything passed.

    Raises:
        CourseError: It can't be read, or is no exercise of the course.
    """
    path = find_notebook(path)
    notebook, catalog = parse_notebook(unpack(path)[0], path.name), shipped_catalog()
    tasks = catalog.of_week((notebook.exercise or "").split("_")[0])
    if not tasks:
        raise CourseError(f"{path} {NO_EXERCISE}")
    own = current_identity()
    student = notebook.student or own
    run = run_exercise(
        notebook.cells, tasks, catalog, student, hidden=False, files=working_files(path, notebook.cells)
    )
    causes = Causes(run.cell_errors, notebook.cells)
    said: list[object] = [*causes.lines()]
    for task, result in zip(tasks, run.results, strict=True):
        remember(task, result, notebook.cells)
        evidence = [one.evidence for one in run.runs if one.evidence.task == task.id]
        follows = causes.explain(result)
        said.append(NOT_CHECKED.format(task) if follows else table_of(task, result, evidence, student))
    if own and student != own:
        said.append(
            f"{path.name} names the student {student}, you are {own}. set_identity('{own}') stamps it."
        )
    print(*said, sep="\n\n")  # noqa: T201  the terminal is its page
    return all(result.passed for result in run.results)
