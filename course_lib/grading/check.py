"""`check(task, obj)` in a notebook: runs the student's object, judges it, shows why."""

import os
from collections.abc import Callable
from typing import Any

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
    task = shipped_catalog().task(task_id)
    runs = run_public(task, subject)
    result = judge_task(task, *shipped_catalog().points(task), runs)
    table = table_of(task, result)
    show(lambda: table, str(table))
    if in_notebook() and task.ghost and not result.passed:
        _show_ghost(task, runs[0].evidence)
    if os.environ.get(STRICT) == "1" and not result.passed:
        raise CheckFailedError(str(table))


def bind_only(bind: Callable[[str, Any], None]) -> None:
    """From now on `check` hands the object over and runs nothing: for the grader's worker."""
    global _bind
    _bind = bind


def run_public(task: Task, subject: Any) -> list[Run]:
    """Run a task's public scenarios in this process."""
    personal = personal_values(task, current_identity())
    return [Run(scenario, run_here(task, scenario, subject, personal)) for scenario in task.scenarios]


def table_of(task: Task, result: TaskResult) -> Table:
    """The result as a table, with the next hint if a check failed; progress and hints shown are kept."""
    state, hint = student_state(), ""
    state.put("progress", task.id, {"score": result.score, "of": result.points})
    if task.scenarios and not result.passed:
        failures = min(state.get("hints", task.id, 0) + 1, HINTS)
        state.put("hints", task.id, failures)
        hint = f"Hint {failures} of {HINTS}: {task.hints[failures - 1]}"
    return Table(result, hint)


def _show_ghost(task: Task, evidence: Evidence) -> None:
    from IPython.display import display

    from course_lib.grading.ghost import compared
    from course_lib.viewer.widget import SceneWidget

    view = SceneWidget(compared(task, evidence), GHOST_HEIGHT, "what you drew, and pale: what is expected")
    display(view)  # type: ignore[no-untyped-call]  # IPython does not annotate it
