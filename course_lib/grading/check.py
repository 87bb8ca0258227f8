"""`check(task, obj)` in a notebook: runs the student's object, judges it, shows why."""

import os
import sys
from collections.abc import Callable, Sequence
from typing import Any

from course_lib.course.checked import keep_check
from course_lib.course.identity import current_identity
from course_lib.course.page import in_notebook, show
from course_lib.course.state import student_state
from course_lib.errors import CourseError
from course_lib.grading.catalog import shipped_catalog
from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import Run, TaskResult, judge_task
from course_lib.grading.personal import personal_values
from course_lib.grading.scenario import run_here
from course_lib.grading.table import Table
from course_lib.grading.task import HINTS, Task

STRICT = "COURSE_STRICT"
GHOST_HEIGHT = 260  # [px]
FILL_IN = "Nothing is filled in yet: replace the line with raise NotImplementedError, then check again."
NO_ID = "No student ID is known, so your own values are a guest's. In week 0 type: set_identity('your-id')"

_bind: Callable[[str, Any], None] | None = None  # set in the grader's worker


class CheckFailedError(CourseError):
    """With COURSE_STRICT=1: a check did not pass."""


def check(task_id: str, subject: Any) -> None:
    """Run your object through a task's public checks and show what passed, what did not, and why.

    Args:
        task_id: The task, "week01.red_cube".
        subject: What the task asks for: the node class itself, a function, a value or a text.

    Raises:
        CourseError: There is no such task; or with COURSE_STRICT=1, a check failed.
    """
    if _bind is not None:
        _bind(task_id, subject)
        return
    catalog, student = shipped_catalog(), current_identity()
    task = catalog.task(task_id)
    personal = personal_values(task, student)
    runs = [Run(scenario, run_here(task, scenario, subject, personal)) for scenario in task.scenarios]
    result = judge_task(task, *catalog.points(task), runs)
    table = table_of(task, result, student, _cells_of_this_kernel())
    show(lambda: table, str(table))
    if in_notebook() and task.ghost and not result.passed:
        _show_ghost(task, runs[0].evidence)
    if os.environ.get(STRICT) == "1" and not result.passed:
        raise CheckFailedError(str(table))


def bind_only(bind: Callable[[str, Any], None]) -> None:
    """From now on `check` hands the object over and runs nothing: for the grader's worker."""
    global _bind
    _bind = bind


def _cells_of_this_kernel() -> list[str]:
    """Return the sources of the cells that were run in this kernel; none outside of one."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    history = getattr(shell, "history_manager", None)
    return [] if history is None else list(history.input_hist_raw)


def table_of(task: Task, result: TaskResult, student: str | None, cells: Sequence[str] = ()) -> Table:
    """Return the result as a table, with the next hint if a check failed; keep progress and hints shown.

    Args:
        task: The task.
        result: What the checks say.
        student: Who asks.
        cells: The sources that were run, by which later changes are noticed.
    """
    state, notes = student_state(), []
    state.put("progress", task.id, {"score": result.score, "of": result.points})
    keep_check(state, task.id, passed=result.passed and not result.untouched, cells=cells)
    if result.untouched:
        notes.append(FILL_IN)
    elif task.scenarios and not result.passed:
        failures = min(state.get("hints", task.id, 0) + 1, HINTS)
        state.put("hints", task.id, failures)
        notes.append(f"Hint {failures} of {HINTS}: {task.hints[failures - 1]}")
    if task.personal and student is None:
        notes.append(NO_ID)
    return Table(result, tuple(notes))


def _show_ghost(task: Task, evidence: Evidence) -> None:
    from IPython.display import display

    from course_lib.grading.ghost import compared
    from course_lib.viewer.widget import SceneWidget

    view = SceneWidget(compared(task, evidence), GHOST_HEIGHT, "what you drew, and pale: what is expected")
    display(view)  # type: ignore[no-untyped-call]  # IPython does not annotate it
